/** The box in which the flight and all that stands about it lies, as wide as squares of the ground's grid. */

import { attitudeToScene, toNed, toScene } from './frames.js';

/** @typedef {import('../data.js').Run} Run */

const HEADROOM = 1; // m above the highest UAV
const SAMPLES = 500; // of a path
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]; // m, from line to line of the grid
const ASIDE = 0.5; // squares, at least, on each side
const MOST = 16; // squares along the wider side, about

/**
 * @param {Run} run
 * @returns {{low: number[], high: number[], step: number}} corners, north-east-down (m), with the UAVs and the ground;
 *   the step of the grid (m)
 */
export function extent(run) {
  const low = [Infinity, Infinity, -1];
  const high = [-Infinity, -Infinity, 0];
  const include = (/** @type {ArrayLike<number>} */ point, /** @type {number} */ reach = 0) => {
    for (let k = 0; k < 3; k += 1) {
      if (!Number.isFinite(point[k])) continue;
      low[k] = Math.min(low[k], point[k] - reach);
      high[k] = Math.max(high[k], point[k] + reach);
    }
  };
  const includePath = (/** @type {string} */ name) => {
    const channel = run.channel(name);
    if (!channel) return;
    const step = Math.max(1, Math.floor(channel.t.length / SAMPLES));
    for (let i = 0; i < channel.t.length; i += step) include(channel.row(i), 1);
  };
  for (const name of [`${run.meta.source}.payload.position`, 'reference.position']) includePath(name);
  const uavs = low[2] - (run.meta.link_length ?? 3) - 0.5;
  run.names('obstacle.').forEach(includePath);
  for (const obstacle of run.obstacles) {
    if (!obstacle.position) continue;
    include(obstacle.position, obstacle.radius);
    for (const corner of obstacle.corners ?? []) include(placed(corner, obstacle));
  }
  for (const ring of run.meta.fence?.boundary ?? []) for (const [north, east] of ring) include([north, east, 0]);
  if (!Number.isFinite(low[0])) include([0, 0, 0], 2);
  // What is far above the UAVs need not be seen whole, such as the zones of a fence.
  low[2] = Math.min(uavs, Math.max(low[2], uavs - HEADROOM));
  high[2] = 0;
  const widest = Math.max(high[0] - low[0], high[1] - low[1]);
  const step = STEPS.find((each) => widest / each <= MOST) ?? 2000;
  for (const k of [0, 1]) {
    low[k] = step * Math.floor(low[k] / step - ASIDE);
    high[k] = step * Math.ceil(high[k] / step + ASIDE);
  }
  return { low, high, step };
}

/**
 * A corner of an obstacle in the world, north-east-down (m).
 * @param {number[]} corner in the obstacle's frame
 * @param {{position: number[], quaternion: number[]}} obstacle
 */
function placed(corner, { position, quaternion }) {
  return toNed(toScene(corner).applyQuaternion(attitudeToScene(quaternion)).add(toScene(position)));
}
