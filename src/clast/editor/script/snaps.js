/** The place that a pointer or a typed text means: vertices, edges, joints, right angles, the grid. */
import { sidesOf } from "./handles.js";

const NUMBER = "([+-]?(?:\\d+\\.?\\d*|\\.\\d+)(?:[eE][+-]?\\d+)?)";
const [POLAR, RELATIVE, ABSOLUTE, SINGLE] = [`^@?\\s*${NUMBER}\\s*<\\s*${NUMBER}$`, `^@\\s*${NUMBER}\\s*[,;\\s]\\s*${NUMBER}$`, `^${NUMBER}\\s*[,;\\s]\\s*${NUMBER}$`, `^${NUMBER}$`].map((one) => new RegExp(one));
const CLEAN = 10;
/** Digits behind the point of a sum that is not its rounding. */
const GRID = 25;
/** Least distance of grid lines, pixels. */

/**
 * The point of a text: `12.5, 8`, `@1, 2` from the last one, `@3<60` from it at an angle, degrees; or a
 * single number as {number}; null where it is neither.
 */
export function typed(text, [x, y] = [0, 0]) {
  const said = text.trim().replaceAll("−", "-").replaceAll("°", ""), read = (form) => said.match(form)?.slice(1).map(Number);
  const polar = read(POLAR), relative = read(RELATIVE), absolute = read(ABSOLUTE), single = read(SINGLE);
  const from = (dx, dy) => ({ at: [x + dx, y + dy].map((one) => rounded(one, CLEAN)), snap: "typed" });
  if (polar) return from(...[Math.cos, Math.sin].map((of) => polar[0] * of((polar[1] * Math.PI) / 180)));
  if (relative) return from(...relative);
  if (absolute) return { at: absolute, snap: "typed" };
  return single ? { number: single[0] } : null;
}

/** Distance of the lines of a grid that can be told apart at a scale, m: 1, 2 or 5 and zeros. */
export function gridStep(scale) {
  const least = GRID / scale, power = 10 ** Math.floor(Math.log10(least));
  return rounded([1, 2, 5, 10].find((one) => one * power >= least * (1 - 1e-9)) * power, CLEAN);
}

/** Digits behind the point that half a pixel needs. */
export const digitsAt = (scale) => Math.max(0, Math.min(9, Math.ceil(Math.log10(scale))));
export const rounded = (x, digits) => Number(x.toFixed(digits)) || 0;

function footOn([[ax, ay], [bx, by]], [x, y]) {
  const [ux, uy] = [bx - ax, by - ay], length = ux * ux + uy * uy;
  const share = length ? Math.max(0, Math.min(1, ((x - ax) * ux + (y - ay) * uy) / length)) : 0;
  return [ax + share * ux, ay + share * uy];
}

/** The nearest of some points, or of the nearest points of some sides, within a reach. */
function nearest(some, at, reach, of = (one) => one) {
  let best = null, least = reach;
  for (const one of some) {
    const point = of(one), far = Math.hypot(point[0] - at[0], point[1] - at[1]);
    if (far < least) [best, least] = [point, far];
  }
  return best;
}

/**
 * The point that a place of the pointer means, m, with `snap`, the name of what it lies on.
 * `lines` and `dots` are those of the file, `joints` and `corners` those of blocks, `before` the last points drawn.
 */
export function snapped(at, { lines, dots, joints, corners, before, near, step, digits }) {
  const whole = lines.filter((line) => !line.isEndless), places = [...whole.flatMap((line) => line.points), ...dots];
  const vertex = nearest(places, at, near);
  if (vertex) return { at: vertex, snap: "vertex" };
  const told = (point, more) => point.map((x) => rounded(x, digits + more));
  const corner = nearest(corners, at, near);
  if (corner) return { at: told(corner, 2), snap: "corner of a block" };
  const edge = nearest(whole.flatMap(sidesOf), at, 0.7 * near, (side) => footOn(side, at));
  if (edge) return { at: told(edge, 4), snap: "edge" };
  const joint = nearest(joints, at, 0.7 * near, (side) => footOn(side, at));
  if (joint) return { at: told(joint, 3), snap: "joint" };
  const grid = at.map((x) => rounded(Math.round(x / step) * step, CLEAN)), isNear = grid.map((x, k) => Math.abs(x - at[k]) < 0.8 * near);
  const last = before.at(-1);
  if (last) {
    const k = [0, 1].find((one) => Math.abs(at[one] - last[one]) < 0.6 * near);
    if (k !== undefined) {
      const point = [...last], other = 1 - k;
      point[other] = isNear[other] ? grid[other] : rounded(at[other], digits);
      return { at: point, snap: k ? "level" : "plumb" };
    }
    const square = before.length > 1 && squareTo(before.at(-2), last, at);
    if (square && Math.hypot(square[0] - at[0], square[1] - at[1]) < 0.6 * near) return { at: told(square, 3), snap: "right angle" };
  }
  return isNear[0] && isNear[1] ? { at: grid, snap: "grid" } : { at: told(at, 0), snap: "" };
}

/** The point at a right angle to the last side, nearest to a place. */
function squareTo([ax, ay], [bx, by], [x, y]) {
  const [nx, ny] = [ay - by, bx - ax], of = ((x - bx) * nx + (y - by) * ny) / (nx * nx + ny * ny || 1);
  return [bx + of * nx, by + of * ny];
}
