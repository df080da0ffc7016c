/** A line of some pixels through points that may change from frame to frame. */

import { Line2 } from 'three/addons/lines/Line2.js';
import { LineGeometry } from 'three/addons/lines/LineGeometry.js';

export class Polyline extends Line2 {
  /** @param {import('three/addons/lines/LineMaterial.js').LineMaterial} material */
  constructor(material) {
    super(new LineGeometry(), material);
    this.frustumCulled = false;
    this.visible = false;
  }

  /**
   * @param {ArrayLike<number>[]} points north, east, down (m)
   * @param {import('three').Color[]} [colours] of the points
   */
  setPoints(points, colours) {
    this.visible = points.length > 1;
    if (!this.visible) return;
    this.geometry.dispose();
    this.geometry = new LineGeometry();
    this.geometry.setPositions(points.flatMap(([north, east, down]) => [east, -down, -north]));
    if (colours) this.geometry.setColors(colours.flatMap(({ r, g, b }) => [r, g, b]));
    if (this.material.dashed) this.computeLineDistances();
  }

  /** Show the first segments only. @param {number} count */
  showFirst(count) {
    this.geometry.instanceCount = count;
  }
}
