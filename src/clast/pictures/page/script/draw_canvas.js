// Blocks on a 2D canvas: all of one colour in one path, all outlines in another.

import { CanvasPen } from "./pens.js";

/**
 * Return the outlines of the blocks that are seen, on the screen, by colour.
 * @param {import("./data.js").RunData} run @param {import("./view.js").View} view
 * @param {number} frame @param {string[]} colours of each block
 */
export function outlinesByColour(run, view, frame, colours) {
  const here = run.vertices(frame);
  const found = new Map();
  for (let block = 0; block < run.blockCount; block++) {
    if (run.isGone(frame, block)) continue;
    const path = outline(run, view, here, block);
    if (!path) continue;
    const paths = found.get(colours[block]);
    if (paths) paths.push(path);
    else found.set(colours[block], [path]);
  }
  return found;
}

/** Return a block's outline on the screen, x and y by turns; null where it is not seen. */
export function outline(run, view, here, block) {
  const first = run.blockStart[block];
  const past = run.blockStart[block + 1];
  const path = new Array(2 * (past - first));
  let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let v = first, k = 0; v < past; v++, k += 2) {
    const x = view.screenX(here[2 * v]);
    const y = view.screenY(here[2 * v + 1]);
    path[k] = x;
    path[k + 1] = y;
    if (x < left) left = x;
    if (x > right) right = x;
    if (y < top) top = y;
    if (y > bottom) bottom = y;
  }
  return right < 0 || left > view.width || bottom < 0 || top > view.height ? null : path;
}

/** Return the width of outlines that leaves room for the colours of small blocks, pixels. */
export function outlineWidth(run, view) {
  let area = 0;
  for (let block = 0; block < run.blockCount; block++) area += run.area[block];
  const size = Math.sqrt(area / run.blockCount) * view.scale;
  return Math.max(0.15, Math.min(1.2, 0.03 * size));
}

/** Draws blocks on a canvas without a graphics card. */
export class CanvasDrawing {
  name = "canvas";

  /** @param {HTMLCanvasElement} canvas @param {import("./data.js").RunData} run */
  constructor(canvas, run) {
    this.canvas = canvas;
    this.run = run;
    // drawing on the CPU is many times quicker where the canvas is kept there
    this.context = canvas.getContext("2d", { willReadFrequently: true });
  }

  /**
   * Draw the blocks of a frame.
   * @param {import("./view.js").View} view @param {number} frame
   * @param {string[]} colours @param {{line: string, paper: string}} theme
   */
  draw(view, frame, colours, theme) {
    const { context, canvas } = this;
    const dots = canvas.width / view.width;
    context.setTransform(dots, 0, 0, dots, 0, 0);
    context.fillStyle = theme.paper;
    context.fillRect(0, 0, view.width, view.height);
    drawBlocks(new CanvasPen(context), this.run, view, frame, colours, theme);
  }
}

/** Draw blocks with a pen. */
export function drawBlocks(pen, run, view, frame, colours, theme) {
  const paths = outlinesByColour(run, view, frame, colours);
  for (const [colour, some] of paths) pen.areas(some, colour);
  const closed = [];
  for (const some of paths.values()) {
    for (const path of some) closed.push([...path, path[0], path[1]]);
  }
  pen.lines(closed, theme.line, outlineWidth(run, view));
}
