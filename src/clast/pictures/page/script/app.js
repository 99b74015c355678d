// The page: reads its data, draws, plays, and answers to hands, keys and the address.

import { Charts } from "./charts.js";
import { curvesOfChosen, isChosen, numbersOfChosen, placeOfChosen, readChoice, writtenChoice } from "./chosen.js";
import { coloursOf, fieldsOf, isSigned, labelOf } from "./colouring.js";
import { withUnit } from "./colours.js";
import { RunData } from "./data.js";
import { CanvasDrawing, drawBlocks } from "./draw_canvas.js";
import { WebglDrawing, isSoftware } from "./draw_webgl.js";
import { jointAt } from "./joints.js";
import { drawDry, drawFlow, isOfFlow } from "./flow.js";
import { LAYERS, drawChosen, drawFaces, drawFactor, drawScaleBar, factorInWords, layersOf } from "./layers.js";
import { drawLegend, fillLegend, heightOfLegend } from "./legend.js";
import { CanvasPen, SvgPen } from "./pens.js";
import { Live } from "./live.js";
import { factorToBeSeen } from "./magnified.js";
import { curveAlong, drawRuler, placeInWords } from "./ruler.js";
import { LivePanel } from "./live_panel.js";
import { fillReport } from "./report.js";
import { View, followPointers } from "./view.js";

const LIGHT = {
  paper: "#ffffff", ink: "#262626", faint: "#9a9a9a", grid: "#e2e2e2", chosen: "#d81b60", line: "#262626",
};
const DARK = {
  paper: "#16181b", ink: "#e8e6e1", faint: "#7c7c7c", grid: "#33373c", chosen: "#ff6fa3", line: "#0b0c0d",
};
const SLOW = 250;
/** Milliseconds of a first frame above which a software renderer is given up. */
const CALM = 250;
/** Milliseconds that a frame stays at least where somebody has asked for less motion. */
const OFTEN = 200;
/** Milliseconds after which the address follows. */
const TICK = { width: 10, height: 12, lanes: 4, texts: 12 };
/** Room of a mark on the time line, pixels; marks below one another, and texts of one that stands for several. */
const NEAR = 9;
/** How far from a joint a click still means it, pixels; never more than a part of a block. */

/** One page of one run, within an element. */
export class Page {
  /** @param {HTMLElement} root @param {any} scene what scene.py made */
  constructor(root, scene, token = "") {
    this.root = root;
    this.token = token;
    /** Within another page the address is that one's. */
    this.embedded = root.classList.contains("embedded");
    this.run = new RunData(scene);
    this.view = new View();
    this.addressDue = null;
    this.state = { frame: 0, field: "displacement", share: null, limits: null, layers: new Set(), chosen: -1 };
    this.state.joint = null;
    this.state.follow = false;
    /** The line that values are shown along, x0, y0, x1, y1, m; null for none. */
    this.state.line = null;
    this.ruling = false;
    this.playing = false;
    this.speed = 1;
    this.loop = false;
    /** Ends what listens outside of the page. */
    this.ending = new AbortController();
  }

  /** Return the element of a name. */
  $(name) {
    return this.root.querySelector(`[data-part="${name}"]`);
  }

  /** Decode the data and show the page. */
  async start() {
    await this.run.decode();
    this.state.frame = this.run.frameCount - 1;
    this.state.layers = new Set(layersOf(this.run).filter((name) => ["bolts", "points", "excavated", "water", "surcharge", "links", "axes"].includes(name)));
    this.theme = matchMedia("(prefers-color-scheme: dark)").matches ? DARK : LIGHT;
    this.canvas = this.$("blocks");
    this.above = this.$("above");
    this.drawing = this.chooseDrawing();
    this.root.dataset.renderer = this.drawing.name;
    this.fillControls();
    this.listen();
    this.resize();
    this.fitAll();
    this.readAddress();
    this.charts = new Charts(this.$("chart"), this.run.scene.curves, this.run.scene.curve_colours, (time) =>
      this.goTo(this.run.frameAt(time)),
    );
    this.fillCurves();
    fillReport(this.$("report"), this.run.scene);
    this.applyTheme();
    this.root.dataset.ready = "yes";
  }

  /** Return what draws the blocks: WebGL2 where a graphics card does it, else the 2D canvas. */
  chooseDrawing() {
    const wanted = new URLSearchParams(location.search).get("renderer");
    if (wanted !== "canvas") {
      const gl = document.createElement("canvas").getContext("webgl2");
      const fit = gl && (wanted === "webgl2" || !isSoftware(gl));
      // browsers give few contexts, and take the oldest away where there are too many
      gl?.getExtension("WEBGL_lose_context")?.loseContext();
      if (fit) {
        try {
          const real = this.canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
          this.canvas.addEventListener("webglcontextlost", () => {
            if (this.drawing?.gl === real) this.useCanvas();
          });
          return new WebglDrawing(real, this.run);
        } catch (fault) {
          console.warn(`WebGL2 is not used: ${fault.message}`);
          this.renewCanvas();
        }
      }
    }
    return new CanvasDrawing(this.canvas, this.run);
  }

  /** Let the graphics card go while the page is out of sight: browsers give few contexts. */
  rest() {
    if (this.drawing?.name !== "webgl2") return;
    this.drawing.gl.getExtension("WEBGL_lose_context")?.loseContext();
    this.renewCanvas();
    this.drawing = null;
  }

  /** Draw again, when the page comes into sight. */
  wake() {
    if (this.drawing) return;
    this.drawing = this.chooseDrawing();
    this.resize();
  }

  /** Put a new canvas in the place of one that has given a WebGL context. */
  renewCanvas() {
    const fresh = this.canvas.cloneNode();
    this.canvas.replaceWith(fresh);
    this.canvas = fresh;
  }

  // --- controls ------------------------------------------------------------------------------

  fillControls() {
    const { run } = this;
    const fields = this.$("field");
    for (const [name, label] of Object.entries(fieldsOf(run))) fields.append(new Option(label, name));
    this.fillLayers();
    this.$("title").textContent = run.scene.title;
    if (!this.embedded) document.title = `${run.scene.title} - clast`;
    this.fillCounts();
    this.fillTicks();
  }

  /** List the layers that the run has something for. */
  fillLayers() {
    this.$("layers").replaceChildren();
    for (const name of layersOf(this.run)) {
      const label = document.createElement("label");
      const box = document.createElement("input");
      box.type = "checkbox";
      box.value = name;
      label.append(box, ` ${LAYERS[name].label}`);
      this.$("layers").append(label);
    }
  }

  /** Say how many blocks, frames, contacts and joints of how many are shown. */
  fillCounts() {
    const { run } = this;
    this.$("time").max = String(run.frameCount - 1);
    const { of } = run.scene.frames;
    const count = (number) => number.toLocaleString("en");
    const part = (what, { shown, of: all }) =>
      shown < all ? `${count(shown)} of ${count(all)} ${what} (evenly in space)` : `${count(all)} ${what}`;
    const said = [`${count(run.blockCount)} blocks`, run.frameCount < of ? `${run.frameCount} of ${of} frames` : `${of} frames`];
    if (run.contacts.of) said.push(part("contacts", run.contacts));
    const faces = { slip: "slips of joints", opening: "openings of joints", worn: "worn joints", water: "wet faces", flow: "channels" };
    for (const [name, table] of Object.entries(run.faces)) {
      if (name in faces && table.shown < table.of) said.push(part(faces[name], table));
    }
    this.$("counts").textContent = said.join(", ");
  }

  /** Mark stages and events on the time line. */
  fillTicks() {
    const { run } = this;
    const [first, last] = [run.times[0], run.times[run.frameCount - 1]];
    const marks = [];
    run.stages.forEach((stage, frame, all) => {
      if (frame === 0 || stage !== all[frame - 1]) marks.push({ kind: "stage-tick", frame, text: `Stage ${stage} begins` });
    });
    for (const { time, text } of run.scene.events) {
      if (time >= first && time <= last) marks.push({ kind: "event-tick", frame: run.frameAt(time), text });
    }
    const wide = this.$("ticks").clientWidth;
    const ticks = [];
    /** The last tick of each lane: those that would cover it lie in the next, and have one tick in the last. */
    const lanes = [];
    for (const mark of marks.sort((a, b) => a.frame - b.frame)) {
      const share = mark.frame / Math.max(1, run.frameCount - 1);
      let lane = lanes.findIndex((tick) => wide * (share - tick.share) >= TICK.width);
      if (lane < 0) lane = lanes.length;
      if (lane === TICK.lanes) lanes[lane - 1].marks.push(mark);
      else ticks.push((lanes[lane] = { lane, share, marks: [mark] }));
    }
    this.$("ticks").style.height = `${TICK.height * lanes.length}px`;
    this.$("ticks").replaceChildren(...ticks.map((tick) => this.buttonOf(tick)));
  }

  /** Return the button of a tick; where it has several marks, each click goes to the next of them. */
  buttonOf({ lane, share, marks }) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = marks[0].kind;
    button.classList.toggle("many", marks.length > 1);
    button.style.left = `${100 * share}%`;
    button.style.top = `${TICK.height * lane}px`;
    const texts = marks.slice(0, TICK.texts).map(({ text }) => text);
    if (marks.length > TICK.texts) texts.push(`${marks.length - TICK.texts} more`);
    button.title = texts.join("\n");
    button.setAttribute("aria-label", texts.join("; "));
    let next = 0;
    button.addEventListener("click", () => this.goTo(marks[next++ % marks.length].frame));
    return button;
  }

  fillCurves() {
    const list = this.$("curve");
    const chosen = list.value;
    list.replaceChildren();
    this.run.scene.curves.forEach((curve, k) => list.append(new Option(curve.name, String(k))));
    if (isChosen(this.state)) {
      curvesOfChosen(this.run, this.state).forEach((curve, k) => list.append(new Option(curve.name, `chosen ${k}`)));
    }
    if (this.state.line) list.append(new Option("Values along the line", "line"));
    if (chosen && [...list.options].some((option) => option.value === chosen)) list.value = chosen;
  }

  listen() {
    const on = (name, event, call) => this.$(name).addEventListener(event, call);
    on("time", "input", () => this.goTo(Number(this.$("time").value)));
    on("play", "click", () => this.play(!this.playing));
    on("back", "click", () => this.goTo(this.state.frame - 1));
    on("next", "click", () => this.goTo(this.state.frame + 1));
    on("speed", "change", () => (this.speed = Number(this.$("speed").value)));
    on("loop", "change", () => (this.loop = this.$("loop").checked));
    on("field", "change", () => this.set({ field: this.$("field").value, limits: null }));
    on("share", "change", () => this.set({ share: Number(this.$("share").value) || null, limits: null }));
    for (const end of ["low", "high"]) on(end, "change", () => this.setLimits());
    on("layers", "change", (event) => this.toggle(event.target.value, event.target.checked));
    on("fit", "click", () => (this.fitAll(), this.changed()));
    on("fit-moving", "click", () => (this.fitMoving(), this.changed()));
    on("rule", "click", () => this.rule(!this.ruling));
    on("factor", "change", () => this.magnify(Number(this.$("factor").value)));
    on("factor-auto", "click", () => this.magnify(factorToBeSeen(this.run, this.state.frame)));
    on("pressed-positive", "change", () => this.countCompression(this.$("pressed-positive").checked));
    on("theme", "click", () => {
      this.theme = this.theme === DARK ? LIGHT : DARK;
      this.themeAsked = true;
      this.applyTheme();
    });
    on("png", "click", () => this.savePng());
    on("svg", "click", () => this.save(new Blob([this.svg()], { type: "image/svg+xml" }), "svg"));
    on("csv", "click", () => this.save(new Blob([this.charts.csv()], { type: "text/csv" }), "csv"));
    on("curve", "change", () => this.showCurve());
    on("follow", "change", () => this.set({ follow: this.$("follow").checked }));
    followPointers(this.above, this.view, {
      changed: () => this.changed(),
      clicked: (x, y) => this.click(x, y),
      over: (x, y) => (this.$("place").textContent = placeInWords(this.run, this.view, this.view.worldX(x), this.view.worldY(y))),
      ruled: () => (this.ruling ? (from, to) => this.drawLine(from, to) : null),
    });
    on("above", "pointerleave", () => (this.$("place").textContent = ""));
    // a page of its own hears keys before anything in it has been clicked
    (this.embedded ? this.root : document).addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(this.$("stage"));
    if (!this.embedded) addEventListener("hashchange", () => this.readAddress());
    const { signal } = this.ending;
    addEventListener("beforeprint", () => this.toPaper(true), { signal });
    addEventListener("afterprint", () => this.toPaper(false), { signal });
    matchMedia("print").addEventListener("change", ({ matches }) => this.toPaper(matches), { signal });
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { tagName, type } = event.target;
    // what is in focus has its own keys: space switches, arrows move
    const own = { BUTTON: /^ $/, SELECT: /./, INPUT: { checkbox: /^ $/, range: /^(Arrow|Home|End)/ }[type] ?? /./ };
    if (own[tagName]?.test(event.key)) return;
    const step = event.shiftKey ? 10 : 1;
    const moves = {
      " ": () => this.play(!this.playing),
      ",": () => this.goTo(this.state.frame - step),
      ".": () => this.goTo(this.state.frame + step),
      Home: () => this.goTo(0),
      End: () => this.goTo(this.run.frameCount - 1),
      "+": () => this.view.zoom(1.25),
      "=": () => this.view.zoom(1.25),
      "-": () => this.view.zoom(0.8),
      0: () => this.fitAll(),
      ArrowLeft: () => this.view.pan(40, 0),
      ArrowRight: () => this.view.pan(-40, 0),
      ArrowUp: () => this.view.pan(0, 40),
      ArrowDown: () => this.view.pan(0, -40),
      Escape: () => (this.rule(false), this.set({ line: null }), this.choose({})),
      l: () => this.rule(!this.ruling),
    };
    if (!(event.key in moves)) return;
    event.preventDefault();
    moves[event.key]();
    this.changed();
  }

  // --- state ---------------------------------------------------------------------------------

  set(part) {
    Object.assign(this.state, part);
    this.changed();
  }

  setLimits() {
    const [low, high] = ["low", "high"].map((end) => this.$(end).value.trim());
    const limits = [Number(low), Number(high)];
    const whole = low !== "" && high !== "" && limits.every(Number.isFinite) && limits[0] < limits[1];
    this.set({ limits: whole ? limits : null });
  }

  toggle(layer, wanted) {
    this.state.layers[wanted ? "add" : "delete"](layer);
    this.changed();
  }

  goTo(frame) {
    this.set({ frame: Math.max(0, Math.min(this.run.frameCount - 1, frame)) });
  }

  /** Play or pause; the run takes ten seconds at speed 1, whatever its own time. */
  play(wanted) {
    this.playing = wanted;
    const button = this.$("play");
    button.setAttribute("aria-label", wanted ? "Pause" : "Play");
    button.textContent = wanted ? "❚❚" : "▶";
    if (!wanted) return this.changed();
    if (this.state.frame >= this.run.frameCount - 1) this.goTo(0);
    const [first, last] = [this.run.times[0], this.run.times[this.run.frameCount - 1]];
    let before = performance.now();
    let time = this.run.times[this.state.frame];
    const rest = matchMedia("(prefers-reduced-motion: reduce)").matches ? CALM : 0;
    const tick = (now) => {
      if (!this.playing) return;
      if (now - before < rest) return requestAnimationFrame(tick);
      time += ((now - before) / 10_000) * this.speed * (last - first);
      before = now;
      if (time >= last && this.loop) time = first;
      const frame = time >= last ? this.run.frameCount - 1 : this.run.frameAt(time);
      if (frame !== this.state.frame) this.goTo(frame);
      if (time >= last && !this.loop) this.play(false);
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Let a drag draw a line instead of moving the view, or no longer. */
  rule(wanted) {
    this.ruling = wanted;
    this.$("rule").setAttribute("aria-pressed", String(wanted));
    this.root.classList.toggle("ruling", wanted);
  }

  /** Take a line between two places of the screen, and show the values along it. */
  drawLine(from, to) {
    const { view } = this;
    const isNew = !this.state.line;
    this.set({ line: [from, to].flatMap(({ x, y }) => [view.worldX(x), view.worldY(y)]) });
    if (isNew) this.fillCurves();
    this.$("curve").value = "line";
  }

  /** Draw displacements some times as large as they are. */
  magnify(factor) {
    if (!(factor > 0 && factor <= 1e9)) factor = 1;
    this.run.magnify(factor);
    this.changed();
  }

  /** Count compression positive, or tension as files do. */
  countCompression(wanted) {
    this.run.pressedPositive = wanted;
    this.set({ limits: null });
    this.showCurve();
  }

  click(x, y) {
    if (this.ruling) return;
    const { view, run, state } = this;
    const at = [view.worldX(x), view.worldY(y)];
    const block = run.blockAt(state.frame, ...at);
    // in the middle of a small block a click means the block
    const size = block < 0 ? Infinity : Math.sqrt(run.area[block]);
    const joint = jointAt(run, state.frame, ...at, Math.min(NEAR / view.scale, 0.15 * size));
    this.choose(joint ? { joint } : { chosen: block });
  }

  /** Choose a block, a joint, or nothing. */
  choose({ chosen = -1, joint = null }) {
    this.set({ chosen, joint });
    this.fillCurves();
    if (isChosen(this.state)) this.$("curve").value = "chosen 0";
    this.showCurve();
  }

  /** Show all of the blocks, at the start and in the frame. */
  fitAll() {
    this.fitBlocks(() => true);
  }

  /** Show the blocks that move by more than a twentieth of the largest displacement, with some room. */
  fitMoving() {
    const { run, state: { frame } } = this;
    const far = run.values("displacement", frame).map((one, block) => (run.isGone(frame, block) ? 0 : one));
    const largest = far.reduce((most, one) => Math.max(most, one), 0);
    if (largest > 0) this.fitBlocks((block) => far[block] > 0.05 * largest, 0.1);
  }

  /** Show some blocks, where they were and where they are, with some room around them. */
  fitBlocks(counts, room = 0) {
    const { run, state } = this;
    const [was, is] = [run.start, run.vertices(state.frame)].map((points) => run.boxOf(points, counts));
    const box = [0, 1, 2, 3].map((k) => (k < 2 ? Math.min(was[k], is[k]) : Math.max(was[k], is[k])));
    for (const [x, y] of room ? [] : run.surroundings) {
      [box[0], box[1], box[2], box[3]] = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
    }
    const margin = room * Math.max(box[2] - box[0], box[3] - box[1]);
    this.view.fit(box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin);
  }

  // --- drawing -------------------------------------------------------------------------------

  resize() {
    const { clientWidth: width, clientHeight: height } = this.$("stage");
    // on paper the picture is that of the screen, whatever room it has there
    if (!width || !height || this.onPaper) return;
    if (width !== this.view.width) this.fillTicks();
    this.view.resize(width, height);
    const dots = Math.min(2, devicePixelRatio || 1);
    for (const canvas of [this.canvas, this.above]) {
      canvas.width = Math.round(width * dots);
      canvas.height = Math.round(height * dots);
    }
    this.charts?.resize();
    this.changed();
  }

  /** Put a drawing in light colours in the place of the canvases, for paper, or take it away. */
  toPaper(wanted) {
    if (wanted === Boolean(this.onPaper) || !this.charts) return;
    if (wanted) {
      const picture = document.createElement("div");
      this.onPaper = { theme: this.theme, picture };
      this.theme = LIGHT;
      picture.className = "picture";
      picture.innerHTML = this.drawnInSvg(0).finish();
      this.$("stage").append(picture);
    } else {
      this.onPaper.picture.remove();
      this.theme = this.onPaper.theme;
      this.onPaper = null;
      this.resize();
    }
    this.applyTheme();
    // uPlot empties its legend as it draws; paper does not wait until it is told again
    queueMicrotask(() => this.charts.tell());
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

  draw() {
    const { run, view, state, theme } = this;
    if (!theme || !this.drawing) return;
    if (state.follow && isChosen(state)) [view.x, view.y] = placeOfChosen(run, state) ?? [view.x, view.y];
    const begun = performance.now();
    const [colours, scale] = coloursOf(run, state);
    this.drawing.draw(view, state.frame, colours, theme);
    const context = this.above.getContext("2d");
    const dots = this.above.width / view.width;
    context.setTransform(dots, 0, 0, dots, 0, 0);
    context.clearRect(0, 0, view.width, view.height);
    this.drawLayers(new CanvasPen(context), scale);
    this.frameTime = performance.now() - begun;
    this.root.dataset.drawn = String(state.frame);
    this.root.dataset.milliseconds = this.frameTime.toFixed(1);
    this.leaveSlowSoftware();
    this.showState(scale);
    this.addressDue ??= setTimeout(() => this.writeAddress(), OFTEN);
  }

  /** Use the 2D canvas where WebGL2 proves slow in the first frames. */
  leaveSlowSoftware() {
    this.framesDrawn = (this.framesDrawn ?? 0) + 1;
    const asked = new URLSearchParams(location.search).get("renderer");
    if (this.drawing.name !== "webgl2" || asked || this.framesDrawn > 5 || this.frameTime < SLOW) return;
    this.useCanvas();
  }

  /** Go on with the 2D canvas: WebGL2 is slow, or the browser has taken its context away. */
  useCanvas() {
    this.renewCanvas();
    this.drawing = new CanvasDrawing(this.canvas, this.run);
    this.root.dataset.renderer = this.drawing.name;
    this.resize();
  }

  /** Return all that layers and legend need to know. */
  seen(scale) {
    const { run, view, state, theme } = this;
    return { run, view, theme, state, scale, frame: state.frame };
  }

  drawLayers(pen, scale) {
    const { run, state } = this;
    const scene = this.seen(scale);
    if (scale && isOfFlow(state.field)) drawDry(pen, scene);
    if (scale && run.hasFaces(state.field)) drawFaces(pen, scene, state.field);
    if (scale && isOfFlow(state.field)) drawFlow(pen, scene);
    for (const name of layersOf(run)) {
      if (state.layers.has(name) && name !== state.field) LAYERS[name].draw(pen, scene);
    }
    if (isChosen(state)) drawChosen(pen, scene);
    if (state.line) drawRuler(pen, scene);
    drawScaleBar(pen, scene);
    drawFactor(pen, scene);
  }

  /** Bring the controls in step with the state. */
  showState(scale) {
    const { run, state } = this;
    const time = run.times[state.frame];
    this.$("time").value = String(state.frame);
    this.$("time").setAttribute("aria-valuetext", withUnit(time, "s", 5));
    const stage = run.stages[state.frame];
    this.$("clock").textContent = `t = ${withUnit(time, "s", 5)}${stage ? `, stage ${stage}` : ""}`;
    this.$("field").value = state.field;
    this.$("share").value = String(state.share ?? "");
    for (const box of this.$("layers").querySelectorAll("input")) box.checked = state.layers.has(box.value);
    this.$("follow").checked = state.follow;
    if (document.activeElement !== this.$("factor")) this.$("factor").value = String(run.factor);
    this.$("pressed-positive").parentElement.hidden = !isSigned(state.field);
    this.$("pressed-positive").checked = run.pressedPositive;
    if (this.$("curve").value === "line") this.showCurve();
    this.showLegend(scale);
    this.$("paper").textContent = this.inWords(scale);
    this.showChosen();
    this.charts?.at(time);
  }

  showLegend(scale) {
    fillLegend(this.$("legend"), this.seen(scale));
    this.$("limits").hidden = !scale;
    this.$("share").parentElement.hidden = !scale;
    if (!scale) return;
    if (document.activeElement !== this.$("low")) this.$("low").value = String(Number(scale.low.toPrecision(4)));
    if (document.activeElement !== this.$("high")) this.$("high").value = String(Number(scale.high.toPrecision(4)));
    this.$("unit").textContent = labelOf(this.run, this.state.field)[1];
  }

  /** Return field, limits, time, file, version and days in words, for paper. */
  inWords(scale) {
    const { run, state } = this;
    const { file, made: [version, day] } = run.scene;
    const label = labelOf(run, state.field)?.[0] ?? fieldsOf(run)[state.field];
    const ends = scale ? [scale.low, scale.high].map((end) => withUnit(end, labelOf(run, state.field)[1], 4)) : [];
    const limits = scale ? ` from ${ends[0]} to ${ends[1]}${state.limits ? ", limits chosen by hand" : ""}` : "";
    const drawn = run.factor === 1 ? "" : `; drawn with ${factorInWords(run)}`;
    const today = new Date().toLocaleDateString("en-GB", { day: "numeric", month: "long", year: "numeric" });
    const written = `File ${file}${day ? ` of ${day}` : ""}, made by clast ${version}`;
    return `Colours: ${label}${limits}${drawn}; ${this.$("clock").textContent}. ${written}; printed on ${today}.`;
  }

  showChosen() {
    const { run, state } = this;
    const place = this.$("chosen");
    // paper has no use for an invitation to click
    place.parentElement.classList.toggle("controls", !isChosen(state));
    this.root.classList.toggle("has-chosen", isChosen(state));
    this.root.classList.toggle("has-line", Boolean(state.line));
    if (!isChosen(state)) {
      place.textContent = "Click a block or a joint for its numbers.";
      return;
    }
    const [heading, rows] = numbersOfChosen(run, state);
    const head = document.createElement("strong");
    head.textContent = heading;
    const table = document.createElement("table");
    for (const [name, value] of rows) {
      const row = table.insertRow();
      const cell = document.createElement("th");
      cell.scope = "row";
      cell.textContent = name;
      row.append(cell);
      row.insertCell().textContent = value;
    }
    place.replaceChildren(head, table);
  }

  showCurve() {
    const [kind, number] = this.$("curve").value.split(" ");
    const { run, state } = this;
    const own = {
      chosen: () => isChosen(state) && curvesOfChosen(run, state)[number],
      line: () => state.line && curveAlong(run, state),
    }[kind];
    const curve = own ? own() : run.scene.curves[Number(kind)];
    if (!curve) return;
    this.charts.show(curve, this.theme);
    this.$("charted").textContent = curve.name;
    this.$("chart").setAttribute("aria-label", `Chart: ${curve.name}`);
    this.charts.at(this.run.times[this.state.frame]);
  }

  applyTheme() {
    this.root.dataset.theme = this.theme === DARK ? "dark" : "light";
    this.showCurve();
    this.changed();
  }

  // --- address, pictures -----------------------------------------------------------------------

  /** Take over what the address says: #t=1.5&field=velocity&view=x,y,width,height&layers=bolts&block=3. */
  readAddress() {
    if (this.embedded || location.hash === this.written) return;
    const said = new URLSearchParams(location.hash.slice(1));
    const { run, state, view } = this;
    const time = Number(said.get("t"));
    if (said.has("t") && Number.isFinite(time)) state.frame = run.frameAt(time);
    const field = said.get("field");
    if (field in fieldsOf(run)) state.field = field;
    const [x, y, wide, tall] = (said.get("view") ?? "").split(",").map(Number);
    if (Number.isFinite(x + y + wide + tall) && wide > 0 && tall > 0) view.show(x, y, wide, tall);
    if (said.has("layers")) {
      const known = layersOf(run);
      state.layers = new Set(said.get("layers").split(",").filter((name) => known.includes(name)));
    }
    const limits = (said.get("limits") ?? "").split(",").map(Number);
    if (limits.length === 2 && limits[0] < limits[1]) state.limits = limits;
    const share = Number(said.get("share"));
    if (share > 0 && share <= 1) state.share = share;
    Object.assign(state, readChoice(run, said), { follow: said.has("follow") });
    const line = (said.get("line") ?? "").split(",").map(Number);
    if (line.length === 4 && line.every(Number.isFinite)) state.line = line;
    run.pressedPositive = said.has("compression");
    if (said.has("magnify")) this.magnify(Number(said.get("magnify")));
    if (said.has("theme")) this.theme = said.get("theme") === "dark" ? DARK : LIGHT;
    this.changed();
  }

  /** Write the state into the address; browsers allow it a few times a second. */
  writeAddress() {
    this.addressDue = null;
    if (this.playing || this.embedded) return;
    const { state, view, run } = this;
    const said = [
      ...(this.token ? [`token=${this.token}`] : []),
      `t=${Number(run.times[state.frame].toPrecision(9))}`,
      `field=${state.field}`,
      ...(view.box ? [] : [`view=${[view.x, view.y, view.wide, view.tall].map((one) => Number(one.toPrecision(6))).join(",")}`]),
      `layers=${[...state.layers].join(",")}`,
    ];
    if (state.limits) said.push(`limits=${state.limits.map((one) => Number(one.toPrecision(6))).join(",")}`);
    if (state.share) said.push(`share=${state.share}`);
    if (isChosen(state)) said.push(writtenChoice(state));
    if (state.follow) said.push("follow");
    if (state.line) said.push(`line=${state.line.map((one) => Number(one.toPrecision(6))).join(",")}`);
    if (run.factor !== 1) said.push(`magnify=${run.factor}`);
    if (run.pressedPositive) said.push("compression");
    if (this.themeAsked) said.push(`theme=${this.theme === DARK ? "dark" : "light"}`);
    const hash = `#${said.join("&")}`;
    if (hash === location.hash) return;
    this.written = hash;
    try {
      history.replaceState(null, "", hash);
    } catch {
      // a page within another page, or too many changes in a second
    }
  }

  /** Return title and time, as a picture has them. */
  caption() {
    const drawn = this.run.factor === 1 ? "" : `, ${factorInWords(this.run)}`;
    return `${this.run.scene.title}, ${this.$("clock").textContent}${drawn}`;
  }

  /** Return the drawing with its legend as an SVG text. */
  svg() {
    const { view } = this;
    const seen = this.seen(coloursOf(this.run, this.state)[1]);
    const pen = this.drawnInSvg(heightOfLegend(seen, view.width));
    drawLegend(pen, seen, view.width, view.height, this.caption());
    return pen.finish();
  }

  /** Return a pen that has drawn blocks and layers into an SVG, with some pixels left below them. */
  drawnInSvg(below) {
    const { run, view, state, theme } = this;
    const [colours, scale] = coloursOf(run, state);
    const pen = new SvgPen(view.width, view.height + below, theme.paper);
    pen.within(view.width, view.height, () => {
      drawBlocks(pen, run, view, state.frame, colours, theme);
      this.drawLayers(pen, scale);
    });
    return pen;
  }

  savePng() {
    const { view, theme } = this;
    const seen = this.seen(coloursOf(this.run, this.state)[1]);
    const dots = this.canvas.width / view.width;
    const whole = document.createElement("canvas");
    whole.width = this.canvas.width;
    whole.height = this.canvas.height + Math.round(dots * heightOfLegend(seen, view.width));
    const context = whole.getContext("2d");
    context.fillStyle = theme.paper;
    context.fillRect(0, 0, whole.width, whole.height);
    context.drawImage(this.canvas, 0, 0);
    context.drawImage(this.above, 0, 0);
    context.setTransform(dots, 0, 0, dots, 0, 0);
    drawLegend(new CanvasPen(context), seen, view.width, view.height, this.caption());
    whole.toBlob((blob) => this.save(blob, "png"));
  }

  save(blob, ending) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = `${this.run.scene.file.replace(/\.[^.]*$/, "")}.${ending}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }
}

/**
 * Show the page of a run within an element of another page; return what takes it away.
 * @param {HTMLElement} place @param {string} markup @param {string} style @param {any} scene
 */
export function embed(place, markup, style, scene) {
  const shadow = place.attachShadow({ mode: "open" });
  const sheet = document.createElement("style");
  sheet.textContent = style;
  const body = document.createElement("div");
  body.innerHTML = markup; // ours: what a case calls things stands in the scene
  shadow.append(sheet, body);
  const root = body.querySelector("main");
  root.classList.add("embedded");
  const page = new Page(root, scene);
  page.ready = page.start();
  const narrow = new ResizeObserver(() => root.classList.toggle("narrow", place.clientWidth < 700));
  narrow.observe(place);
  const seen = new IntersectionObserver(([entry]) => {
    page.ready.then(() => (entry.isIntersecting ? page.wake() : page.rest()));
  });
  seen.observe(root);
  place.clastPage = page;
  return () => {
    narrow.disconnect();
    seen.disconnect();
    page.ending.abort();
    page.play(false);
    page.rest();
  };
}

/** Show the page of the run whose data stand in the document, or come from its server. */
export async function main() {
  const root = document.querySelector("main");
  try {
    let scene = JSON.parse(document.getElementById("scene").textContent);
    const token = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
    const live = scene === null ? new Live(token) : null;
    if (live) root.querySelector('[data-part="counts"]').textContent = "waiting for the first frame";
    scene ??= await live.scene();
    const page = new Page(root, scene, live ? token : "");
    globalThis.clastPage = page;
    await page.start();
    if (live) await new LivePanel(page, live).follow();
  } catch (fault) {
    const say = root.querySelector('[data-part="fault"]');
    say.hidden = false;
    say.textContent = `The page cannot be shown: ${fault.message}`;
    throw fault;
  }
}
