/** The fence: the boundary that holds the flight, and what it must not enter, as translucent walls. */

import { BufferGeometry, EdgesGeometry, ExtrudeGeometry, Float32BufferAttribute, Group, LineSegments, Mesh, Shape } from 'three';

/**
 * @param {import('../data.js').Run} run
 * @param {number} height of the walls (m)
 * @param {import('./palette.js').Palette} palette
 */
export function fence(run, height, palette) {
  const group = new Group();
  const { boundary = [], excluded = [] } = run.meta.fence ?? {};
  const wall = palette.translucent('fence', 0.07);
  const edge = palette.hairline('fence', 0.8);
  for (const ring of boundary) {
    const { faces, edges } = walls(ring, height);
    group.add(new Mesh(faces, wall), new LineSegments(edges, edge));
  }
  const block = palette.translucent('limit', 0.16);
  const blockEdge = palette.hairline('limit', 0.9);
  for (const ring of excluded) {
    const shape = new Shape();
    ring.forEach((/** @type {number[]} */ [north, east], /** @type {number} */ i) => (i ? shape.lineTo(east, north) : shape.moveTo(east, north)));
    const geometry = new ExtrudeGeometry(shape, { depth: height, bevelEnabled: false }).rotateX(-Math.PI / 2);
    group.add(new Mesh(geometry, block), new LineSegments(new EdgesGeometry(geometry), blockEdge));
  }
  return group;
}

/** Upright walls along a ring, without a roof. @param {number[][]} ring north, east @param {number} height */
function walls(ring, height) {
  const faces = [];
  const edges = [];
  for (let i = 0; i < ring.length; i += 1) {
    const [[n0, e0], [n1, e1]] = [ring[i], ring[(i + 1) % ring.length]];
    const corners = [[e0, 0, -n0], [e1, 0, -n1], [e1, height, -n1], [e0, height, -n0]];
    for (const k of [0, 1, 2, 0, 2, 3]) faces.push(...corners[k]);
    for (const k of [0, 1, 2, 3, 0, 3]) edges.push(...corners[k]);
  }
  const geometry = (/** @type {number[]} */ points) => new BufferGeometry().setAttribute('position', new Float32BufferAttribute(points, 3));
  return { faces: geometry(faces), edges: geometry(edges) };
}
