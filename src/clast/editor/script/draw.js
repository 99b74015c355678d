/** Drawing in the section: tools, snaps, typed points, and handles of the table that is chosen. */
import { drawAxes } from "../../pictures/page/script/axes.js";
import { outline } from "../../pictures/page/script/draw_canvas.js";
import { copyTo, pasted } from "./copies.js";
import { baseOf, crossing, partOf, plain, pointText, shapesOf, shapeOf, sidesOf, withSurface } from "./handles.js";
import { digitsAt, gridStep, rounded, snapped, typed } from "./snaps.js";
import { drawArrow, drawHeld, drawSlope, drawStress, stressAt } from "./signs.js";
import { editsOf, roundedExtent, taken, toolsOf } from "./choices.js";

const NEAR = 9;
/** How far from something the pointer still means it, pixels. */
const [REACH, ARROW, FORCE] = [90, 70, 1e5];
/** Length of the handle of a direction and of the longest arrow, pixels; force of an arrow where there is none, N. */
const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const HELP = "Click chooses, handles are dragged; double click: a new point; Delete; n, arrows: by keys";
const FIELD = "12.5, 8   @1, 2   @3<60";
const key = (value) => JSON.stringify(value);
let gestures = 0;

/** The hand in a section: `state` is the window's, `hand` sends edits, `choose` shows the form of a table. */
export class Tools {
  constructor(section, { state, hand, choose }) {
    Object.assign(this, { section, state, hand, choose, clicks: [], shapes: [], pointer: null, held: null, grip: "", content: null });
    this.tools = toolsOf(state.schema);
    this.build();
    this.take("select");
    const { above } = section;
    above.addEventListener("pointerdown", (event) => this.press(event));
    for (const end of ["pointerup", "pointercancel"]) above.addEventListener(end, () => this.drop());
    above.addEventListener("dblclick", (event) => this.twice(event));
    addEventListener("keydown", (event) => this.key(event), true);
    document.addEventListener("copy", (event) => this.copy(event));
    document.addEventListener("paste", (event) => this.paste(event));
    section.tools = this;
  }

  build() {
    const bar = document.createElement("div");
    bar.className = "tools";
    bar.setAttribute("role", "toolbar");
    bar.setAttribute("aria-label", "Drawing");
    bar.innerHTML = `<span class="each"></span><select aria-label="Drawn table"></select>
      <label class="point">point <input type="text" aria-label="Point: x, y or @distance&lt;angle" placeholder="${FIELD.replace("<", "&lt;")}"></label>
      <label><input type="checkbox" class="snap" checked> snap</label><label><input type="checkbox" class="grid"> grid</label><output class="hint" role="status"></output>`;
    const of = (what) => bar.querySelector(what);
    Object.assign(this, { bar, choices: of("select"), field: of(".point input"), snaps: of(".snap"), grid: of(".grid"), hint: of("output") });
    of(".each").append(...this.tools.map(({ key: sign, name }) => {
      const button = Object.assign(document.createElement("button"), { type: "button", title: `key ${sign}` });
      button.innerHTML = `<kbd>${sign}</kbd> `;
      button.append(name);
      Object.assign(button.dataset, { tool: name });
      button.setAttribute("aria-keyshortcuts", sign);
      button.addEventListener("click", () => { this.take(name); this.section.above.focus(); });
      return button;
    }));
    this.choices.addEventListener("change", () => this.begin());
    this.grid.addEventListener("change", () => this.section.changed());
    this.section.root.querySelector(".stage").prepend(bar);
  }

  /** Take a tool by its name. */
  take(name) {
    this.use(this.tools.find((one) => one.name === name));
  }

  /** Ask for points of the section, each in words; `then` gets them. */
  pick(words, then) {
    this.use({ name: "", choices: [{ node: { properties: {} }, fixed: {}, steps: words.map((one, key) => ({ key, kind: "point", words: `${one}; click or type x, y` })), then }] });
    this.section.above.focus();
  }

  use(tool) {
    Object.assign(this, { tool, pointer: null });
    const { name } = tool;
    for (const button of this.bar.querySelectorAll("[data-tool]")) button.setAttribute("aria-pressed", String(button.dataset.tool === name));
    this.choices.replaceChildren(...this.tool.choices.map(({ label }, i) => new Option(label, i)));
    // the strip keeps its height: the drawing below must not jump
    this.choices.style.visibility = this.tool.choices.length < 2 ? "hidden" : "";
    this.field.parentElement.style.visibility = this.tool.choices.length ? "" : "hidden";
    const { domain } = this.state.content;
    if (this.tool.name === "outline" && (domain?.boundary || domain?.profile)) this.choices.value = "1"; // one domain alone
    this.begin();
  }

  get choice() { return this.tool.choices[Number(this.choices.value)] ?? null; }
  get isDrawing() { return this.choice !== null; }

  /** Begin to draw another thing of the same kind. */
  begin() {
    Object.assign(this, { clicks: [], grip: "", held: null });
    this.field.value = "";
    this.tell();
  }

  tell(words = "") {
    this.field.toggleAttribute("aria-invalid", Boolean(words));
    this.hint.title = this.hint.textContent = words || (this.isDrawing ? `${this.taken().step?.words ?? ""} (Backspace: back, Esc: leave)` : HELP);
    this.section.changed();
  }

  /** What the view means for sizes: reach of handles, m, its middle and width, force by metre of an arrow. */
  get seen() {
    const { view, origin } = this.section, { scale } = view;
    const middle = [view.x + origin[0], view.y + origin[1]], digits = digitsAt(scale);
    const { force, pressure } = this.held ?? this.largest(), arrow = ARROW / scale;
    return { reach: REACH / scale, wide: (view.width + view.height) / scale, middle, digits, force: force / arrow, pressure: pressure / arrow, holds: (at) => this.holds(at) };
  }

  /** The largest of all forces and of all pressures, N and Pa: their arrows are the longest. */
  largest() {
    const of = (table, key, size) => (this.state.content[table] ?? []).map((one) => size(...[one[key] ?? 0].flat().map(Math.abs))).filter(Number.isFinite);
    return { force: Math.max(0, ...of("point_load", "force", Math.hypot), ...of("line_load", "traction", Math.hypot)) || FORCE, pressure: Math.max(0, ...of("pressure", "value", Math.max)) || FORCE };
  }

  holds(at) {
    const { run, showsFile } = this.section;
    return Boolean(run) && !showsFile && run.blockAt(0, ...this.section.local(at)) >= 0;
  }

  /** Follow the newest content of the case. */
  changed() {
    if (this.content === this.state.content || !this.section.origin) return;
    this.content = this.state.content;
    this.renew();
    this.section.changed();
  }

  renew() {
    this.shapes = shapesOf(this.state.schema, this.state.content, this.seen);
    this.where = this.viewKey;
  }

  get viewKey() {
    const { view: { x, y, scale }, origin } = this.section;
    return `${x},${y},${scale},${origin}`;
  }

  get chosen() {
    const { chosen } = this.state;
    return chosen.length ? this.shapes.filter(({ place }) => key(place.slice(0, chosen.length)) === key(chosen) || (key(chosen.slice(0, place.length)) === key(place))) : [];
  }
  get handles() { return this.chosen.flatMap(({ handles }) => handles); }
  get gripped() { return this.handles.find((one) => nameOf(one) === this.grip); }

  taken(more = []) { return taken(this.state.content, this.choice, [...this.clicks, ...more], this.seen); }

  /** The point from which distances are told and typed. */
  get last() {
    const { values, step, points } = this.taken();
    const from = step?.kind === "extent" && baseOf(this.state.content, this.choice.node, values, step.key, this.seen)?.base;
    return from || points.at(-1) || this.clicks.findLast(({ at }) => at)?.at;
  }

  // --- places --------------------------------------------------------------------------------

  world(x, y) {
    const { view, origin } = this.section;
    return [view.worldX(x) + origin[0], view.worldY(y) + origin[1]];
  }

  /** The point that a place on the screen means; of what is dragged its own lines are none. */
  meant(x, y, own = null) {
    const { view } = this.section, at = this.world(x, y), digits = digitsAt(view.scale);
    if (!this.snaps.checked) return { at: at.map((one) => rounded(one, digits)), snap: "" };
    const others = this.shapes.filter(({ place }) => key(place) !== own), before = this.isDrawing ? this.taken().points : [];
    if (before.length > 2 && this.taken().step?.isClosed && Math.hypot(at[0] - before[0][0], at[1] - before[0][1]) * view.scale < NEAR) return { at: before[0], snap: "closes", closes: true };
    const mine = { points: before, closed: false };
    return snapped(at, {
      lines: [...others.flatMap(({ lines }) => lines), mine], dots: others.flatMap(({ dots }) => dots), joints: own ? [] : this.sides(), corners: own ? [] : this.corners ?? [],
      before, near: NEAR / view.scale, step: gridStep(view.scale), digits,
    });
  }

  /** Sides of all blocks, m. */
  sides() {
    const { run, origin } = this.section;
    if (!run || this.section.showsFile) return [];
    if (this.sidesOf === run) return this.known;
    const point = (v) => [run.start[2 * v] + origin[0], run.start[2 * v + 1] + origin[1]];
    this.sidesOf = run;
    this.known = Array.from({ length: run.blockCount }, (_, block) => {
      const [first, past] = [run.blockStart[block], run.blockStart[block + 1]];
      return Array.from({ length: past - first }, (__, k) => [point(first + k), point(k + 1 < past - first ? first + k + 1 : first)]);
    }).flat();
    this.corners = this.known.map(([point]) => point);
    return this.known;
  }

  over(x, y) {
    if (!this.section.origin) return;
    this.hover = this.world(x, y);
    this.pointer = this.isDrawing ? this.meant(x, y) : this.held ? this.held.to : null;
    this.section.above.style.cursor = this.isDrawing ? "crosshair" : this.handleAt(x, y) ? "move" : "";
    const last = this.isDrawing && this.last, place = this.section.root.querySelector(".place");
    if (this.pointer?.at) place.textContent = `x ${plain(this.pointer.at[0])} m, y ${plain(this.pointer.at[1])} m`;
    if (last) {
      const [dx, dy] = this.pointer.at.map((one, k) => one - last[k]), digits = digitsAt(this.section.view.scale);
      place.textContent += `; ${rounded(Math.hypot(dx, dy), digits)} m < ${rounded((180 / Math.PI) * Math.atan2(dy, dx), 1)}° from the last point`;
    }
    this.section.changed();
  }

  handleAt(x, y) {
    const far = ({ at }) => Math.hypot(...this.section.screen(at).map((one, k) => one - [x, y][k]));
    // points before the middles of sides, which come close where sides are short
    return this.handles.filter((one) => far(one) < NEAR).sort((a, b) => Number(Boolean(a.isMiddle || a.isWhole)) - Number(Boolean(b.isMiddle || b.isWhole)) || far(a) - far(b))[0];
  }

  /** The shape under a place on the screen: points and lines before areas. */
  shapeAt(x, y) {
    const at = this.world(x, y), near = NEAR / this.section.view.scale, away = (point) => Math.hypot(point[0] - at[0], point[1] - at[1]);
    const far = ({ lines, dots, arrows }) => Math.min(...dots.map(away), ...[...lines.filter((line) => !line.isFaint).flatMap(sidesOf), ...arrows].map((side) => distance(side, at)), Infinity);
    return [...this.shapes].reverse().map((shape) => [shape, far(shape) - (shape.dots.length ? near / 3 : 0)]).filter(([, one]) => one < near).sort(([, a], [, b]) => a - b)[0]?.[0];
  }

  // --- the pointer ---------------------------------------------------------------------------

  press(event) {
    if (this.isDrawing || event.button || !this.section.origin) return;
    const handle = this.handleAt(event.offsetX, event.offsetY);
    if (handle) this.held = { handle, own: key(this.chosen.find(({ handles }) => handles.includes(handle)).place), gesture: `draw ${++gestures}`, touched: new Set(), ...this.largest(), to: null };
  }

  /** What a drag does instead of moving the view. */
  rule() {
    return this.held && ((_, to) => this.drag(to));
  }

  drag({ x, y }) {
    const { held } = this, { handle } = held;
    this.section.view.moved();
    held.to = this.meant(x, y, held.own);
    if (held.isWaiting) return;
    if (!handle.isMiddle) return this.move(handle, held.to, held);
    // a middle that is dragged becomes a point first
    held.isWaiting = true;
    const point = { ...handle, isMiddle: false, of: (to) => [[handle.place, to]] };
    this.hand.edit(withSurface(this.state.content, { do: "insert", place: handle.place, toml: pointText(held.to.at) }), held.gesture).then((isDone) => {
      Object.assign(held, { handle: point, isWaiting: false });
      if (isDone) this.move(point, held.to, held); // which may have been let go meanwhile
    });
  }

  /** Send the values that a place of a handle means; numbers that have not changed keep their digits. */
  move(handle, { at, snap }, { gesture, touched }) {
    const { state: { content } } = this, edits = [], digits = this.seen.digits + (snap ? 3 : 0);
    for (const [place, value, extent] of handle.of(at)) {
      const next = extent ? roundedExtent(extent, value, digits) : handle.isWhole ? value.map((x) => rounded(x, digits)) : value, now = place.reduce((inner, part) => inner?.[part], content);
      const parts = Array.isArray(next) ? next.map((one, k) => [[...place, k], one, now?.[k]]) : [[place, next, now]];
      for (const [where, one, before] of parts) {
        if (one === before && !touched.has(key(where))) continue;
        touched.add(key(where));
        edits.push({ do: "set", place: where, toml: plain(one) });
      }
    }
    this.grip = nameOf(handle);
    if (edits.length) this.hand.move(edits, gesture);
  }

  drop() {
    if (!this.held) return;
    const { handle } = this.held;
    this.grip = nameOf({ ...handle, what: handle.isMiddle ? "" : handle.what });
    this.nudging = `draw ${++gestures}`;
    this.held = this.pointer = null;
    this.tellGrip();
  }

  tellGrip() {
    const one = this.gripped;
    this.tell(one ? `${one.what.replaceAll("_", " ")} of ${one.place[0].toString().replaceAll("_", " ")}: ${one.at.map(plain).join(", ")}` : "");
    this.field.removeAttribute("aria-invalid");
  }

  /** Take a click; says whether it meant something here. */
  click(x, y) {
    if (!this.section.origin) return false;
    if (this.isDrawing) {
      this.give(this.meant(x, y));
      return true;
    }
    if (this.handleAt(x, y)) return true;
    this.grip = "";
    const shape = this.shapeAt(x, y);
    if (shape) this.choose(shape.place.slice(0, typeof shape.place[1] === "number" || typeof shape.place[1] === "string" ? 2 : 1));
    this.tell();
    return Boolean(shape);
  }

  twice({ offsetX: x, offsetY: y }) {
    if (this.isDrawing) return this.end();
    const at = this.world(x, y), near = NEAR / this.section.view.scale;
    const side = this.handles.filter((one) => one.isMiddle).find((one) => distance(one.side, at) < near);
    if (side) this.hand.edit(withSurface(this.state.content, { do: "insert", place: side.place, toml: pointText(this.meant(x, y, key(side.place.slice(0, -2))).at) }));
  }

  // --- what is drawn -------------------------------------------------------------------------

  /** Take a point or a number for what is drawn. */
  give(click) {
    this.section.view.moved();
    if (click.closes) return this.end();
    const { step: now, points } = this.taken();
    if (now.kind !== "edges" && points.length && click.at && key(points.at(-1)) === key(click.at)) return;
    this.clicks.push(click);
    if (click.at && now.kind !== "extent") this.bring(click.at);
    const { values, step } = this.taken();
    if (!step) return this.finish(values);
    this.tell();
  }

  /** Show more where a point that was typed is out of sight. */
  bring(at) {
    const { section, section: { view } } = this, [x, y] = section.screen(at), [px, py] = section.local(at);
    if (x >= 0 && y >= 0 && x <= view.width && y <= view.height) return;
    const [[left, top], [right, low]] = [[0, 0], [view.width, view.height]].map(([sx, sy]) => [view.worldX(sx), view.worldY(sy)]);
    view.fit(Math.min(left, px), Math.min(low, py), Math.max(right, px), Math.max(top, py));
    view.moved();
  }

  /** End the line that is drawn. */
  end() {
    const { step, points } = this.taken();
    if (!step || !["line", "edges", "ends"].includes(step.kind) || step.kind === "ends") return this.tell(this.clicks.length ? "not complete yet" : "");
    if (step.kind === "line" && points.length < step.least) return this.tell(`an outline or line needs ${step.least} points: it has ${points.length}`);
    this.clicks.push({ ends: true });
    const { values, step: next } = this.taken();
    if (!next) this.finish(values);
    else this.tell();
  }

  finish(values) {
    const { then, steps } = this.choice;
    if (then) {
      this.take("select");
      return then(steps.map(({ key: step }) => values[step]));
    }
    const { place, edits } = editsOf(this.state, this.choice, values);
    const isOnce = this.choice.kind === "one" && this.taken().step === null && this.tool.name === "outline";
    this.begin();
    this.hand.edit(edits, `draw ${++gestures}`).then((isDone) => {
      if (!isDone) return;
      if (isOnce) this.take("select");
      this.choose(place);
    });
  }

  /** Take the last point back. */
  back() {
    while (this.clicks.at(-1)?.ends) this.clicks.pop();
    this.clicks.pop();
    this.tell();
  }

  type() {
    const { field } = this, text = field.value;
    if (!text.trim()) return this.end();
    const point = typed(text, this.last), { step } = this.taken();
    if (!point || (point.number !== undefined && step?.kind !== "extent")) return this.tell(`'${text}' is no point: write x, y or @distance<angle`);
    field.value = "";
    this.give(point);
  }

  // --- keys ----------------------------------------------------------------------------------

  key(event) {
    const { target } = event, isOurs = target === document.body || this.section.root.contains(target);
    if (!isOurs || event.ctrlKey || event.metaKey || event.altKey) return;
    if (target === this.field) return this.inField(event);
    if (target.matches("input[type=text], textarea, select, summary") || (event.key === "Enter" && target.matches("button"))) return;
    const way = this.isDrawing ? this.drawingKey(event) : this.selectKey(event);
    if (!way) return;
    event.preventDefault();
    event.stopPropagation();
    way();
  }

  inField(event) {
    const way = { Enter: () => this.type(), Escape: () => { this.field.value = ""; this.leave(); } }[event.key] ?? (event.key === "Backspace" && !this.field.value ? () => this.back() : null);
    if (!way) return;
    event.preventDefault();
    event.stopPropagation();
    way();
  }

  drawingKey(event) {
    const ways = { Enter: () => this.end(), Escape: () => this.leave(), Backspace: () => this.back(), Delete: () => this.back() };
    if (event.key in MOVES && this.clicks.at(-1)?.at) return () => this.nudgeLast(MOVES[event.key]);
    if (/^[\d@.,<+-]$/.test(event.key)) return () => { this.field.focus(); this.field.value += event.key; };
    return ways[event.key];
  }

  selectKey(event) {
    const tool = this.tools.find((one) => one.key === event.key), handle = this.gripped;
    if (tool) return () => this.take(tool.name);
    if (event.key.toLowerCase() === "n" && this.handles.length) return () => this.next(event.shiftKey ? -1 : 1);
    if (event.key in MOVES && handle && !handle.isMiddle) return () => this.nudge(handle, MOVES[event.key]);
    if (event.key === "r" && this.state.chosen[0] === "joint_set" && this.state.chosen.length === 2) return () => this.reseed();
    if (event.key === "Escape" && this.grip) return () => { this.grip = ""; this.tell(); };
    if (event.key === "Delete" || event.key === "Backspace") return () => this.remove(handle);
    return null;
  }

  /** Whether keys mean the drawing. */
  get isUsed() {
    const { activeElement: at } = document;
    return (at === document.body || this.section.root.contains(at)) && !at.matches("input, textarea") && getSelection().isCollapsed;
  }

  copy(event) {
    const { content, chosen } = this.state;
    if (!this.isUsed || chosen.length !== 2 || !Array.isArray(content[chosen[0]])) return;
    event.preventDefault();
    copyTo(event.clipboardData, this.state, chosen);
    this.tell("copied: Ctrl+V sets its copy to the pointer");
    this.field.removeAttribute("aria-invalid");
  }

  /** Add what was copied with its first point at the pointer. */
  paste(event) {
    const { hover, section, state: { content } } = this;
    const made = this.isUsed && pasted(event.clipboardData, this.state, (node, value) => {
      const from = shapeOf(content, node, value, [], this.seen).handles.find((one) => !one.isWhole && !one.isMiddle)?.at;
      return from && hover && this.meant(...section.screen(hover)).at.map((one, k) => one - from[k]);
    });
    if (!made) return;
    event.preventDefault();
    this.hand.edit(made.edits).then((isDone) => isDone && this.choose(made.place));
  }

  /** Leave what is drawn, and then the tool. */
  leave() {
    if (this.clicks.length) return this.begin();
    this.take("select");
    this.section.above.focus();
  }

  next(way) {
    const some = this.handles.filter((one) => !one.isMiddle), at = some.findIndex((one) => nameOf(one) === this.grip);
    this.grip = nameOf(some[(at + way + (at < 0 && way < 0 ? 1 : 0) + some.length) % some.length]);
    this.nudging = `draw ${++gestures}`;
    this.tellGrip();
  }

  /** Give the chosen joint set another seed: another realisation of the same statistics. */
  reseed() {
    this.hand.edit([{ do: "set", place: [...this.state.chosen, "seed"], toml: String(Math.floor(1e6 * Math.random())) }]);
  }

  nudge(handle, [dx, dy]) {
    const step = gridStep(this.section.view.scale);
    this.move(handle, { at: handle.at.map((x, k) => rounded(x + step * [dx, dy][k], 10)), snap: "grid" }, { gesture: this.nudging, touched: new Set() });
  }

  nudgeLast([dx, dy]) {
    const step = gridStep(this.section.view.scale), last = this.clicks.at(-1);
    this.clicks[this.clicks.length - 1] = { ...last, at: last.at.map((x, k) => rounded(x + step * [dx, dy][k], 10)) };
    this.tell();
  }

  /** Delete the chosen point of an outline or line, or the chosen table. */
  remove(handle) {
    const { chosen } = this.state;
    if (handle && typeof handle.item === "number") {
      if (handle.count <= handle.least) return this.tell(`an outline or line needs ${handle.least} points`);
      this.grip = "";
      return this.hand.edit(withSurface(this.state.content, { do: "remove", place: handle.place })).then(() => this.tell());
    }
    if (!handle && this.chosen.length) this.hand.edit([{ do: "remove", place: chosen }]).then((isDone) => isDone && this.choose([]));
  }

  // --- drawing -------------------------------------------------------------------------------

  /** Draw the tables that are not chosen, below marks of faults. */
  drawFile(pen) {
    const { section, section: { theme, view, run, origin } } = this;
    if (this.where !== this.viewKey) this.renew();
    if (this.grid.checked) this.drawGrid(pen);
    if (!run || section.showsFile) drawAxes(pen, { run: { scene: { origin } }, view, theme });
    if (section.showsFile || !run) drawSlope(pen, this.state.content, (point) => section.screen(point), theme);
    drawHeld(pen, this.state.content, (point) => section.screen(point), theme.ink);
    if (run && !section.showsFile) this.drawAwaited(pen);
    const chosen = new Set(this.chosen);
    for (const shape of this.shapes) if (!chosen.has(shape)) this.drawShape(pen, shape, theme.ink, 1.2, Boolean(section.showsFile) || !run);
  }

  /** Draw the table that is chosen with its handles, and what is being drawn. */
  drawHand(pen) {
    const stress = !this.isDrawing && this.state.chosen[0] === "in_situ" && this.hover && stressAt(this.state.content, this.hover[1]);
    if (stress) drawStress(pen, this.section.screen(this.hover), stress, this.section.theme);
    for (const shape of this.chosen) this.drawShape(pen, shape, this.section.theme.chosen, 3, true);
    if (!this.isDrawing) for (const handle of this.handles) this.drawHandle(pen, handle);
    if (this.isDrawing) this.drawPreview(pen);
    if (this.pointer?.snap) this.write(pen, this.pointer.at, this.pointer.snap);
  }

  /** Draw linings as thick as they will be, which come with a later stage. */
  drawAwaited(pen) {
    const { run, view, state: { frame }, theme } = this.section;
    const awaited = [...run.lined].filter((block) => run.isAwaited(frame, block)).map((block) => outline(run, view, run.start, block)).filter(Boolean);
    pen.areas(awaited, `${theme.paper}b0`);
    pen.lines(awaited.map((path) => [...path, path[0], path[1]]), theme.ink, 1, [3, 2]);
  }

  drawGrid(pen) {
    const { section: { view, theme } } = this, step = gridStep(view.scale);
    const [[left, top], [right, low]] = [this.world(0, 0), this.world(view.width, view.height)], lines = [];
    for (let k = Math.ceil(left / step); k * step <= right; k++) lines.push([[k * step, low], [k * step, top]]);
    for (let k = Math.ceil(low / step); k * step <= top; k++) lines.push([[left, k * step], [right, k * step]]);
    pen.lines(lines.map((ends) => ends.flatMap((point) => this.section.screen(point))), `${theme.faint}55`, 1);
  }

  drawShape(pen, { place, lines, dots, arrows }, colour, width, isWhole) {
    const { section } = this, of = (points) => points.flatMap((point) => section.screen(point));
    const path = ({ points, closed }) => of(closed ? [...points, points[0]] : points);
    if (isWhole) pen.lines(lines.filter((line) => !line.isEndless).map(path), colour, width);
    if (isWhole) pen.lines(lines.filter((line) => line.isEndless && !line.isFaint).map(path), colour, Math.min(width, 2), [8, 4]);
    if (isWhole && width > 2) pen.lines(lines.filter((line) => line.isFaint).map(path), colour, 1, [4, 4]);
    for (const [base, tip] of arrows) drawArrow(pen, section.screen(base), section.screen(tip), colour, Math.min(width, 2));
    for (const at of dots) {
      const [x, y] = section.screen(at);
      if (place[0] === "fixed_point") pen.areas([[x, y, x - 6, y + 10, x + 6, y + 10]], colour);
      else if (isWhole) pen.circle(x, y, 3.5, section.theme.paper, colour);
    }
  }

  drawHandle(pen, handle) {
    const { theme } = this.section, [x, y] = this.section.screen(handle.at), isGripped = nameOf(handle) === this.grip;
    if (handle.isWhole) return pen.lines([[x - 6, y, x + 6, y], [x, y - 6, x, y + 6]], theme.chosen, isGripped ? 4 : 2);
    if (handle.isMiddle) return pen.circle(x, y, 2, theme.chosen, theme.chosen);
    if (handle.from) pen.lines([[...this.section.screen(handle.from), x, y]], theme.chosen, 1, [3, 3]);
    pen.circle(x, y, isGripped ? 6 : 4.5, isGripped ? theme.chosen : theme.paper, theme.chosen);
  }

  drawPreview(pen) {
    const { theme } = this.section, { choice, state: { content } } = this, more = this.pointer ? [this.pointer] : [];
    const { values, step, points } = this.taken(more);
    const shape = shapeOf(content, choice.node, values, [], this.seen);
    this.drawShape(pen, shape, theme.chosen, 2.5, true);
    pen.lines(shape.handles.filter(({ from }) => from).map(({ at, from }) => [from, at].flatMap((point) => this.section.screen(point))), theme.chosen, 1.5, [3, 3]);
    if (step?.kind === "edges" || choice.steps.some(({ kind }) => kind === "edges")) this.drawPart(pen, values);
    if (choice.steps[0].kind === "pick") this.drawPicked(pen, values);
    for (const { at } of this.clicks) if (at) pen.circle(...this.section.screen(at), 4, theme.paper, theme.chosen);
    const cross = step?.kind === "line" && points.length > 3 && crossing({ points, closed: false });
    if (cross) {
      pen.circle(...this.section.screen(cross), 6, theme.paper, "#d32f2f");
      this.write(pen, cross, `crosses itself at ${cross.map((x) => rounded(x, this.seen.digits)).join(", ")}`, "#d32f2f");
    }
    this.cross = cross || null;
  }

  /** The outline that is picked, and the part of it from its first to its last point. */
  drawPicked(pen, { opening }) {
    const shape = opening && this.shapes.find(({ place }) => place[0] === "opening" && this.state.content.opening[place[1]]?.name === opening);
    if (shape) this.drawShape(pen, shape, this.section.theme.chosen, 2, true);
  }

  drawPart(pen, { opening, part }) {
    const line = part && partOf(this.state.content, opening, part);
    if (line) this.drawShape(pen, { place: [], lines: [{ points: line, closed: false }], dots: line, arrows: [] }, this.section.theme.chosen, 5, true);
  }

  write(pen, at, text, colour = this.section.theme.chosen) {
    const [x, y] = this.section.screen(at), isRight = x > 0.7 * this.section.view.width;
    pen.text(x + (isRight ? -12 : 12), y - 14, text, colour, this.section.theme.paper, isRight ? "end" : "start");
  }
}

const nameOf = ({ place, what }) => key([place, what === "middle" || what === "all" ? what : ""]);

function distance([[ax, ay], [bx, by]], [x, y]) {
  const [ux, uy] = [bx - ax, by - ay], length = ux * ux + uy * uy, share = length ? Math.max(0, Math.min(1, ((x - ax) * ux + (y - ay) * uy) / length)) : 0;
  return Math.hypot(ax + share * ux - x, ay + share * uy - y);
}
