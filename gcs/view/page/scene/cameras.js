/** Three ways to look at the scene: free, with the payload, and from above. */

import { MOUSE, OrthographicCamera, PerspectiveCamera, Spherical, TOUCH, Vector3 } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { toScene } from './frames.js';

/** @typedef {'free'|'follow'|'top'} Kind */

const FIELD = 40; // deg, of view, up and down
const FROM = new Vector3(-0.45, 0.5, 1).normalize(); // where the camera first is: south, a bit west, above
const TURN = Math.PI / 36; // by a key
const FILLED = 0.94; // of the picture, at most, by the flight

export class Cameras {
  /**
   * @param {HTMLElement} canvas
   * @param {{low: number[], high: number[]}} box of the flight, north-east-down (m)
   * @param {number} formation the size of the formation (m)
   * @param {Vector3} aside the direction from which the formation is seen at first
   * @param {() => void} onChange
   */
  constructor(canvas, box, formation, aside, onChange) {
    const a = toScene(box.low);
    const b = toScene(box.high);
    this.corners = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => new Vector3(k & 1 ? a.x : b.x, k & 2 ? a.y : b.y, k & 4 ? a.z : b.z));
    this.middle = a.clone().add(b).multiplyScalar(0.5);
    this.formation = formation;
    this.perspective = new PerspectiveCamera(FIELD, 1, 0.1, 5000);
    this.above = new OrthographicCamera(-1, 1, 1, -1, 0.1, 5000);
    this.above.up.set(0, 0, -1);
    this.orbit = new OrbitControls(this.perspective, canvas);
    this.orbit.maxPolarAngle = 0.497 * Math.PI;
    this.orbit.minDistance = 1;
    this.orbit.zoomToCursor = false;
    this.pan = new OrbitControls(this.above, canvas);
    this.pan.enableRotate = false;
    this.pan.mouseButtons = { LEFT: MOUSE.PAN, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
    this.pan.touches = { ONE: TOUCH.PAN, TWO: TOUCH.DOLLY_PAN };
    this.followed = new Vector3();
    this.aside = aside;
    /** What is not covered by the key: its share of the width. */
    this.seen = 1;
    /** @type {Kind} */
    this.kind = 'free';
    this.isPlaced = false;
    for (const controls of [this.orbit, this.pan]) {
      controls.enableDamping = false;
      controls.addEventListener('change', onChange);
    }
  }

  get current() {
    return this.kind === 'top' ? this.above : this.perspective;
  }

  /**
   * @param {number} width CSS pixels
   * @param {number} height CSS pixels
   * @param {number} covered CSS pixels at the right edge: the middle is that of what is left
   */
  resize(width, height, covered) {
    this.seen = 1 - covered / width;
    this.perspective.aspect = width / height;
    for (const camera of [this.perspective, this.above]) camera.setViewOffset(width, height, covered / 2, 0, width, height);
    this.frameAbove(width / height);
    if (!this.isPlaced) this.set(this.kind);
    this.isPlaced = true;
  }

  /** @param {Kind} kind */
  set(kind) {
    this.kind = kind;
    this.orbit.enabled = kind !== 'top';
    this.pan.enabled = kind === 'top';
    if (kind === 'free') this.frame(this.corners, FROM);
    else if (kind === 'follow') this.nearby();
    else {
      this.pan.target.copy(this.middle);
      this.above.position.copy(this.middle).setY(1000);
      this.above.zoom = 1;
      this.above.updateProjectionMatrix();
      this.pan.update();
    }
  }

  /**
   * Look at a box: its corners fill the picture.
   * @param {Vector3[]} corners
   * @param {Vector3} from the direction to the camera
   */
  frame(corners, from) {
    const { perspective } = this;
    const { target } = this.orbit;
    target.copy(corners[0]).add(corners[7]).multiplyScalar(0.5);
    perspective.position.copy(target).add(from);
    perspective.lookAt(target);
    perspective.updateMatrixWorld();
    const [right, up, back] = [0, 1, 2].map((k) => new Vector3().setFromMatrixColumn(perspective.matrixWorld, k));
    const slope = FILLED * Math.tan((FIELD * Math.PI) / 360);
    let distance = 0;
    // What is near fills more of the picture than what is far, so the target moves until both sides fill as much.
    for (let pass = 0; pass < 4; pass += 1) {
      const seen = corners.map((corner) => corner.clone().sub(target));
      const reach = (/** @type {Vector3} */ corner) => Math.max(Math.abs(corner.dot(right)) / (perspective.aspect * this.seen), Math.abs(corner.dot(up)));
      distance = Math.max(...seen.map((corner) => corner.dot(back) + reach(corner) / slope));
      for (const axis of [right, up]) {
        const sides = seen.map((corner) => corner.dot(axis) / (distance - corner.dot(back)));
        target.addScaledVector(axis, (distance * (Math.min(...sides) + Math.max(...sides))) / 2);
      }
    }
    perspective.position.copy(target).addScaledVector(from, distance);
    this.orbit.update();
  }

  /** Look at the formation. */
  nearby() {
    this.orbit.target.copy(this.followed);
    const distance = (2.1 * this.formation) / Math.min(1, 1.2 * this.perspective.aspect * this.seen);
    this.perspective.position.copy(this.followed).addScaledVector(this.aside, distance);
    this.orbit.update();
  }

  /** Go along with the payload. @param {Vector3} payload */
  follow(payload) {
    const middle = payload.clone();
    middle.y += 0.25 * this.formation;
    if (this.kind === 'follow') {
      this.perspective.position.add(middle).sub(this.followed);
      this.orbit.target.copy(middle);
      this.orbit.update();
    }
    this.followed.copy(middle);
  }

  /** Look as before, at a scene that has been made anew. @param {Cameras} before */
  resume(before) {
    this.set(before.kind);
    if (before.kind !== 'follow') return;
    const offset = before.perspective.position.clone().sub(before.orbit.target);
    this.perspective.position.copy(this.orbit.target).add(offset);
    this.orbit.update();
  }

  /** The flight from above fills the picture. @param {number} aspect */
  frameAbove(aspect) {
    const width = 1.1 * Math.abs(this.corners[0].x - this.corners[1].x);
    const depth = 1.1 * Math.abs(this.corners[0].z - this.corners[4].z);
    const half = Math.max(depth, width / (aspect * this.seen)) / 2 + 0.5;
    Object.assign(this.above, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    this.above.updateProjectionMatrix();
  }

  /** The direction to the camera. @param {Vector3} into */
  from(into) {
    if (this.kind === 'top') return into.set(0, 1, 0);
    return into.copy(this.perspective.position).sub(this.orbit.target).normalize();
  }

  /** From where a place is seen. @param {Vector3} place */
  eye(place) {
    return this.kind === 'top' ? place.clone().setY(1000) : this.perspective.position;
  }

  /** @param {number} factor below 1 brings nearer */
  zoom(factor) {
    if (this.kind === 'top') {
      this.above.zoom /= factor;
      this.above.updateProjectionMatrix();
      this.pan.update();
    } else {
      const { target } = this.orbit;
      this.perspective.position.sub(target).multiplyScalar(factor).add(target);
      this.orbit.update();
    }
  }

  /**
   * Go around the target, or, from above, along.
   * @param {number} right steps
   * @param {number} up steps
   */
  turn(right, up) {
    const { orbit, pan } = this;
    if (this.kind === 'top') {
      const step = 0.05 * (this.above.top - this.above.bottom) / this.above.zoom;
      for (const place of [pan.target, this.above.position]) place.add(new Vector3(right * step, 0, -up * step));
      pan.update();
      return;
    }
    const offset = this.perspective.position.clone().sub(orbit.target);
    const place = new Spherical().setFromVector3(offset);
    place.theta += right * TURN;
    place.phi = Math.min(Math.max(place.phi - up * TURN, TURN), orbit.maxPolarAngle);
    this.perspective.position.setFromSpherical(place).add(orbit.target);
    orbit.update();
  }

  dispose() {
    this.orbit.dispose();
    this.pan.dispose();
  }
}

/**
 * The direction from which the line of the least clearance is seen at its length, from a little above; from higher up, or
 * from the other side, where an obstacle is in the way.
 * @param {import('../data.js').Run} run
 * @param {import('./obstacles.js').Obstacles} obstacles at the time of the least clearance
 * @param {number} distance of the camera (m)
 */
export function besideClearance(run, obstacles, distance) {
  const { clearance } = run;
  const from = FROM.clone().setY(0);
  if (clearance && clearance.min > 0) {
    const line = toScene(clearance.point_obstacle).sub(toScene(clearance.point_hull));
    // One that is almost upright is seen from everywhere.
    if (Math.hypot(line.x, line.z) > 0.2 * clearance.min) from.set(-line.z, 0, line.x);
    if (from.z < 0) from.negate();
  }
  from.normalize();
  const ways = [0.3, 0.7, 1.2].flatMap((up) => [1, -1].map((side) => new Vector3(side * from.x, up, side * from.z).normalize()));
  if (!clearance) return ways[0];
  const payload = run.flown('position').at(clearance.time);
  const places = [clearance.point_hull, clearance.point_obstacle, payload].map((place) => toScene(place));
  const isFree = (/** @type {Vector3} */ way) =>
    places.every((place) => obstacles.hiding(place.clone().addScaledVector(way, distance), place).length === 0);
  return ways.find(isFree) ?? ways[0];
}
