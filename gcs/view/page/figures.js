/** What the plots show: groups of plots, each with its series, limits and shaded intervals. */

import { angles, columnsAt, distance, intervals, resample, tracking } from './derived.js';

/** @typedef {import('./data.js').Run} Run */
/**
 * @typedef {{label: string, values: (number|null)[], color: string, dash?: number[], width?: number}} Series
 * @typedef {{value: number, label: string}} Line
 * @typedef {{title: string, unit: string, t: ArrayLike<number>, series: Series[], lines?: Line[], zero?: boolean,
 *   bands?: {low: number, high: number, color: string}[], shaded?: {spans: [number, number][], color: string, label: string}[],
 *   digits?: number, range?: [number|null, number|null]}} Figure
 */

const COLOURS = ['series-1', 'series-2', 'series-3', 'series-4', 'series-5', 'series-6', 'series-7', 'series-8'];
const DASHES = [[], [8, 4], [2, 3]];
const SHOWN = 8; // test ratios: those with the largest values
const RATIO_MAX = 5; // above, at touchdown for example, they are cut off

const up = (values) => values.map((value) => (value === null ? null : -value));

/**
 * @param {Run} run @param {Run} [ghost]
 * @returns {{title: string, note?: string, figures: Figure[]}[]}
 */
export function groups(run, ghost) {
  const all = [
    positions(run, ghost), deviations(run, ghost), attitude(run, ghost), clearances(run, ghost), plan(run), separation(run, ghost),
    forces(run), estimation(run), tests(run), steps(run), links(run),
  ];
  return all.filter((group) => group && group.figures.length);
}

const flownLabel = (run) => (run.meta.source === 'truth' ? 'flown' : 'flown (estimate)');

function positions(run, ghost) {
  const flown = run.flown('position');
  const { t } = flown;
  const reference = run.channel('reference.position');
  const at = columnsAt(flown, t);
  const wanted = reference && columnsAt(reference, t);
  const other = ghost && columnsAt(ghost.flown('position'), t);
  const titles = ['North', 'East', 'Altitude'];
  const figures = titles.map((title, j) => {
    const turn = j === 2 ? up : (values) => values;
    /** @type {Series[]} */
    const series = [];
    if (wanted) series.push({ label: 'reference', values: turn(wanted[j]), color: 'reference', width: 3 });
    series.push({ label: flownLabel(run), values: turn(at[j]), color: 'flown' });
    if (other) series.push({ label: 'B flown', values: turn(other[j]), color: 'series-2', dash: [6, 4] });
    return { title, unit: 'm', t, series, digits: 3 };
  });
  return { title: 'Position of the payload', figures };
}

function deviations(run, ghost) {
  const kept = tracking(run);
  if (!kept) return null;
  const shaded = [{ spans: kept.avoiding, color: 'detected', label: 'plan is off the reference: avoiding or waiting' }];
  const figures = [];
  if (run.has('plan.position')) {
    const bound = run.meta.summary.safety?.payload_tracking_bound_m;
    figures.push({
      title: 'Error: distance from the plan', unit: 'm', t: kept.t, zero: true, digits: 4,
      series: [{ label: 'error', values: kept.error, color: 'flown' }],
      lines: bound ? [{ value: bound, label: 'bound of the guarantee' }] : [],
      shaded,
    });
  }
  figures.push({
    title: 'Distance from the mission’s reference', unit: 'm', t: kept.t, zero: true, digits: 3,
    series: [{ label: 'distance', values: kept.deviation, color: 'flown' }], shaded,
  });
  if (ghost) {
    const [a, b] = [run, ghost].map((each) => columnsAt(each.flown('position'), kept.t));
    figures.push({
      title: 'Distance between the payloads of A and B at the same time', unit: 'm', t: kept.t, zero: true, digits: 3,
      series: [{ label: 'B − A', values: distance(a, b), color: 'series-2' }],
    });
  }
  return {
    title: 'Error and avoidance',
    note: 'An error is a distance from the plan. To avoid obstacles the plan itself leaves the reference, which is wanted (shaded).',
    figures,
  };
}

function attitude(run, ghost) {
  const flown = run.flown('attitude');
  const { t } = flown;
  const limit = run.meta.summary.limits?.payload_tilt_deg?.limit;
  const lines = limit ? [{ value: limit, label: 'limit' }, { value: -limit, label: '' }] : [];
  const own = angles(flown);
  const series = ['roll', 'pitch', 'yaw'].map((label, j) => ({ label, values: Array.from(own[j]), color: COLOURS[j] }));
  if (ghost) {
    const other = ghost.flown('attitude');
    const turned = angles(other);
    ['roll', 'pitch', 'yaw'].forEach((label, j) => {
      series.push({ label: `B ${label}`, values: resample(other.t, turned[j], t), color: COLOURS[j], dash: [6, 4] });
    });
  }
  const figures = [{ title: 'Roll, pitch and yaw (reference: 0)', unit: '°', t, series, lines, digits: 2 }];
  return { title: 'Attitude of the payload', figures };
}

function clearances(run, ghost) {
  const each = run.channel('clearance.each') ?? run.channel('clearance.nearest');
  if (!each) return null;
  const limit = run.meta.summary.limits?.clearance?.limit;
  const series = columnsAt(each, each.t).map((values, j) => ({
    label: each.columns[j], values, color: COLOURS[j % COLOURS.length],
  }));
  const other = ghost?.channel('clearance.nearest');
  if (other) {
    series.push({ label: 'B nearest', values: columnsAt(other, each.t)[0], color: 'series-8', dash: [6, 4] });
  }
  const lines = [{ value: run.meta.margin, label: 'margin of plans' }];
  if (limit) {
    if (limit === run.meta.margin) lines[0].label = 'margin of plans, limit';
    else lines.push({ value: limit, label: 'limit' });
  }
  const low = Math.max(4 * Math.max(run.meta.margin, limit ?? 0), 2);
  return {
    title: 'Clearance',
    note: 'From the formation’s hull (payload and rotor discs) to the surface of each obstacle, on the true state.',
    figures: [
      { title: 'Hull to obstacle', unit: 'm', t: each.t, series, lines, digits: 3, zero: true },
      { title: `The same, below ${low} m`, unit: 'm', t: each.t, series, lines, digits: 3, range: [0, low] },
    ],
  };
}

function plan(run) {
  const clearance = run.channel('plan.clearance');
  const rate = run.channel('plan.progress_rate');
  const slack = run.channel('plan.slack');
  const verified = run.channel('plan.verified');
  if (!verified || !rate) return null;
  const { t } = verified;
  const not = intervals(t, Array.from(verified.series[0], (value) => value < 0.5));
  const shaded = [{ spans: not, color: 'bad', label: 'plan not verified to keep the margin' }];
  const series = [];
  if (clearance) series.push({ label: 'least clearance of the plan', values: columnsAt(clearance, t)[0], color: 'plan' });
  if (slack) series.push({ label: 'slack (violation)', values: columnsAt(slack, t)[0], color: 'bad' });
  const solved = run.channel('plan.solved');
  if (solved) {
    const failed = intervals(t, Array.from(solved.series[0], (value) => value < 0.5));
    shaded.push({ spans: failed, color: 'reference', label: 'no solution: the plan before, or a stop, is flown' });
  }
  const figures = [];
  if (series.length) {
    figures.push({
      title: 'Barrier: clearance of the plan over its horizon, at most the margin', unit: 'm', t, series, zero: true, digits: 3,
      lines: [{ value: run.meta.margin, label: 'margin' }], shaded,
    });
  }
  figures.push({
    title: 'Progress rate along the mission (1: as planned, 0: waiting)', unit: '1', t, zero: true, digits: 2,
    series: [{ label: 'progress rate', values: columnsAt(rate, t)[0], color: 'flown' }],
  });
  return { title: 'Safety filter', figures };
}

function separation(run, ghost) {
  const found = run.channel('separation');
  if (!found) return null;
  const limit = run.meta.summary.limits?.uav_separation?.limit;
  const series = [{ label: 'nearest two', values: columnsAt(found, found.t)[0], color: 'flown' }];
  const other = ghost?.channel('separation');
  if (other) series.push({ label: 'B', values: columnsAt(other, found.t)[0], color: 'series-2', dash: [6, 4] });
  const touch = { value: 2 * run.meta.disc_radius, label: 'rotor discs touch' };
  const lines = limit ? [touch, { value: limit, label: 'limit' }] : [touch];
  return {
    title: 'Distance between UAVs',
    figures: [{ title: 'Centres of the nearest two', unit: 'm', t: found.t, series, lines, digits: 3 }],
  };
}

function forces(run) {
  const figures = [];
  const thrust = run.channel('truth.thrust');
  const columns = (channel) =>
    columnsAt(channel, channel.t).map((values, j) => ({
      label: channel.columns[j], values, color: COLOURS[j % COLOURS.length], dash: DASHES[Math.floor(j / COLOURS.length) % 3],
    }));
  if (thrust) {
    const lines = [{ value: run.meta.thrust_max, label: 'largest thrust' }];
    figures.push({ title: 'Thrust of each UAV', unit: 'N', t: thrust.t, series: columns(thrust), lines, zero: true, digits: 2 });
  }
  const tension = run.channel('truth.tension');
  if (tension) {
    const lines = [{ value: 0, label: 'below: compression' }];
    figures.push({ title: 'Tension of each link', unit: 'N', t: tension.t, series: columns(tension), lines, digits: 2 });
  }
  const force = run.channel('estimate.disturbance');
  if (force) {
    const found = columnsAt(force, force.t);
    const series = ['north', 'east', 'up'].map((label, j) => ({
      label, values: j === 2 ? up(found[2]) : found[j], color: COLOURS[j],
    }));
    figures.push({ title: 'Disturbance force on the payload, as estimated', unit: 'N', t: force.t, series, digits: 2 });
  }
  return { title: 'Forces', figures };
}

function estimation(run) {
  const estimate = run.channel('estimate.payload.position');
  const truth = run.channel('truth.payload.position');
  if (!estimate || !truth) return null;
  const { t } = estimate;
  const sd = run.channel('estimate.payload.position_sd');
  const [guess, real] = [columnsAt(estimate, t), columnsAt(truth, t)];
  const bounds = sd && columnsAt(sd, t);
  const figures = ['north', 'east', 'altitude'].map((name, j) => {
    const error = guess[j].map((value, k) => (value === null || real[j][k] === null ? null : value - real[j][k]));
    const values = j === 2 ? up(error) : error;
    /** @type {Series[]} */
    const series = [];
    const bands = [];
    if (bounds) {
      const three = bounds[j].map((value) => (value === null ? null : 3 * value));
      series.push({ label: '+3σ', values: three, color: 'reference', width: 1 });
      series.push({ label: '−3σ', values: up(three), color: 'reference', width: 1 });
      bands.push({ low: 2, high: 1, color: 'reference' });
    }
    series.push({ label: 'estimate − truth', values, color: 'estimate' });
    return { title: `Error of the estimate, ${name}`, unit: 'm', t, series, bands, digits: 4 };
  });
  const note = bounds ? 'Grey: three standard deviations, as the estimator states them.' : 'Standard deviations are not on record.';
  return { title: 'Estimation', note, figures };
}

function tests(run) {
  const names = run.names('innovations.');
  if (!names.length) return null;
  const channels = names.map((name) => {
    const channel = run.channel(name);
    const [, source, part] = name.split('.');
    const isIsolated = run.events.some((event) => event.kind === 'isolation' && event.source === source && event.text === part);
    return { label: `${source} ${part}`, channel, isIsolated, most: Math.max(...Array.from(channel.series[0]).filter(Number.isFinite), 0) };
  });
  channels.sort((a, b) => Number(b.isIsolated) - Number(a.isIsolated) || b.most - a.most);
  const shown = channels.slice(0, SHOWN);
  const longest = shown.reduce((a, b) => (b.channel.t.length > a.channel.t.length ? b : a));
  const { t } = longest.channel;
  const series = shown.map(({ label, channel }, j) => ({
    label, values: columnsAt(channel, t)[0], color: COLOURS[j], dash: DASHES[0],
  }));
  const lines = [{ value: 1, label: 'rejected above' }];
  const more = channels.length - shown.length;
  return {
    title: 'Innovation tests',
    note: `Above 1 a measurement is rejected.${more > 0 ? ` Shown are isolated channels, then those with the largest ratios: ${SHOWN} of ${channels.length}.` : ''}`,
    figures: [
      Math.max(...shown.map(({ most }) => most)) > RATIO_MAX
        ? { title: `Test ratio, up to ${RATIO_MAX}`, unit: '1', t, series, lines, digits: 2, range: [0, RATIO_MAX] }
        : { title: 'Test ratio', unit: '1', t, series, lines, zero: true, digits: 2 },
    ],
  };
}

function steps(run) {
  const found = run.channel('steps.time');
  if (!found) return null;
  const labels = { total: 'whole step', estimator: 'estimation', planner: 'planning' };
  const series = columnsAt(found, found.t).map((values, j) => ({
    label: labels[found.columns[j]] ?? found.columns[j], values, color: COLOURS[(j + 7) % COLOURS.length], width: j ? 1 : 1.5,
  }));
  const lines = [{ value: 1000 * run.meta.control_period, label: 'control period' }];
  return {
    title: 'Compute time',
    figures: [{ title: 'Control step, and its parts (wall time)', unit: 'ms', t: found.t, series, lines, zero: true, digits: 1 }],
  };
}

function links(run) {
  const titles = [
    ['link.loss', 'Messages lost, vehicle to ground', '%', 1],
    ['link.latency', 'Latency, vehicle to ground (above the least)', 'ms', 1],
    ['link.rate', 'Messages received', '1/s', 0],
  ];
  const figures = titles
    .filter(([name]) => run.has(name))
    .map(([name, title, unit, digits]) => {
      const channel = run.channel(name);
      const series = columnsAt(channel, channel.t).map((values, j) => ({
        label: channel.columns[j], values, color: COLOURS[j % COLOURS.length],
      }));
      return { title, unit, t: channel.t, series, zero: true, digits };
    });
  return { title: 'Links', note: 'From the telemetry log.', figures };
}
