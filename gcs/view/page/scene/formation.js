/** Payload, UAVs and links of one run, and their hull, at a time. */

import {
  BoxGeometry, BufferGeometry, CircleGeometry, ConeGeometry, CylinderGeometry, Float32BufferAttribute, Group, LineLoop,
  LineSegments, EdgesGeometry, Mesh, Vector3,
} from 'three';
import { ConvexGeometry } from 'three/addons/geometries/ConvexGeometry.js';
import { attitudeToScene, toScene } from './frames.js';

const LINK_RADIUS = 0.03; // m, wider than it is, to be seen from afar
const RIM = 24; // points on the rim of a disc for the hull

/** @typedef {import('../data.js').Run} Run */
/** @typedef {import('./palette.js').Palette} Palette */

export class Formation {
  /**
   * @param {Run} run
   * @param {Palette} palette
   * @param {'flown'|'ghost'} look as it was, or as what it is compared with
   * @param {import('./labels.js').Labels} [labels] for the numbers of the UAVs
   */
  constructor(run, palette, look, labels) {
    this.run = run;
    this.palette = palette;
    this.group = new Group();
    this.position = run.flown('position');
    this.attitude = run.flown('attitude');
    const ghost = look === 'ghost';
    this.tension = ghost ? null : run.channel('truth.tension');
    const surface = (/** @type {string} */ colour) => (ghost ? palette.translucent('series-7', 0.45) : palette.solid(colour));
    this.payload = payload(run, surface('payload'), palette.hairline(ghost ? 'series-7' : 'background', ghost ? 1 : 0.8));
    this.group.add(this.payload);
    const radius = run.meta.disc_radius ?? 0.3;
    const looks = {
      body: surface('uav'),
      heading: surface('heading'),
      disc: palette.translucent(ghost ? 'series-7' : 'uav', ghost ? 0.2 : 0.3),
      rim: palette.hairline(ghost ? 'series-7' : 'uav'),
    };
    /** @type {{mesh: Group, position: any, attitude: any}[]} */
    this.uavs = [];
    for (let i = 1; run.has(`truth.uav${i}.position`); i += 1) {
      const mesh = uav(radius, looks);
      this.group.add(mesh);
      // It goes where the UAV goes.
      if (labels) labels.add(`${i}`, 'vehicle').position = mesh.position;
      this.uavs.push({ mesh, position: run.channel(`truth.uav${i}.position`), attitude: run.channel(`truth.uav${i}.attitude`) });
    }
    const rod = new CylinderGeometry(LINK_RADIUS, LINK_RADIUS, 1, 8);
    this.attachments = (run.meta.attachments ?? []).map((/** @type {number[]} */ point) => toScene(point));
    this.links = this.uavs.slice(0, this.attachments.length).map(() => {
      const link = new Mesh(rod, surface('link'));
      this.group.add(link);
      return link;
    });
    /** The scale of the links: about the force in the middle (N), so far as all but the jolts at touch-down go. */
    this.force = this.scale();
    this.rim = Array.from({ length: RIM }, (_, k) => {
      const angle = (2 * Math.PI * k) / RIM;
      return new Vector3(radius * Math.cos(angle), 0, radius * Math.sin(angle));
    });
    this.corners = (run.meta.hull ?? []).map((/** @type {number[]} */ corner) => toScene(corner));
    this.hull = new Group();
    this.hull.visible = this.uavs.length > 0;
    this.skin = new Mesh(new BufferGeometry(), palette.translucent('flown', 0.1));
    this.edges = new LineSegments(new BufferGeometry(), palette.hairline('flown', 0.55));
    this.hull.add(this.skin, this.edges);
  }

  scale() {
    return this.tension ? spread(this.tension, 0.02) : { middle: 0, reach: 1 };
  }

  /** Whether the forces in the links have gone far from the scale. */
  isOutgrown() {
    const { middle, reach } = this.scale();
    return Math.abs(middle - this.force.middle) + Math.abs(reach - this.force.reach) > 0.25 * this.force.reach;
  }

  /** @param {number} time */
  update(time) {
    if (!this.position || !this.attitude) return;
    toScene(this.position.at(time), this.payload.position);
    attitudeToScene(this.attitude.at(time), this.payload.quaternion);
    for (const { mesh, position, attitude } of this.uavs) {
      toScene(position.at(time), mesh.position);
      if (attitude) attitudeToScene(attitude.at(time), mesh.quaternion);
    }
    const tension = this.tension?.at(time);
    const from = new Vector3();
    const along = new Vector3();
    this.links.forEach((link, i) => {
      from.copy(this.attachments[i]).applyQuaternion(this.payload.quaternion).add(this.payload.position);
      along.copy(this.uavs[i].mesh.position).sub(from);
      const length = along.length();
      link.position.copy(from).addScaledVector(along, 0.5);
      link.scale.set(1, Math.max(length, 1e-3), 1);
      link.quaternion.setFromUnitVectors(UP, along.normalize());
      if (tension) link.material.color.copy(this.palette.diverging((tension[i] - this.force.middle) / this.force.reach));
    });
    if (this.hull.visible) this.updateHull();
  }

  /** The convex hull of the payload and the discs: that from which clearance is measured. */
  updateHull() {
    const points = this.corners.map((corner) => placed(corner, this.payload));
    for (const { mesh } of this.uavs) points.push(...this.rim.map((point) => placed(point, mesh)));
    if (points.length < 4) return;
    this.skin.geometry.dispose();
    this.edges.geometry.dispose();
    this.skin.geometry = new ConvexGeometry(points);
    this.edges.geometry = new EdgesGeometry(this.skin.geometry, 20);
  }
}

const UP = new Vector3(0, 1, 0);

/** @param {Vector3} point @param {import('three').Object3D} body */
function placed(point, body) {
  return point.clone().applyQuaternion(body.quaternion).add(body.position);
}

/** The hull of the payload, with its edges. @param {Run} run @param {any} surface @param {any} edge */
export function payload(run, surface, edge) {
  const corners = (run.meta.hull ?? []).map((/** @type {number[]} */ corner) => toScene(corner));
  const geometry = corners.length >= 4 ? new ConvexGeometry(corners) : new BoxGeometry(1, 0.5, 1);
  const mesh = new Mesh(geometry, surface);
  mesh.add(new LineSegments(new EdgesGeometry(geometry, 15), edge));
  return mesh;
}

/** A disc with a body and a mark ahead. @param {number} radius m @param {Record<string, any>} looks */
function uav(radius, looks) {
  const group = new Group();
  const disc = new Mesh(new CircleGeometry(radius, 32), looks.disc);
  disc.rotation.x = -Math.PI / 2;
  const rim = new BufferGeometry();
  const points = Array.from({ length: 32 }, (_, k) => [Math.cos((k * Math.PI) / 16) * radius, 0, Math.sin((k * Math.PI) / 16) * radius]);
  rim.setAttribute('position', new Float32BufferAttribute(points.flat(), 3));
  const body = new Mesh(new BoxGeometry(0.45 * radius, 0.3 * radius, 0.7 * radius), looks.body);
  const heading = new Mesh(new ConeGeometry(0.22 * radius, 0.5 * radius, 12), looks.heading);
  heading.rotation.x = -Math.PI / 2;
  heading.position.set(0, 0, -0.7 * radius);
  group.add(disc, new LineLoop(rim, looks.rim), body, heading);
  return group;
}

/**
 * The median of all values, and how far from it all but a share of them are.
 * @param {import('../data.js').Channel} channel
 * @param {number} share
 */
function spread(channel, share) {
  const values = channel.series.flatMap((column) => Array.from(column).filter(Number.isFinite)).sort((a, b) => a - b);
  const middle = values[values.length >> 1] ?? 0;
  const away = values.map((value) => Math.abs(value - middle)).sort((a, b) => a - b);
  return { middle, reach: Math.max(away[Math.floor((1 - share) * (away.length - 1))] ?? 0, 0.1) };
}
