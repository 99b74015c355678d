// Joints that are clicked: contacts, and edges that have parted; found in any frame by their names.
//
// A contact is told by its vertex and the block that the vertex enters, as in the run's own memory, one
// of the points inside a face also by its place on the edge that begins at the vertex; a joint without
// contacts by the edge along it.

import { stressesOfFace } from "./contact_faces.js";

const APART = 0.03;
/** Points of a face that are further apart, as a share of the edge, are not the same. */

const CLEARLY = 0.2;
/** How much nearer than contacts an edge must be to be meant, as a share of the reach of a click. */

/**
 * Return the joint nearest to a point of a frame, null where none is near.
 * @param {import("./data.js").RunData} run
 * @param {number} frame @param {number} x m @param {number} y m
 * @param {number} reach how far it may be, m
 * @returns {{vertex: number, by: number, along: number} | {edge: number} | null}
 */
export function jointAt(run, frame, x, y, reach) {
  const { contacts } = run;
  const faces = new Map();
  for (let k = contacts.first[frame]; k < contacts.first[frame + 1]; k++) {
    const pair = [contacts.on[k], contacts.by[k]].sort((a, b) => a - b).join();
    if (!faces.has(pair)) faces.set(pair, []);
    faces.get(pair).push(k);
  }
  let [nearest, found] = [reach, null];
  for (const own of faces.values()) {
    // between the contacts of two blocks the joint is theirs: the nearer of them is meant
    for (const one of own) {
      for (const other of own) {
        const ends = [contacts.x[one], contacts.y[one], contacts.x[other], contacts.y[other]];
        const away = distance(x, y, ends);
        if (away >= nearest) continue;
        const toOne = Math.hypot(x - ends[0], y - ends[1]);
        const chosen = toOne <= Math.hypot(x - ends[2], y - ends[3]) ? one : other;
        [nearest, found] = [away, { vertex: contacts.vertex[chosen], by: contacts.by[chosen], row: chosen }];
      }
    }
  }
  const { opening } = run.faces;
  for (let k = opening?.first[frame]; k < opening?.first[frame + 1]; k++) {
    const away = distance(x, y, [opening.x0[k], opening.y0[k], opening.x1[k], opening.y1[k]]);
    // a joint that carries is told by its contacts, which lie beside it by as much as they close
    if (away + CLEARLY * reach < nearest) [nearest, found] = [away, { edge: opening.edge[k] }];
  }
  if (!found || "edge" in found) return found;
  return { vertex: found.vertex, by: found.by, along: alongOf(run, frame, found.row) };
}

/** Return the place of a contact on the edge that begins at its vertex, as a share of its length. */
function alongOf(run, frame, row) {
  const { contacts } = run;
  const vertex = contacts.vertex[row];
  const block = contacts.on[row];
  const next = vertex + 1 < run.blockStart[block + 1] ? vertex + 1 : run.blockStart[block];
  const [[x0, y0], [x1, y1]] = [run.vertex(frame, block, vertex), run.vertex(frame, block, next)];
  return Math.hypot(contacts.x[row] - x0, contacts.y[row] - y0) / Math.max(1e-12, Math.hypot(x1 - x0, y1 - y0));
}

/** Return the distance of a point from a line x0, y0, x1, y1. */
function distance(x, y, [x0, y0, x1, y1]) {
  const [dx, dy] = [x1 - x0, y1 - y0];
  const square = dx * dx + dy * dy;
  const along = square ? Math.max(0, Math.min(1, ((x - x0) * dx + (y - y0) * dy) / square)) : 0;
  return Math.hypot(x - x0 - along * dx, y - y0 - along * dy);
}

/** Return the row of a joint in a frame, of the contacts or of the openings; -1 where it has none. */
export function rowOf(run, joint, frame) {
  const isContact = "vertex" in joint;
  const table = isContact ? run.contacts : run.faces.opening;
  const found = [];
  for (let k = table?.first[frame]; k < table?.first[frame + 1]; k++) {
    if (isContact ? table.vertex[k] === joint.vertex && table.by[k] === joint.by : table.edge[k] === joint.edge) {
      found.push(k);
    }
  }
  if (!isContact) return found[0] ?? -1;
  const away = found.map((k) => Math.abs(alongOf(run, frame, k) - joint.along));
  const nearest = away.indexOf(Math.min(...away));
  // corners have no points near them
  const apart = joint.along < APART ? 2 * APART : APART;
  return nearest >= 0 && away[nearest] < apart ? found[nearest] : -1;
}

/** Return where a joint is in a frame, m; null where it is not. */
export function placeOf(run, joint, frame) {
  const k = rowOf(run, joint, frame);
  if (k < 0) return null;
  if ("vertex" in joint) return [run.contacts.x[k], run.contacts.y[k]];
  const { x0, y0, x1, y1 } = run.faces.opening;
  return [0.5 * (x0[k] + x1[k]), 0.5 * (y0[k] + y1[k])];
}

/** Return the two blocks of a joint; the second is -1 where it is not known. */
export function blocksOf(run, joint) {
  const blockOf = (vertex) => run.blockStart.findIndex((first) => first > vertex) - 1;
  if ("vertex" in joint) return [blockOf(joint.vertex), joint.by];
  const block = blockOf(joint.edge);
  const next = joint.edge + 1 < run.blockStart[block + 1] ? joint.edge + 1 : run.blockStart[block];
  const [x0, y0, x1, y1] = [joint.edge, next].flatMap((v) => [run.start[2 * v], run.start[2 * v + 1]]);
  // a little to the right of the edge, at the start
  const [x, y] = [0.5 * (x0 + x1) + 1e-3 * (y1 - y0), 0.5 * (y0 + y1) - 1e-3 * (x1 - x0)];
  // linings that come later lie in the rock until then
  const isOther = (one) => run.isAwaited(0, one) !== run.isAwaited(0, block);
  return [block, run.blockOfOutline(run.start, x, y, isOther)];
}

/** Return the name of the joint set or the joint, "" where it has none of its own. */
export function nameOf(run, joint) {
  const { joints } = run.scene;
  if (!("vertex" in joint)) return joints[run.edgeJoint[joint.edge]] ?? "";
  const k = run.contacts.vertex.findIndex((one, row) => one === joint.vertex && run.contacts.by[row] === joint.by);
  return joints[run.contacts.joint[k]] ?? "";
}

const MODES = ["open", "slides", "locked"];
const UNKNOWN = 45;
/** Error of an angle of friction from which on nothing is known of it, degrees. */

/** Return what is said of a joint in a frame: pairs of name and value, with the unit of values. */
export function valuesOf(run, joint, frame) {
  const k = rowOf(run, joint, frame);
  if (!("vertex" in joint)) return k < 0 ? [] : [["Opening", run.faces.opening.value[k], "m"]];
  if (k < 0) return [];
  const { normal, shear, slip, opening, mode } = run.contacts;
  const half = (values) => 0.5 * values.step;
  const angle = (180 / Math.PI) * Math.atan2(Math.abs(shear[k]), normal[k]);
  const share = run.contacts.error / Math.hypot(normal[k], shear[k]);
  const off = share < 1 ? (180 / Math.PI) * Math.asin(share) : 90;
  return [
    ["State", MODES[mode[k]] ?? "", ""],
    ["Normal force", normal[k], "N/m", half(normal)],
    ["Shear force", shear[k], "N/m", half(shear)],
    ["Mobilised friction", normal[k] > half(normal) && off < UNKNOWN ? angle : NaN, "°", off],
    ["Slip", slip[k], "m", half(slip)],
    ["Opening", opening[k], "m", half(opening)],
    ...stressesOfFace(run, frame, k),
  ];
}

/** Return the curves of a joint over the frames, with gaps where it carries nothing. */
export function curvesOfJoint(run, joint) {
  const rows = run.times.map((_, frame) => rowOf(run, joint, frame));
  const line = (name, values) => ({ name, values: rows.map((k) => (k < 0 ? null : values[k])), error: 0.5 * (values.step ?? 0) });
  const curve = (name, unit, ...lines) => ({ name, unit, time: run.times, lines });
  if (!("vertex" in joint)) return [curve("Joint, opening", "m", line("opening", run.faces.opening.value))];
  const { normal, shear, slip, opening } = run.contacts;
  return [
    curve("Joint, slip", "m", line("slip", slip)),
    curve("Joint, forces", "N/m", line("normal", normal), line("shear", shear)),
    curve("Joint, opening", "m", line("opening", opening)),
  ];
}
