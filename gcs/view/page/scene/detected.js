/** What was on the ground station's map at a time: tracked obstacles, and boxes about what stands. */

import { EdgesGeometry, Group, LineSegments, Mesh, WireframeGeometry } from 'three';
import { sizeToScene, toScene, yawToScene } from './frames.js';
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
    this.tracks = run.tracks.map((/** @type {any} */ track) => {
      const geometry = shapeGeometry(track, true);
      const frame = track.kind === 'sphere' || track.kind === 'pole' ? new WireframeGeometry(geometry) : new EdgesGeometry(geometry);
      const mesh = new LineSegments(frame, wire);
      mesh.quaternion.copy(yawToScene(track.yaw));
      mesh.visible = false;
      this.group.add(mesh);
      return { mesh, channel: run.channel(track.channel) };
    });
    this.standing = run.standing;
    const box = shapeGeometry({ kind: 'box', radius: 0, size: [1, 1, 1] });
    this.box = { skin: box, frame: new EdgesGeometry(box) };
    this.looks = { skin, wire };
    /** @type {Group[]} as many as were shown at once so far */
    this.boxes = [];
  }

  /** @param {number} time */
  update(time) {
    if (!this.group.visible) return;
    for (const { mesh, channel } of this.tracks) {
      mesh.visible = channel !== null && isTracked(channel, time);
      if (mesh.visible) toScene(channel.at(time), mesh.position);
    }
    let shown = 0;
    for (const { start, end, position, size, yaw } of this.standing) {
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
    return this.tracks.length === 0 && this.standing.length === 0;
  }
}

/** @param {import('../data.js').Channel} channel @param {number} time */
function isTracked(channel, time) {
  const last = channel.t[channel.rowAt(time)];
  return time >= last && time - last < RECENT;
}
