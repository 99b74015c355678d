/** Copies of tables: in rows, mirrored; their names are new, what they name stays, and what names the first one. */
import { drawnKeys, isPoint, isPoints, lowerLeft, notesOf, plain, tableNode } from "./handles.js";
import { isTable, keyText, numberFrom, toml } from "./values.js";
const { html, useState } = htmPreact;

const UNMIRRORED = ["velocity", "initial_stress", "edge_joint", "block_file", "file"];
/** Keys whose values would have to turn too, or which are told elsewhere. */
const TURNING = new Set(["motion", "link", "measured_reaction", "viscous_boundary", "flow_boundary"]);
/** Tables that say more of directions than their places. */
const CLIP = "application/x-clast-table";
/** Kind of what the clipboard has for windows. */
const clean = (x) => Number(plain(x));

/** A table with other places: `of` has what becomes of a point, a level and the like. */
function changed(node, value, of) {
  const parts = drawnKeys(node).flatMap(([name, one]) => {
    const { geometry } = notesOf(one), held = value[name];
    if (isPoints(held)) return [[name, of.line(held.map(of.point), name)]];
    if (geometry === "point") return isPoint(held) ? [[name, of.point(held)]] : [];
    return of[geometry] && (typeof held === "number" || isPoint(held)) ? [[name, of[geometry](held)]] : [];
  });
  return { ...value, ...Object.fromEntries(parts) };
}

/** A table moved by a distance, m. */
export function moved(content, node, value, [dx, dy]) {
  const held = withOrigin(content, node, value);
  return changed(node, held, { point: ([x, y]) => [clean(x + dx), clean(y + dy)], line: (points) => points, level: (y) => clean(y + dy), station: (x) => clean(x + dx) });
}

/** A joint set begins at the lower left of the domain where it does not say where. */
const withOrigin = (content, node, value) => (node.properties.angle && node.properties.origin && !value.origin && lowerLeft(content) ? { ...value, origin: lowerLeft(content) } : value);

/** A table mirrored at x = `at` for axis 0, at y = `at` for axis 1. */
export function mirrored(content, node, table, given, axis, at) {
  const flip = (point) => point.map((one, k) => (k === axis ? clean(2 * at - one) : one)), value = withOrigin(content, node, given);
  const only = (k) => (one) => (k === axis ? clean(2 * at - one) : one);
  const next = changed(node, value, {
    point: flip,
    // sides of lines, and their left and right, are told by their order; a train goes the other way
    line: (points, name) => (name === "path" ? points : points.reverse()),
    vector: (one) => one.map((x, k) => (k === axis ? clean(-x) : x)), angle: (one) => clean(-one), level: only(1), station: only(0),
  });
  if (isPoint(value.corner) && isPoint(value.size)) next.corner = flip(value.corner.map((x, k) => (k === axis ? x + value.size[k] : x)));
  if (node.properties.to && (value.from ?? value.to) !== undefined) {
    const { from = node.properties.from.default, to = node.properties.to.default } = value, turn = axis ? 360 : 180, first = (((turn - to) % 360) + 360) % 360;
    Object.assign(next, { from: clean(first), to: clean(first + to - from) });
  }
  if (typeof value.dip_direction === "number") next.dip_direction = clean((axis ? value.dip_direction + 180 : 2 * (content.domain?.section_azimuth ?? 0) + 540 - value.dip_direction) % 360);
  if (typeof value.inclination === "number" && !axis) next.inclination = clean(-value.inclination);
  if (table === "lining" && !isPoint(value.start)) Object.assign(next, { start: value.end, end: value.start });
  return next;
}

/** Why a table cannot be mirrored; "" where it can. */
function unmirrored(table, value, axis) {
  const key = UNMIRRORED.find((one) => one in value);
  if (TURNING.has(table)) return `[[${table}]] says more than places: change it in its form`;
  if (key) return `cannot be mirrored with ${key}: leave it out, or give the places here`;
  return value.width > 0 && axis ? "a horseshoe has its arch above: give the shape 'polygon' to turn it over" : "";
}

/** A name that no entry has: that of the first one with another number. */
export function nameLike(taken, name) {
  const word = name.replace(/ \d+$/, "");
  for (let n = 2; ; n++) if (!taken.has(`${word} ${n}`)) return `${word} ${n}`;
}

/** A value as TOML, numbers that are the file's own as they are written there. */
function written({ literals }, value, place) {
  const own = literals[JSON.stringify(place)];
  if (typeof value === "number") return own !== undefined && Number(own.replaceAll("_", "")) === value ? own : plain(value);
  if (Array.isArray(value)) return `[${value.map((one, i) => written({ literals }, one, [...place, i])).join(", ")}]`;
  if (!isTable(value)) return toml(value);
  return `{${Object.entries(value).filter(([, one]) => one !== undefined).map(([key, one]) => `${keyText(key)} = ${written({ literals }, one, [...place, key])}`).join(", ")}}`;
}

/** Edits that add entries from a number on: `made` has pairs of the number of the one that each is like, and its values. */
export function addition(ctx, table, made, first) {
  const taken = new Set(ctx.content[table].map((one) => one?.name));
  const edits = made.map(([from, value], k) => {
    const name = taken.has(value.name) && typeof value.name === "string" && nameLike(taken, value.name);
    taken.add(name || value.name);
    return { do: "insert", place: [table, first + k], toml: written(ctx, name ? { ...value, name } : value, [table, from]) };
  });
  return { place: [table, first], edits };
}

/** Put an entry on the clipboard: as a text for a text editor, and as it is for windows. */
export function copyTo(clipboard, state, [table, from]) {
  const value = state.content[table][from];
  clipboard.setData(CLIP, JSON.stringify({ table, from, value }));
  clipboard.setData("text/plain", [`[[${table}]]`, ...Object.keys(value).map((key) => `${keyText(key)} = ${written(state, value[key], [table, from, key])}`), ""].join("\n"));
}

/** Edits that add the entry of a clipboard, moved to where `to` says its point is to be; null where it holds none. */
export function pasted(clipboard, state, to) {
  const { table, from, value } = JSON.parse(clipboard.getData(CLIP) || "{}"), { schema, content } = state, node = schema.properties[table] && tableNode(schema, schema.properties[table]);
  if (!node || !(Array.isArray(content[table] ?? []))) return null;
  const held = content[table] ?? [], by = to(node, value);
  return addition({ ...state, content: { ...content, [table]: held } }, table, [[from, by ? moved(content, node, value, by) : value]], held.length);
}

/** Edits that change an entry where it stands. */
const alteration = (place, old, next) => [...new Set([...Object.keys(old), ...Object.keys(next)])].filter((key) => JSON.stringify(old[key]) !== JSON.stringify(next[key]))
  .map((key) => ({ place: [...place, key], ...(next[key] === undefined ? { do: "remove" } : { do: "set", toml: toml(next[key]) }) }));

/** Offer copies of an entry, or of all of a table. */
export function Copies({ ctx, table, entry, node }) {
  const [form, setForm] = useState({ count: "1", x: "", y: "", axis: 0, at: "" }), [said, say] = useState("");
  const put = (more) => { say(""); setForm({ ...form, ...more }); }, { content, hand, choose, pick } = ctx;
  const behind = entry === undefined ? content[table].length : entry + 1, numbers = entry === undefined ? content[table].map((_, k) => k) : [entry], metres = (text) => (text.trim() ? Number(numberFrom(text, "m") ?? NaN) : NaN);
  const field = (name, label, size = 5) => html`<label>${label} <input type="text" inputmode="decimal" style=${{ width: `${size}rem` }} value=${form[name]} onInput=${(e) => put({ [name]: e.target.value })} /></label>`;
  const send = async ({ place, edits }) => { if (await hand.edit(edits)) choose(entry === undefined ? [table] : place); };
  const row = () => {
    const count = Number(form.count), by = [form.x || "0", form.y || "0"].map(metres);
    if (!Number.isInteger(count) || count < 1 || count > 1000) return say("give a whole number of copies, from 1 to 1000");
    if (!by.every(Number.isFinite) || !by.some(Boolean)) return say("give a distance, m, in x or in y");
    const made = Array.from({ length: count }, (_, n) => numbers.map((k) => [k, moved(content, node, content[table][k], by.map((one) => (n + 1) * one))])).flat();
    if (made.some(([k, value]) => JSON.stringify(value) === JSON.stringify(content[table][k]))) return say("has no place of its own to be moved");
    return send(addition(ctx, table, made, behind));
  };
  const mirror = (isCopy) => {
    const at = metres(form.at), axis = Number(form.axis), refused = numbers.map((k) => unmirrored(table, content[table][k], axis)).find(Boolean);
    if (refused || !Number.isFinite(at)) return say(refused || "give the axis, m");
    const made = numbers.map((k) => [k, mirrored(content, node, table, content[table][k], axis, at)]);
    if (isCopy) return send(addition(ctx, table, made, behind));
    return send({ place: [table, entry], edits: made.flatMap(([k, value]) => alteration([table, k], content[table][k], value)) });
  };
  const clicked = (words, then) => pick(words, (points) => put(then(points)));
  return html`<details class="copies"><summary>Copies</summary>
    <p class="row">${field("count", "copies", 3)}${field("x", "each moved by x", 4)}${field("y", "y", 4)} m
      <button onClick=${() => clicked(["copies: from a point", "copies: to a point"], ([[ax, ay], [bx, by]]) => ({ x: plain(bx - ax), y: plain(by - ay) }))}>by two clicks</button> <button onClick=${row}>copy</button></p>
    <p class="row"><label>mirror at <select value=${form.axis} onChange=${(e) => put({ axis: e.target.value })}><option value="0">x =</option><option value="1">y =</option></select></label>
      ${field("at", html`<span class="unseen">Axis</span>`, 4)} m <button onClick=${() => clicked(["mirror: a point of the axis"], ([point]) => ({ at: plain(point[form.axis]) }))}>by a click</button>
      <button onClick=${() => mirror(true)}>copy mirrored</button> <button onClick=${() => mirror(false)}>mirror</button></p><p class="fault" role="alert">${said}</p></details>`;
}
