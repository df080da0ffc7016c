/**
 * From the frames of the records to those of three.js and back. World: north-east-down to x east, y up, z south.
 * Body: forward-right-down to x right, y up, z backward. Both are the same rotation of the axes.
 */

import { Quaternion, Vector3 } from 'three';

/**
 * @param {ArrayLike<number>} ned north, east, down (m), or a vector forward, right, down
 * @param {Vector3} [into]
 */
export function toScene(ned, into = new Vector3()) {
  return into.set(ned[1], -ned[2], -ned[0]);
}

/** @param {Vector3} vector @returns {number[]} north, east, down (m) */
export function toNed(vector) {
  return [-vector.z, vector.x, -vector.y];
}

/** @param {ArrayLike<number>} q body to world, w first @param {Quaternion} [into] */
export function attitudeToScene(q, into = new Quaternion()) {
  return into.set(q[2], -q[3], -q[1], q[0]);
}

/** The attitude of a yaw about down. @param {number} yaw rad */
export function yawToScene(yaw) {
  return new Quaternion().setFromAxisAngle(new Vector3(0, -1, 0), yaw);
}

/** The size along the axes of the scene. @param {ArrayLike<number>} size along north, east, down, or along those of a body */
export function sizeToScene(size) {
  return new Vector3(size[1], size[2], size[0]);
}
