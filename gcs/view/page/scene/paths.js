/** Lines of where the payload was to go, went, and was planned to go. */

import { Group } from 'three';
import { toScene } from './frames.js';
import { Polyline } from './polyline.js';
import { spaced, straightened } from './thinning.js';

const TRAIL_POINTS = 4000; // at most, over a flight
const TRAIL_STEP = 0.25; // m from point to point
const TOLERANCE = 0.02; // m, of the mission's path
const PLAN_AGE = 0.5; // s after which a plan is no longer shown

/** @typedef {import('../data.js').Run} Run */
/** @typedef {import('./palette.js').Palette} Palette */

/** The mission's path. @param {Run} run @param {Palette} palette */
export function reference(run, palette) {
  const line = new Polyline(palette.line('reference', 1.5));
  line.setPoints(referencePoints(run));
  return line;
}

/** @param {Run} run */
export function referencePoints(run) {
  const channel = run.channel('reference.position');
  return channel ? straightened(sampled(channel, 3000).map((i) => channel.row(i)), TOLERANCE) : [];
}

/** Where the payload has flown until a time, coloured by its speed. */
export class Trail {
  /** @param {Run} run @param {Palette} palette @param {string} [colour] token, in place of the speed */
  constructor(run, palette, colour) {
    this.run = run;
    this.palette = palette;
    this.line = new Polyline(colour ? palette.line(colour, 2) : palette.colouredLine(3.5));
    this.read();
    /** The end of the scale (m/s). */
    this.fastest = this.scale();
    if (colour) this.line.setPoints(this.points);
    else palette.onChange(() => this.paint());
  }

  read() {
    const position = this.run.flown('position');
    const velocity = this.run.flown('velocity');
    const sample = position ? sampled(position, TRAIL_POINTS) : [];
    const rows = spaced(sample.map((i) => position.row(i)), TRAIL_STEP).map((i) => sample[i]);
    this.times = rows.map((i) => position.t[i]);
    this.points = rows.map((i) => position.row(i));
    this.speeds = rows.map((i) => (velocity ? Math.hypot(...velocity.row(i)) : 0));
  }

  scale() {
    return Math.max(0.5, Math.ceil(2 * Math.max(0, ...this.speeds.filter(Number.isFinite))) / 2);
  }

  isOutgrown() {
    return this.scale() > this.fastest;
  }

  /** Show what has been flown since. */
  grow() {
    this.read();
    this.paint();
  }

  paint() {
    this.line.setPoints(this.points, this.speeds.map((speed) => this.palette.sequential(speed / this.fastest)));
    this.update(this.time ?? 0);
  }

  /** @param {number} time */
  update(time) {
    this.time = time;
    let low = 0;
    let high = this.times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle + 1;
      else high = middle;
    }
    this.line.showFirst(Math.max(low - 1, 0));
  }
}

/** The planned path and the stop plan of a time. */
export class Plans {
  /** @param {Run} run @param {Palette} palette */
  constructor(run, palette) {
    this.group = new Group();
    this.plans = [
      { channel: run.channel('horizon.plan'), line: new Polyline(palette.line('plan', 3)) },
      { channel: run.channel('horizon.stop'), line: new Polyline(palette.line('stop', 3, { dashed: true, dashSize: 0.15, gapSize: 0.1 })) },
    ];
    for (const { line } of this.plans) this.group.add(line);
  }

  /** @param {number} time */
  update(time) {
    if (!this.group.visible) return;
    for (const { channel, line } of this.plans) {
      if (!channel) continue;
      const age = time - channel.t[channel.rowAt(time)];
      line.setPoints(age >= 0 && age < PLAN_AGE ? channel.path(time) : []);
    }
  }

  get isEmpty() {
    return this.plans.every(({ channel }) => channel === null);
  }
}

/**
 * Numbers at the waypoints: where the mission has them, or where the payload was nearest to them.
 * @param {Run} run
 * @param {import('./labels.js').Labels} labels
 */
export function waypoints(run, labels) {
  const flown = run.flown('position');
  const reached = run.events.filter((event) => event.kind === 'waypoint');
  const places = run.meta.waypoints ?? (flown ? reached.map((event) => flown.at(event.start)) : []);
  return places.map((/** @type {number[]} */ place, /** @type {number} */ i) => {
    const label = labels.add(`${i + 1}`, 'waypoint');
    toScene(place, label.position);
    return label;
  });
}

/** Rows of a channel, evenly, at most so many, with the last. @param {import('../data.js').Channel} channel @param {number} most */
function sampled(channel, most) {
  const count = channel.t.length;
  const step = Math.max(1, Math.ceil(count / most));
  const rows = Array.from({ length: Math.ceil(count / step) }, (_, k) => k * step);
  if (rows.length && rows[rows.length - 1] !== count - 1) rows.push(count - 1);
  return rows.filter((i) => channel.series.every((column) => Number.isFinite(column[i])));
}
