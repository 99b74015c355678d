// What changes from frame to frame, decoded; frames that a run has made since are put behind.

import { rawArray, unpacked } from "./packing.js";

const FORCES = ["x", "y", "fx", "fy"];
const NUMBERS = ["on", "by", "mode"];
const ENDS = ["x0", "y0", "x1", "y1"];

/**
 * Decode some frames: see frame_data.py.
 * @param {any} part what ``moving`` made @param {number} wide blocks
 */
export async function decodeMoving(part, wide) {
  const found = { times: part.times, stages: part.stages, gone: part.gone, points: part.points };
  for (const kind of ["motion", "fields"]) {
    found[kind] = {};
    for (const [name, table] of Object.entries(part[kind])) found[kind][name] = await unpacked(table, wide);
  }
  found.contacts = counted(part.contacts);
  for (const name of FORCES) found.contacts[name] = await rawArray(part.contacts[name], Float32Array);
  for (const name of NUMBERS) found.contacts[name] = await rawArray(part.contacts[name], Int32Array);
  found.faces = {};
  for (const [name, table] of Object.entries(part.faces)) {
    const faces = counted(table);
    for (const end of ENDS) faces[end] = await unpacked(table[end], Math.max(1, table.shown));
    faces.value = await rawArray(table.value, Float32Array);
    found.faces[name] = faces;
  }
  if (part.bolts) {
    found.bolts = { bolt: part.bolts.bolt, names: part.bolts.names };
    for (const name of ["x", "y", "force"]) found.bolts[name] = await rawArray(part.bolts[name], Float32Array);
    found.bolts.state = await rawArray(part.bolts.state, Int32Array);
  }
  return withTotals(found);
}

function counted({ shown, of, count }) {
  return { shown, of, count };
}

/** Work out where each frame begins, and the largest force. */
function withTotals(found) {
  for (const table of [found.contacts, ...Object.values(found.faces)]) {
    table.first = new Int32Array(table.count.length + 1);
    table.count.forEach((count, k) => {
      table.first[k + 1] = table.first[k] + count;
    });
  }
  const { contacts } = found;
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
    gone: before.gone.map((frame, block) => (frame < frames ? frame : frames + more.gone[block])),
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
  for (const name of Object.keys(before.faces)) {
    found.faces[name] = rowsJoined(before.faces[name], more.faces[name]);
  }
  if (before.bolts) found.bolts = { ...before.bolts, ...eachJoined(before.bolts, more.bolts) };
  return withTotals(found);
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
  }
  return found;
}
