/** What can be drawn: tables of the schema, and the points that each is made of. */
import { blank, kindOf, tablesOf, toml, variants } from "./values.js";
import { EXTENTS, baseOf, drawnKeys, notesOf, outlineNamed, plain, sidesOf, tableNode } from "./handles.js";
import { rounded } from "./snaps.js";

/** Tools by their keys, with the tables that they make; the last has all other tables of the section. */
const TOOLS = [
  ["1", "select", []],
  ["2", "outline", ["domain.boundary", "region.polygon", "block.vertices", "domain.profile", "rockfall.profile"]],
  ["3", "trace", ["trace.points"]],
  ["4", "joint set", ["joint_set.origin.angle.spacing"]],
  ["5", "opening", ["opening"]],
  ["6", "bolt", ["bolt", "bolt_pattern.opening.length.spacing"]],
  ["7", "lining", ["lining.opening.part", "lining.polyline"]],
  ["8", "water", ["water"]],
  ["9", "load", ["point_load", "line_load", "pressure", "fill", "load_train"]],
  ["0", "support", ["fixed_point", "domain.fixed_sides"]],
  [".", "more", null],
];
/** What the drawing cannot know of a table that it makes; the form changes it. */
const GIVEN = {
  lining: { thickness: 0.2, segment: 1, young: 2e10 }, fill: { density: 2000 }, load_train: { position: 0, axles: [0], loads: [1e5] },
  source: { rocks: 100, volume: 0.5 }, barrier: { height: 3 },
};
/** Tables of which a new entry is like the last one. */
const ALIKE = new Set(["bolt", "bolt_pattern", "lining", "trace", "point_load", "line_load", "pressure", "block", "source", "barrier"]);

/** The tools of a schema: key, name, and their choices, each with `table`, `kind`, `node`, `fixed`, `steps`, `label`. */
export function toolsOf(schema) {
  const named = new Set(TOOLS.flatMap(([, , makes]) => (makes ?? []).map((one) => one.split(".")[0])));
  const others = Object.entries(schema.properties).filter(([name, one]) => !named.has(name) && drawnKeys(tableNode(schema, one)).length).map(([name]) => name);
  others.sort((a, b) => Number(b.startsWith("measured")) - Number(a.startsWith("measured")));
  return TOOLS.map(([key, name, makes]) => ({ key, name, choices: (makes ?? others).flatMap((one) => choicesOf(schema, one)) }));
}

function choicesOf(schema, text) {
  const [table, ...keys] = text.split("."), one = schema.properties[table], node = tableNode(schema, one), words = table.replaceAll("_", " ");
  const choice = (chosen, fixed, label) => ({ table, kind: tablesOf(schema, one), node, fixed, label, steps: stepsOf(schema, node, chosen) });
  if (keys.length) return [choice(keys, {}, keys.length > 1 && !keys.includes("part") ? words : `${words}: ${keys[0].replaceAll("_", " ")}`)];
  const drawn = drawnKeys(node).map(([name]) => name), note = (name) => notesOf(node.properties[name]);
  // a key such as shape, which chooses among several that are drawn
  const bys = drawn.flatMap((name) => Object.keys(note(name).when ?? {}));
  const by = bys.find((one, i) => bys.indexOf(one) !== i && kindOf(variants(schema, node.properties[one])[0]) === "choice");
  if (by) return variants(schema, node.properties[by])[0].enum.map((value) => choice(drawn.filter((name) => note(name).when?.[by]?.includes(value)), { [by]: value }, `${words}: ${value}`));
  const needed = drawn.filter((name) => node.required?.includes(name)), either = (notesOf(node).one_of ?? []).flat().filter((name) => drawn.includes(name));
  if (either.length) return either.map((name) => choice([name, ...needed], {}, either.length > 1 ? `${words}: ${name.replaceAll("_", " ")}` : words));
  return [choice(needed.length ? needed : drawn, {}, words)];
}

function stepsOf(schema, node, keys) {
  const steps = keys.map((key) => {
    const one = node.properties[key], { geometry, refers_to: [named] = [] } = notesOf(one), sides = variants(schema, variants(schema, one)[0].items ?? {})[0];
    if (named === "opening") return { key, one, kind: "pick", named, words: "click an opening" };
    if (EXTENTS[geometry]) return { key, one, kind: "extent", geometry, words: `${key.replaceAll("_", " ")}: click or type a number` };
    if (geometry === "point") return { key, one, kind: "point", words: `${key}: click or type x, y` };
    if (one.prefixItems) return { key, one, kind: "ends", words: `${key}: two points` };
    if (geometry) return { key, one, kind: "line", least: geometry === "polygon" ? 3 : 2, isClosed: geometry === "polygon", words: `${key}: click points; Enter ends` };
    return { key, one, kind: "side", sides: sides.enum, words: "click beside a side: held, or free again" };
  });
  // beside an opening, two points are the ends of some of its sides
  return steps.map((step, i) => (step.kind === "ends" && steps[i - 1]?.kind === "pick" ? { ...step, kind: "edges", words: "first and last side, counter-clockwise; Enter: all" } : step));
}

/**
 * The values that clicks have given so far, the step that goes on, null at the end, and its points.
 * A click has `at`, m, or a `number`, or `ends` a line.
 */
export function taken(content, { node, fixed, steps }, clicks, seen) {
  const values = { ...fixed };
  let k = 0;
  for (const step of steps) {
    const most = { line: Infinity, ends: 2, edges: 2 }[step.kind] ?? 1, points = [];
    while (points.length < most && k < clicks.length && !clicks[k].ends) points.push(clicks[k++]);
    const isEnded = clicks[k]?.ends && points.length < most;
    if (isEnded) k += 1;
    const value = WAYS[step.kind](step, points, { content, node, values, seen });
    if (value !== undefined) values[step.key] = value;
    if (!isEnded && points.length < most) return { values, step, points: points.map(({ at }) => at).filter(Boolean) };
  }
  return { values: upright(values), step: null, points: [] };
}

const WAYS = {
  point: (_, [point]) => point?.at,
  line: (_, points) => (points.length ? points.map(({ at }) => at) : undefined),
  ends: (_, points) => (points.length ? points.map(({ at }) => at) : undefined),
  pick: ({ named }, [point], { content }) => point && openingAt(content, named, point.at)?.name,
  extent: (step, [point], { content, node, values, seen }) => {
    if (!point) return undefined;
    const from = baseOf(content, node, values, step.key, seen);
    if (!from) return undefined;
    if (point.number !== undefined) return point.number;
    if (step.geometry === "vector" && point.snap === "typed") return point.at; // a force is typed as it is
    if (["vector", "pressure"].includes(step.geometry)) return EXTENTS[step.geometry].of(point.at, from.base, from.seen);
    return roundedExtent(EXTENTS[step.geometry], EXTENTS[step.geometry].of(point.at, from.base, from.seen), point.snap ? seen.digits + 3 : seen.digits);
  },
  edges: (_, [first, last], { content, values }) => {
    const outline = outlineNamed(content, "opening", values.opening);
    if (!outline || !first) return undefined;
    const of = (point) => sideAt(outline, point.at);
    return [of(first)[0], of(last ?? first)[1]];
  },
  side: ({ sides, key }, [point], { content, values }) => {
    const held = content.domain?.[key] ?? [], side = point && sideOf(content, point.at);
    return !side || !sides.includes(side) ? values[key] : sides.filter((one) => held.includes(one) !== (one === side));
  },
};

/** A size or direction without digits that nobody meant. */
export const roundedExtent = ({ isAngle }, value, digits) => (Array.isArray(value) ? value.map((x) => rounded(x, digits)) : rounded(value, isAngle ? Math.min(digits + 1, 4) : digits));

function sideAt(outline, [x, y]) {
  const far = ([a, b]) => Math.hypot(a[0] - x, a[1] - y) + Math.hypot(b[0] - x, b[1] - y) - Math.hypot(a[0] - b[0], a[1] - b[1]);
  return sidesOf({ points: outline, closed: true }).reduce((best, side) => (far(side) < far(best) ? side : best));
}

/** The opening whose outline is nearest to a point. */
function openingAt(content, table, at) {
  const far = (outline) => Math.min(...outline.map(([x, y]) => Math.hypot(x - at[0], y - at[1])), Math.hypot(...[0, 1].map((k) => at[k] - outline.reduce((sum, one) => sum + one[k], 0) / outline.length)));
  const some = (content[table] ?? []).map((one) => [one, outlineNamed(content, table, one?.name)]).filter(([, outline]) => outline);
  return some.sort(([, a], [, b]) => far(a) - far(b))[0]?.[0];
}

/** Side of the smallest rectangle about the domain that is nearest to a point. */
function sideOf({ domain }, [x, y]) {
  const points = [domain?.boundary, domain?.profile].find((one) => Array.isArray(one) && one.length);
  if (!points) return null;
  const [xs, ys] = [0, 1].map((k) => points.map((point) => point[k]));
  const far = { left: Math.abs(x - Math.min(...xs)), right: Math.abs(x - Math.max(...xs)), bottom: Math.abs(y - Math.min(...ys)), top: Math.abs(y - Math.max(...ys)) };
  return Object.keys(far).sort((a, b) => far[a] - far[b])[0];
}

/** Boxes that were drawn from another corner than the lower left. */
function upright(values) {
  const { corner, size } = values;
  if (!corner || !Array.isArray(size)) return values;
  return { ...values, corner: corner.map((x, k) => Number(plain(Math.min(x, x + size[k])))), size: size.map(Math.abs) };
}

/** The edits that write what was drawn, and the place of its table. */
export function editsOf({ schema, content }, { table, kind, node, fixed, steps }, values) {
  const keys = steps.map(({ key }) => key);
  if (kind === "one" && content[table]) {
    const others = (notesOf(node).one_of ?? []).filter((group) => group.some((key) => keys.includes(key))).flat().filter((key) => !keys.includes(key) && key in content[table]);
    const tied = others.includes("profile") ? ["depth", "sides"].filter((key) => key in content[table]) : [];
    return { place: [table], edits: [...[...others, ...tied].map((key) => ({ do: "remove", place: [table, key] })), ...Object.keys(values).map((key) => ({ do: "set", place: [table, key], toml: toml(values[key]) }))] };
  }
  const held = content[table] ?? [], last = ALIKE.has(table) && !held.at?.(-1)?.file ? held.at?.(-1) ?? {} : {};
  const drawn = new Set([...drawnKeys(node).map(([key]) => key), ...(notesOf(node).one_of ?? []).flat(), "name"]);
  const like = Object.fromEntries(Object.entries(last).filter(([key]) => !drawn.has(key)));
  const nameOf = (one) => [notesOf(one).refers_to ?? []].flat().flatMap((name) => (Array.isArray(content[name]) ? content[name].map((each) => each?.name) : Object.keys(content[name] ?? {})))[0];
  const all = { ...blank(schema, node, nameOf), ...GIVEN[table], ...like, ...fixed, ...values };
  if (node.required?.includes("name")) all.name = freeName(held, table.replaceAll("_", " "));
  const ours = { ...GIVEN[table], ...values }, text = (key) => (key in ours && !(key in like) ? numbersShort(ours[key]) : toml(all[key]));
  const written = `{${Object.keys(node.properties).filter((key) => all[key] !== undefined).map((key) => `${key} = ${text(key)}`).join(", ")}}`;
  return kind === "one" ? { place: [table], edits: [{ do: "set", place: [table], toml: written }] }
    : { place: [table, held.length ?? 0], edits: [{ do: "insert", place: [table, held.length ?? 0], toml: written }] };
}

/** A value of numbers as TOML, long ones with a power of ten. */
const numbersShort = (value) => (typeof value === "string" ? toml(value) : toml(value).replace(/\d{4,}0{3,}(?![\d.])/g, (digits) => Number(digits).toExponential().replace("+", "")));

function freeName(held, word) {
  const names = new Set(held.map?.((one) => one?.name));
  for (let n = 1; ; n++) if (!names.has(`${word} ${n}`)) return `${word} ${n}`;
}
