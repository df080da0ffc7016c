/** The time that scene, timeline and plots show, and its play. */

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16];

export class Clock {
  /** @param {number} begin s @param {number} end s */
  constructor(begin, end) {
    this.begin = begin;
    this.end = end;
    this.time = begin;
    this.speed = 1;
    this.playing = false;
    /** @type {((clock: Clock) => void)[]} */
    this.listeners = [];
    this.shown = 0;
  }

  /** Call `listener` at every change of time, speed or play, and now. @param {(clock: Clock) => void} listener */
  onChange(listener) {
    this.listeners.push(listener);
    listener(this);
  }

  /** @param {number} time s; held within the flight */
  set(time) {
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.changed();
  }

  play() {
    if (this.playing) return;
    if (this.time >= this.end) this.time = this.begin;
    this.playing = true;
    this.shown = performance.now();
    this.changed();
    requestAnimationFrame((now) => this.frame(now));
  }

  pause() {
    this.playing = false;
    this.changed();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** @param {number} steps along the list of speeds */
  changeSpeed(steps) {
    const at = SPEEDS.indexOf(this.speed) + steps;
    this.speed = SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)];
    this.changed();
  }

  /** @param {number} now ms */
  frame(now) {
    if (!this.playing) return;
    const passed = Math.max(0, now - this.shown) / 1000;
    this.shown = now;
    this.time = Math.min(this.time + passed * this.speed, this.end);
    if (this.time >= this.end) this.playing = false;
    this.changed();
    requestAnimationFrame((next) => this.frame(next));
  }

  changed() {
    for (const listener of this.listeners) listener(this);
  }
}
