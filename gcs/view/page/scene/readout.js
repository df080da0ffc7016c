/** The figures of the moment in a corner of the scene. */

import { h } from '../dom.js';

const CONTACT = 1e-3; // m, within what the records tell

export class Readout {
  /** @param {HTMLElement} parent @param {import('../data.js').Run} run */
  constructor(parent, run) {
    this.margin = run.meta.margin;
    this.clearance = run.channel('clearance.nearest');
    this.position = run.flown('position');
    this.velocity = run.flown('velocity');
    this.figures = { clearance: h('b'), height: h('b'), speed: h('b') };
    const row = (/** @type {'clearance'|'height'|'speed'} */ name) => h('div', {}, h('span', {}, name), this.figures[name]);
    this.element = h('div.scene-readout', {}, this.clearance && row('clearance'), row('height'), row('speed'));
    parent.append(this.element);
  }

  /** @param {number} time */
  update(time) {
    const { clearance, height, speed } = this.figures;
    if (this.position) height.textContent = `${(-this.position.at(time)[2]).toFixed(1)} m`;
    if (this.velocity) speed.textContent = `${Math.hypot(...this.velocity.at(time)).toFixed(1)} m/s`;
    const nearest = this.clearance ? this.clearance.at(time)[0] : NaN;
    const touches = nearest <= CONTACT;
    clearance.textContent = touches ? 'contact' : Number.isFinite(nearest) ? `${nearest.toFixed(2)} m` : '–';
    clearance.className = touches ? 'contact' : nearest < this.margin ? 'near' : '';
  }

  dispose() {
    this.element.remove();
  }
}
