/** Words in the scene: HTML over the canvas, each at its place, none over another. */

import { Vector3 } from 'three';
import { h } from '../dom.js';

const GAP = 8; // px between a place and the words beside it

/**
 * Where words may stand about their place, the first that is free: shares of their size, and px, to the right and down.
 * @type {Record<string, number[][]>}
 */
const PLACES = {
  clearance: [[0, -0.5, 14, 0], [-0.5, 0, 0, 12], [-0.5, -1, 0, -12], [-1, -0.5, -14, 0]],
  contact: [[0, -0.5, 14, 0]],
  waypoint: [[-0.5, -0.5, 0, 0]],
  obstacle: [[-0.5, -1, 0, -2], [-1, -1, -GAP, 0], [0, -1, GAP, 0]],
  vehicle: [[-0.5, -1, 0, -10], [-0.5, 0, 0, 10]],
  height: [[0, -0.5, GAP, 0], [-1, -0.5, -GAP, 0]],
  north: [[-0.5, -0.5, 0, 0]],
  mark: [[-0.5, -0.5, 0, 0]],
};
/** In this order they choose; from `MAY_HIDE` on, those without a free place are not shown. */
const ORDER = Object.keys(PLACES);
const CLEARANCE = ORDER.indexOf('contact');
const MAY_HIDE = ORDER.indexOf('obstacle');

export class Labels {
  /** @param {HTMLElement} parent */
  constructor(parent) {
    this.element = h('div.scene-labels', { 'aria-hidden': 'true' });
    parent.append(this.element);
    /** @type {Label[]} */
    this.labels = [];
    /** Whether names and numbers are shown; the clearance always says its metres. */
    this.visible = true;
  }

  /** @param {string} text @param {string} kind one of `PLACES`, a class of scene.css */
  add(text, kind) {
    const label = new Label(text, kind);
    this.labels.push(label);
    this.labels.sort((a, b) => a.rank - b.rank);
    this.element.append(label.element);
    return label;
  }

  /**
   * Put all labels where the camera sees their places.
   * @param {import('three').Camera} camera
   * @param {number} width px
   * @param {number} height px
   * @param {Vector3[]} points that no words may cover
   */
  place(camera, width, height, points = []) {
    const at = new Vector3();
    /** @type {number[][]} left, top, right, bottom */
    const taken = points.map((point) => {
      at.copy(point).project(camera);
      const [x, y] = [(0.5 + 0.5 * at.x) * width, (0.5 - 0.5 * at.y) * height];
      return [x - 4, y - 4, x + 4, y + 4];
    });
    for (const label of this.labels) {
      at.copy(label.position).project(camera);
      const inside = at.z > -1 && at.z < 1 && Math.abs(at.x) < 1.1 && Math.abs(at.y) < 1.1;
      const x = (0.5 + 0.5 * at.x) * width;
      const y = (0.5 - 0.5 * at.y) * height;
      const spot = inside && label.visible && label.layer() && (this.visible || label.rank <= CLEARANCE) ? label.spot(x, y, taken, width) : null;
      label.element.hidden = !spot;
      if (!spot) continue;
      taken.push(spot);
      label.element.style.transform = `translate(${spot[0].toFixed(1)}px, ${spot[1].toFixed(1)}px)`;
    }
  }

  dispose() {
    this.element.remove();
  }
}

export class Label {
  /** @param {string} text @param {string} kind */
  constructor(text, kind) {
    this.kind = kind;
    this.rank = ORDER.indexOf(kind);
    this.text = text;
    this.element = h(`div.scene-label.${kind}`, { hidden: true }, text);
    /** @type {number[]|null} width and height (px), once measured */
    this.size = null;
    this.position = new Vector3();
    this.visible = true;
    /** Whether the layer to which it belongs is shown. */
    this.layer = () => true;
  }

  /** @param {string} text */
  say(text) {
    if (text === this.text) return;
    this.text = text;
    this.element.textContent = text;
    this.size = null;
  }

  /**
   * Choose where the words stand.
   * @param {number} x px
   * @param {number} y px
   * @param {number[][]} taken by others
   * @param {number} across px, the width of the scene: the words of what is in it are, too
   * @returns {number[]|null} left, top, right, bottom
   */
  spot(x, y, taken, across) {
    this.size ??= [this.element.offsetWidth, this.element.offsetHeight];
    const [width, height] = this.size;
    const spots = PLACES[this.kind].map(([aside, down, right, below]) => {
      const wanted = x + aside * width + right;
      const left = x > 0 && x < across ? Math.max(2, Math.min(wanted, across - width - 2)) : wanted;
      const top = y + down * height + below;
      return [left, top, left + width, top + height];
    });
    const free = spots.find(([l, t, r, b]) => taken.every((other) => r < other[0] || l > other[2] || b < other[1] || t > other[3]));
    return free ?? (this.rank < MAY_HIDE ? spots[0] : null);
  }
}
