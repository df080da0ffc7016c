/** The least clearance: a line between the two points that were nearest, with its metres. */

import { Group, Mesh, SphereGeometry } from 'three';
import { toScene } from './frames.js';
import { Polyline } from './polyline.js';

const AROUND = 1.5; // s before and after, when it is shown

export class Clearance {
  /**
   * @param {import('../data.js').Run} run
   * @param {import('./palette.js').Palette} palette
   * @param {import('./labels.js').Labels} labels
   */
  constructor(run, palette, labels) {
    this.group = new Group();
    this.always = false;
    this.found = run.clearance;
    /** @type {import('three').Vector3[]} its two points, while they are shown */
    this.ends = [];
    this.label = null;
    if (!this.found) return;
    const { min, obstacle, point_hull: ours, point_obstacle: theirs } = this.found;
    // It lies between surfaces that would hide it.
    const overAll = { depthTest: false, transparent: true };
    const line = new Polyline(palette.line('clearance', 3, overAll));
    line.setPoints([ours, theirs]);
    const dot = new SphereGeometry(0.06, 16, 10);
    const look = palette.flat('clearance', overAll);
    const dots = [ours, theirs].map((point) => {
      const mesh = new Mesh(dot, look);
      toScene(point, mesh.position);
      return mesh;
    });
    this.group.add(line, ...dots);
    for (const part of this.group.children) part.renderOrder = 10;
    this.label = labels.add(min > 0 ? `${min.toFixed(2)} m to ${obstacle}` : `touched ${obstacle}`, min > 0 ? 'clearance' : 'contact');
    this.points = [toScene(ours), toScene(theirs)];
    this.label.position.copy(toScene(ours)).add(toScene(theirs)).multiplyScalar(0.5);
  }

  /** @param {number} time */
  update(time) {
    const shown = this.found !== null && (this.always || Math.abs(time - this.found.time) <= AROUND);
    this.group.visible = shown;
    this.ends = shown ? (this.points ?? []) : [];
    if (this.label) this.label.visible = shown;
  }
}
