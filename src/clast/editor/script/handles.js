/** What the tables of a case are in the section, from its schema: lines to draw, and handles to drag. */
import { variants, kindOf, isTable, toml } from "./values.js";

const RAD = Math.PI / 180;
const PARALLELS = 4;
/** Lines on either side of the one that a joint set begins with. */
const ARROWS = 4;
/** Parts of the line of a pressure between its arrows. */

export const isPoint = (value) => Array.isArray(value) && value.length === 2 && value.every(Number.isFinite);
export const isPoints = (value) => Array.isArray(value) && value.length > 0 && value.every(isPoint);
export const notesOf = (one) => one["x-clast"] ?? {};
export const tableNode = (schema, one) => variants(schema, one).flatMap((form) => (kindOf(form) === "list" ? variants(schema, form.items ?? {}) : [form])).find((form) => kindOf(form) === "table");
export const drawnKeys = (node) => Object.entries(node?.properties ?? {}).filter(([, one]) => notesOf(one).geometry);
const away = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const middleOf = (a, b) => [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
const within = (angle) => ((((angle + 90) % 180) + 180) % 180) - 90 || 90;
/** The same line, at an angle from -90 to 90 degrees. */

/** A number as a case file has it, without the noise of its last digits. */
export const plain = (x) => String(Number(x.toPrecision(12)) || 0);
export const pointText = (point) => `[${point.map(plain).join(", ")}]`;

/**
 * Sizes and directions from a point: where their handle is, and the value that a place of it means.
 * `seen` has `reach`, m, for what has no length, `middle` of the view, `force` and `pressure`, N and Pa for each
 * metre drawn, and `holds`, whether a block is at a point.
 */
export const EXTENTS = {
  radius: { at: (r, [x, y]) => [x + r, y], of: away },
  width: { at: (w, [x, y]) => [x + w / 2, y], of: ([px], [x]) => 2 * Math.abs(px - x) },
  height: { at: (h, [x, y]) => [x, y + h], of: ([, py], [, y]) => Math.abs(py - y) },
  size: { at: ([w, h], [x, y]) => [x + w, y + h], of: ([px, py], [x, y]) => [px - x, py - y] },
  angle: {
    at: (a, [x, y], { reach }) => [x + reach * Math.cos(RAD * a), y + reach * Math.sin(RAD * a)],
    of: ([px, py], [x, y]) => within(Math.atan2(py - y, px - x) / RAD),
    isAngle: true,
  },
  spacing: {
    at: (s, [x, y], { angle }) => [x - s * Math.sin(RAD * angle), y + s * Math.cos(RAD * angle)],
    of: ([px, py], [x, y], { angle }) => Math.abs((py - y) * Math.cos(RAD * angle) - (px - x) * Math.sin(RAD * angle)),
  },
  length: { at: (l, [x, y], { out: [ox, oy] }) => [x + l * ox, y + l * oy], of: ([px, py], [x, y], { out: [ox, oy] }) => Math.max(0, (px - x) * ox + (py - y) * oy) },
  vector: {
    at: ([fx, fy], [x, y], { force }) => [x + fx / force, y + fy / force],
    of: ([px, py], [x, y], { force }) => [px - x, py - y].map((one) => Number((one * force).toPrecision(2))),
  },
  pressure: {
    at: (p, [x, y], { out: [ox, oy], pressure }) => [x + (ox * p) / pressure, y + (oy * p) / pressure],
    of: ([px, py], [x, y], { out: [ox, oy], pressure }) => Number((((px - x) * ox + (py - y) * oy) * pressure).toPrecision(2)),
  },
  along: {
    at: (s, [x, y], { out: [ox, oy] }) => [x - s * oy, y + s * ox],
    of: ([px, py], [x, y], { out: [ox, oy] }) => Math.abs((py - y) * ox - (px - x) * oy),
  },
  direction: {
    at: (a, [x, y], { reach }) => [x + reach * Math.cos(RAD * a), y + reach * Math.sin(RAD * a)],
    of: ([px, py], [x, y]) => (Math.atan2(py - y, px - x) / RAD + 360) % 360,
    isAngle: true,
  },
  level: { at: (y, _, { middle }) => [middle[0], y], of: ([, py]) => py },
  station: { at: (x, _, { middle }) => [x, middle[1]], of: ([px]) => px },
};

// --- outlines ------------------------------------------------------------------------------------

/** Corners of an opening that has a shape, as clast cuts it. */
function corners(value) {
  const { center, radius, width, wall_height: wall, corner, size, chords } = value;
  if (isPoint(corner) && isPoint(size)) return [[0, 0], [1, 0], [1, 1], [0, 1]].map(([i, j]) => [corner[0] + i * size[0], corner[1] + j * size[1]]);
  if (!isPoint(center)) return null;
  const [x, y] = center, turned = (r, angle) => [x + r * Math.cos(angle), y + r * Math.sin(angle)];
  if (radius > 0) { // the polygon has the area of the circle
    const n = chords ?? 32, part = (2 * Math.PI) / n, r = radius * Math.sqrt(part / Math.sin(part));
    return Array.from({ length: n }, (_, k) => turned(r, k * part));
  }
  if (!(width > 0)) return null;
  const n = chords ?? 16, half = width / 2, top = wall ?? 0, turn = Math.sin(Math.PI / n);
  const [a, b, c] = [0.5 * (n - 2) * turn, half * turn, -0.5 * Math.PI * half * half], r = a ? (Math.sqrt(b * b - 4 * a * c) - b) / (2 * a) : -c / b;
  const roof = Array.from({ length: n - 1 }, (_, k) => turned(r, ((k + 1) * Math.PI) / n)).map(([px, py]) => [px, py + top]);
  return [[x - half, y], [x + half, y], [x + half, y + top], ...roof, [x - half, y + top]];
}

/** Outline of an opening, a region or the domain by its name, counter-clockwise; null where there is none. */
export function outlineNamed(content, table, name) {
  const one = (content[table] ?? []).find?.((each) => each?.name === name);
  const points = one && (corners(one) ?? [one.points, one.polygon].find(isPoints));
  return points ? counterClockwise(points) : null;
}

/** The corners of an opening from one of them to another, counter-clockwise; null where there is none. */
export function partOf(content, name, [first, last]) {
  const outline = outlineNamed(content, "opening", name);
  if (!outline) return null;
  const [i, j] = [first, last].map((point) => outline.reduce((best, one, k) => (away(one, point) < away(outline[best], point) ? k : best), 0)), count = outline.length;
  return Array.from({ length: ((j - i + count) % count || count) + 1 }, (_, k) => outline[(i + k) % count]);
}

const areaOf = (points) => points.reduce((sum, [x, y], k) => sum + x * points[(k + 1) % points.length][1] - y * points[(k + 1) % points.length][0], 0) / 2;
const counterClockwise = (points) => (areaOf(points) < 0 ? [...points].reverse() : points);
const meanOf = (points) => [0, 1].map((k) => points.reduce((sum, point) => sum + point[k], 0) / points.length);

/** Sides of a line, closed or not, each as two points. */
export function sidesOf({ points, closed }) {
  return points.flatMap((point, k) => (k + 1 < points.length || (closed && k > 1) ? [[point, points[(k + 1) % points.length]]] : []));
}

/** Where a line first crosses itself; null where it does not. */
export function crossing(line) {
  const sides = sidesOf(line), last = sides.length - 1;
  for (let i = 0; i <= last; i++) for (let j = i + 2; j <= last; j++) {
    if (line.closed && i === 0 && j === last) continue;
    const [[ax, ay], [bx, by]] = sides[i], [[cx, cy], [dx, dy]] = sides[j], [ux, uy, vx, vy] = [bx - ax, by - ay, dx - cx, dy - cy];
    const of = ux * vy - uy * vx, s = ((cx - ax) * vy - (cy - ay) * vx) / of, t = ((cx - ax) * uy - (cy - ay) * ux) / of;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) return [ax + s * ux, ay + s * uy];
  }
  return null;
}

/** An edit that adds or removes an item of a list; of a profile of a rockfall its surface comes or goes with the point. */
export function withSurface({ rockfall: { profile, surface } = {} }, edit) {
  const { place: [table, key, i] } = edit, count = surface?.length;
  if (table !== "rockfall" || key !== "profile" || !(count > 1) || count !== profile.length - 1) return [edit];
  const isNew = edit.do === "insert", k = Math.min(i, isNew ? count : count - 1);
  return [edit, { do: edit.do, place: [table, "surface", k], toml: isNew ? toml(surface[Math.max(0, k - 1)]) : "" }];
}

// --- shapes --------------------------------------------------------------------------------------

/** Where a size or direction of a table begins, and what else its handle needs; null where it is nowhere. */
export function baseOf(content, node, value, name, seen) {
  const { geometry, from } = notesOf(node.properties[name]);
  const all = { ...seen, angle: typeof value.angle === "number" ? value.angle : 0 };
  if (!from) return { base: null, seen: all };
  if (AROUND.has(geometry)) {
    const outline = isPoints(value[from]) ? counterClockwise(value[from]) : outlineNamed(content, notesOf(node.properties[from]).refers_to?.[0], value[from]);
    if (!outline) return null;
    const angle = RAD * 0.5 * ((value.from ?? 0) + (value.to ?? 360)), out = [Math.cos(angle), Math.sin(angle)], c = meanOf(outline);
    return { base: geometry === "direction" ? c : reached(outline, c, out), seen: { ...all, out } };
  }
  const base = value[from] ?? (from === "origin" ? lowerLeft(content) : undefined);
  if (!isPoint(base)) return null;
  if (!isPoint(value.end)) return { base, seen: all };
  const [ux, uy] = [value.end[0] - base[0], value.end[1] - base[1]], length = Math.hypot(ux, uy) || 1, middle = middleOf(base, value.end);
  // a pressure comes from the side without a block
  const left = [-uy / length, ux / length], isHeld = all.holds?.([0, 1].map((k) => middle[k] + left[k] * 0.05 * length));
  return { base: middle, seen: { ...all, out: isHeld ? [-left[0], -left[1]] : left } };
}

const AROUND = new Set(["length", "along", "direction"]);
/** What is told of the outline of an opening. */

/** Where a ray from inside leaves an outline. */
function reached(outline, [x, y], [ox, oy]) {
  const found = sidesOf({ points: outline, closed: true }).map(([[ax, ay], [bx, by]]) => {
    const of = ox * (by - ay) - oy * (bx - ax), t = ((ax - x) * (by - ay) - (ay - y) * (bx - ax)) / of, s = ((ax - x) * oy - (ay - y) * ox) / of;
    return t > 0 && s >= 0 && s <= 1 ? t : Infinity;
  });
  const t = Math.min(...found);
  return Number.isFinite(t) ? [x + t * ox, y + t * oy] : [x, y];
}

/** Lower left of the domain, m; undefined where it has no outline. */
export function lowerLeft({ domain }) {
  const points = [domain?.boundary, domain?.profile].find(isPoints);
  return points && [0, 1].map((k) => Math.min(...points.map((point) => point[k])));
}

/**
 * A table in the section: `lines` of points, `dots`, `arrows`, and its handles. A handle has the place that
 * it is `at`, the `place` of its value in the file, and gives with `of` the values that a place of it means.
 */
export function shapeOf(content, node, value, place, seen) {
  const shape = { place, lines: [], dots: [], arrows: [], handles: [] };
  const given = drawnKeys(node).filter(([name]) => value[name] !== undefined);
  const add = (at, more) => shape.handles.push({ at, ...more });
  const ends = given.filter(([name, one]) => notesOf(one).geometry === "point" && node.required?.includes(name) && isPoint(value[name])).map(([name]) => name);
  if (ends.length === 2) shape.lines.push({ points: ends.map((name) => value[name]), closed: false });
  for (const [name, one] of given) {
    const { geometry } = notesOf(one), held = value[name], at = [...place, name], extent = EXTENTS[geometry];
    if (geometry === "point" && isPoint(held)) {
      if (ends.length !== 2) shape.dots.push(held);
      add(held, { place: at, what: name, of: (point) => [[at, point]] });
    } else if (extent && (typeof held === "number" || (isPoint(held) && geometry !== "pressure"))) {
      const from = baseOf(content, node, value, name, seen);
      if (!from) continue;
      const tip = extent.at(held, from.base, from.seen), ofExtent = (point) => [[at, extent.of(point, from.base, from.seen), extent]];
      for (const at of isPoint(value.end) ? [value.start, from.base, value.end] : [from.base]) {
        if (geometry === "vector") shape.arrows.push([at, extent.at(held, at, from.seen)]);
        if (geometry === "pressure") shape.arrows.push([extent.at(held, at, from.seen), at]);
      }
      add(tip, { place: at, what: name, of: ofExtent, from: from.base });
    } else if (geometry === "pressure" && isPoint(held) && isPoint(value.end)) {
      addVarying(shape, value, held, at, baseOf(content, node, value, name, seen).seen);
    } else if (isPoints(held)) addLine(shape, held, geometry === "polygon", at, one);
  }
  const round = corners(value), { wide } = seen;
  if (round) shape.lines.push({ points: round, closed: true });
  if (round && isPoint(value.brick)) shape.lines.push({ points: corners({ corner: value.corner, size: value.brick }), closed: true });
  for (const { what, at: [x, y] } of shape.handles.filter(({ from }) => from === null)) {
    const isLevel = notesOf(node.properties[what]).geometry === "level";
    shape.lines.push({ points: isLevel ? [[x - wide, y], [x + wide, y]] : [[x, y - wide], [x, y + wide]], closed: false, isEndless: true });
  }
  shape.lines.push(...parallels(content, node, value, seen));
  return shape;
}

/** A pressure that varies along its line: arrows as long as it is, and a handle for each end. */
function addVarying(shape, { start, end }, held, at, seen) {
  const { at: tail, of } = EXTENTS.pressure, along = ([a, b], share) => a + share * (b - a);
  const arrows = Array.from({ length: ARROWS + 1 }, (_, k) => k / ARROWS).map((share) => {
    const foot = [0, 1].map((k) => along([start[k], end[k]], share));
    return [tail(along(held, share), foot, seen), foot];
  });
  shape.arrows.push(...arrows);
  for (const [i, [from, foot]] of [arrows[0], arrows.at(-1)].entries()) shape.handles.push({ at: from, place: [...at, i], what: `value ${i + 1}`, from: foot, of: (point) => [[[...at, i], of(point, foot, seen)]] });
}

function addLine(shape, points, closed, at, one) {
  shape.lines.push({ points, closed });
  const isFixed = Boolean(one.prefixItems); // two ends, no more
  points.forEach((point, i) => shape.handles.push({ at: point, place: [...at, i], what: `point ${i + 1}`, item: isFixed ? null : i, least: closed ? 3 : 2, count: points.length, of: (to) => [[[...at, i], to]] }));
  if (isFixed) return;
  for (const [i, [a, b]] of sidesOf({ points, closed }).entries()) shape.handles.push({ at: middleOf(a, b), place: [...at, i + 1], what: "middle", isMiddle: true, side: [a, b] });
  const centre = meanOf(points);
  const all = ([x, y]) => points.map((point, i) => [[...at, i], [point[0] + x - centre[0], point[1] + y - centre[1]]]);
  shape.handles.push({ at: centre, place: at, what: "all", isWhole: true, of: all });
}

/** Lines of a joint set of one spacing, beside that through its origin. */
function parallels(content, node, value, seen) {
  if (notesOf(node.properties.angle ?? {}).geometry !== "angle" || typeof value.angle !== "number") return [];
  const from = baseOf(content, node, value, "angle", seen);
  if (!from) return [];
  const [ux, uy] = [Math.cos(RAD * value.angle), Math.sin(RAD * value.angle)].map((one) => one * seen.wide);
  const count = value.spacing > 0 && !isPoint(value.spacing) ? PARALLELS : 0;
  return Array.from({ length: 2 * count + 1 }, (_, k) => {
    const [x, y] = k === count ? from.base : EXTENTS.spacing.at((k - count) * value.spacing, from.base, from.seen);
    return { points: [[x - ux, y - uy], [x + ux, y + uy]], closed: false, isFaint: k !== count, isEndless: true };
  });
}

/** Every table of a case that is in the section, those within others too. */
export function shapesOf(schema, content, seen) {
  const found = [];
  const walk = (value, one, place) => {
    const forms = variants(schema, one);
    if (Array.isArray(value)) {
      const items = forms.find((form) => kindOf(form) === "list")?.items;
      if (items && isTable(value[0])) value.forEach((item, i) => walk(item, items, [...place, i]));
    } else if (isTable(value)) {
      const node = forms.find((form) => kindOf(form) === "table" && Object.keys(value).some((key) => key in form.properties));
      const map = forms.find((form) => kindOf(form) === "map");
      if (node && place.length && drawnKeys(node).some(([name]) => value[name] !== undefined)) found.push(shapeOf(content, node, value, place, seen));
      for (const [key, inner] of Object.entries(value)) {
        const below = node?.properties[key] ?? map?.additionalProperties;
        if (below && typeof inner === "object") walk(inner, below, [...place, key]);
      }
    }
  };
  walk(content, schema, []);
  return found;
}
