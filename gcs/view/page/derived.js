/** What plots and header show that is not on record as such: errors, deviations, angles, intervals. */

import { euler } from './data.js';

/** @typedef {import('./data.js').Run} Run */
/** @typedef {import('./data.js').Channel} Channel */

const AVOIDING = 0.1; // m of the plan from the reference: as for `way_back_max_s` of summary.json
const DEGREES = 180 / Math.PI;

/**
 * A column at other times, linearly interpolated; null where it is not known, and before and after it.
 * @param {ArrayLike<number>} t @param {ArrayLike<number>} values @param {ArrayLike<number>} at
 * @returns {(number|null)[]}
 */
export function resample(t, values, at) {
  const found = new Array(at.length).fill(null);
  if (t.length === 0) return found;
  let i = 0;
  for (let k = 0; k < at.length; k += 1) {
    const time = at[k];
    if (time < t[0] - 1e-6 || time > t[t.length - 1] + 1e-6) continue;
    while (i + 1 < t.length && t[i + 1] <= time) i += 1;
    let value = values[i];
    if (i + 1 < t.length && time > t[i]) {
      // A gap in the record is one in the curve.
      if (t[i + 1] - t[i] > 1) continue;
      value += ((time - t[i]) / (t[i + 1] - t[i])) * (values[i + 1] - values[i]);
    }
    if (Number.isFinite(value)) found[k] = value;
  }
  return found;
}

/** Columns of a channel at other times. @param {Channel} channel @param {ArrayLike<number>} at */
export function columnsAt(channel, at) {
  return channel.series.map((values) => resample(channel.t, values, at));
}

/** The distance between two positions over time (m); null where one is not known. */
export function distance(a, b) {
  return a[0].map((_, k) => {
    let sum = 0;
    for (let j = 0; j < 3; j += 1) {
      if (a[j][k] === null || b[j][k] === null) return null;
      sum += (a[j][k] - b[j][k]) ** 2;
    }
    return Math.sqrt(sum);
  });
}

/** Roll, pitch and yaw (deg) of a channel of quaternions at its own times. @param {Channel} attitude */
export function angles(attitude) {
  const found = [0, 1, 2].map(() => new Float32Array(attitude.t.length));
  for (let i = 0; i < attitude.t.length; i += 1) {
    const row = euler(attitude.row(i));
    for (let j = 0; j < 3; j += 1) found[j][i] = row[j];
  }
  return found;
}

/**
 * How the payload kept to its plan, and the plan to the reference.
 * @param {Run} run
 * @returns {{t: Float64Array, error: (number|null)[], deviation: (number|null)[], avoiding: [number, number][],
 *   errorMax: number|null, deviationMax: number|null}|null} error: from the plan, deviation: from the reference (m)
 */
export function tracking(run) {
  const flown = run.flown('position');
  const reference = run.channel('reference.position');
  if (!flown || !reference) return null;
  const plan = run.channel('plan.position');
  const { t } = flown;
  const [at, wanted] = [columnsAt(flown, t), columnsAt(reference, t)];
  const planned = plan ? columnsAt(plan, t) : wanted;
  const away = distance(planned, wanted);
  const error = distance(at, planned);
  const deviation = distance(at, wanted);
  const largest = (values) => values.reduce((most, value) => (value !== null && value > (most ?? -1) ? value : most), null);
  return {
    t,
    error,
    deviation,
    avoiding: plan ? intervals(t, away.map((value) => value !== null && value > AVOIDING)) : [],
    errorMax: largest(error),
    // Vehicles that land by themselves have no plan, nor a reference that they should follow.
    deviationMax: largest(plan ? deviation.map((value, k) => (error[k] === null ? null : value)) : deviation),
  };
}

/** Root mean square of what is known; null of nothing. @param {(number|null)[]} values */
export function rootMeanSquare(values) {
  let [sum, count] = [0, 0];
  for (const value of values) {
    if (value === null) continue;
    sum += value * value;
    count += 1;
  }
  return count ? Math.sqrt(sum / count) : null;
}

/** From when to when a condition holds. @param {ArrayLike<number>} t @param {ArrayLike<boolean>} holds */
export function intervals(t, holds) {
  /** @type {[number, number][]} */
  const found = [];
  for (let i = 0; i < t.length; i += 1) {
    if (!holds[i]) continue;
    const begin = t[i];
    while (i + 1 < t.length && holds[i + 1]) i += 1;
    found.push([begin, t[Math.min(i + 1, t.length - 1)]]);
  }
  return found;
}

/** The alarms and isolations that a fault has led to. @param {Run} run @param {import('./data.js').Event} fault */
export function consequences(run, fault) {
  const sources = fault.source.split(', ');
  const until = (fault.end ?? run.meta.end) + 5;
  return run.events.filter(
    (event) =>
      (event.kind === 'alarm' || event.kind === 'isolation') &&
      event.start >= fault.start &&
      event.start <= until &&
      (sources.includes(event.source) || fault.source === 'all vehicles' || event.source === 'team'),
  );
}

export { DEGREES };
