/** Geometries of obstacles, about their position, in the axes of the scene. */

import { CylinderGeometry, IcosahedronGeometry, SphereGeometry, Vector3 } from 'three';
import { ConvexGeometry } from 'three/addons/geometries/ConvexGeometry.js';
import { toScene } from './frames.js';

/**
 * @param {{kind: string, radius: number, size: number[], corners?: number[][], rounding?: number}} shape
 */
export function shapeGeometry(shape) {
  if (shape.kind === 'sphere') return new SphereGeometry(shape.radius, 32, 20);
  if (shape.kind === 'pole') return new CylinderGeometry(shape.radius, shape.radius, shape.size[2], 32, 1);
  return new ConvexGeometry(rounded(shape.corners ?? boxCorners(shape.size), shape.rounding ?? 0));
}

/** @param {number[]} size along each axis */
function boxCorners([x, y, z]) {
  const ends = [-0.5, 0.5];
  return ends.flatMap((a) => ends.flatMap((b) => ends.map((c) => [a * x, b * y, c * z])));
}

/** Points on the corners, or on spheres about them. @param {number[][]} corners @param {number} radius */
function rounded(corners, radius) {
  const centres = corners.map((corner) => toScene(corner));
  if (radius <= 0) return centres;
  const ball = new IcosahedronGeometry(radius, 2).getAttribute('position');
  const points = [];
  for (const centre of centres) {
    for (let i = 0; i < ball.count; i += 1) points.push(new Vector3().fromBufferAttribute(ball, i).add(centre));
  }
  return points;
}
