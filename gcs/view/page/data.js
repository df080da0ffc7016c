/**
 * The records of a run, as the page holds them: decoded from the header and the blob of gcs/view/page_data.py.
 * Frames are north-east-down, times s, quaternions body to world, w first.
 */

/** @typedef {{shape: number[], offset: number, dtype: 'int16'|'float32'|'time', first?: any, scale?: number[]}} ArrayRef */
/** @typedef {{kind: string, start: number, end: number|null, source: string, text: string, severity: string}} Event */

const MISSING = 65535;

/** A record over time: `series[j][i]` is column j in row i; NaN where it is not known. */
export class Channel {
  /**
   * @param {string} name
   * @param {Float64Array} t
   * @param {string[]} columns
   * @param {string} unit
   * @param {number[]} shape of the values: rows first
   * @param {Float32Array[]} series
   */
  constructor(name, t, columns, unit, shape, series) {
    this.name = name;
    this.t = t;
    this.columns = columns;
    this.unit = unit;
    this.shape = shape;
    this.series = series;
    this.isQuaternion = columns.join('') === 'wxyz';
    this.last = 0;
    /** Whether the arrays are in memory of its own, with room for further rows. */
    this.grows = false;
  }

  /**
   * Append the rows of the same record that have come since. What has no column there, or none here, is not known.
   * @param {Channel} later
   */
  append(later) {
    const named = this.shape.length < 3; // others are paths, of as many steps as there are
    const added = named ? later.columns.filter((name) => !this.columns.includes(name)) : [];
    const count = named ? this.columns.length + added.length : Math.max(this.series.length, later.series.length);
    this.columns = [...this.columns, ...added];
    const unknown = (/** @type {Channel} */ { t }) => new Float32Array(t.length).fill(NaN);
    const before = Array.from({ length: count }, (_, j) => this.series[j] ?? unknown(this));
    const after = before.map((_, j) => later.series[named ? later.columns.indexOf(this.columns[j]) : j] ?? unknown(later));
    // What was added has no room yet.
    this.series = before.map((values, j) => joined(values, after[j], this.grows && j < this.series.length));
    this.t = joined(this.t, later.t, this.grows);
    this.shape = [this.t.length, ...this.shape.slice(1)];
    this.grows = true;
  }

  /** The number of the last row that is not after `time`; the first one before all. @param {number} time */
  rowAt(time) {
    const { t } = this;
    let low = this.last < t.length && t[this.last] <= time ? this.last : 0;
    // From frame to frame, time moves on by a few rows.
    for (let k = 0; k < 8 && low + 1 < t.length && t[low + 1] <= time; k += 1) low += 1;
    if (low + 1 < t.length && t[low + 1] <= time) {
      let high = t.length;
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (t[middle] <= time) low = middle;
        else high = middle;
      }
    }
    this.last = low;
    return low;
  }

  /** All values of a row. @param {number} i @returns {number[]} */
  row(i) {
    return this.series.map((column) => column[i]);
  }

  /** A path (steps of [north, east, down]) of a channel of paths, at or before `time`; without unknown steps. */
  path(time) {
    const values = this.row(this.rowAt(time));
    const found = [];
    for (let k = 0; k + 2 < values.length; k += 3) {
      if (Number.isFinite(values[k])) found.push(values.slice(k, k + 3));
    }
    return found;
  }

  /**
   * The values at a time, interpolated between rows (spherically if a quaternion); those at the ends before and after.
   * @param {number} time
   * @returns {number[]}
   */
  at(time) {
    const i = this.rowAt(time);
    const { t } = this;
    if (i + 1 >= t.length || time <= t[i]) return this.row(i);
    const share = (time - t[i]) / (t[i + 1] - t[i]);
    const a = this.row(i);
    const b = this.row(i + 1);
    if (this.isQuaternion) return slerp(a, b, share);
    return a.map((value, j) => (Number.isNaN(b[j]) ? value : value + share * (b[j] - value)));
  }
}

/**
 * Two arrays, one after the other: in the memory of the first where it has room, otherwise in new memory, with room.
 * @template {Float32Array|Float64Array} T
 * @param {T} first @param {T} second @param {boolean} hasRoom whether what follows the first in its memory is free
 * @returns {T}
 */
function joined(first, second, hasRoom) {
  const length = first.length + second.length;
  const Kind = /** @type {any} */ (first.constructor);
  let found = first;
  if (!hasRoom || first.byteOffset + length * Kind.BYTES_PER_ELEMENT > first.buffer.byteLength) {
    found = new Kind(2 * length);
    found.set(first);
  }
  found = new Kind(found.buffer, found.byteOffset, length);
  found.set(second, first.length);
  return found;
}

/** @param {number[]} a @param {number[]} b @param {number} share @returns {number[]} */
export function slerp(a, b, share) {
  let cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const sign = cosine < 0 ? -1 : 1;
  cosine = Math.min(Math.abs(cosine), 1);
  const angle = Math.acos(cosine);
  let wa = 1 - share;
  let wb = share;
  if (angle > 1e-3) {
    wa = Math.sin((1 - share) * angle) / Math.sin(angle);
    wb = Math.sin(share * angle) / Math.sin(angle);
  }
  const q = a.map((value, j) => wa * value + sign * wb * b[j]);
  const norm = Math.hypot(...q);
  return q.map((value) => value / norm);
}

/** Roll, pitch and yaw (deg) of a quaternion. @param {number[]} q @returns {number[]} */
export function euler([w, x, y, z]) {
  const degrees = 180 / Math.PI;
  const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)) * degrees,
    Math.asin(sine) * degrees,
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) * degrees,
  ];
}

/** A run: what the header says, and channels that are decoded when they are first asked for. */
export class Run {
  /** @param {any} header @param {ArrayBuffer} blob */
  constructor(header, blob) {
    this.header = header;
    this.meta = header.meta;
    /** @type {Event[]} */
    this.events = header.events;
    this.obstacles = header.obstacles;
    this.tracks = header.tracks;
    this.standing = header.standing;
    this.clearance = header.clearance;
    this.blob = blob;
    /** @type {Map<string, Channel>} */
    this.channels = new Map();
    /** @type {Map<number, Float64Array>} */
    this.times = new Map();
  }

  /** @param {string} name */
  has(name) {
    return name in this.header.channels;
  }

  /** The names of the channels that begin with `prefix`. @param {string} prefix @returns {string[]} */
  names(prefix) {
    return Object.keys(this.header.channels).filter((name) => name.startsWith(prefix));
  }

  /** A channel; null if it is not on record. @param {string} name @returns {Channel|null} */
  channel(name) {
    const entry = this.header.channels[name];
    if (!entry) return null;
    let found = this.channels.get(name);
    if (!found) {
      const series = decodeColumns(this.blob, entry.values);
      found = new Channel(name, this.time(entry.t), entry.columns, entry.unit, entry.values.shape, series);
      this.channels.set(name, found);
    }
    return found;
  }

  /**
   * Take what has come to be on record since.
   * @param {Run} later the same run, with the new rows alone
   * @returns {boolean} whether there are records of another kind
   */
  extend(later) {
    let isOther = false;
    for (const name of Object.keys(later.header.channels)) {
      const found = /** @type {Channel} */ (later.channel(name));
      const own = this.channel(name);
      if (own) own.append(found);
      else {
        this.header.channels[name] = later.header.channels[name];
        this.channels.set(name, found);
        isOther ||= !name.startsWith('track.');
      }
    }
    Object.assign(this.meta, later.meta, { begin: this.meta.begin });
    this.events = later.events;
    this.tracks = later.tracks;
    this.standing = later.standing;
    if (isOther) this.obstacles = later.obstacles;
    return isOther;
  }

  /** What was flown, by the truth or, where there is none, the estimate: `position`, `attitude`, `velocity`, `rates`. */
  flown(part) {
    return this.channel(`${this.meta.source}.payload.${part}`);
  }

  /** @param {ArrayRef} ref @returns {Float64Array} */
  time(ref) {
    let t = this.times.get(ref.offset);
    if (!t) {
      t = decodeTimes(this.blob, ref);
      this.times.set(ref.offset, t);
    }
    return t;
  }
}

/** @param {ArrayBuffer} blob @param {ArrayRef} ref */
function decodeTimes(blob, ref) {
  const steps = new Int32Array(blob, ref.offset, ref.shape[0]);
  const t = new Float64Array(steps.length);
  let microseconds = ref.first;
  for (let i = 0; i < steps.length; i += 1) {
    microseconds += steps[i];
    t[i] = microseconds / 1e6;
  }
  return t;
}

/** @param {ArrayBuffer} blob @param {ArrayRef} ref @returns {Float32Array[]} */
function decodeColumns(blob, ref) {
  const rows = ref.shape[0];
  const columns = ref.shape.slice(1).reduce((a, b) => a * b, 1);
  const found = [];
  for (let j = 0; j < columns; j += 1) {
    if (ref.dtype === 'float32') {
      found.push(new Float32Array(blob, ref.offset + 4 * rows * j, rows));
      continue;
    }
    const steps = new Uint16Array(blob, ref.offset + 2 * rows * j, rows);
    const values = new Float32Array(rows);
    let q = 0;
    for (let i = 0; i < rows; i += 1) {
      q = (q + steps[i]) & 0xffff;
      values[i] = q === MISSING ? NaN : ref.first[j] + ref.scale[j] * q;
    }
    found.push(values);
  }
  return found;
}

/** @param {string} text base64 of deflated bytes @returns {Promise<ArrayBuffer>} */
async function inflate(text) {
  const packed = Uint8Array.from(atob(text.trim()), (character) => character.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

/**
 * The runs of the page: one, or two that are compared.
 * @param {Document} document
 * @returns {Promise<Run[]>}
 */
export async function decode(document) {
  const headers = [...document.querySelectorAll('script.run-header')];
  const blobs = [...document.querySelectorAll('script.run-blob')];
  return Promise.all(
    headers.map((header, k) => {
      const text = blobs[k].textContent ?? '';
      blobs[k].textContent = '';
      return decoded(JSON.parse(header.textContent ?? ''), text);
    }),
  );
}

/** A run of its header and its blob. @param {any} header @param {string} blob @returns {Promise<Run>} */
export async function decoded(header, blob) {
  return new Run(header, await inflate(blob));
}
