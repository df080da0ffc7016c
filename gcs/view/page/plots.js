/** The plots: one time axis with the clock's cursor, zoomed together, bands of events behind. */

import uPlot from 'uplot';
import { h, token } from './dom.js';
import { groups } from './figures.js';

/** @typedef {import('./data.js').Run} Run */
/** @typedef {import('./clock.js').Clock} Clock */

const HEIGHT = 170;
const BACKGROUND = [
  { kind: 'phase', label: 'phase (every second one)', color: 'band-phase' },
  { kind: 'fault', label: 'fault', color: 'band-fault' },
  { kind: 'mode', label: 'onboard mode or failsafe', color: 'band-mode' },
  { kind: 'isolation', label: 'channel isolated', color: 'band-isolation' },
  { kind: 'alarm', label: 'alarm', color: 'bad' },
];

export class Plots {
  /** @param {HTMLElement} element @param {Run} run @param {Clock} clock @param {Run} [ghost] */
  constructor(element, run, clock, ghost) {
    this.run = run;
    this.clock = clock;
    this.ghost = ghost;
    /** @type {{plot: any, figure: import('./figures.js').Figure, cursor: HTMLElement, visible: boolean, isOld: boolean}[]} */
    this.shown = [];
    this.zooming = false;
    this.legendAt = -Infinity;
    this.observer = new IntersectionObserver((entries) => {
      for (const entry of entries) {
        const found = this.shown.find(({ plot }) => plot.root.parentElement === entry.target);
        if (found) {
          found.visible = entry.isIntersecting;
          if (found.visible && found.isOld) this.fill(found);
          else if (found.visible) this.place(found, true);
        }
      }
    });
    this.groups = groups(run, ghost);
    this.element = element;
    this.draw();
    clock.onChange(() => this.move());
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(element);
    this.closing = new AbortController();
    const dark = window.matchMedia('(prefers-color-scheme: dark)');
    dark.addEventListener('change', () => this.draw(), { signal: this.closing.signal });
  }

  /** Show a run that has grown. */
  refresh() {
    this.groups = groups(this.run, this.ghost);
    const figures = this.groups.flatMap((group) => group.figures);
    const kinds = new Set(this.run.events.map(({ kind }) => kind));
    const names = (/** @type {import('./figures.js').Figure} */ figure) => [figure.title, ...figure.series.map(({ label }) => label)].join();
    if (kinds.size !== this.kinds.size || figures.map(names).join() !== this.shown.map(({ figure }) => names(figure)).join()) {
      this.draw();
      return;
    }
    this.shown.forEach((found, k) => {
      found.figure = figures[k];
      if (found.visible) this.fill(found);
      else found.isOld = true;
    });
  }

  /** Give a plot the values of its figure. */
  fill(found) {
    found.isOld = false;
    found.plot.setData(columns(found.figure));
    this.place(found, true);
  }

  dispose() {
    this.observer.disconnect();
    this.sizes.disconnect();
    this.closing.abort();
    for (const { plot } of this.shown) plot.destroy();
    this.shown = [];
  }

  draw() {
    this.observer.disconnect();
    for (const { plot } of this.shown) plot.destroy();
    this.shown = [];
    this.kinds = new Set(this.run.events.map((event) => event.kind));
    const closed = [...this.element.querySelectorAll('details:not([open]) > summary')].map((head) => head.textContent);
    const keys = BACKGROUND.filter(({ kind }) => this.kinds.has(kind)).map(({ kind, label }) =>
      h('span.key', {}, h(`span.swatch.${kind}`, {}), label),
    );
    const reset = h('button', { type: 'button', onclick: () => this.zoom(this.clock.begin, this.clock.end) }, 'whole flight');
    this.element.replaceChildren(
      h('h2', {}, 'Plots'),
      h('p.hint', {}, 'Drag over a plot to zoom all of them; click to move the clock. ', reset),
      h('p.keys-of-bands', {}, ...keys),
    );
    for (const { title, note, figures } of this.groups) {
      const body = h('div.plots', {});
      this.element.append(h('details', { open: !closed.includes(title) }, h('summary', {}, title), note ? h('p.hint', {}, note) : null, body));
      for (const figure of figures) this.add(body, figure);
    }
  }

  add(body, figure) {
    const place = h('figure', {}, h('figcaption', {}, figure.title, ...this.shadedKeys(figure)));
    body.append(place);
    const lines = figure.lines ?? [];
    const limit = token('limit');
    const font = '12px system-ui, sans-serif';
    const axis = { stroke: token('muted'), font, grid: { stroke: token('line'), width: 0.5 }, ticks: { stroke: token('line'), width: 0.5 } };
    const digits = figure.digits ?? 2;
    const options = {
      width: this.width(), height: HEIGHT,
      scales: { x: { time: false, range: this.rangeX() }, y: { range: (u, low, high) => rangeY(figure, low, high) } },
      cursor: { sync: { key: 'report', scales: ['x', null], setSeries: false }, drag: { x: true, y: false, setScale: false }, points: { size: 6 } },
      legend: { live: true },
      padding: [12, 8, 0, 0],
      axes: [
        { ...axis, label: 'time (s)', labelSize: 16, labelFont: font, size: 28, space: 60 },
        { ...axis, label: figure.unit === '1' ? 'ratio' : figure.unit, labelSize: 16, labelFont: font, size: 46 },
      ],
      series: [
        { label: 'time', value: (u, value) => (value === null ? '' : `${value.toFixed(2)} s`) },
        ...figure.series.map(({ label, color, dash, width }) => ({
          label, stroke: token(color), width: width ?? 1.5, dash, points: { show: false },
          value: (u, value) => (value === null ? '–' : `${value.toFixed(digits)} ${figure.unit === '1' ? '' : figure.unit}`),
        })),
        ...lines.map(({ label, value }) => ({
          label: label ? `${label} ${value} ${figure.unit === '1' ? '' : figure.unit}` : ' ', stroke: limit, width: 1.5, dash: [7, 4],
          points: { show: false }, value: () => '', class: label ? 'line' : 'unnamed',
        })),
      ],
      bands: (figure.bands ?? []).map(({ low, high, color }) => ({ series: [high, low], fill: `${token(color)}40` })),
      hooks: {
        // The scale is not set before uPlot draws.
        setScale: [(u, key) => {
          const found = key === 'x' && this.shown.find(({ plot }) => plot === u);
          if (found) this.place(found, true);
        }],
        drawClear: [(u) => this.background(u, this.shown.find(({ plot }) => plot === u)?.figure ?? figure)],
        setSelect: [(u) => {
          if (u.select.width > 3) {
            this.zoom(u.posToVal(u.select.left, 'x'), u.posToVal(u.select.left + u.select.width, 'x'));
          }
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
      },
    };
    const plot = new uPlot(options, columns(figure), place);
    const cursor = h('div.clock-cursor', {});
    plot.over.append(cursor);
    plot.over.addEventListener('click', (event) => {
      if (event.detail === 1) this.clock.set(plot.posToVal(event.offsetX, 'x'));
    });
    plot.over.addEventListener('dblclick', () => this.zoom(this.clock.begin, this.clock.end));
    const found = { plot, figure, cursor, visible: false, isOld: false };
    this.shown.push(found);
    this.observer.observe(place);
  }

  shadedKeys(figure) {
    return (figure.shaded ?? [])
      .filter(({ spans }) => spans.length)
      .map(({ color, label }) => h('span.key', {}, h('span.swatch', { style: { background: token(color), opacity: '0.35' } }), label));
  }

  rangeX() {
    return () => this.view ?? [this.clock.begin, this.clock.end];
  }

  /** Show all plots from one time to another (s). */
  zoom(begin, end) {
    const view = [Math.max(begin, this.clock.begin), Math.min(end, this.clock.end)];
    // The whole flight may go on.
    this.view = view[0] > this.clock.begin || view[1] < this.clock.end ? view : null;
    for (const { plot } of this.shown) plot.setScale('x', { min: view[0], max: view[1] });
  }

  background(u, figure) {
    const { ctx } = u;
    const { left, top, width, height } = u.bbox;
    const x = (time) => Math.min(Math.max(u.valToPos(time, 'x', true), left), left + width);
    const fill = (begin, end, color, y, tall) => {
      const [a, b] = [x(begin), x(end)];
      if (b <= left || a >= left + width) return;
      ctx.fillStyle = color;
      ctx.fillRect(a, y, Math.max(b - a, 1), tall);
    };
    ctx.save();
    const end = this.clock.end;
    this.run.events.filter((event) => event.kind === 'phase').forEach((event, k) => {
      if (k % 2) fill(event.start, event.end ?? end, token('band-phase'), top, height);
    });
    for (const { spans, color } of figure.shaded ?? []) {
      ctx.globalAlpha = 0.2;
      for (const [begin, until] of spans) fill(begin, until, token(color), top, height);
      ctx.globalAlpha = 1;
    }
    const strip = 4 * devicePixelRatio;
    for (const event of this.run.events) {
      if (event.kind === 'fault') {
        fill(event.start, event.end ?? end, token('band-fault'), top, height);
      } else if (event.kind === 'mode') {
        fill(event.start, event.end ?? end, token('band-mode'), top, strip);
      } else if (event.kind === 'isolation') {
        fill(event.start, event.end ?? end, token('band-isolation'), top + strip, strip);
      } else if (event.kind === 'alarm') {
        fill(event.start, event.start, token('bad'), top, 2 * strip);
      }
    }
    ctx.restore();
  }

  /** Move the cursors to the clock; the values beside them now and then, as they take longer. */
  move() {
    const now = performance.now();
    const values = !this.clock.playing || now - this.legendAt > 100;
    if (values) this.legendAt = now;
    for (const found of this.shown) if (found.visible) this.place(found, values);
  }

  place({ plot, figure, cursor }, values) {
    const left = plot.valToPos(this.clock.time, 'x');
    const inside = left >= -0.5 && left <= plot.over.clientWidth + 0.5;
    cursor.style.display = inside ? '' : 'none';
    cursor.style.transform = `translateX(${left}px)`;
    if (values && (plot.cursor.left ?? -10) < 0) plot.setLegend({ idx: nearest(figure.t, this.clock.time) }, false);
  }

  width() {
    return Math.max(this.element.clientWidth, 200);
  }

  resize() {
    const width = this.width();
    for (const found of this.shown) {
      if (found.plot.width !== width) found.plot.setSize({ width, height: HEIGHT });
      this.place(found, false);
    }
  }
}

/** What a plot shows: times, values, lines. @param {import('./figures.js').Figure} figure */
function columns({ t, series, lines = [] }) {
  return [Array.from(t), ...series.map(({ values }) => values), ...lines.map(({ value }) => Array.from(t, () => value))];
}

/** @returns {[number, number]} the range of the axis */
function rangeY(figure, low, high) {
  if (figure.range) return [figure.range[0] ?? low, figure.range[1] ?? high];
  if (low === null || high === null) return [0, 1];
  const [bottom, top] = figure.zero ? [Math.min(low, 0), Math.max(high, 0)] : [low, high];
  const room = (top - bottom || Math.abs(top) || 1) * 0.06;
  return [figure.zero && bottom === 0 ? 0 : bottom - room, top + 2 * room]; // above: strips of modes and isolations
}

function nearest(t, time) {
  let [low, high] = [0, t.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return time - t[low] < t[high] - time ? low : high;
}
