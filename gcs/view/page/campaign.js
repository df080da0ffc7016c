/** The page of a campaign: matrix of faults and severities or list of kinds, distributions, and the worst flights first. */

import { copyable, h, number } from './dom.js';

/** @typedef {Record<string, string> & {replay: string, page: string|null}} Flight a row of results.csv */

const RANK = ['collided', 'lost', 'failed', 'aborted', 'interrupted', 'completed'];
const FIGURES = [
  ['clearance_min_m', 'Least clearance', 'm', 2],
  ['uav_separation_min_m', 'Distance between UAVs', 'm', 2],
  ['tilt_max_deg', 'Largest payload angle', '°', 1],
  ['position_rmse_m', 'Position error, RMS', 'm', 3],
  ['delay_s', 'Delay', 's', 1],
  ['detected_s', 'Time to the first alarm', 's', 2],
  ['touchdown_mps', 'Touchdown speed', 'm/s', 2],
];
const BINS = 24;

const passed = (flight) => flight.passed === 'True';
const value = (flight, column) => (flight[column] === undefined || flight[column] === '' ? NaN : Number(flight[column]));

/** @param {{name: string, flights: Flight[]}} campaign @returns {HTMLElement[]} */
export function campaignPage({ name, flights }) {
  const good = flights.filter(passed).length;
  const state = good === flights.length ? 'good' : 'bad';
  const list = h('div.scroll.tall', {});
  const shown = h('p.hint', {});
  const show = (chosen, what) => {
    list.replaceChildren(table(chosen));
    const all = chosen.length === flights.length;
    shown.replaceChildren(`${chosen.length} flights${what ? `, ${what}` : ''}, the worst first. `);
    if (!all) shown.append(h('button', { type: 'button', onclick: () => show(flights, '') }, 'show all'));
  };
  show(flights, '');
  const levels = new Set(flights.map((flight) => flight.level));
  const isMatrix = flights.some((flight) => flight.fault) && levels.size > 0;
  return [
    h('header', {}, h('h1', {}, name, h(`span.badge.${state}`, {}, `${state === 'good' ? '✓' : '✗'} ${good} of ${flights.length} passed`))),
    h('section', {}, h('h2', {}, isMatrix ? 'Faults and severities' : 'Kinds'), isMatrix ? matrix(flights, show) : kinds(flights, show)),
    h('section', {}, h('h2', {}, 'Distributions'), h('p.hint', {}, h('span.swatch.passed', {}), ' passed  ', h('span.swatch.not', {}), ' not passed'), h('div.histograms', {}, ...FIGURES.map((figure) => histogram(flights, ...figure)))),
    h('section', { id: 'flights' }, h('h2', {}, 'Flights'), shown, list),
  ];
}

function cell(flights, text, show, what) {
  const good = flights.filter(passed).length;
  const state = good === flights.length ? 'good' : good === 0 ? 'bad' : 'mixed';
  const worst = sorted(flights)[0];
  const outcome = worst.outcome === 'completed' ? '' : `worst: ${worst.outcome}`;
  return h(
    'td', {},
    h(
      `button.cell.${state}`, { type: 'button', onclick: () => { show(flights, what); document.getElementById('flights').scrollIntoView(); } },
      text ? h('span', {}, text) : null, h('strong', {}, `${good} of ${flights.length}`), outcome ? h('span', {}, outcome) : null,
    ),
  );
}

function matrix(flights, show) {
  const faults = [...new Set(flights.map((flight) => flight.fault))];
  const most = Math.max(...flights.map((flight) => Number(flight.level)));
  const rows = faults.map((fault) => {
    const own = flights.filter((flight) => flight.fault === fault);
    const cells = Array.from({ length: most }, (_, k) => {
      const level = own.filter((flight) => Number(flight.level) === k + 1);
      return level.length ? cell(level, level[0].severity, show, `${fault}, ${level[0].severity}`) : h('td', {});
    });
    return h('tr', {}, h('th', { scope: 'row' }, fault), ...cells);
  });
  const head = Array.from({ length: most }, (_, k) => h('th', {}, `severity ${k + 1}`));
  return h(
    'div.scroll.tall', {},
    h('table.matrix', {}, h('thead', {}, h('tr', {}, h('th', {}, 'fault'), ...head)), h('tbody', {}, ...rows)),
  );
}

function kinds(flights, show) {
  const groups = [...new Set(flights.map((flight) => [flight.variant, flight.kind].filter(Boolean).join(', ')))];
  const rows = groups.map((group) => {
    const own = flights.filter((flight) => [flight.variant, flight.kind].filter(Boolean).join(', ') === group);
    const contacts = own.filter((flight) => value(flight, 'contacts') > 0).length;
    const clearance = own.map((flight) => value(flight, 'clearance_min_m')).filter(Number.isFinite);
    return h(
      'tr', {}, h('th', { scope: 'row' }, group || 'all'), cell(own, '', show, group),
      h('td.number', {}, `${contacts} with contacts`),
      h('td.number', {}, clearance.length ? `least clearance ${number(Math.min(...clearance))} m` : ''),
    );
  });
  return h('div.scroll.tall', {}, h('table.matrix', {}, h('tbody', {}, ...rows)));
}

/** Flights by how bad they are. @param {Flight[]} flights */
function sorted(flights) {
  const last = (known) => (Number.isFinite(known) ? known : Infinity);
  return [...flights].sort(
    (a, b) =>
      Number(passed(a)) - Number(passed(b)) ||
      RANK.indexOf(a.outcome) - RANK.indexOf(b.outcome) ||
      last(value(a, 'clearance_min_m')) - last(value(b, 'clearance_min_m')) ||
      last(-value(a, 'tilt_max_deg')) - last(-value(b, 'tilt_max_deg')),
  );
}

function table(flights) {
  const figures = FIGURES.filter(([column]) => flights.some((flight) => Number.isFinite(value(flight, column)))).slice(0, 5);
  const rows = sorted(flights).map((flight) => {
    const name = flight.page ? h('a', { href: flight.page }, flight.name) : flight.name;
    const why = [flight.failures, flight.reason].filter(Boolean).join(': ');
    return h(
      'tr', {},
      h('td', {}, name),
      h(`td.${passed(flight) ? 'held' : 'missed'}`, {}, passed(flight) ? '✓ passed' : '✗ not passed'),
      h('td', {}, flight.outcome),
      ...figures.map(([column, , , digits]) =>
        h('td.number', {}, Number.isFinite(value(flight, column)) ? number(value(flight, column), digits) : '–'),
      ),
      h('td.text', {}, why),
      h('td', {}, flight.replay ? copyable(flight.replay, 'copy command') : ''),
    );
  });
  const head = ['flight', '', 'outcome', ...figures.map(([, title, unit]) => `${title} (${unit})`), 'why not', 'again'];
  return h('table.flights', {}, h('thead', {}, h('tr', {}, ...head.map((text) => h('th', {}, text)))), h('tbody', {}, ...rows));
}

/** A histogram of a figure over the flights; those that did not pass below. */
function histogram(flights, column, title, unit, digits) {
  const known = flights.filter((flight) => Number.isFinite(value(flight, column)));
  if (known.length < 2) return null;
  const values = known.map((flight) => value(flight, column)).sort((a, b) => a - b);
  const [low, high] = [values[0], values[values.length - 1]];
  const span = high - low || 1;
  const bins = Array.from({ length: BINS }, () => [0, 0]);
  for (const flight of known) {
    const bin = Math.min(Math.floor(((value(flight, column) - low) / span) * BINS), BINS - 1);
    bins[bin][passed(flight) ? 1 : 0] += 1;
  }
  const most = Math.max(...bins.map(([a, b]) => a + b));
  const bars = bins.map(([bad, good]) =>
    h(
      'span.bar', { title: `${good} passed, ${bad} not` },
      h('span.bar-good', { style: { height: `${(100 * good) / most}%` } }), h('span.bar-bad', { style: { height: `${(100 * bad) / most}%` } }),
    ),
  );
  const median = values[Math.floor(values.length / 2)];
  return h(
    'figure.histogram', {},
    h('figcaption', {}, `${title} (${unit})`),
    h('div.bars', {}, ...bars),
    h('div.range', {}, h('span', {}, number(low, digits)), h('span', {}, `median ${number(median, digits)}`), h('span', {}, number(high, digits))),
  );
}
