/** Fewer points for the same line. */

/** @typedef {ArrayLike<number>} Point */

/**
 * The points without which the line would miss some by more than a tolerance (Douglas and Peucker).
 * @param {Point[]} points
 * @param {number} tolerance m
 */
export function straightened(points, tolerance) {
  const kept = new Set([0, points.length - 1]);
  const parts = [[0, points.length - 1]];
  for (let part = parts.pop(); part; part = parts.pop()) {
    const [first, last] = part;
    let [farthest, distance] = [0, tolerance];
    for (let i = first + 1; i < last; i += 1) {
      const off = fromSegment(points[i], points[first], points[last]);
      if (off > distance) [farthest, distance] = [i, off];
    }
    if (!farthest) continue;
    kept.add(farthest);
    parts.push([first, farthest], [farthest, last]);
  }
  return points.filter((_, i) => kept.has(i));
}

/**
 * The indices of points that are apart by at least a distance, each from that before.
 * @param {Point[]} points
 * @param {number} least m
 */
export function spaced(points, least) {
  let last = 0;
  return points.flatMap((point, i) => {
    if (i > 0 && Math.hypot(...[0, 1, 2].map((k) => point[k] - points[last][k])) < least) return [];
    last = i;
    return [i];
  });
}

/** The distance of a point from the segment between two. @param {Point} point @param {Point} a @param {Point} b */
function fromSegment(point, a, b) {
  let [along, length] = [0, 0];
  for (let k = 0; k < 3; k += 1) {
    along += (point[k] - a[k]) * (b[k] - a[k]);
    length += (b[k] - a[k]) ** 2;
  }
  const share = length > 0 ? Math.min(Math.max(along / length, 0), 1) : 0;
  return Math.hypot(...[0, 1, 2].map((k) => point[k] - a[k] - share * (b[k] - a[k])));
}
