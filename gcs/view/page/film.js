/** The page as a film: only the scene, with title and time over it, moment by moment. */

import { Vector3 } from 'three';
import { h } from './dom.js';
import { toScene } from './scene/frames.js';

/** @typedef {import('./scene.js').Scene} Scene */
/** @typedef {'around'|'overview'|'follow'|'top'} View */

const REACH = 9; // m, to each side of the payload: of a wider flight only this is seen
const EDGE = 2; // m, of the ground, that may lie outside the picture
const EDGE_SHARE = 0.2; // at most, of half its width
const HEADROOM = 1; // m above, for the title
const UP = 0.36; // of the camera, to one aside
const SWING = 0.4; // rad, to both sides
const PERIOD = 60; // s of the flight
const MOST_NAMES = 6;

/**
 * Make the page that of a film, and return what draws a time (s).
 * @param {Scene} scene
 * @param {View} view around: from beside the flight, slowly to and fro; the others are cameras of the scene
 */
export function film(scene, view) {
  const time = h('div', { id: 'film-time' });
  document.documentElement.classList.add('film');
  document.body.append(time);
  for (const { label } of scene.obstacles.obstacles) label.visible = scene.obstacles.obstacles.length <= MOST_NAMES;
  scene.panel.key.open = false;
  scene.setCamera(view === 'follow' || view === 'top' ? view : 'free');
  scene.resize();
  const aside = beside(scene);
  return (/** @type {number} */ now) => {
    time.textContent = `${now.toFixed(1)} s`;
    if (view === 'around') {
      const turn = aside + SWING * Math.sin((2 * Math.PI * (now - scene.run.meta.begin)) / PERIOD);
      scene.cameras.frame(seen(scene, now), new Vector3(Math.cos(turn), UP, Math.sin(turn)).normalize());
    }
    scene.renderAt(now);
  };
}

/** The angle (rad, from x to z) from which the flight is seen at its length, rather from the south. @param {Scene} scene */
function beside({ run }) {
  const { t, series: [north, east] } = run.flown('position');
  const mean = (/** @type {(i: number) => number} */ value) => t.reduce((sum, _, i) => sum + (value(i) || 0), 0) / t.length;
  const [n0, e0] = [mean((i) => north[i]), mean((i) => east[i])];
  const [nn, ee, ne] = [mean((i) => (north[i] - n0) ** 2), mean((i) => (east[i] - e0) ** 2), mean((i) => (north[i] - n0) * (east[i] - e0))];
  const along = Math.atan2(-2 * ne, ee - nn) / 2;
  return along + Math.PI / 2;
}

/** The corners of what is seen at a time: the flight, or as much of it about the payload. @param {Scene} scene @param {number} time */
function seen({ run, cameras: { corners } }, time) {
  const payload = toScene(run.flown('position').at(time));
  const sides = ['x', 'z'].map((axis) => {
    const [low, high] = [corners[0][axis], corners[7][axis]].sort((a, b) => a - b);
    const half = (high - low) / 2;
    const edge = Math.min(EDGE, EDGE_SHARE * half);
    const reach = Math.min(REACH, half - edge);
    const middle = Math.min(Math.max(payload[axis], low + edge + reach), high - edge - reach);
    return [middle - reach, middle + reach];
  });
  return corners.map((corner, k) => new Vector3(sides[0][k & 1], corner.y > 0 ? corner.y + HEADROOM : 0, sides[1][(k >> 2) & 1]));
}
