/** What happened, in sentences for somebody who has not seen the project before. */

import { number } from './dom.js';
import { consequences, rootMeanSquare, tracking } from './derived.js';

/** @typedef {import('./data.js').Run} Run */

const OUTCOMES = {
  completed: 'Every waypoint and the landing were reached, and the payload was set down.',
  interrupted: 'The user ended the flight; the payload was set down.',
  aborted: 'A failsafe ended the flight early, and the payload was set down.',
  failed: 'A waypoint or the landing was missed, or the payload was not set down safely.',
  lost: 'The records end without the vehicles being known to be on the ground.',
  collided: 'Something touched: a vehicle or the payload came into contact.',
  'in flight': 'The flight is going on.',
  'connection lost': 'The connection to the flight was lost; this is what had come until then. Open the page again, or see the run folder.',
  'no ground station': 'The simulator by itself: no ground station has records in this folder.',
  'cut off': 'The records end before the flight does.',
};

/**
 * Figures that the flight is judged by and that have a limit; of runs of earlier versions by their names alone.
 * @param {Run} run
 * @returns {{name: string, what: string, value: number|null, unit: string, bound: string, limit: number, held: boolean}[]}
 */
export function judged({ meta: { summary } }) {
  if (summary.result) return summary.result.filter((/** @type {any} */ { limit }) => limit !== null);
  return Object.entries(summary.limits ?? {}).map(([name, entry]) => ({ name, what: name.replaceAll('_', ' '), unit: '', bound: '', ...entry }));
}

/** Whether the flight is good, bad or in between, or still going on. @param {Run} run @returns {'good'|'warning'|'bad'|'live'} */
export function verdict(run) {
  const { outcome, summary } = run.meta;
  if (outcome === 'in flight') return 'live';
  if (['failed', 'lost', 'collided'].includes(outcome)) return 'bad';
  const held = Object.values(summary.limits ?? {}).every((limit) => limit.held);
  return outcome === 'completed' && held ? 'good' : 'warning';
}

/** @param {Run} run @returns {string[]} */
export function happened(run) {
  const { meta } = run;
  const refused = meta.outcome === 'aborted' && !meta.summary.duration_s;
  const found = [refused ? 'The flight was refused before take-off.' : (OUTCOMES[meta.outcome] ?? '')];
  if (meta.reason) found.push(`Reason: ${meta.reason}.`);
  const duration = meta.summary.duration_s;
  const team = `${meta.vehicles} vehicles carried the payload`;
  if (duration) found.push(`${team} for ${number(duration, 0)} s${meta.seed === null ? '' : ` (seed ${meta.seed})`}.`);
  if (meta.source === 'estimate') {
    found.push('No truth is on record: all that is shown is the estimate of the ground, which can be wrong.');
  }
  return found;
}

/** @param {Run} run @returns {string[]} */
export function safety(run) {
  const { summary, margin } = run.meta;
  const found = [];
  const contacts = summary.contacts;
  if (contacts !== null && contacts !== undefined) {
    const first = run.events.find(({ kind }) => kind === 'contact');
    const since = first ? `, from ${number(first.start, 1)} s on` : '';
    found.push(contacts === 0 ? 'Nothing touched.' : `NOT safe: there ${contacts === 1 ? 'was 1 contact' : `were ${contacts} contacts`}${since}.`);
  }
  const least = run.clearance;
  if (run.meta.outcome === 'in flight') {
    const known = Array.from(run.channel('clearance.nearest')?.series[0] ?? []).filter(Number.isFinite);
    if (known.length) found.push(`So far the formation's hull kept at least ${number(known.reduce((a, b) => Math.min(a, b)))} m from obstacles and fence.`);
    else found.push(run.meta.source === 'truth' ? 'So far nothing is known that it must keep clear of.' : 'The distance from obstacles is known where the truth is on record.');
  } else if (least) {
    const limit = summary.limits?.clearance;
    const bound = limit ? limit.limit : margin;
    const spare = least.min - bound;
    const than = limit ? `the limit of ${number(bound)} m` : `the margin of ${number(bound)} m that plans keep`;
    const which = `“${least.obstacle}”, at ${number(least.time, 1)} s`;
    if (least.min <= 1e-6) found.push(`The formation met ${which}.`);
    else {
      const how = `${number(Math.abs(spare))} m ${spare >= 0 ? 'more' : 'LESS'} than ${than}`;
      found.push(`The formation's hull kept at least ${number(least.min)} m from ${which}: ${how}.`);
    }
  } else if (run.meta.source === 'truth') found.push('There was no obstacle or fence to keep clear of.');
  if (Number.isFinite(summary.uav_separation_min_m) && summary.uav_separation_min_m !== null) {
    found.push(`Two UAVs came as near as ${number(summary.uav_separation_min_m)} m, between their centres.`);
  }
  const plan = summary.safety;
  if (plan && plan.steps) {
    const share = (100 * plan.verified_steps) / plan.steps;
    const shown = plan.verified_steps === plan.steps ? '100' : number(Math.min(share, 99.9), 1);
    found.push(
      `${shown} % of the plans were verified to keep the margin of ${number(margin)} m by exact distances` +
        `${plan.unverified_reason ? `; the worst other did not: ${plan.unverified_reason}` : ''}.`,
    );
    for (const [name, entry] of Object.entries(plan.exceeded ?? {})) {
      const what = name.replaceAll('_', ' ');
      const when = Number.isFinite(entry.time_s) ? ` at ${number(entry.time_s, 1)} s` : '';
      found.push(`The guarantee did not hold: ${what} was ${number(entry.value, 3)} m${when} (limit ${number(entry.limit, 3)} m).`);
    }
  }
  const missed = judged(run).filter(({ held }) => !held).map(({ what }) => what);
  if (missed.length) found.push(`Outside the mission's limits: ${missed.join(', ')} (see Limits).`);
  return found;
}

/** @param {Run} run @returns {string[]} */
export function position(run) {
  const found = [];
  const kept = tracking(run);
  if (!kept) return ['No reference is on record.'];
  const avoided = kept.avoiding.length > 0;
  const on = kept.t;
  const elsewhere = kept.deviation.filter(
    (_, k) => kept.error[k] !== null && !kept.avoiding.some(([begin, end]) => on[k] >= begin && on[k] <= end),
  );
  if (run.has('plan.position')) {
    const most = run.meta.summary.safety?.payload_tracking_max_m ?? kept.errorMax;
    found.push(`Error: the payload kept within ${number(most, 3)} m of its plan.`);
  }
  if (avoided) {
    const total = kept.avoiding.reduce((sum, [begin, end]) => sum + end - begin, 0);
    found.push(
      `Avoidance: for ${number(total, 0)} s the plan left the mission's reference, to avoid obstacles or to wait for what ` +
        `comes, by up to ${number(kept.deviationMax)} m.`,
    );
    const rest = rootMeanSquare(elsewhere);
    if (rest !== null) found.push(`Otherwise the payload was ${number(rest, 3)} m (RMS) from the reference.`);
  } else if (kept.deviationMax !== null) {
    found.push(`The plan stayed on the mission's reference; the payload was at most ${number(kept.deviationMax, 3)} m from it.`);
  }
  return found;
}

/** Sentences about vehicles that flew by themselves, each with its first event. @param {Run} run */
export function modes(run) {
  /** @type {Map<string, import('./data.js').Event[]>} */
  const found = new Map();
  for (const event of run.events) {
    if (event.kind === 'mode') found.set(event.text, [...(found.get(event.text) ?? []), event]);
  }
  return [...found].map(([text, events]) => {
    const names = [...new Set(events.map(({ source }) => source.replace('vehicle ', '')))];
    const who =
      names.length > 1
        ? `Vehicles ${names.slice(0, -1).join(', ')} and ${names.at(-1)} flew by themselves`
        : `Vehicle ${names[0]} flew by itself`;
    return { text: `${who} from ${number(events[0].start, 1)} s: ${text}.`, event: events[0] };
  });
}

/** Sentences about each fault, with the event that it is about. @param {Run} run */
export function faults(run) {
  const found = run.events
    .filter((event) => event.kind === 'fault')
    .map((fault) => {
      const after = consequences(run, fault);
      const [alarm] = after.filter((event) => event.kind === 'alarm');
      const isolations = after.filter((event) => event.kind === 'isolation');
      const span = `${number(fault.start, 1)} s to ${fault.end === null ? 'the end' : `${number(fault.end, 1)} s`}`;
      let text = `${fault.source}, ${fault.text}, ${span}: `;
      text += alarm
        ? `first alarm ${number(alarm.start - fault.start)} s later (${alarm.text}, ${alarm.source})`
        : 'no alarm';
      for (const isolation of isolations) {
        text += `; ${isolation.text} of ${isolation.source} isolated after ${number(isolation.start - fault.start)} s`;
        if (fault.end !== null && isolation.start > fault.end) text += ', when the fault was over';
        text += isolation.end === null ? '' : `, used again from ${number(isolation.end, 1)} s`;
      }
      return { text: `${text}.`, event: fault };
    });
  const explained = new Set(
    run.events.filter((event) => event.kind === 'fault').flatMap((fault) => consequences(run, fault)),
  );
  for (const event of run.events) {
    if (event.kind === 'isolation' && !explained.has(event)) {
      const until = event.end === null ? 'to the end' : `until ${number(event.end, 1)} s`;
      const text = `${event.text} of ${event.source} was isolated from ${number(event.start, 1)} s ${until}, without a fault.`;
      found.push({ text, event });
    }
  }
  return found;
}
