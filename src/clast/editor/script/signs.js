/** Signs of the section that are no lines of the file: arrows, sides that are held, stress in the rock. */
import { isPoints, plain, sidesOf } from "./handles.js";

const [TEETH, LONG] = [9, 6];
/** Distance and length of the hatching of a side that is held, pixels. */
const AXIS = 45;
/** Half of the longer axis of the ellipse of a stress, pixels. */
const SURFACES = ["#8c6d46", "#4f8a3c", "#6b6b6b", "#2f7f8f", "#a0522d", "#7a5195"];
/** Colours of the surfaces of a rockfall, by turns. */

export function drawArrow(pen, [x0, y0], [x1, y1], colour, width) {
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (length < 1) return;
  const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length], size = Math.min(10, 0.5 * length);
  pen.lines([[x0, y0, x1, y1]], colour, width);
  pen.areas([[x1, y1, x1 - size * ux - 0.4 * size * uy, y1 - size * uy + 0.4 * size * ux, x1 - size * ux + 0.4 * size * uy, y1 - size * uy - 0.4 * size * ux]], colour);
}

/** Hatch the parts of the outline of the domain on sides that are held. */
export function drawHeld(pen, { domain }, screen, colour) {
  const points = domain?.boundary, held = domain?.fixed_sides;
  if (!isPoints(points) || !Array.isArray(held)) return;
  const [xs, ys] = [0, 1].map((k) => points.map((point) => point[k]));
  const ends = { left: [0, Math.min(...xs)], right: [0, Math.max(...xs)], bottom: [1, Math.min(...ys)], top: [1, Math.max(...ys)] };
  const isOn = (point) => held.some((side) => ends[side] && point[ends[side][0]] === ends[side][1]);
  const middle = [0, 1].map((k) => 0.5 * (Math.min(...[xs, ys][k]) + Math.max(...[xs, ys][k]))), [mx, my] = screen(middle);
  for (const [a, b] of sidesOf({ points, closed: true })) {
    if (!isOn([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]) || (a[0] !== b[0] && a[1] !== b[1])) continue;
    const [[x0, y0], [x1, y1]] = [screen(a), screen(b)], length = Math.hypot(x1 - x0, y1 - y0) || 1, count = Math.ceil(length / TEETH);
    const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length], out = Math.sign((x0 - mx) * uy - (y0 - my) * ux) || 1;
    pen.lines(Array.from({ length: count }, (_, k) => {
      const [x, y] = [x0 + ((k + 0.5) * (x1 - x0)) / count, y0 + ((k + 0.5) * (y1 - y0)) / count];
      return [x, y, x + LONG * (out * uy + 0.7 * ux), y + LONG * (0.7 * uy - out * ux)];
    }), colour, 1);
  }
}

/** Draw the slope of a rockfall: each part of the profile in the colour of its surface, barriers as high as they are. */
export function drawSlope(pen, { rockfall, surface, barrier = [] }, screen, { ink, paper }) {
  const profile = rockfall?.profile, names = Object.keys(surface ?? {});
  if (!isPoints(profile)) return;
  const told = new Set(), of = [rockfall.surface ?? []].flat();
  for (let k = 0; k + 1 < profile.length; k++) {
    const name = of[k] ?? of[0], colour = SURFACES[names.indexOf(name) % SURFACES.length] ?? ink, ends = [...screen(profile[k]), ...screen(profile[k + 1])];
    pen.lines([ends], colour, 4);
    if (name && !told.has(name)) pen.text(0.5 * (ends[0] + ends[2]) + 8, 0.5 * (ends[1] + ends[3]) - 10, name, colour, paper);
    told.add(name);
  }
  for (const { x, height, inclination = 0 } of Array.isArray(barrier) ? barrier : []) {
    const k = profile.findIndex(([px], i) => i + 1 < profile.length && (px - x) * (profile[i + 1][0] - x) <= 0 && px !== profile[i + 1][0]);
    if (k < 0 || !(height > 0)) continue;
    const [[ax, ay], [bx, by]] = profile.slice(k, k + 2), y = ay + ((x - ax) * (by - ay)) / (bx - ax), turn = (inclination * Math.PI) / 180;
    pen.lines([[...screen([x, y]), ...screen([x + height * Math.sin(turn), y + height * Math.cos(turn)])]], ink, 4);
  }
}

/** Stress [xx, yy, xy] of [in_situ] at a height, Pa, tension positive; null where the case does not say it. */
export function stressAt(content, y) {
  const { in_situ: given, rock, gravity, domain } = content;
  if (!given) return null;
  const points = [domain?.boundary, domain?.profile].find(isPoints), datum = given.datum ?? (given.vertical ? points && Math.max(...points.map((point) => point[1])) : 0);
  const depth = datum - y, of = (rock ?? {})[domain?.rock] ?? Object.values(rock ?? {})[0], weight = Math.abs(gravity?.[1] ?? 9.8) * of?.density;
  if (Array.isArray(given.stress)) return given.stress.map((one, k) => one + depth * (given.gradient?.[k] ?? 0));
  const vertical = -weight * depth;
  return given.vertical && Number.isFinite(vertical * given.k0) ? [given.k0 * vertical, vertical, 0] : null;
}

/** Draw the ellipse of a stress about a point of the screen, with its principal values. */
export function drawStress(pen, [x, y], [xx, yy, xy], { chosen, paper }) {
  const mean = 0.5 * (xx + yy), turn = 0.5 * Math.atan2(2 * xy, xx - yy), half = Math.hypot(0.5 * (xx - yy), xy);
  const [first, second] = [mean + half, mean - half], scale = AXIS / (Math.max(Math.abs(first), Math.abs(second)) || 1);
  const at = (angle) => {
    const [a, b] = [Math.abs(first) * scale * Math.cos(angle), Math.abs(second) * scale * Math.sin(angle)];
    return [x + a * Math.cos(turn) - b * Math.sin(turn), y - a * Math.sin(turn) - b * Math.cos(turn)];
  };
  pen.lines([Array.from({ length: 65 }, (_, k) => at((k * Math.PI) / 32)).flat()], chosen, 1.5);
  pen.lines([[...at(0), ...at(Math.PI)], [...at(Math.PI / 2), ...at(-Math.PI / 2)]], chosen, 1);
  const mega = (one) => plain(Number((one / 1e6).toPrecision(3))).replace("-", "−");
  pen.text(x + AXIS + 8, y - 8, `${mega(second)} and ${mega(first)} MPa`, chosen, paper);
}
