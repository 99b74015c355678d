// Water that flows in joints: dry channels, arrows, flows of boundaries and openings, as in draw_flow.py.

import { withUnit } from "./colours.js";

const FIELDS = ["pressure", "head", "flow", "aperture", "saturation"];
const CELL = 54;
/** Side of the squares of which each has one arrow, pixels. */
const ARROW = 16;
const ABOVE = 18;
/** How far numbers stand above their places, pixels: above the sign of a level. */
const LEAST = 0.01;
/** Share of the largest flow below which a flow has no arrow. */
const DRY = 1;
const EDGE = 2.6;
/** Widths of dry channels, and of the edge of others, pixels. */

/** Return whether a field is one of water that flows in joints. */
export function isOfFlow(field) {
  return FIELDS.includes(field);
}

/** Draw the channels that are dry, and below the others an edge on which pale colours are seen. */
export function drawDry(pen, { run, view, frame, theme }) {
  for (const [name, width] of [["dry", DRY], ["flow", EDGE]]) {
    const paths = [];
    run.eachFace(name, frame, ([x0, y0, x1, y1]) => {
      paths.push([view.screenX(x0), view.screenY(y0), view.screenX(x1), view.screenY(y1)]);
    });
    pen.lines(paths, theme.faint, width);
  }
}

/** Draw an arrow on the channel with the largest flow of each square of the screen, and flows as numbers. */
export function drawFlow(pen, { run, view, frame, theme }) {
  const cells = new Map();
  const least = LEAST * largestFlow(run);
  run.eachFace("flow", frame, (ends, value) => {
    const [x, y] = [view.screenX(0.5 * (ends[0] + ends[2])), view.screenY(0.5 * (ends[1] + ends[3]))];
    if (!(value > least) || x < 0 || x > view.width || y < 0 || y > view.height) return;
    const key = `${Math.floor(x / CELL)} ${Math.floor(y / CELL)}`;
    if (!(cells.get(key)?.value >= value)) cells.set(key, { value, x, y, ends });
  });
  const shafts = [];
  const heads = [];
  for (const { x, y, ends } of cells.values()) {
    const [dx, dy] = [ends[2] - ends[0], ends[1] - ends[3]];
    const length = Math.hypot(dx, dy);
    if (!length) continue;
    const [ux, uy] = [(0.5 * ARROW * dx) / length, (0.5 * ARROW * dy) / length];
    shafts.push([x - ux, y - uy, x, y]);
    heads.push([x + ux, y + uy, x - 0.6 * uy, y + 0.6 * ux, x + 0.6 * uy, y - 0.6 * ux]);
  }
  pen.lines(shafts, theme.ink, 1.2);
  pen.areas(heads, theme.ink);
  for (const [worldX, worldY, text] of run.flows[frame].flows) {
    const [x, y] = [view.screenX(worldX), view.screenY(worldY)];
    const side = x < 0.2 * view.width ? "start" : x > 0.8 * view.width ? "end" : "middle";
    pen.text(x, y - ABOVE, text, theme.ink, theme.paper, side);
  }
}

/** Return the largest flow in a channel in all frames, as wide as lines are. */
function largestFlow(run) {
  return run.faces.flow.value.reduce((most, one) => Math.max(most, one), 0);
}

/** Return the entries of the legend: flow as width, and dry joints. */
export function legendOfFlow({ run, frame, theme }) {
  const largest = largestFlow(run);
  const [, unit] = run.scene.joint_labels.flow;
  const found = [];
  if (largest > 0) found.push({ colour: theme.ink, width: 4, text: `flow as width, up to ${withUnit(largest, unit, 3)}` });
  let dry = 0;
  run.eachFace("dry", frame, () => dry++);
  if (dry) found.push({ colour: theme.faint, width: DRY, text: "dry joint" });
  return found;
}
