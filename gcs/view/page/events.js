/** The list of events; a click moves the clock. */

import { h } from './dom.js';

const TITLES = { phase: 'phase', mode: 'mode', fault: 'fault', alarm: 'alarm', isolation: 'isolated', contact: 'contact', waypoint: 'waypoint' };

/**
 * @param {import('./data.js').Run} run @param {import('./clock.js').Clock} clock
 * @param {AbortSignal} signal which ends its listening to the clock
 */
export function eventList(run, clock, signal) {
  const rows = run.events.map((event) => {
    const row = h(
      `tr.event.${event.kind}`,
      { onclick: () => clock.set(event.start) },
      h('td.number', {}, h('button.link', { type: 'button' }, `${event.start.toFixed(2)} s`)),
      h('td', {}, h(`span.tag.${event.kind}`, {}, TITLES[event.kind] ?? event.kind)),
      h('td', {}, event.source),
      h('td.text', {}, event.text + (event.end !== null && event.kind === 'fault' ? `, to ${event.end.toFixed(2)} s` : '')),
    );
    return { row, event };
  });
  let current = -1;
  clock.onChange(() => {
    let now = -1;
    while (now + 1 < rows.length && rows[now + 1].event.start <= clock.time + 1e-6) now += 1;
    if (now === current) return;
    rows[current]?.row.classList.remove('current');
    rows[now]?.row.classList.add('current');
    current = now;
  }, signal);
  const head = ['time', 'kind', 'source', 'event'].map((text) => h('th', {}, text));
  return h(
    'section', { id: 'events' },
    h('h2', {}, 'Events'),
    rows.length
      ? h('div.scroll', {}, h('table', {}, h('thead', {}, h('tr', {}, ...head)), h('tbody', {}, ...rows.map(({ row }) => row))))
      : h('p', {}, 'None is on record.'),
  );
}
