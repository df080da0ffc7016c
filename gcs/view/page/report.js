/** The report of a run: words, scene, timeline, events and plots around one clock. */

import { Clock } from './clock.js';
import { h } from './dom.js';
import { eventList } from './events.js';
import { film } from './film.js';
import { cards, comparison, title } from './header.js';
import { Plots } from './plots.js';
import { Scene } from './scene.js';
import { keyboard, timeline } from './timeline.js';

/** @typedef {import('./data.js').Run} Run */

export class ReportPage {
  /**
   * @param {HTMLElement} element which it fills
   * @param {Run} run
   * @param {Run} [ghost] a second run that is compared
   * @param {boolean} [live] whether the flight is still going on
   */
  constructor(element, run, ghost, live = false) {
    this.run = run;
    this.ghost = ghost;
    this.clock = new Clock(run.meta.begin, run.meta.end, live);
    this.closing = new AbortController();
    this.stage = h('section', { id: 'scene', 'aria-label': 'scene' });
    /** @type {AbortController|null} of the parts that are made anew */
    this.parts = null;
    this.places = { title: h('header'), cards: h('div'), timeline: h('section'), events: h('section') };
    const plots = h('section', { id: 'plots' });
    const { places } = this;
    element.replaceChildren(
      places.title, h('div.top', {}, places.cards, this.stage), places.timeline, comparison(run, ghost) ?? '', places.events, plots,
    );
    this.tell();
    keyboard(run, this.clock, this.closing.signal);
    this.scene = this.newScene();
    this.plots = new Plots(plots, run, this.clock, ghost);
    // The moment that says most: the latest, the first contact, the least clearance, or else the beginning.
    const contact = run.events.find(({ kind }) => kind === 'contact');
    this.clock.set(live ? run.meta.end : (contact?.start ?? run.clearance?.time ?? run.meta.begin));
  }

  /** Make all parts but scene and plots anew. */
  tell() {
    const { run, clock } = this;
    this.parts?.abort();
    this.parts = new AbortController();
    const { signal } = this.parts;
    const scrolled = ['.cards', '#events .scroll'].map((name) => document.querySelector(name)?.scrollTop ?? 0);
    /** @type {Record<string, HTMLElement>} */
    const made = {
      title: h('header', {}, title(run)),
      cards: cards(run, clock),
      timeline: timeline(run, clock, signal),
      events: eventList(run, clock, signal),
    };
    for (const [name, part] of Object.entries(made)) this.places[name].replaceWith(part);
    this.places = made;
    ['.cards', '#events .scroll'].forEach((name, k) => {
      const part = document.querySelector(name);
      if (part) part.scrollTop = scrolled[k];
    });
  }

  /** @param {import('./scene/cameras.js').Cameras} [cameras] of the scene before @returns {Scene|null} */
  newScene(cameras) {
    try {
      return new Scene(this.stage, this.run, this.clock, this.ghost, cameras);
    } catch (error) {
      console.warn(error);
      this.stage.replaceChildren(h('p.failed', {}, `The scene cannot be shown: ${error.message} (it needs WebGL).`));
      this.stage.classList.add('absent');
      return null;
    }
  }

  /** Let the scene go on with what has come to be on record. @param {Run} later the run with the new rows alone */
  extend(later) {
    if (this.run.extend(later)) this.renewScene();
    else this.scene?.grow();
    this.clock.extend(this.run.meta.end);
  }

  /** Show what has come to be on record in words, plots and scales, too, which takes longer. */
  refresh() {
    // What is in use would be taken out of the hands of the user.
    if (!this.places.timeline.querySelector(':active, :focus-visible')) this.tell();
    this.plots.refresh();
    if (this.scene?.isOutgrown()) this.renewScene();
  }

  renewScene() {
    if (!this.scene) return;
    this.scene.dispose();
    this.scene = this.newScene(this.scene.cameras);
  }

  /** Become a film, and return what draws a time (s). @param {import('./film.js').View} view */
  film(view) {
    return film(/** @type {Scene} */ (this.scene), view);
  }

  /** End all that goes on by itself. */
  close() {
    this.clock.pause();
    this.clock.listeners = [];
    this.closing.abort();
    this.parts?.abort();
    this.scene?.dispose();
    this.plots.dispose();
  }
}
