/** The obstacles as they were, at their place at a time; the zones of the fence are in fence.js. */

import { Box3, EdgesGeometry, Group, LineSegments, Mesh, Raycaster } from 'three';
import { isZone } from './fence.js';
import { attitudeToScene, toScene } from './frames.js';
import { Polyline } from './polyline.js';
import { shapeGeometry } from './shapes.js';
import { straightened } from './thinning.js';

const FADED = 0.25; // opacity of what hides the formation
const TOLERANCE = 0.02; // m, of the path of one that moves
const TOUCHING = 0.05; // m: a place on the surface is not behind it

export class Obstacles {
  /**
   * @param {import('../data.js').Run} run
   * @param {import('./palette.js').Palette} palette
   * @param {import('./labels.js').Labels} labels
   */
  constructor(run, palette, labels) {
    this.group = new Group();
    this.ray = new Raycaster();
    const edge = palette.hairline('obstacle-edge', 0.7);
    const bodies = run.obstacles.filter((/** @type {any} */ obstacle) => !isZone(obstacle));
    this.obstacles = bodies.map((/** @type {any} */ obstacle) => {
      const geometry = shapeGeometry(obstacle);
      const mesh = new Mesh(geometry, palette.solid('obstacle', { transparent: true }));
      attitudeToScene(obstacle.quaternion, mesh.quaternion);
      if (obstacle.kind !== 'sphere') mesh.add(new LineSegments(new EdgesGeometry(geometry, 25), edge));
      if (obstacle.position) toScene(obstacle.position, mesh.position);
      const top = new Box3().setFromObject(mesh, true).max.y - mesh.position.y;
      this.group.add(mesh);
      const channel = obstacle.channel ? run.channel(obstacle.channel) : null;
      const label = labels.add(obstacle.known ? obstacle.name : `${obstacle.name} (not on the map)`, 'obstacle');
      label.layer = () => this.group.visible;
      return { mesh, channel, label, top };
    });
    const path = palette.line('obstacle', 1.5, { transparent: true, opacity: 0.5 });
    for (const { channel } of this.obstacles) {
      if (!channel) continue;
      const line = new Polyline(path);
      const step = Math.max(1, Math.floor(channel.t.length / 1000));
      const points = Array.from({ length: Math.ceil(channel.t.length / step) }, (_, k) => channel.row(k * step));
      line.setPoints(straightened(points, TOLERANCE));
      this.group.add(line);
    }
  }

  /**
   * The obstacles that hide a place.
   * @param {import('three').Vector3} eye
   * @param {import('three').Vector3} place
   */
  hiding(eye, place) {
    const along = place.clone().sub(eye);
    this.ray.far = along.length() - TOUCHING;
    this.ray.set(eye, along.normalize());
    return this.obstacles.filter(({ mesh }) => this.ray.intersectObject(mesh, false).length > 0);
  }

  /**
   * Let places be seen through what hides them.
   * @param {(place: import('three').Vector3) => import('three').Vector3} eye from where a place is seen
   * @param {import('three').Vector3[]} places
   */
  reveal(eye, places) {
    const hiding = new Set(places.flatMap((place) => this.hiding(eye(place), place)));
    for (const obstacle of this.obstacles) {
      const { material } = obstacle.mesh;
      material.opacity = hiding.has(obstacle) ? FADED : 1;
      material.depthWrite = material.opacity === 1;
    }
  }

  /** @param {number} time */
  update(time) {
    for (const { mesh, channel, label, top } of this.obstacles) {
      if (channel) toScene(channel.at(time), mesh.position);
      mesh.updateMatrixWorld(); // for the rays
      label.position.copy(mesh.position);
      label.position.y += top;
    }
  }
}
