/** Words in the scene: HTML over the canvas, each at its place. */

import { Vector3 } from 'three';
import { h } from '../dom.js';

export class Labels {
  /** @param {HTMLElement} parent */
  constructor(parent) {
    this.element = h('div.scene-labels', { 'aria-hidden': 'true' });
    parent.append(this.element);
    /** @type {Label[]} */
    this.labels = [];
  }

  /** @param {string} text @param {string} kind a class of scene.css */
  add(text, kind) {
    const label = new Label(text, kind);
    this.labels.push(label);
    this.element.append(label.element);
    return label;
  }

  /** Put all labels where the camera sees their places. */
  place(/** @type {import('three').Camera} */ camera, /** @type {number} */ width, /** @type {number} */ height) {
    const at = new Vector3();
    for (const label of this.labels) {
      at.copy(label.position).project(camera);
      const seen = label.visible && label.layer() && at.z > -1 && at.z < 1 && Math.abs(at.x) < 1.1 && Math.abs(at.y) < 1.1;
      label.element.hidden = !seen;
      if (!seen) continue;
      const x = (0.5 + 0.5 * at.x) * width;
      const y = (0.5 - 0.5 * at.y) * height;
      label.element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    }
  }

  dispose() {
    this.element.remove();
  }
}

export class Label {
  /** @param {string} text @param {string} kind */
  constructor(text, kind) {
    this.text = text;
    this.span = h('span', {}, text);
    this.element = h(`div.scene-label.${kind}`, {}, this.span);
    this.position = new Vector3();
    this.visible = true;
    /** Whether the layer to which it belongs is shown. */
    this.layer = () => true;
  }

  /** @param {string} text */
  say(text) {
    if (text === this.text) return;
    this.text = text;
    this.span.textContent = text;
  }
}
