/** What was on the ground station's map at a time: known and tracked obstacles, and boxes about what stands. */

import { BufferGeometry, EdgesGeometry, Float32BufferAttribute, Group, LineSegments, Mesh, Vector3 } from 'three';
import { isZone } from './fence.js';
import { attitudeToScene, sizeToScene, toScene, yawToScene } from './frames.js';
import { shapeGeometry } from './shapes.js';

const RECENT = 0.3; // s after which a track has ended

export class Detected {
  /**
   * @param {import('../data.js').Run} run
   * @param {import('./palette.js').Palette} palette
   */
  constructor(run, palette) {
    this.group = new Group();
    const wire = palette.hairline('detected-wire');
    const skin = palette.translucent('detected-wire', 0.12);
    const known = run.obstacles.filter((/** @type {any} */ obstacle) => obstacle.known && !isZone(obstacle));
    this.known = known.map((/** @type {any} */ obstacle) => {
      const mesh = new LineSegments(frame(obstacle), wire);
      attitudeToScene(obstacle.quaternion, mesh.quaternion);
      if (obstacle.position) toScene(obstacle.position, mesh.position);
      this.group.add(mesh);
      return { mesh, channel: obstacle.channel ? run.channel(obstacle.channel) : null };
    });
    this.run = run;
    /** @type {{mesh: LineSegments, channel: import('../data.js').Channel|null}[]} */
    this.tracks = [];
    const box = shapeGeometry({ kind: 'box', radius: 0, size: [1, 1, 1] });
    this.box = { skin: box, frame: new EdgesGeometry(box) };
    this.looks = { skin, wire };
    /** @type {Group[]} as many as were shown at once so far */
    this.boxes = [];
    this.grow();
  }

  /** Add the tracks that the run has had since. */
  grow() {
    for (const track of this.run.tracks.slice(this.tracks.length)) {
      const mesh = new LineSegments(frame(track), this.looks.wire);
      mesh.quaternion.copy(yawToScene(track.yaw));
      mesh.visible = false;
      this.group.add(mesh);
      this.tracks.push({ mesh, channel: this.run.channel(track.channel) });
    }
  }

  /** @param {number} time */
  update(time) {
    if (!this.group.visible) return;
    for (const { mesh, channel } of this.known) if (channel) toScene(channel.at(time), mesh.position);
    for (const { mesh, channel } of this.tracks) {
      mesh.visible = channel !== null && isTracked(channel, time);
      if (mesh.visible) toScene(channel.at(time), mesh.position);
    }
    let shown = 0;
    for (const { start, end, position, size, yaw } of this.run.standing) {
      if (time < start || (end !== null && time >= end)) continue;
      const box = this.boxes[shown] ?? this.newBox();
      box.visible = true;
      toScene(position, box.position);
      box.scale.copy(sizeToScene(size));
      box.quaternion.copy(yawToScene(yaw));
      shown += 1;
    }
    for (const box of this.boxes.slice(shown)) box.visible = false;
  }

  newBox() {
    const box = new Group();
    box.add(new Mesh(this.box.skin, this.looks.skin), new LineSegments(this.box.frame, this.looks.wire));
    this.boxes.push(box);
    this.group.add(box);
    return box;
  }

  get isEmpty() {
    return this.known.length === 0 && this.tracks.length === 0 && this.run.standing.length === 0;
  }
}

const AROUND = 24; // segments of a circle
const OFF = 0.015; // m, so that the lines lie off the surface of the obstacle itself

/**
 * The lines of a shape: its edges; of a sphere circles about its axes; of a pole circles and lines along it.
 * @param {any} shape
 */
function frame(shape) {
  const { kind, radius, size } = shape;
  if (kind !== 'sphere' && kind !== 'pole') return grown(new EdgesGeometry(shapeGeometry(shape), 25));
  /** @type {number[]} */
  const ends = [];
  const circle = (/** @type {(c: number, s: number) => number[]} */ at) => {
    for (let k = 0; k < AROUND; k += 1) {
      for (const step of [k, k + 1]) {
        const angle = (2 * Math.PI * step) / AROUND;
        ends.push(...at(Math.cos(angle) * radius, Math.sin(angle) * radius));
      }
    }
  };
  if (kind === 'sphere') {
    circle((c, s) => [c, 0, s]);
    for (const turn of [0, 0.25, 0.5, 0.75]) {
      const [x, z] = [Math.cos(turn * Math.PI), Math.sin(turn * Math.PI)];
      circle((c, s) => [c * x, s, c * z]);
    }
  } else {
    const half = size[2] / 2;
    for (const share of [-1, -0.5, 0, 0.5, 1]) circle((c, s) => [c, share * half, s]);
    for (let k = 0; k < 6; k += 1) {
      const [x, z] = [Math.cos((k * Math.PI) / 3) * radius, Math.sin((k * Math.PI) / 3) * radius];
      ends.push(x, -half, z, x, half, z);
    }
  }
  return grown(new BufferGeometry().setAttribute('position', new Float32BufferAttribute(ends, 3)));
}

/** @param {BufferGeometry} geometry */
function grown(geometry) {
  geometry.computeBoundingBox();
  const { x, y, z } = /** @type {import('three').Box3} */ (geometry.boundingBox).getSize(new Vector3());
  const [a, b, c] = [x, y, z].map((size) => 1 + (2 * OFF) / Math.max(size, OFF));
  return geometry.scale(a, b, c);
}

/** @param {import('../data.js').Channel} channel @param {number} time */
function isTracked(channel, time) {
  const last = channel.t[channel.rowAt(time)];
  return time >= last && time - last < RECENT;
}
