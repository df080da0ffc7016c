/** The time that scene, timeline and plots show, and its play. */

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16];

export class Clock {
  /** @param {number} begin s @param {number} end s @param {boolean} [live] whether the end still moves */
  constructor(begin, end, live = false) {
    this.begin = begin;
    this.end = end;
    this.live = live;
    /** Whether the clock goes with the end of a flight that is still going on. */
    this.following = live;
    this.time = begin;
    this.speed = 1;
    this.playing = false;
    /** @type {((clock: Clock) => void)[]} */
    this.listeners = [];
    this.shown = 0;
    /** What a clock that follows has to make up: from a time (s), until when, from which moment on, for how long (ms). */
    this.way = { from: begin, to: end, since: performance.now(), lasts: 1 };
  }

  /**
   * Call `listener` at every change of time, speed or play, and now.
   * @param {(clock: Clock) => void} listener
   * @param {AbortSignal} [signal] ends that
   */
  onChange(listener, signal) {
    this.listeners.push(listener);
    signal?.addEventListener('abort', () => {
      this.listeners = this.listeners.filter((each) => each !== listener);
    });
    listener(this);
  }

  /** @param {number} time s; held within the flight */
  set(time) {
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.followAtEnd();
    if (this.following) this.play();
    this.changed();
  }

  /** Go with the end from now on, if that is where the time is. */
  followAtEnd() {
    this.following = this.live && this.time >= this.end;
    Object.assign(this.way, { from: this.time, to: this.time });
  }

  /** Move the end of a flight that is going on. @param {number} end s */
  extend(end) {
    const now = performance.now();
    // As long as until the next one comes: what is followed moves evenly.
    this.way = { from: this.time, to: end, since: now, lasts: Math.max(now - this.way.since, 1) };
    this.end = end;
    if (this.following) this.play();
    this.changed();
  }

  play() {
    if (this.playing) return;
    if (this.time >= this.end && !this.live) this.time = this.begin;
    this.playing = true;
    this.shown = performance.now();
    this.changed();
    requestAnimationFrame((now) => this.frame(now));
  }

  pause() {
    this.playing = false;
    this.following = false;
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
    if (this.following) {
      const { from, to, since, lasts } = this.way;
      this.time = from + (to - from) * Math.min(Math.max(now - since, 0) / lasts, 1);
    } else {
      this.time = Math.min(this.time + passed * this.speed, this.end);
      this.followAtEnd();
      this.playing = this.following || this.time < this.end;
    }
    this.changed();
    requestAnimationFrame((next) => this.frame(next));
  }

  changed() {
    for (const listener of this.listeners) listener(this);
  }
}
