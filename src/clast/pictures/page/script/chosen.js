// What is chosen by a click, a block or a joint: its numbers, its curves, where it is.

import { labelOf } from "./colouring.js";
import { withUnit } from "./colours.js";
import { blocksOf, curvesOfJoint, nameOf, placeOf, valuesOf } from "./joints.js";

const OF_BLOCK = [
  "displacement", "velocity", "rotation", "sigma_xx", "sigma_yy", "sigma_xy", "sigma_1", "sigma_3",
];

/** Return whether anything is chosen. */
export function isChosen({ chosen, joint }) {
  return chosen >= 0 || joint !== null;
}

/** Return where what is chosen is in the frame, m; null where it is nowhere. */
export function placeOfChosen(run, { chosen, joint, frame }) {
  if (joint) return placeOf(run, joint, frame);
  return run.centre(frame, chosen);
}

/** Return heading and rows of name and text of what is chosen. */
export function numbersOfChosen(run, state) {
  return state.joint ? ofJoint(run, state) : ofBlock(run, state);
}

function ofBlock(run, { chosen: block, frame }) {
  const rows = [["Rock", run.scene.rocks[run.scene.rock[block]] ?? "–"]];
  rows.push(["Area", `${withUnit(run.area[block], "", 4, run.areaError[block])} m²`]);
  if (run.fixed[block]) rows.push(["Support", "fixed"]);
  if (run.isGone(frame, block)) rows.push(["State", run.isAwaited(frame, block) ? "comes later" : "excavated"]);
  for (const name of OF_BLOCK) {
    const [label, unit] = labelOf(run, name);
    rows.push([label, withUnit(run.value(name, frame, block), unit, 4, run.error(name))]);
  }
  return [`Block ${run.scene.blocks[block]}`, rows];
}

function ofJoint(run, { joint, frame }) {
  const [one, other] = blocksOf(run, joint).map((block) => run.scene.blocks[block] ?? "–");
  const name = nameOf(run, joint);
  const values = valuesOf(run, joint, frame);
  const rows = name ? [["Joint", name]] : [];
  for (const [label, value, unit, error] of values) {
    rows.push([label, typeof value === "string" ? value : withUnit(value, unit, 4, error)]);
  }
  if (!values.length) rows.push(["State", "carries nothing in this frame, or is left out"]);
  return [`Joint of ${one} and ${other}`, rows];
}

/** Return the curves of what is chosen over the frames. */
export function curvesOfChosen(run, state) {
  if (state.joint) return curvesOfJoint(run, state.joint);
  const { chosen: block } = state;
  const field = state.field in run.scene.labels ? state.field : "displacement";
  const [label, unit] = labelOf(run, field);
  const values = run.times.map((_, frame) => (run.isGone(frame, block) ? null : run.value(field, frame, block)));
  return [
    { name: `Block ${run.scene.blocks[block]}, ${label}`, unit, time: run.times, lines: [{ name: label, values, error: run.error(field) }] },
  ];
}

/** Return what is chosen as the address has it. */
export function writtenChoice({ chosen, joint }) {
  if (joint && "edge" in joint) return `joint=${joint.edge}`;
  if (joint) return `joint=${joint.vertex},${joint.by},${Number(joint.along.toFixed(3))}`;
  return chosen >= 0 ? `block=${chosen}` : "";
}

/** Return the choice that an address has: a block, a joint or nothing. */
export function readChoice(run, said) {
  const number = (text, past) => (/^\d+$/.test(text) && Number(text) < past ? Number(text) : -1);
  const nothing = { chosen: -1, joint: null };
  if (said.has("block")) return { ...nothing, chosen: number(said.get("block"), run.blockCount) };
  const vertices = run.start.length / 2;
  const parts = (said.get("joint") ?? "").split(",");
  const [vertex, by] = [number(parts[0], vertices), number(parts[1] ?? "", run.blockCount)];
  const along = Number(parts[2] ?? 0);
  if (vertex < 0 || (parts.length > 1 && by < 0) || !Number.isFinite(along)) return nothing;
  return { ...nothing, joint: parts.length > 1 ? { vertex, by, along } : { edge: vertex } };
}
