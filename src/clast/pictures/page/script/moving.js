// What changes from frame to frame, decoded; frames that a run has made since are put behind.

import { rawArray, unpacked } from "./packing.js";

const OF_CONTACTS = ["x", "y", "angle", "normal", "shear", "strength", "slip", "opening"];
const NAMES = ["vertex", "by", "mode", "joint"];
const OF_SUPPORTS = {
  links: ["x0", "y0", "x1", "y1", "alongX", "alongY"],
  reactions: ["x", "y", "fx", "fy"],
  linings: ["normal_force", "shear_force", "moment"],
};
const ENDS = ["x0", "y0", "x1", "y1"];
/** Fields that are those of the motion where they are not given. */
const OF_MOTION = { displacement_x: "x", displacement_y: "y", rotation: "angle" };

/**
 * Decode some frames: see frame_data.py.
 * @param {any} part what ``moving`` made @param {Int32Array} blockStart of the run
 */
export async function decodeMoving(part, blockStart) {
  const wide = blockStart.length - 1;
  const { times, stages, gone, points, levels, flows } = part;
  const found = { times, stages, gone, points, levels, flows };
  for (const kind of ["motion", "fields"]) {
    found[kind] = {};
    for (const [name, table] of Object.entries(part[kind])) found[kind][name] = await unpacked(table, wide);
  }
  for (const [field, name] of Object.entries(OF_MOTION)) found.fields[field] ??= found.motion[name];
  found.contacts = counted(part.contacts);
  const rows = Math.max(1, part.contacts.shown);
  for (const name of OF_CONTACTS) found.contacts[name] = await unpacked(part.contacts[name], rows);
  for (const name of NAMES) found.contacts[name] = await rawArray(part.contacts[name], Int32Array);
  giveForces(found.contacts, blockStart);
  found.faces = {};
  for (const [name, table] of Object.entries(part.faces)) {
    const faces = counted(table);
    for (const end of ENDS) faces[end] = await unpacked(table[end], Math.max(1, table.shown));
    faces.value = await rawArray(table.value, Float32Array);
    faces.edge = await rawArray(table.edge, Int32Array);
    if (table.width) faces.width = await rawArray(table.width, Float32Array);
    found.faces[name] = faces;
  }
  if (part.bolts) {
    found.bolts = { bolt: part.bolts.bolt, names: part.bolts.names };
    for (const name of ["x", "y", "force"]) found.bolts[name] = await rawArray(part.bolts[name], Float32Array);
    found.bolts.state = await rawArray(part.bolts.state, Int32Array);
  }
  for (const [kind, names] of Object.entries(OF_SUPPORTS)) {
    const given = part[kind];
    if (!given) continue;
    found[kind] = given.names ? { names: given.names } : {};
    for (const name of names) found[kind][name] = await rawArray(given[name], Float32Array);
    if (kind === "links") found.links.state = await rawArray(given.state, Int32Array);
  }
  return withTotals(found);
}

/** Work out the force on the vertex of each contact, and the block of the vertex. */
function giveForces(contacts, blockStart) {
  const { angle, normal, shear, vertex } = contacts;
  const blockOf = new Int32Array(blockStart[blockStart.length - 1]);
  for (let block = 0; block + 1 < blockStart.length; block++) {
    blockOf.fill(block, blockStart[block], blockStart[block + 1]);
  }
  contacts.fx = new Float32Array(angle.length);
  contacts.fy = new Float32Array(angle.length);
  contacts.on = vertex.map((one) => blockOf[one]);
  for (let k = 0; k < angle.length; k++) {
    const [cosine, sine] = [Math.cos(angle[k]), Math.sin(angle[k])];
    contacts.fx[k] = normal[k] * cosine - shear[k] * sine;
    contacts.fy[k] = normal[k] * sine + shear[k] * cosine;
  }
}

function counted({ shown, of, count }) {
  return { shown, of, count };
}

/** Work out where each frame begins, the largest force, and how far forces may be off. */
function withTotals(found) {
  for (const table of [found.contacts, ...Object.values(found.faces)]) {
    table.first = new Int32Array(table.count.length + 1);
    table.count.forEach((count, k) => {
      table.first[k + 1] = table.first[k] + count;
    });
  }
  const { contacts } = found;
  contacts.error = 0.5 * Math.hypot(contacts.normal.step, contacts.shear.step);
  contacts.largest = 0;
  for (let k = 0; k < contacts.fx.length; k++) {
    contacts.largest = Math.max(contacts.largest, Math.hypot(contacts.fx[k], contacts.fy[k]));
  }
  return found;
}

/**
 * Return frames with those that have come since behind them.
 * @param {any} before @param {any} more both from ``decodeMoving`` @param {number} wide blocks
 */
export function joined(before, more, wide) {
  const frames = before.times.length;
  turnOn(before.motion.angle, more.motion.angle, wide);
  const found = {
    times: [...before.times, ...more.times],
    stages: [...before.stages, ...more.stages],
    levels: [...before.levels, ...more.levels],
    flows: [...before.flows, ...more.flows],
    gone: before.gone.map((changes, block) => changesJoined(changes, more.gone[block], frames)),
    motion: eachJoined(before.motion, more.motion),
    fields: eachJoined(before.fields, more.fields),
    contacts: rowsJoined(before.contacts, more.contacts),
    faces: {},
    points: before.points.map((point, k) => ({
      name: point.name,
      x: [...point.x, ...more.points[k].x],
      y: [...point.y, ...more.points[k].y],
    })),
  };
  for (const name of Object.keys({ ...before.faces, ...more.faces })) {
    const [first, second] = [before.faces[name] ?? noFaces(frames), more.faces[name] ?? noFaces(more.times.length)];
    found.faces[name] = rowsJoined(first, second);
  }
  for (const kind of ["bolts", ...Object.keys(OF_SUPPORTS)]) {
    if (before[kind]) found[kind] = { ...before[kind], ...eachJoined(before[kind], more[kind]) };
  }
  return withTotals(found);
}

/** Return when a block goes and comes: ``more`` is told as if it had been there before its first frame. */
function changesJoined(before, more, frames) {
  const behind = more.map((frame) => frames + frame);
  if (before.length % 2 === 0) return [...before, ...behind];
  return behind[0] === frames ? [...before, ...behind.slice(1)] : [...before, frames, ...behind];
}

/** Return the faces of frames that have none of a field. */
function noFaces(frames) {
  const numbers = Object.fromEntries([...ENDS, "value"].map((name) => [name, new Float32Array(0)]));
  return { shown: 0, of: 0, count: new Array(frames).fill(0), edge: new Int32Array(0), ...numbers };
}

/** Let rotations go on from the last frame: each part counts its turns anew. */
function turnOn(before, more, wide) {
  const last = before.length - wide;
  for (let block = 0; block < wide; block++) {
    const turns = 2 * Math.PI * Math.round((before[last + block] - more[block]) / (2 * Math.PI));
    if (turns) for (let at = block; at < more.length; at += wide) more[at] += turns;
  }
}

function rowsJoined(before, more) {
  const told = {
    shown: before.shown + more.shown,
    of: before.of + more.of,
    count: [...before.count, ...more.count],
  };
  return { ...eachJoined(before, more), ...told };
}

function eachJoined(before, more) {
  const found = {};
  for (const [name, values] of Object.entries(before)) {
    if (!ArrayBuffer.isView(values) || !(name in more)) continue;
    found[name] = new values.constructor(values.length + more[name].length);
    found[name].set(values);
    found[name].set(more[name], values.length);
    found[name].step = Math.max(values.step ?? 0, more[name].step ?? 0);
  }
  return found;
}
