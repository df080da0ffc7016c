/** The flight in three dimensions: what it was at the clock's time, beside what the ground station believed. */

import { Color, DirectionalLight, HemisphereLight, Scene as World, Vector3, WebGLRenderer } from 'three';
import { h } from './dom.js';
import { besideClearance, Cameras } from './scene/cameras.js';
import { Clearance } from './scene/clearance.js';
import { Detected } from './scene/detected.js';
import { Estimate } from './scene/estimate.js';
import { extent } from './scene/extent.js';
import { fence } from './scene/fence.js';
import { Formation } from './scene/formation.js';
import { toScene } from './scene/frames.js';
import { ground } from './scene/ground.js';
import { Heights } from './scene/heights.js';
import { Labels } from './scene/labels.js';
import { Obstacles } from './scene/obstacles.js';
import { Palette } from './scene/palette.js';
import { Panel } from './scene/panel.js';
import { Plans, reference, referencePoints, Trail, waypoints } from './scene/paths.js';
import { Readout } from './scene/readout.js';

/** @typedef {import('./data.js').Run} Run */
/** @typedef {'free'|'follow'|'top'} Kind */

/** @type {Record<string, number[]>} steps right and up */
const TURNS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const LIT_FROM = new Vector3(0.3, 0.8, 0.2);
const LARGE = 60; // m: in a wider flight the formation would be too small in the overview

export class Scene {
  /**
   * @param {HTMLElement} element which it fills
   * @param {Run} run
   * @param {import('./clock.js').Clock} clock
   * @param {Run} [ghost] another run, shown translucent at the same time
   * @param {Cameras} [cameras] of the scene before, as which this one is seen
   */
  constructor(element, run, clock, ghost, cameras) {
    this.element = element;
    this.run = run;
    const canvas = h('canvas.scene-canvas', { role: 'img', 'aria-label': 'the flight in three dimensions; arrow keys turn it', tabIndex: 0 });
    this.renderer = new WebGLRenderer({ canvas, antialias: true, stencil: true });
    element.append(canvas);
    // The player takes the keys at the document: those that are for the canvas are taken before.
    this.onKey = (/** @type {KeyboardEvent} */ event) => this.turn(event);
    window.addEventListener('keydown', this.onKey, { capture: true });
    this.palette = new Palette();
    this.labels = new Labels(element);
    this.world = new World();
    this.time = clock.time;
    this.live = clock.live;
    this.frame = 0;
    this.isStale = true;
    this.build(run, ghost);
    const box = extent(run);
    this.box = box;
    this.fence = fence(run, -box.low[2], this.palette, this.labels);
    this.world.add(ground(run, box, this.palette, this.labels), this.fence);
    const size = (run.meta.link_length ?? 3) + 2;
    if (run.clearance) this.obstacles.update(run.clearance.time);
    const aside = besideClearance(run, this.obstacles, 2 * size);
    this.cameras = new Cameras(canvas, box, size, aside, () => this.invalidate());
    this.panel = new Panel(element, this.parts(ghost), this.scales(), this.palette, {
      choose: (kind) => this.setCamera(kind),
      zoom: (factor) => this.cameras.zoom(factor),
      cover: () => this.resize(),
    });
    this.readout = new Readout(element, run);
    const isLarge = Math.max(box.high[0] - box.low[0], box.high[1] - box.low[1]) > LARGE;
    this.update();
    this.resize();
    this.setCamera(isLarge || run.clearance || this.live ? 'follow' : 'free');
    if (cameras) {
      this.cameras.resume(cameras);
      this.panel.choose(cameras.kind);
    }
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(element);
    this.palette.onChange(() => {
      this.world.background = this.palette.colour('sky');
      this.stale();
    });
    this.closing = new AbortController();
    clock.onChange(() => {
      if (clock.time === this.time) return;
      this.time = clock.time;
      this.stale();
    }, this.closing.signal);
  }

  /** @param {Run} run @param {Run} [ghost] */
  build(run, ghost) {
    const { palette, labels, world } = this;
    this.sun = new DirectionalLight(new Color(0xffffff), 1.7);
    world.add(this.sun, new HemisphereLight(new Color(0xffffff), new Color(0xb0b4ba), 1.9));
    this.formation = new Formation(run, palette, 'flown', labels);
    this.ghost = ghost ? new Formation(ghost, palette, 'ghost') : null;
    this.ghostTrail = ghost ? new Trail(ghost, palette, 'series-7') : null;
    this.obstacles = new Obstacles(run, palette, labels);
    this.heights = new Heights(this.formation, this.obstacles, palette, labels);
    this.estimate = new Estimate(run, palette);
    this.detected = new Detected(run, palette);
    this.reference = reference(run, palette);
    this.trail = new Trail(run, palette);
    this.plans = new Plans(run, palette);
    this.clearance = new Clearance(run, palette, labels);
    this.waypoints = waypoints(run, labels);
    world.add(
      this.formation.group, this.formation.hull, this.obstacles.group, this.heights.group, this.estimate.mesh,
      this.detected.group, this.reference, this.trail.line, this.plans.group, this.clearance.group,
    );
    if (this.ghost && this.ghostTrail) world.add(this.ghost.group, this.ghostTrail.line);
  }

  /** The parts of the key. @param {Run} [ghost] @returns {import('./scene/panel.js').Part[]} */
  parts(ghost) {
    const { run } = this;
    const toggle = (/** @type {{visible: boolean}[]} */ ...objects) => (/** @type {boolean} */ shown) => {
      for (const object of objects) object.visible = shown;
      this.stale();
    };
    /** @type {(import('./scene/panel.js').Part|null|false|undefined)[]} */
    const parts = [
      { name: run.meta.source === 'truth' ? 'payload' : 'payload, as estimated', colour: 'payload', look: 'area', shown: true, show: null },
      this.obstacles.obstacles.length > 0 && { name: 'obstacles', colour: 'obstacle', look: 'area', shown: true, show: toggle(this.obstacles.group) },
      this.formation.uavs.length > 0 && { name: 'formation hull', colour: 'flown', look: 'glass', shown: true, show: toggle(this.formation.hull) },
      this.estimate.position && { name: 'estimate', colour: 'estimate', look: 'glass', shown: true, show: toggle(this.estimate.mesh) },
      this.fence.children.length > 0 && { name: 'fence', colour: 'limit', look: 'glass', shown: true, show: toggle(this.fence) },
      (!this.detected.isEmpty || this.live) && { name: 'ground’s map', colour: 'detected-wire', look: 'wire', shown: true, show: toggle(this.detected.group) },
      run.has('reference.position') && { name: 'reference', colour: 'reference', look: 'thin', shown: true, show: toggle(this.reference) },
      run.has('horizon.plan') && { name: 'plan', colour: 'plan', look: 'line', shown: true, show: toggle(this.plans.plans[0].line) },
      run.has('horizon.stop') && { name: 'stop plan', colour: 'stop', look: 'dashed', shown: true, show: toggle(this.plans.plans[1].line) },
      { name: 'flown path', colour: 'flown', look: 'line', shown: true, show: toggle(this.trail.line) },
      { name: 'shadows and heights', colour: 'muted', look: 'thin', shown: true, show: toggle(this.heights.group) },
      { name: 'names and numbers', colour: 'text', look: 'word', shown: true, show: toggle(this.labels) },
      ghost && { name: `other run: ${ghost.meta.run}`, colour: 'series-7', look: 'glass', shown: true, show: toggle(this.ghost.group, this.ghostTrail.line) },
    ];
    if (run.clearance) {
      const show = (/** @type {boolean} */ shown) => {
        this.clearance.always = shown;
        this.stale();
      };
      parts.push({ name: 'least clearance, always', colour: 'clearance', look: 'line', shown: false, show });
    }
    return parts.filter((part) => Boolean(part));
  }

  /** @returns {import('./scene/panel.js').Scale[]} */
  scales() {
    const { palette } = this;
    const scales = [
      { name: 'flown path: speed (m/s)', from: '0', to: `${this.trail.fastest}`, scale: (/** @type {number} */ x) => palette.sequential(x), low: 0, high: 1 },
    ];
    if (this.formation.tension) {
      const { middle, reach } = this.formation.force;
      const [from, between, to] = [middle - reach, middle, middle + reach].map((force) => force.toFixed(1).replace('-', '−'));
      scales.push({ name: 'links: tension (N)', from, between, to, scale: (x) => palette.diverging(x), low: -1, high: 1 });
    }
    return scales;
  }

  /** @param {Kind} kind the flight at a fixed place, the formation, or from above */
  setCamera(kind) {
    this.cameras.set(kind);
    this.panel.choose(kind);
    this.invalidate();
  }

  /** Turn by the arrow keys, which do not move the time while the keyboard has reached the canvas. @param {KeyboardEvent} event */
  turn(event) {
    const turn = TURNS[event.key];
    const canvas = this.renderer.domElement;
    if (!turn || event.target !== canvas || !canvas.matches(':focus-visible') || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    this.cameras.turn(turn[0], turn[1]);
  }

  /** Fit the canvas to the element; called by itself when the element's size changes. */
  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.width = width;
    this.height = height;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.cameras.resize(width, height, this.panel.covered);
    // At once: a canvas of a new size is empty.
    this.draw();
  }

  /**
   * Where a place is seen.
   * @param {number[]} position north, east, down (m)
   * @returns {number[]} x, y (CSS pixels) from the top left of the element
   */
  project(position) {
    const camera = this.cameras.current;
    camera.updateMatrixWorld();
    const { x, y } = toScene(position).project(camera);
    return [(0.5 + 0.5 * x) * (this.width ?? 0), (0.5 - 0.5 * y) * (this.height ?? 0)];
  }

  /** Where the payload is seen now. @returns {number[]} x, y (CSS pixels) */
  payloadPixel() {
    if (this.isStale) this.update();
    return this.project(this.run.flown('position').at(this.time));
  }

  /** Draw a time at once, whatever the clock says. @param {number} time s */
  renderAt(time) {
    this.time = time;
    this.isStale = true;
    this.draw();
  }

  /** What is shown has changed. */
  stale() {
    this.isStale = true;
    this.invalidate();
  }

  /** Draw once before the next frame. */
  invalidate() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => this.draw());
  }

  /** Move all to the time. */
  update() {
    this.isStale = false;
    const { time } = this;
    this.formation.update(time);
    this.ghost?.update(time);
    this.ghostTrail?.update(time);
    this.obstacles.update(time);
    this.heights.update();
    this.estimate.update(time);
    this.detected.update(time);
    this.trail.update(time);
    this.plans.update(time);
    this.clearance.update(time);
    this.readout.update(time);
    this.cameras.follow(this.formation.payload.position);
  }

  draw() {
    cancelAnimationFrame(this.frame);
    if (this.isStale) this.update();
    const places = [this.formation.payload, ...this.formation.uavs.map(({ mesh }) => mesh)].map(({ position }) => position);
    this.obstacles.reveal((place) => this.cameras.eye(place), [...places, ...this.clearance.ends]);
    // From beside the camera, a bit higher: what is seen is lit, and its faces differ.
    this.cameras.from(this.sun.position).add(LIT_FROM);
    this.renderer.render(this.world, this.cameras.current);
    this.labels.place(this.cameras.current, this.width ?? 1, this.height ?? 1, this.clearance.ends);
    // Only now: the controls of the camera ask for a further frame when they are moved along.
    cancelAnimationFrame(this.frame);
    this.frame = 0;
  }

  /** Whether what has been flown is beyond the ground that is shown, or beyond a scale. */
  isOutgrown() {
    const { low, high } = this.box;
    const last = this.run.flown('position')?.series.map((values) => values[values.length - 1]) ?? [];
    return [0, 1].some((k) => last[k] < low[k] || last[k] > high[k]) || this.trail.isOutgrown() || this.formation.isOutgrown();
  }

  /** Show a run that has grown, by rows of the records that it had. */
  grow() {
    this.detected.grow();
    this.trail.grow();
    this.reference.setPoints(referencePoints(this.run));
    this.stale();
  }

  dispose() {
    cancelAnimationFrame(this.frame);
    this.closing.abort();
    this.observer.disconnect();
    window.removeEventListener('keydown', this.onKey, { capture: true });
    this.cameras.dispose();
    this.panel.dispose();
    this.readout.dispose();
    this.labels.dispose();
    this.world.traverse((/** @type {any} */ part) => part.geometry?.dispose());
    this.palette.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // browsers keep few
    this.renderer.domElement.remove();
  }
}
