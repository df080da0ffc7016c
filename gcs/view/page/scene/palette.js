/** Materials whose colours are those of the page (tokens.css), in light and dark, and scales of colour. */

import { Color, DoubleSide, LineBasicMaterial, MeshBasicMaterial, MeshLambertMaterial } from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { token } from '../dom.js';

/** Viridis, dark to bright. */
const SEQUENTIAL = ['#440154', '#46327e', '#365c8d', '#277f8e', '#1fa187', '#4ac16d', '#a0da39', '#fde725'];

export class Palette {
  constructor() {
    /** @type {{colour: string|null, material: any}[]} those without a token keep their colour */
    this.materials = [];
    /** @type {(() => void)[]} */
    this.listeners = [];
    this.scheme = matchMedia('(prefers-color-scheme: dark)');
    this.change = () => this.refresh();
    this.scheme.addEventListener('change', this.change);
  }

  /** @param {string} name of a token @returns {Color} */
  colour(name) {
    return new Color(token(name) || '#888888');
  }

  /** Call `listener` now, and whenever the page changes between light and dark. @param {() => void} listener */
  onChange(listener) {
    this.listeners.push(listener);
    listener();
  }

  refresh() {
    for (const { colour, material } of this.materials) if (colour) material.color.copy(this.colour(colour));
    for (const listener of this.listeners) listener();
  }

  /** A shaded surface. @param {string} colour token @param {object} [options] */
  solid(colour, options = {}) {
    return this.keep(colour, new MeshLambertMaterial(options));
  }

  /** A translucent surface, which hides nothing. @param {string} colour token @param {number} opacity @param {object} [options] */
  translucent(colour, opacity, options = {}) {
    // In one pass: of one colour and without shade, both sides look the same in any order.
    const look = { transparent: true, opacity, depthWrite: false, side: DoubleSide, forceSinglePass: true };
    return this.keep(colour, new MeshBasicMaterial({ ...look, ...options }));
  }

  /** A surface without shade. @param {string} colour token @param {object} [options] */
  flat(colour, options = {}) {
    return this.keep(colour, new MeshBasicMaterial(options));
  }

  /** A line of one pixel. @param {string} colour token @param {number} [opacity] */
  hairline(colour, opacity = 1) {
    return this.keep(colour, new LineBasicMaterial({ transparent: opacity < 1, opacity }));
  }

  /** A line of some pixels. @param {string} colour token @param {number} width CSS pixels @param {object} [options] */
  line(colour, width, options = {}) {
    return this.keep(colour, new LineMaterial({ linewidth: width, ...options }));
  }

  /** A line of some pixels with a colour for each point. @param {number} width CSS pixels */
  colouredLine(width) {
    const material = new LineMaterial({ linewidth: width, vertexColors: true });
    this.materials.push({ colour: null, material });
    return material;
  }

  /** @template {{color: Color}} M @param {string} colour @param {M} material @returns {M} */
  keep(colour, material) {
    material.color.copy(this.colour(colour));
    this.materials.push({ colour, material });
    return material;
  }

  /** The colour of a share (0 to 1) of a sequential scale; it leaves out what is faint on the background. */
  sequential(/** @type {number} */ share) {
    const clamped = Math.min(Math.max(share, 0), 1);
    return between(SEQUENTIAL, this.scheme.matches ? 0.3 + 0.7 * clamped : 0.9 * clamped);
  }

  /** The colour of a share (-1 to 1) of a scale of two sides: below nothing orange, above blue. */
  diverging(/** @type {number} */ share) {
    const middle = this.scheme.matches ? '#d8dde3' : '#b8bec6';
    const ends = this.scheme.matches ? ['#ff7f32', '#2f9be8'] : ['#c04a00', '#005f9e'];
    return between([ends[0], middle, ends[1]], 0.5 + 0.5 * Math.min(Math.max(share, -1), 1));
  }

  dispose() {
    this.scheme.removeEventListener('change', this.change);
    for (const { material } of this.materials) material.dispose();
  }
}

/** @param {string[]} colours @param {number} share of the way from the first to the last */
function between(colours, share) {
  const at = share * (colours.length - 1);
  const i = Math.min(Math.floor(at), colours.length - 2);
  return new Color(colours[i]).lerp(new Color(colours[i + 1]), at - i);
}

/** A gradient for CSS. @param {(share: number) => Color} scale @param {number} from @param {number} to */
export function gradient(scale, from, to) {
  const stops = Array.from({ length: 9 }, (_, i) => `#${scale(from + ((to - from) * i) / 8).getHexString()}`);
  return `linear-gradient(to right, ${stops.join(', ')})`;
}
