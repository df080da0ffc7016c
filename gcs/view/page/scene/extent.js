/** The box in which the flight and all that stands about it lies. */

/** @typedef {import('../data.js').Run} Run */

/**
 * @param {Run} run
 * @returns {{low: number[], high: number[]}} corners, north-east-down (m), with the UAVs and the ground
 */
export function extent(run) {
  const low = [Infinity, Infinity, -1];
  const high = [-Infinity, -Infinity, 0];
  const include = (/** @type {ArrayLike<number>} */ point, reach = 0) => {
    for (let k = 0; k < 3; k += 1) {
      if (!Number.isFinite(point[k])) continue;
      low[k] = Math.min(low[k], point[k] - reach);
      high[k] = Math.max(high[k], point[k] + reach);
    }
  };
  const channels = [run.flown('position'), run.channel('reference.position'), ...run.names('obstacle.').map((name) => run.channel(name))];
  for (const channel of channels) {
    if (!channel) continue;
    const step = Math.max(1, Math.floor(channel.t.length / 500));
    for (let i = 0; i < channel.t.length; i += step) include(channel.row(i), 1);
  }
  for (const obstacle of run.obstacles) {
    if (!obstacle.position) continue;
    include(obstacle.position, obstacle.radius);
    for (const corner of obstacle.corners ?? []) include(obstacle.position.map((/** @type {number} */ x, /** @type {number} */ k) => x + corner[k]));
  }
  for (const ring of run.meta.fence?.boundary ?? []) for (const [north, east] of ring) include([north, east, 0]);
  if (!Number.isFinite(low[0])) include([0, 0, 0], 2);
  low[2] -= (run.meta.link_length ?? 3) + 0.5;
  high[2] = 0;
  return { low, high };
}
