/** The ground: a board with a grid in metres, marks along its edges, the north and the pad. */

import { BoxGeometry, BufferGeometry, Float32BufferAttribute, Group, LineSegments, Mesh, PlaneGeometry, Shape, ShapeGeometry } from 'three';
import { toScene } from './frames.js';

/**
 * @param {import('../data.js').Run} run
 * @param {{low: number[], high: number[], step: number}} box of the flight, and the step of the grid (m)
 * @param {import('./palette.js').Palette} palette
 * @param {import('./labels.js').Labels} labels
 */
export function ground(run, box, palette, labels) {
  const group = new Group();
  const { low: [north0, east0], high: [north1, east1], step } = box;
  const board = new Mesh(new PlaneGeometry(east1 - east0, north1 - north0), palette.flat('ground'));
  board.rotation.x = -Math.PI / 2;
  board.position.set((east0 + east1) / 2, -0.02, -(north0 + north1) / 2);
  board.renderOrder = -2;
  group.add(board);

  /** @type {number[]} */
  const fine = [];
  /** @type {number[]} */
  const coarse = [];
  const isCoarse = (/** @type {number} */ x) => Math.abs(x / (5 * step) - Math.round(x / (5 * step))) < 1e-6;
  for (let north = north0; north <= north1 + 1e-6; north += step) {
    (isCoarse(north) ? coarse : fine).push(east0, 0, -north, east1, 0, -north);
  }
  for (let east = east0; east <= east1 + 1e-6; east += step) {
    (isCoarse(east) ? coarse : fine).push(east, 0, -north0, east, 0, -north1);
  }
  group.add(lines(fine, palette.hairline('muted', 0.16)), lines(coarse, palette.hairline('muted', 0.5)));

  // Metres inside the south and the west edge, at every other line; not in their corner.
  const every = 2 * step;
  const inside = 0.35 * step;
  const first = (/** @type {number} */ x) => every * Math.ceil((x + 0.8 * step) / every);
  for (let east = first(east0); east < east1; east += every) {
    labels.add(mark('E', east), 'mark').position.set(east, 0, -north0 - inside);
  }
  for (let north = first(north0); north < north1; north += every) {
    labels.add(mark('N', north), 'mark').position.set(east0 + inside, 0, -north);
  }

  const arrow = new Mesh(new ShapeGeometry(arrowShape(step)), palette.flat('text'));
  arrow.rotation.x = -Math.PI / 2;
  arrow.position.set(east1 - 0.5 * step, 0, -(north1 - 2.3 * step));
  group.add(arrow);
  labels.add('N', 'north').position.set(east1 - 0.5 * step, 0, -(north1 + 0.4 * step));
  group.add(...pad(run, palette));
  return group;
}

/** @param {string} axis @param {number} metres */
function mark(axis, metres) {
  return metres === 0 ? `${axis} 0 m` : `${metres}`.replace('-', '−');
}

/** @param {number[]} points @param {import('three').Material} material */
function lines(points, material) {
  const geometry = new BufferGeometry().setAttribute('position', new Float32BufferAttribute(points, 3));
  const found = new LineSegments(geometry, material);
  found.renderOrder = -1;
  return found;
}

/** An arrow that points along y, two steps long. @param {number} step */
function arrowShape(step) {
  const corners = [[-0.06, 0], [0.06, 0], [0.06, 1.3], [0.28, 1.3], [0, 2], [-0.28, 1.3], [-0.06, 1.3]];
  const shape = new Shape();
  corners.forEach(([x, y], i) => (i ? shape.lineTo(x * step, y * step) : shape.moveTo(x * step, y * step)));
  return shape;
}

/** The pad under the payload at the start. @param {import('../data.js').Run} run @param {import('./palette.js').Palette} palette */
function pad(run, palette) {
  const { pad: plate, hull } = run.meta;
  const position = run.flown('position');
  if (!plate?.thickness || !hull?.length || !position) return [];
  const reach = [0, 1].map((k) => {
    const along = hull.map((/** @type {number[]} */ corner) => corner[k]);
    return [Math.min(...along) - plate.margin, Math.max(...along) + plate.margin];
  });
  const [length, width] = reach.map(([a, b]) => b - a);
  const mesh = new Mesh(new BoxGeometry(width, plate.thickness, length), palette.solid('reference'));
  const [north, east] = position.row(0);
  const middle = [north + (reach[0][0] + reach[0][1]) / 2, east + (reach[1][0] + reach[1][1]) / 2, -plate.thickness / 2];
  toScene(middle, mesh.position);
  return [mesh];
}
