/** A line of some pixels through points that may change from frame to frame. */

import { BufferGeometry, Float32BufferAttribute } from 'three';
import { Line2 } from 'three/addons/lines/Line2.js';

/** A segment is drawn as a rectangle; what `LineMaterial` takes of its corners, two at the end and two at the start. */
const CORNERS = { position: [-1, 1, 0, 1, 1, 0, -1, 0, 0, 1, 0, 0], uv: [-1, 1, 1, 1, -1, -1, 1, -1] };
const TRIANGLES = [0, 2, 1, 2, 3, 1];
const CORNER_COUNT = 4;

export class Polyline extends Line2 {
  /** @param {import('three/addons/lines/LineMaterial.js').LineMaterial} material */
  constructor(material) {
    super(/** @type {any} */ (new BufferGeometry()), material);
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
    this.geometry = rectangles(points.length - 1);
    this.setEnds('', points.map(([north, east, down]) => [east, -down, -north]));
    if (colours) this.setEnds('Color', colours.map(({ r, g, b }) => [r, g, b]));
    if (this.material.dashed) this.setEnds('Distance', along(points));
  }

  /** Give both ends of each segment to all its corners. @param {string} name @param {number[][]} values of the points */
  setEnds(name, values) {
    for (const [end, first] of /** @type {[string, number][]} */ ([['Start', 0], ['End', 1]])) {
      const ends = values.slice(first, first + values.length - 1);
      const ofCorners = ends.flatMap((value) => Array(CORNER_COUNT).fill(value).flat());
      this.geometry.setAttribute(`instance${name}${end}`, new Float32BufferAttribute(ofCorners, values[0].length));
    }
  }

  /** Show the first segments only. @param {number} count */
  showFirst(count) {
    this.geometry.setDrawRange(0, TRIANGLES.length * count);
  }
}

/**
 * The rectangles of segments. Not instances of one: without a graphics card each of these would be drawn for itself.
 * @param {number} count
 */
function rectangles(count) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(repeated(CORNERS.position, count), 3));
  geometry.setAttribute('uv', new Float32BufferAttribute(repeated(CORNERS.uv, count), 2));
  return geometry.setIndex(repeated(TRIANGLES, count, CORNER_COUNT));
}

/** @param {number[]} values @param {number} count @param {number} step from one to the next */
function repeated(values, count, step = 0) {
  return Array.from({ length: count }, (_, i) => values.map((value) => value + i * step)).flat();
}

/** The length of the line up to each point. @param {ArrayLike<number>[]} points */
function along(points) {
  let length = 0;
  return points.map((point, i) => {
    if (i > 0) length += Math.hypot(...[0, 1, 2].map((k) => point[k] - points[i - 1][k]));
    return [length];
  });
}
