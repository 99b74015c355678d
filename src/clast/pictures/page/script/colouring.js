// What has colours in a frame: blocks by a field, or the joints between them.

import { FIXED, PLAIN, SLACK, Scale, endsOf, kindColour } from "./colours.js";

/** Fields that tell kinds apart. */
export const KINDS = { rock: "Rock", block: "Blocks", none: "Nothing" };

/** Return all fields of a run by their names, with what they are called. */
export function fieldsOf(run) {
  const { labels, joint_labels: joints } = run.scene;
  const found = {};
  for (const [name, [label]] of Object.entries(labels)) found[name] = label;
  for (const [name, [label]] of Object.entries(joints)) if (run.hasFaces(name)) found[name] = label;
  return { ...found, ...KINDS };
}

/** Return whether a field is a stress of blocks that has a sign. */
export function isSigned(field) {
  return field.startsWith("sigma_");
}

/** Return label and unit of a field with a scale, with the sign of stresses; undefined for others. */
export function labelOf(run, field) {
  const [label, unit] = run.scene.labels[field] ?? run.scene.joint_labels[field] ?? [];
  if (!label) return undefined;
  return [isSigned(field) ? `${label}, ${run.pressedPositive ? "compression" : "tension"} positive` : label, unit];
}

/**
 * Return the colour of every block in a frame, and the scale of blocks or joints, null without one.
 * @param {import("./data.js").RunData} run
 * @param {{field: string, frame: number, share: number | null, limits: number[] | null}} state
 * @returns {[string[], Scale | null]}
 */
export function coloursOf(run, state) {
  const { field, frame, limits } = state;
  const kinds = { rock: (block) => run.scene.rock[block], block: (block) => block };
  if (field in kinds) return [ofKinds(run, kinds[field]), null];
  if (!(field in run.scene.labels)) return [plain(run), run.hasFaces(field) ? scaleOfFaces(run, state) : null];
  const values = run.values(field, frame);
  const counted = (_, block) => !run.fixed[block] && !run.isGone(frame, block);
  const own = values.filter(counted);
  const [low, high] = limits ?? endsOf(own, run.area.filter(counted), state.share, run.error(field));
  const scale = new Scale(run.scene.colours, low, high).holds(own, limits ? SLACK.limits : SLACK.ends, run.error(field));
  return [Array.from(values, (value, block) => (run.fixed[block] ? FIXED : scale.colour(value))), scale];
}

/** Return the scale of slip or opening in a frame. */
export function scaleOfFaces(run, { field, frame, share, limits }) {
  const [values, lengths] = [[], []];
  run.eachFace(field, frame, (_, value, length) => {
    values.push(value);
    lengths.push(length);
  });
  const least = 0.1 * lengths.reduce((most, one) => Math.max(most, one), 0) + 1e-12;
  const weights = Float32Array.from(lengths, (length) => Math.max(length, least));
  const [, , fromZero] = run.scene.joint_labels[field];
  const free = fromZero === false && values.length ? extremes(values) : null;
  const [low, high] = limits ?? free ?? endsOf(Float32Array.from(values), weights, share);
  return new Scale(run.scene.colours, low, high).holds(values, limits ? SLACK.limits : SLACK.ends);
}

/** Return the least and the largest of some values, null where they are one. */
function extremes(values) {
  const [low, high] = values.reduce(([least, most], one) => [Math.min(least, one), Math.max(most, one)], [Infinity, -Infinity]);
  return low < high ? [low, high] : null;
}

function ofKinds(run, kindOf) {
  return run.scene.blocks.map((_, block) => (run.fixed[block] ? FIXED : kindColour(kindOf(block))));
}

function plain(run) {
  return run.scene.blocks.map((_, block) => (run.fixed[block] ? FIXED : PLAIN));
}
