/** The player: slider, lanes of events above it, buttons and keys. */

import { h } from './dom.js';

/** @typedef {import('./data.js').Run} Run */
/** @typedef {import('./clock.js').Clock} Clock */

export const LANES = [
  { name: 'phase', kinds: ['phase', 'waypoint'], title: 'phases' },
  { name: 'fault', kinds: ['fault'], title: 'faults' },
  { name: 'alarm', kinds: ['isolation', 'mode', 'alarm', 'contact'], title: 'alarms' },
];

const PLAY = 'M3 1v12l9-6z';
const PAUSE = 'M3 1h3v12H3zM8 1h3v12H8z';
const TO_START = 'M2 1h2v12H2zM12 1v12L5 7z';
const TO_END = 'M10 1h2v12h-2zM2 1v12l7-6z';

/** @param {string} path of a picture of 14 by 14 */
function icon(path) {
  const place = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  place.setAttribute('viewBox', '0 0 14 14');
  place.setAttribute('class', 'icon');
  const shape = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  shape.setAttribute('d', path);
  place.append(shape);
  return place;
}

/** @param {Run} run @param {Clock} clock @param {AbortSignal} signal which ends its listening to the clock */
export function timeline(run, clock, signal) {
  const { begin, end } = run.meta;
  const span = Math.max(end - begin, 1e-9);
  const share = (time) => `${(100 * (Math.min(Math.max(time, begin), end) - begin)) / span}%`;
  const lanes = LANES.map(({ name, kinds, title }) => {
    const events = run.events.filter((event) => kinds.includes(event.kind));
    if (!events.length) return null;
    // What is short lies above what is long.
    const lasts = (event) => (event.end ?? (event.kind === 'isolation' ? end : event.start)) - event.start;
    const bands = [...events].sort((a, b) => lasts(b) - lasts(a)).map((event) => {
      const instant = event.end === null && !['isolation', 'fault'].includes(event.kind);
      const until = instant ? event.start : (event.end ?? end);
      return h(
        `button.band.${event.kind}${instant ? '.instant' : ''}`,
        {
          type: 'button',
          title: describe(event),
          tabIndex: -1,
          style: { left: share(event.start), width: instant ? '' : `calc(${share(until)} - ${share(event.start)})` },
          onclick: () => clock.set(event.start),
        },
        // A name that has no room says nothing.
        event.kind === 'phase' && (until - event.start) / span > 0.008 * event.text.length ? event.text : '',
      );
    });
    return h('div.lane', {}, h('span.lane-name', {}, title), h(`div.lane-track.${name}`, {}, ...bands));
  });
  const slider = h('input', {
    type: 'range', id: 'slider', min: String(begin), max: String(end), step: 'any', 'aria-label': 'time (s)',
    oninput: () => clock.set(Number(slider.value)),
  });
  const button = (face, label, act) => h('button', { type: 'button', 'aria-label': label, title: label, onclick: act }, face);
  const play = button(icon(PLAY), 'play or pause (space)', () => clock.toggle());
  const speed = h('span.speed', {});
  const shown = h('output.time', { id: 'time' });
  const controls = h(
    'div.controls', {},
    button(icon(TO_START), 'to the start (home)', () => clock.set(begin)),
    play,
    button(icon(TO_END), 'to the end (end)', () => clock.set(clock.end)),
    button('−', 'slower (-)', () => clock.changeSpeed(-1)),
    speed,
    button('+', 'faster (+)', () => clock.changeSpeed(1)),
    shown,
    h('span.keys', {}, 'keys: space, ← →, + −, home, end'),
  );
  clock.onChange(() => {
    slider.max = String(clock.end);
    slider.value = String(clock.time);
    play.firstElementChild.firstElementChild.setAttribute('d', clock.playing ? PAUSE : PLAY);
    speed.textContent = `${clock.speed}×`;
    shown.textContent = `${clock.time.toFixed(2)} s of ${clock.end.toFixed(1)} s`;
  }, signal);
  return h('section', { id: 'timeline' }, ...lanes, h('div.lane', {}, h('span.lane-name', {}, 'time'), slider), controls);
}

/** @param {import('./data.js').Event} event */
export function describe(event) {
  const span = event.end === null ? `${event.start.toFixed(2)} s` : `${event.start.toFixed(2)} to ${event.end.toFixed(2)} s`;
  return `${span}: ${event.source === 'team' ? '' : `${event.source}: `}${event.text}`;
}

/**
 * Space: play, pause; arrows: a row of the record (with shift: 1 s); +, -: speed; home, end.
 * @param {Run} run @param {Clock} clock @param {AbortSignal} signal which ends that
 */
export function keyboard(run, clock, signal) {
  const row = (steps) => {
    const { t } = run.flown('position');
    let i = 0;
    let high = t.length;
    while (high - i > 1) {
      const middle = (i + high) >> 1;
      if (t[middle] <= clock.time + 1e-9) i = middle;
      else high = middle;
    }
    clock.pause();
    clock.set(t[Math.min(Math.max(i + steps, 0), t.length - 1)]);
  };
  const keys = {
    ' ': () => clock.toggle(),
    ArrowRight: (event) => (event.shiftKey ? clock.set(clock.time + 1) : row(1)),
    ArrowLeft: (event) => (event.shiftKey ? clock.set(clock.time - 1) : row(-1)),
    '+': () => clock.changeSpeed(1),
    '=': () => clock.changeSpeed(1),
    '-': () => clock.changeSpeed(-1),
    Home: () => clock.set(clock.begin),
    End: () => clock.set(clock.end),
  };
  document.addEventListener(
    'keydown',
    (event) => {
      const target = /** @type {HTMLElement} */ (event.target);
      const types = target instanceof HTMLInputElement && target.type !== 'range';
      if (types || event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
      // A button that the keyboard has reached is pressed by the space bar; one that was clicked is left.
      if (event.key === ' ' && target.matches('button, summary')) {
        if (target.matches(':focus-visible')) return;
        target.blur();
      }
      event.preventDefault();
      event.stopPropagation();
      keys[event.key](event);
    },
    { capture: true, signal },
  );
}
