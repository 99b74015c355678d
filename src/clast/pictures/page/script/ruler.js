// A line that is drawn by hand: its length and dip, and the values of the field along it.

import { withUnit } from "./colours.js";

const SAMPLES = 400;
/** Places along the line at which values are asked for. */

/** Return length, m, and dip of a line x0, y0, x1, y1: degrees from the horizontal, in words. */
export function measured([x0, y0, x1, y1]) {
  const [dx, dy] = [x1 - x0, y1 - y0];
  const dip = (180 / Math.PI) * Math.atan2(Math.abs(dy), Math.abs(dx));
  const side = dip > 0.05 && dip < 89.95 ? (dx * dy > 0 ? ", rising to the right" : ", falling to the right") : "";
  return [
    `${withUnit(Math.hypot(dx, dy), "m", 4)} long, ${dip.toFixed(1)}°${side}`,
    `Δx ${withUnit(dx, "m", 4)}, Δy ${withUnit(dy, "m", 4)}`,
  ];
}

/** Return the numbers of a place on the ground, with the coordinates of the case. */
export function placeInWords(run, view, x, y) {
  const digits = Math.max(0, Math.min(6, Math.ceil(Math.log10(view.scale))));
  const [east, up] = [x + run.scene.origin[0], y + run.scene.origin[1]].map((one) => one.toFixed(digits).replace("-", "−"));
  return `x ${east} m, y ${up} m`;
}

/** Draw the line, with its length and dip. */
export function drawRuler(pen, { view, theme, state }) {
  const [x0, y0, x1, y1] = [0, 2].flatMap((k) => [view.screenX(state.line[k]), view.screenY(state.line[k + 1])]);
  pen.lines([[x0, y0, x1, y1]], theme.paper, 4.5);
  pen.lines([[x0, y0, x1, y1]], theme.chosen, 2);
  for (const [x, y] of [[x0, y0], [x1, y1]]) pen.circle(x, y, 3.5, theme.paper, theme.chosen);
  const left = 0.5 * (x0 + x1) > 0.6 * view.width;
  const texts = measured(state.line);
  texts.forEach((text, k) => {
    pen.text(0.5 * (x0 + x1) + (left ? -10 : 10), 0.5 * (y0 + y1) - 8 - 16 * (texts.length - 1 - k), text, theme.ink, theme.paper, left ? "end" : "start");
  });
}

/**
 * Return the values of a field of blocks along the line as a curve over the distance from its first end.
 * @param {import("./data.js").RunData} run @param {{line: number[], field: string, frame: number}} state
 */
export function curveAlong(run, { line: [x0, y0, x1, y1], field, frame }) {
  const name = field in run.scene.labels ? field : "displacement";
  const [label, unit] = run.scene.labels[name];
  const length = Math.hypot(x1 - x0, y1 - y0);
  const share = Array.from({ length: SAMPLES + 1 }, (_, k) => k / SAMPLES);
  const values = share.map((part) => {
    const block = run.blockAt(frame, x0 + part * (x1 - x0), y0 + part * (y1 - y0));
    return block < 0 ? null : run.value(name, frame, block);
  });
  const lines = [{ name: label, values, error: run.error(name) }];
  return { name: `${label} along the line`, unit, along: share.map((part) => part * length), lines };
}
