/** The top of the page: what happened, was it safe, by how much, and the command that flies it again. */

import { copyable, h, number } from './dom.js';
import { faults, happened, judged, modes, position, safety, verdict } from './words.js';

/** @typedef {import('./data.js').Run} Run */

const MARKS = { good: '✓', warning: '!', bad: '✗', live: '●' };

/** @param {Run} run */
export function title(run) {
  const { meta } = run;
  const state = verdict(run);
  const outside = meta.outcome === 'completed' && state !== 'good' ? ', outside its limits' : '';
  return h(
    'h1', {}, meta.mission, h('span.seed', {}, meta.seed === null ? '' : ` seed ${meta.seed}`),
    h(`span.badge.${state}`, {}, `${MARKS[state]} ${meta.outcome}${outside}`),
  );
}

/** @param {Run} run @param {import('./clock.js').Clock} clock */
export function cards(run, clock) {
  return h(
    'div.cards', { tabIndex: 0, role: 'region', 'aria-label': 'what happened' },
    card('What happened', happened(run)),
    card('Was it safe?', safety(run), ...moments(run, clock)),
    faultCard(run, clock),
    card('Position: error and avoidance', position(run)),
    limits(run),
    again(run.meta.command),
  );
}

function card(title, sentences, ...more) {
  return h('section.card', {}, h('h2', {}, title), ...sentences.map((text) => h('p', {}, text)), ...more);
}

function moments(run, clock) {
  const contact = run.events.find(({ kind }) => kind === 'contact');
  return [
    contact && jump(clock, contact.start, 'show the first contact'), contact && run.clearance && ', ',
    run.clearance && jump(clock, run.clearance.time, 'show the least clearance'),
  ];
}

function jump(clock, time, text) {
  return h('button.link', { type: 'button', onclick: () => clock.set(time) }, text);
}

function faultCard(run, clock) {
  const found = [...faults(run), ...modes(run)];
  const alarms = run.events.filter((event) => event.kind === 'alarm').length;
  const count = alarms ? `${alarms} alarms are in the list of events.` : 'No alarm was raised.';
  if (!found.length) return card('Faults, failsafes, refused sensors', ['No fault was injected and no channel isolated.', count]);
  const items = found.map(({ text, event }) =>
    h('li', {}, `${text} `, jump(clock, event.start, 'show')),
  );
  return h('section.card', {}, h('h2', {}, 'Faults, failsafes, refused sensors'), h('ul', {}, ...items), h('p', {}, count));
}

function limits(run) {
  if (run.meta.outcome === 'in flight') return null; // they are judged at the end
  const entries = judged(run);
  if (!entries.length) return card('Limits', ['The mission has no limits on record.']);
  const rows = entries.map(({ what, value, unit: of, bound, limit, held }) => {
    const unit = of === 'deg' ? '°' : of;
    const flown = value === null ? 'none' : `${number(value, unit === '°' ? 1 : 3)} ${unit}`;
    return h(
      'tr', {},
      h('td', {}, what), h('td.number', {}, flown), h('td.number', {}, `${bound} ${limit} ${unit}`),
      h(`td.${held ? 'held' : 'missed'}`, {}, held ? '✓ held' : '✗ NOT held'),
    );
  });
  return h('section.card', {}, h('h2', {}, 'Limits'), h('table', {}, h('tbody', {}, ...rows)));
}

function again(command) {
  if (!command) return null;
  const button = copyable(command, 'copy');
  return h('section.card', {}, h('h2', {}, 'Fly it again'), h('div.command', {}, h('code', {}, command), button));
}

/** Figures of two runs side by side; null of one. @param {Run} run @param {Run} [ghost] */
export function comparison(run, ghost) {
  if (!ghost) return null;
  const [a, b] = [run.meta.summary, ghost.meta.summary];
  const figures = [
    ['position error, RMS (m)', a.position_rmse_m?.total, b.position_rmse_m?.total, 3],
    ['least clearance (m)', a.clearance_min_m, b.clearance_min_m, 3],
    ['UAV separation (m)', a.uav_separation_min_m, b.uav_separation_min_m, 3],
    ['largest roll (°)', a.payload_tilt_max_deg?.roll, b.payload_tilt_max_deg?.roll, 2],
    ['largest pitch (°)', a.payload_tilt_max_deg?.pitch, b.payload_tilt_max_deg?.pitch, 2],
    ['duration (s)', a.duration_s, b.duration_s, 1],
    ['contacts', a.contacts, b.contacts, 0],
    ['alarms', a.alarms, b.alarms, 0],
    ['control step, median (ms)', a.step_time_ms?.p50, b.step_time_ms?.p50, 1],
  ];
  const known = (value) => value !== null && value !== undefined;
  const rows = figures.map(([name, left, right, digits]) =>
    h(
      'tr', {},
      h('td', {}, name),
      h('td.number', {}, known(left) ? number(left, digits) : '–'),
      h('td.number', {}, known(right) ? number(right, digits) : '–'),
      h('td.number', {}, known(left) && known(right) ? (right - left > 0 ? '+' : '') + number(right - left, digits) : '–'),
    ),
  );
  const head = ['', `A: ${run.meta.run}`, `B: ${ghost.meta.run}`, 'B − A'].map((text) => h('th', {}, text));
  const outcomes = h(
    'tr', {},
    h('td', {}, 'outcome'), h('td.number', {}, run.meta.outcome), h('td.number', {}, ghost.meta.outcome), h('td', {}),
  );
  return h(
    'section.card', {},
    h('h2', {}, 'Two runs'),
    h('p', {}, 'A is what the page is about; B is its ghost in the scene and the dashed curves of the plots.'),
    h('div.scroll.flat', {}, h('table', {}, h('thead', {}, h('tr', {}, ...head)), h('tbody', {}, outcomes, ...rows))),
  );
}
