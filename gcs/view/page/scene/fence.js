/** The fence: the boundary that holds the flight, and the zones that it must not enter, as translucent walls. */

import {
  BufferGeometry, CylinderGeometry, EdgesGeometry, ExtrudeGeometry, Float32BufferAttribute, Group, LineSegments, Mesh, Shape,
} from 'three';

/**
 * Whether an obstacle is a zone of the fence: such are as high as no flight is, and drawn here, up to the flight's height.
 * @param {{name: string}} obstacle
 */
export function isZone({ name }) {
  return /^fence (circle|polygon) \d+/.test(name);
}

/**
 * @param {import('../data.js').Run} run
 * @param {number} height of the walls (m)
 * @param {import('./palette.js').Palette} palette
 * @param {import('./labels.js').Labels} labels
 */
export function fence(run, height, palette, labels) {
  const group = new Group();
  const { boundary = [], excluded = [] } = run.meta.fence ?? {};
  const wall = palette.translucent('fence', 0.07);
  const edge = palette.hairline('fence', 0.8);
  for (const ring of boundary) {
    const { faces, edges } = walls(ring, height);
    group.add(new Mesh(faces, wall), new LineSegments(edges, edge));
  }
  const inside = palette.translucent('limit', 0.14);
  const insideEdge = palette.hairline('limit', 0.9);
  const zones = run.obstacles.filter(isZone);
  const circles = zones.filter((/** @type {any} */ zone) => zone.kind === 'pole');
  for (const geometry of [
    ...excluded.map((/** @type {number[][]} */ ring) => block(ring, height)),
    ...circles.map((/** @type {any} */ circle) => column(circle, height)),
  ]) {
    group.add(new Mesh(geometry, inside), new LineSegments(new EdgesGeometry(geometry, 30), insideEdge));
  }
  for (const { name, position: [north, east] } of zones) {
    const label = labels.add(name, 'obstacle');
    label.position.set(east, height, -north);
    label.layer = () => group.visible;
  }
  return group;
}

/** What is over a ring, with a roof. @param {number[][]} ring north, east (m) @param {number} height m */
function block(ring, height) {
  const shape = new Shape();
  ring.forEach(([north, east], i) => (i ? shape.lineTo(east, north) : shape.moveTo(east, north)));
  return new ExtrudeGeometry(shape, { depth: height, bevelEnabled: false }).rotateX(-Math.PI / 2);
}

/** What is over a circle. @param {{position: number[], radius: number}} circle @param {number} height m */
function column({ position: [north, east], radius }, height) {
  return new CylinderGeometry(radius, radius, height, 48).translate(east, height / 2, -north);
}

/** Upright walls along a ring, without a roof. @param {number[][]} ring north, east (m) @param {number} height m */
function walls(ring, height) {
  /** @type {number[]} */
  const faces = [];
  /** @type {number[]} */
  const edges = [];
  for (let i = 0; i < ring.length; i += 1) {
    const [[n0, e0], [n1, e1]] = [ring[i], ring[(i + 1) % ring.length]];
    const corners = [[e0, 0, -n0], [e1, 0, -n1], [e1, height, -n1], [e0, height, -n0]];
    for (const k of [0, 1, 2, 0, 2, 3]) faces.push(...corners[k]);
    for (const k of [0, 1, 2, 3, 0, 3]) edges.push(...corners[k]);
  }
  const geometry = (/** @type {number[]} */ points) =>
    new BufferGeometry().setAttribute('position', new Float32BufferAttribute(points, 3));
  return { faces: geometry(faces), edges: geometry(edges) };
}
