/** The key of the scene, whose parts can be switched, and the choice of the camera. */

import { h } from '../dom.js';
import { gradient } from './palette.js';

const NARROW = 560; // CSS pixels: in a scene narrower than this, the key is closed at first

/**
 * A part of the scene.
 * @typedef {{name: string, colour: string, look: 'area'|'glass'|'wire'|'line'|'thin'|'dashed'|'word', shown: boolean, show: ((shown: boolean) => void)|null}} Part
 */
/** @typedef {{name: string, from: string, between?: string, to: string, scale: (share: number) => import('three').Color, low: number, high: number}} Scale */

export class Panel {
  /**
   * @param {HTMLElement} parent
   * @param {Part[]} parts
   * @param {Scale[]} scales
   * @param {import('./palette.js').Palette} palette
   * @param {{choose(kind: 'free'|'follow'|'top'): void, zoom(factor: number): void, cover(): void}} on what is called
   *   when a camera is chosen, is to go nearer or farther, and when the key is opened or closed
   */
  constructor(parent, parts, scales, palette, on) {
    const views = /** @type {const} */ ([['free', 'overview'], ['follow', 'follow'], ['top', 'top']]);
    this.buttons = views.map(([kind, name]) =>
      h('button', { type: 'button', 'aria-pressed': 'false', 'data-camera': kind, onclick: () => on.choose(kind) }, name));
    const zoom = (/** @type {string} */ face, /** @type {string} */ title, /** @type {number} */ factor) =>
      h('button', { type: 'button', title, 'aria-label': title, onclick: () => on.zoom(factor) }, face);
    this.cameras = h('div.scene-cameras', { role: 'group', 'aria-label': 'camera' }, ...this.buttons, zoom('+', 'nearer', 0.8), zoom('−', 'farther', 1.25));
    this.key = h('details.scene-key', { open: parent.clientWidth >= NARROW, ontoggle: () => on.cover() },
      h('summary', {}, 'Key'),
      h('div', {}, ...parts.map(row), ...scales.map((scale) => legend(scale, palette))));
    parent.append(this.cameras, this.key);
  }

  /** @param {'free'|'follow'|'top'} kind */
  choose(kind) {
    for (const button of this.buttons) button.setAttribute('aria-pressed', String(button.dataset.camera === kind));
  }

  /** The width that the open key covers at the right edge (CSS pixels). */
  get covered() {
    const parent = this.key.parentElement;
    const open = this.key.open && parent !== null && parent.clientWidth >= NARROW;
    return open ? this.key.offsetWidth : 0;
  }

  dispose() {
    this.cameras.remove();
    this.key.remove();
  }
}

/** @param {Part} part */
function row({ name, colour, look, shown, show }) {
  const swatch = h(`span.scene-swatch.${look}`, { 'aria-hidden': 'true' }, look === 'word' ? 'a1' : '');
  swatch.style.setProperty('--colour', `var(--${colour})`);
  if (!show) return h('div.scene-row', {}, h('span.scene-no-box'), swatch, name);
  const box = h('input', { type: 'checkbox', checked: shown, onchange: () => show(box.checked) });
  return h('label.scene-row', {}, box, swatch, name);
}

/** @param {Scale} scale @param {import('./palette.js').Palette} palette */
function legend({ name, from, between = '', to, scale, low, high }, palette) {
  const bar = h('div.scene-bar');
  palette.onChange(() => {
    bar.style.background = gradient(scale, low, high);
  });
  return h('div.scene-legend', {}, name, bar, h('div.scene-ends', {}, h('span', {}, from), h('span', {}, between), h('span', {}, to)));
}
