// The section of a case: its blocks and all that lies on them, drawn as the page of a run does; marks of faults and notes.

import { coloursOf } from "../../pictures/page/script/colouring.js";
import { RunData } from "../../pictures/page/script/data.js";
import { drawBlocks, outline } from "../../pictures/page/script/draw_canvas.js";
import { LAYERS, drawChosen, drawScaleBar, layersOf } from "../../pictures/page/script/layers.js";
import { fillLegend } from "../../pictures/page/script/legend.js";
import { CanvasPen } from "../../pictures/page/script/pens.js";
import { View, followPointers } from "../../pictures/page/script/view.js";

export const LIGHT = { paper: "#ffffff", ink: "#262626", faint: "#9a9a9a", chosen: "#d81b60", line: "#262626" };
const DARK = { paper: "#16181b", ink: "#e8e6e1", faint: "#7c7c7c", chosen: "#ff6fa3", line: "#0b0c0d" };
const MARKS = { fault: "#d32f2f", warning: "#ef7d00", note: "#1f6fb4" };
const NEAR = 9;
/** How far from a mark a click still means it, pixels. */
const SHOWN = ["bolts", "points", "excavated", "water", "surcharge", "links", "axes", "faults", "notes"];
/** Layers that are on at first. */
const OWN = { faults: "Marks of faults and warnings", notes: "Marks of notes", slivers: "Slivers" };
/** Layers of the section alone. */
const SHARP = 10, LONG = 20;
/** Of a sliver: an angle below, degrees, or a length above so many times its width. */
const STEP = 40;
const EMPTY = [-2, -2, 38, 28];
/** What a case without any place shows, m. */

/** Edges of a block, its smallest angle, degrees, and whether it is a sliver. */
export function shapeOf(run, block) {
  const [first, past] = [run.blockStart[block], run.blockStart[block + 1]], count = past - first, at = (k) => [0, 1].map((i) => run.start[2 * (first + ((k + count) % count)) + i]);
  let [angle, half] = [180, 0];
  for (let k = 0; k < count; k++) {
    const [[x, y], [a, b], [c, d]] = [at(k), at(k - 1), at(k + 1)], [ux, uy, vx, vy] = [a - x, b - y, c - x, d - y];
    const turn = (Math.atan2(vx * uy - vy * ux, ux * vx + uy * vy) * 180) / Math.PI; // within the block, which runs counter-clockwise
    angle = Math.min(angle, turn < 0 ? turn + 360 : turn);
    half += 0.5 * Math.hypot(vx, vy);
  }
  // width of the rectangle that has its area and perimeter
  const wide = 0.5 * (half - Math.sqrt(Math.max(0, half * half - 4 * run.area[block])));
  return { edges: count, angle, isSliver: angle < SHARP || half - wide > LONG * wide };
}

const POINT = /\(-?[\d.e+-]+, -?[\d.e+-]+\)/;
/** Coordinates in a message: its points are places by themselves, and no line. */

/** The smallest block and the shortest edge of a section, in words. */
function sizesOf({ start, blockStart, blockCount, area, scene }) {
  let [block, shortest] = [0, Infinity];
  for (let k = 0; k < blockCount; k++) {
    if (area[k] < area[block]) block = k;
    for (let v = blockStart[k], before = blockStart[k + 1] - 1; v < blockStart[k + 1]; before = v++) {
      shortest = Math.min(shortest, Math.hypot(start[2 * v] - start[2 * before], start[2 * v + 1] - start[2 * before + 1]));
    }
  }
  return blockCount ? `smallest block ${scene.blocks[block]} of ${Number(area[block].toPrecision(3))} m², shortest edge ${Number(shortest.toPrecision(3))} m` : "";
}

/** Return faults, warnings and notes of a case as marks. */
export function marksOf(news) {
  const of = (kind, some) => some.map((one) => ({ ...one, kind, isLine: one.at.length > 1 && !POINT.test(one.what) }));
  return [...of("fault", news.faults), ...of("warning", news.warnings), ...of("note", news.notes)];
}

/** Draws a case within an element; ``asked`` is called with the mark that somebody clicks on. */
export class Section {
  /** @param {HTMLElement} root @param {(mark: any) => void} asked */
  constructor(root, asked) {
    root.innerHTML = `<div class="stage"><div class="legend"><div class="entries"></div><details><summary>Layers</summary><div class="layers"></div></details></div>
      <div class="canvases"><canvas aria-hidden="true"></canvas><canvas tabindex="0" role="img" aria-label="Drawing of the case. Arrows move it, plus and minus zoom, Home shows all."></canvas>
      <output class="place"></output><p class="wait" role="status">Reading the case. After an installation parts of clast are compiled first, once: up to a minute.</p>
      <p class="old" hidden>The blocks are those before the faults.</p></div></div>`;
    this.root = root;
    this.asked = asked;
    /** The hand that draws in it, of a window that has one. */
    this.tools = null;
    [this.below, this.above] = root.querySelectorAll("canvas");
    this.view = new View();
    this.run = null;
    /** What was found in the case last. */
    this.newest = null;
    /** Its smallest block and shortest edge, in words. */
    this.sizes = "";
    this.origin = null;
    /** All points, lines and outlines of the file; place of those that are chosen. */
    this.lines = [];
    this.place = [];
    /** Lines that cut the rock while a slider moves, x0, y0, x1, y1, m. */
    this.moving = [];
    this.marks = [];
    this.lit = null;
    /** What lies under the section: has ``draw(pen)``, ``take(x, y)`` and ``points()``, m. */
    this.under = null;
    /** A version that is kept beside it: has ``draw()``. */
    this.beside = null;
    this.state = { frame: 0, field: "rock", share: null, limits: null, layers: new Set(), chosen: -1, joint: null };
    /** Layers that somebody has switched: whether they are on. */
    this.wanted = new Map();
    this.theme = matchMedia("(prefers-color-scheme: dark)").matches ? DARK : LIGHT;
    followPointers(this.above, this.view, {
      changed: () => this.changed(),
      clicked: (x, y) => this.click(x, y),
      over: (x, y) => {
        this.tellPlace(x, y);
        this.tools?.over(x, y);
      },
      ruled: () => this.tools?.rule() ?? null,
    });
    this.above.addEventListener("keydown", (event) => this.press(event));
    new ResizeObserver(() => this.resize()).observe(this.above.parentElement);
    this.resize();
  }

  /**
   * Show what is found in a case: a scene, or the lines of the file where there is none.
   * @param {any} news what section.py made @param {any[]} marks each with ``kind`` and ``at``
   */
  async show(news, marks) {
    this.root.querySelector(".wait").hidden = true;
    const run = news.scene && new RunData(news.scene);
    this.newest = news;
    await run?.decode();
    if (this.newest !== news) return; // another one has come meanwhile
    const old = this.origin, isFirst = old === null;
    const before = this.run && JSON.stringify([this.run.scene.vertices, old]);
    if (run) {
      this.run = run;
      this.sizes = sizesOf(run);
      this.state.frame = Math.min(this.state.frame, run.frameCount - 1);
      this.origin = news.scene.origin;
      this.fillLayers();
    } else if (!this.run) {
      this.origin = news.lines.flatMap(({ points }) => points)[0] ?? this.origin ?? [0, 0];
    }
    // what is looked at stays where it is
    if (old) [this.view.x, this.view.y] = [this.view.x + old[0] - this.origin[0], this.view.y + old[1] - this.origin[1]];
    this.lines = news.lines;
    this.moving = [];
    this.showsFile = !news.scene;
    this.marks = marks;
    this.lit = null;
    if (this.state.chosen >= (this.run?.blockCount ?? 0)) this.state.chosen = -1;
    this.root.querySelector(".old").hidden = Boolean(news.scene) || !this.run;
    if (this.origin && (isFirst || (this.view.box && before !== JSON.stringify([this.run?.scene.vertices, this.origin])))) this.fit();
    this.kept = null;
    this.changed();
  }

  /** Light a mark up, or none; bring it into sight if that is asked for. */
  light(mark, bring = false) {
    this.lit = mark;
    if (bring && mark?.at.length) {
      const [xs, ys] = [0, 1].map((k) => mark.at.map((point) => point[k] - this.origin[k]));
      const [x, y] = [xs, ys].map((some) => 0.5 * (Math.min(...some) + Math.max(...some)));
      const isSeen = (px, py) => px > 0 && py > 0 && px < this.view.width && py < this.view.height;
      if (!xs.every((_, k) => isSeen(this.view.screenX(xs[k]), this.view.screenY(ys[k])))) {
        this.view.pan(this.view.screenX(this.view.x) - this.view.screenX(x), this.view.screenY(this.view.y) - this.view.screenY(y));
      }
    }
    this.changed();
  }

  /** Show where the file has the points and lines of a table, by its place. */
  choose(place) {
    this.place = place;
    this.changed();
  }

  /** Show the lines that cut the rock mass until its blocks are there: x0, y0, x1, y1, m. */
  move(lines) {
    this.moving = lines;
    this.changed();
  }

  /** Show all that is drawn. */
  fit() {
    const box = this.run && !this.showsFile ? this.run.boxOf(this.run.start) : [Infinity, Infinity, -Infinity, -Infinity];
    const around = this.showsFile ? this.lines.flatMap(({ points }) => points).map((point) => this.local(point)) : [...(this.run?.surroundings ?? [])];
    if (this.origin && !around.length && (!this.run || this.showsFile)) around.push(...(this.under?.points() ?? []).map((point) => this.local(point)));
    for (const [x, y] of around) {
      [box[0], box[1], box[2], box[3]] = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
    }
    if (box.every(Number.isFinite)) this.view.fit(...box);
    else if (!this.run) this.view.fit(...EMPTY);
    this.changed();
  }

  /** Show the table that is chosen, or the block. */
  zoomToChosen() {
    const { run, state: { chosen } } = this;
    const local = this.lines.filter(({ place }) => this.place.length && this.place.every((part, k) => part === place[k])).flatMap(({ points }) => points).map((point) => this.local(point));
    if (!local.length && chosen >= 0) for (let v = run.blockStart[chosen]; v < run.blockStart[chosen + 1]; v++) local.push([run.start[2 * v], run.start[2 * v + 1]]);
    if (!local.length) return;
    const [[left, right], [low, high]] = [0, 1].map((k) => [Math.min(...local.map((point) => point[k])), Math.max(...local.map((point) => point[k]))]);
    const room = Math.max(right - left, high - low, 0.02 * this.view.wide);
    this.view.fit(left - room / 4, low - room / 4, right + room / 4, high + room / 4);
    this.changed();
  }

  // --- hands ---------------------------------------------------------------------------------

  press(event) {
    const moves = {
      "+": () => this.view.zoom(1.25),
      "=": () => this.view.zoom(1.25),
      "-": () => this.view.zoom(0.8),
      0: () => this.fit(),
      Home: () => this.fit(),
      ArrowLeft: () => this.view.pan(STEP, 0),
      ArrowRight: () => this.view.pan(-STEP, 0),
      ArrowUp: () => this.view.pan(0, STEP),
      ArrowDown: () => this.view.pan(0, -STEP),
      z: () => this.zoomToChosen(),
      Escape: () => (this.state.chosen = -1),
    };
    if (!(event.key in moves)) return;
    event.preventDefault();
    moves[event.key]();
    this.changed();
  }

  click(x, y) {
    if (this.tools?.isDrawing && this.tools.click(x, y)) return;
    if (this.under?.take(x, y)) return;
    const mark = this.marksShown().find(({ at }) => at.some((point) => Math.hypot(...this.screen(point).map((one, k) => one - [x, y][k])) < NEAR));
    if (mark) return this.asked(mark);
    if (this.tools?.click(x, y)) return;
    this.state.chosen = this.run ? this.run.blockAt(this.state.frame, this.view.worldX(x), this.view.worldY(y)) : -1;
    this.tellPlace(x, y);
    this.changed();
  }

  /** Tell the coordinates of the case below the pointer, and the block that is chosen. */
  tellPlace(x, y) {
    if (!this.origin) return;
    const digits = Math.max(0, Math.min(6, Math.ceil(Math.log10(this.view.scale))));
    const [east, up] = [this.view.worldX(x) + this.origin[0], this.view.worldY(y) + this.origin[1]].map((one) => one.toFixed(digits).replace("-", "−"));
    const { run, state: { chosen } } = this;
    const { edges, angle, isSliver } = chosen < 0 ? {} : shapeOf(run, chosen);
    const block = chosen < 0 ? "" : `block ${run.scene.blocks[chosen]}, ${run.scene.rocks[run.scene.rock[chosen]]}, ${Number(run.area[chosen].toPrecision(4))} m², ${edges} edges, smallest angle ${angle.toFixed(1)}°${isSliver ? ", a sliver" : ""}${run.fixed[chosen] ? ", fixed" : ""}; `;
    this.root.querySelector(".place").textContent = `${block}x ${east} m, y ${up} m`;
  }

  /** Whether a layer is on. */
  isOn(name) { return this.wanted.get(name) ?? SHOWN.includes(name); }

  marksShown() { return this.marks.filter(({ kind }) => this.isOn(kind === "note" ? "notes" : "faults")); }

  fillLayers() {
    const known = layersOf(this.run);
    this.state.layers = new Set(known.filter((name) => this.isOn(name)));
    const place = this.root.querySelector(".layers");
    const names = [...known.filter((name) => !["before", "displacements", "velocities", "crosses"].includes(name)), ...Object.keys(OWN)];
    place.replaceChildren(...names.map((name) => {
      const label = document.createElement("label");
      const box = document.createElement("input");
      Object.assign(box, { type: "checkbox", value: name, checked: this.isOn(name) });
      box.addEventListener("change", () => {
        this.wanted.set(name, box.checked);
        if (known.includes(name)) this.state.layers[box.checked ? "add" : "delete"](name);
        this.changed();
      });
      label.append(box, ` ${LAYERS[name]?.label ?? OWN[name]}`);
      return label;
    }));
  }

  // --- drawing -------------------------------------------------------------------------------

  local(point) {
    return [point[0] - this.origin[0], point[1] - this.origin[1]];
  }

  screen(point) {
    const [x, y] = this.local(point);
    return [this.view.screenX(x), this.view.screenY(y)];
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.above.parentElement;
    if (!width || !height) return;
    // messages come and go beside it: what somebody draws must not move under the hand
    if (this.tools && !this.view.box) this.view.keep(width, height);
    else this.view.resize(width, height);
    const dots = Math.min(2, devicePixelRatio || 1);
    for (const canvas of [this.below, this.above]) [canvas.width, canvas.height] = [Math.round(width * dots), Math.round(height * dots)];
    this.kept = null;
    this.changed();
  }

  /** Draw soon; many changes at once are drawn once. */
  changed() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  /** All that drawing asks for. */
  seen() {
    const { view, run, theme, state } = this;
    return { run, view, theme, state, scale: null, frame: state.frame };
  }

  draw() {
    const { view, run, theme, state } = this;
    // blocks are drawn again only where they or the view have changed
    const where = `${state.frame},${view.x},${view.y},${view.scale}`;
    if (this.kept !== where) {
      this.kept = where;
      this.drawBelow(this.penOf(this.below, theme.paper));
      if (run) fillLegend(this.root.querySelector(".entries"), this.seen());
    }
    const pen = this.penOf(this.above);
    this.drawAbove(pen);
    if (this.origin) this.tools?.drawHand(pen);
    this.beside?.draw();
    this.root.dataset.drawn = String(Number(this.root.dataset.drawn ?? 0) + 1);
  }

  drawBelow(pen) {
    const { view, run, theme, state } = this;
    if (run) drawBlocks(pen, run, view, state.frame, coloursOf(run, state)[0], theme);
  }

  /** Draw what lies on the blocks. */
  drawAbove(pen) {
    const { run, theme, state } = this, seen = this.seen();
    if (this.origin) this.under?.draw(pen);
    if (run) {
      for (const name of layersOf(run)) if (state.layers.has(name)) LAYERS[name].draw(pen, seen);
      if (this.isOn("slivers")) this.drawSlivers(pen);
      if (state.chosen >= 0) drawChosen(pen, seen);
      drawScaleBar(pen, seen);
    }
    if (!this.origin) return;
    const isChosen = ({ place }) => this.place.length && this.place.every((part, k) => part === place[k]);
    for (const line of this.showsFile && !this.tools ? this.lines : []) this.drawPoints(pen, line, theme.ink, 1.2);
    this.tools?.drawFile(pen);
    for (const mark of this.marksShown().reverse()) this.drawMark(pen, mark, MARKS[mark.kind], mark === this.lit ? 4 : 2);
    pen.lines(this.moving.map((ends) => [...this.screen(ends.slice(0, 2)), ...this.screen(ends.slice(2))]), theme.chosen, 1.2);
    for (const line of this.tools ? [] : this.lines.filter(isChosen)) this.drawPoints(pen, line, theme.chosen, 3);
  }

  drawSlivers(pen) {
    const { run, view, theme } = this;
    const all = Array.from({ length: run.blockCount }, (_, block) => block).filter((block) => shapeOf(run, block).isSliver);
    pen.lines(all.flatMap((block) => {
      const path = outline(run, view, run.start, block);
      return path ? [[...path, path[0], path[1]]] : [];
    }), theme.chosen, 2.5);
  }

  penOf(canvas, paper = "") {
    const context = canvas.getContext("2d", { willReadFrequently: true });
    const dots = canvas.width / this.view.width;
    context.setTransform(dots, 0, 0, dots, 0, 0);
    if (paper) context.fillStyle = paper;
    context[paper ? "fillRect" : "clearRect"](0, 0, this.view.width, this.view.height);
    return new CanvasPen(context);
  }

  drawPoints(pen, { geometry, points }, colour, width) {
    if (geometry === "point") return points.forEach((point) => pen.circle(...this.screen(point), 3.5, this.theme.paper, colour));
    const closed = geometry === "polygon" ? [...points, points[0]] : points;
    pen.lines([closed.flatMap((point) => this.screen(point))], colour, width);
  }

  /** Draw the points of a mark, and lines between them where they are one. */
  drawMark(pen, { at, isLine }, colour, width) {
    if (isLine) pen.lines([at.flatMap((point) => this.screen(point))], this.theme.paper, width + 3);
    if (isLine) pen.lines([at.flatMap((point) => this.screen(point))], colour, width);
    else at.forEach((point) => pen.circle(...this.screen(point), 3 + width, colour, this.theme.paper));
  }
}
