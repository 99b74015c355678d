/** Drawings and pictures under the section: how they are shown and placed, and lines of them taken over into the case. */
import { namesOf } from "./form.js";
import { blank, kindOf, tablesOf, toml, variants } from "./values.js";
const { html, render } = htmPreact;

const COLOURS = ["#00838f", "#6a3d9a", "#b15928", "#2e7d32", "#1f78b4", "#ad1457"];
const NEAR = 10;
/** How far from a line a click still means it, pixels. */
const WIDTH = 100;
/** Width of a picture that nobody has placed in a section with nothing else, m. */
const NOT_ALONE = ["within", "part"];
/** Outlines and lines by which no table begins. */

/** What a line can be taken over as: `table` and `key` that get it, and their `geometry`. */
export function rolesOf(schema) {
  return Object.entries(schema.properties).flatMap(([table, one]) => {
    const kind = tablesOf(schema, one), forms = variants(schema, one);
    if (kind !== "list" && kind !== "one") return [];
    const list = forms.find((form) => kindOf(form) === "list");
    const node = (kind === "list" ? variants(schema, list.items) : forms).find((form) => kindOf(form) === "table");
    const of = (key) => node.properties[key]?.["x-clast"]?.geometry;
    const keys = Object.keys(node.properties).filter((key) => (["polygon", "polyline"].includes(of(key)) && !NOT_ALONE.includes(key)) || (of(key) === "point" && key === "at"));
    const found = keys.map((key) => ({ table, key, kind, node, geometry: of(key) }));
    if (of("start") === "point" && of("end") === "point") found.push({ table, key: "start", kind, node, geometry: "ends" });
    return found.map((role) => ({ ...role, label: `${table}${found.length > 1 ? ` ${role.key}` : ""}`.replaceAll("_", " ") }));
  });
}

/** Changes of a case that take lines over, as one step. */
export function edits({ schema, content }, role, lines) {
  const { table, key, kind, node, geometry } = role, held = content[table], taken = new Set(Array.isArray(held) ? held.map((one) => one?.name) : []);
  return lines.map((line, i) => {
    const { points } = line, own = geometry === "ends" ? { start: points[0], end: points.at(-1) } : { [key]: geometry === "point" ? points[0] : points };
    if (kind === "one" && held) return { do: "set", place: [table, key], toml: toml(own[key]) };
    const named = (inner) => namesOf({ content }, inner).find((name) => name.toLowerCase() === line.name.toLowerCase());
    const like = (inner) => named(inner) ?? namesOf({ content }, inner)[0];
    const value = { ...blank(schema, node, like), ...own };
    for (const [name, values] of Object.entries(node.properties[key]["x-clast"].when ?? {})) value[name] = values[0];
    for (const [name, inner] of Object.entries(node.properties)) if (["joint", "rock"].includes(name) && named(inner)) value[name] = named(inner);
    if ("name" in value) {
      const base = line.name || table;
      for (let n = 1; ; n++) if (!taken.has(value.name = n === 1 && line.name ? base : `${base} ${n}`)) break;
      taken.add(value.name);
    }
    return kind === "one" ? { do: "set", place: [table], toml: toml(value) } : { do: "insert", place: [table, (held?.length ?? 0) + i], toml: toml(value) };
  });
}

/** The similarity [A, B, x, y] by which two points of a picture come to their places: x = A px + B py + x, y = B px - A py + y. */
export function placing([[p, q], [r, s]], [[x, y], [u, v]]) {
  const [dp, dq, dx, dy] = [r - p, q - s, u - x, v - y], square = dp * dp + dq * dq;
  const [A, B] = [(dx * dp + dy * dq) / square, (dy * dp - dx * dq) / square];
  return [A, B, x - A * p - B * q, y - B * p + A * q];
}

/** Distance of a point of the screen from a line, pixels. */
function distance(path, x, y) {
  let least = Math.hypot(path[0] - x, path[1] - y);
  for (let k = 2; k < path.length; k += 2) {
    const [px, py, dx, dy] = [path[k - 2], path[k - 1], path[k] - path[k - 2], path[k + 1] - path[k - 1]];
    const t = Math.max(0, Math.min(1, ((x - px) * dx + (y - py) * dy) / (dx * dx + dy * dy || 1)));
    least = Math.min(least, Math.hypot(px + t * dx - x, py + t * dy - y));
  }
  return least;
}

/** The underlays of a section; `ask` asks the server for JSON, `fetched` for an answer; `state`, `hand` and `goTo` are the window's. */
export class Underlays {
  constructor(section, tools) {
    Object.assign(this, { section, ...tools, list: [], drawings: {}, files: [], said: "", role: -1, turn: 0, last: Promise.resolve(), picking: null, images: new Map(), begun: new Map(), fields: new Map(), stamps: new Map() });
    this.roles = rolesOf(this.state.schema);
    const place = document.createElement("details");
    place.innerHTML = "<summary>Underlay</summary>";
    const layers = section.root.querySelector(".legend details");
    layers.before(place);
    layers.name = place.name = "panels"; // one would cover the other
    this.panel = document.createElement("div");
    Object.assign(this.panel, { className: "under", hidden: true });
    const row = document.createElement("div"), canvases = section.root.querySelector(".canvases");
    row.className = "beside";
    canvases.replaceWith(row);
    row.append(canvases, this.panel);
    place.addEventListener("toggle", () => { this.panel.hidden = !place.open; });
    section.under = this;
    this.load();
  }

  /** Ask for the underlays, or keep them as they are here, one request after the other; the newest answer is shown. */
  load(body) {
    const turn = ++this.turn;
    this.last = this.last.then(() => this.answered(body, turn));
    return this.last;
  }

  async answered(body, turn) {
    let said = "", answer = null;
    try {
      answer = await this.ask("/underlays", body);
      if (answer.refused) throw new Error(answer.refused); // of a window that looks on
    } catch (error) {
      said = error.message;
      answer = await this.ask("/underlays").catch(() => null); // what is kept goes on
    }
    if (!answer || turn !== this.turn) return;
    Object.assign(this, { list: answer.underlays, files: answer.files, said: said || answer.trouble, seen: JSON.stringify(answer.under) });
    for (const [i, { file }] of this.list.entries()) await this.open(file, String(answer.under[i + 1]));
    const { section } = this, first = this.points()[0];
    if (first && !section.origin) {
      section.origin = first;
      section.fit();
    }
    this.show();
  }

  /** Ask again where a file, or the list of them, is another than at the last answer. */
  follow(stamps) {
    const now = JSON.stringify(stamps);
    if (this.seen && now !== this.seen && now !== this.followed) this.load();
    this.followed = now;
  }

  keep(list = this.list) {
    this.list = list;
    this.show();
    return this.load({ underlays: list });
  }

  /** Change one underlay, and keep it where nothing more of the same comes. */
  set(one, change, isLast = true) {
    Object.assign(one, change);
    if (isLast) this.keep(); else this.show();
  }

  isPicture(file) { return /\.(png|jpe?g)$/i.test(file); }

  /** Get the lines or the picture of a file that is not here yet as its stamp says it is. */
  async open(file, stamp) {
    if (this.stamps.get(file) === stamp) return;
    this.stamps.set(file, stamp);
    try {
      const answer = await this.fetched(`/under?${encodeURIComponent(file)}`), isLines = answer.headers.get("Content-Type") === "application/json";
      this.drawings[file] = isLines ? await answer.json() : {};
      this.images.delete(file);
      if (isLines) return;
      const blob = await answer.blob(), reader = new FileReader();
      const url = await new Promise((done) => { reader.onload = () => done(reader.result); reader.readAsDataURL(blob); });
      this.images.set(file, { bitmap: await createImageBitmap(blob), url });
    } catch (error) {
      this.drawings[file] = { trouble: error.message };
    }
  }

  // --- what is drawn ------------------------------------------------------------------------------

  /** Lines of an underlay that are shown. */
  lines(one, what = "lines") {
    return one.shown ? (this.drawings[one.file]?.[what] ?? []).filter(({ layer }) => !one.hidden.includes(layer)) : [];
  }

  layers(one) { return [...new Set((this.drawings[one.file]?.lines ?? []).map(({ layer }) => layer))]; }

  /** Points of all that is shown, m. */
  points() {
    return this.list.flatMap((one) => {
      const size = this.images.get(one.file)?.bitmap;
      if (!size || !one.shown) return this.lines(one).flatMap(({ points }) => points);
      const [A, B, x, y] = this.placeOf(one);
      return [[0, 0], [size.width, 0], [0, size.height], [size.width, size.height]].map(([p, q]) => [A * p + B * q + x, B * p - A * q + y]);
    });
  }

  /** Where a picture lies; one that nobody has placed lies in the middle of what is seen. */
  placeOf(one) {
    if (one.pixels && one.points) return placing(one.pixels, one.points);
    const { view, origin } = this.section, { width, height } = this.images.get(one.file).bitmap;
    if (!this.begun.has(one.file)) this.begun.set(one.file, origin ? [0.8 * view.width / view.scale, view.x + origin[0], view.y + origin[1]] : [WIDTH, WIDTH / 2, (WIDTH * height) / width / 2]);
    const [wide, x, y] = this.begun.get(one.file), A = wide / width;
    return [A, 0, x - wide / 2, y + (A * height) / 2];
  }

  draw(pen) {
    const { section } = this;
    for (const one of [...this.list].sort((a, b) => this.isPicture(b.file) - this.isPicture(a.file))) {
      const image = this.images.get(one.file), alpha = Math.round(255 * one.opacity).toString(16).padStart(2, "0"), layers = this.layers(one);
      if (image && one.shown) this.drawImage(pen, image, this.placeOf(one), one.opacity);
      for (const { layer, points } of this.lines(one)) {
        const colour = `${COLOURS[layers.indexOf(layer) % COLOURS.length]}${alpha}`;
        if (points.length > 1) pen.lines([points.flatMap((point) => section.screen(point))], colour, 1.5);
        else pen.circle(...section.screen(points[0]), 3, section.theme.paper, colour);
      }
    }
  }

  drawImage(pen, { bitmap, url }, [A, B, x, y], opacity) {
    const { section } = this, { scale } = section.view, turn = [scale * A, -scale * B, scale * B, scale * A, ...section.screen([x, y])];
    if (pen.parts) return pen.parts.push(`<image href="${url}" width="${bitmap.width}" height="${bitmap.height}" opacity="${opacity}" transform="matrix(${turn})"/>`);
    pen.context.save();
    pen.context.transform(...turn);
    pen.context.globalAlpha = opacity;
    pen.context.drawImage(bitmap, 0, 0);
    pen.context.restore();
  }

  // --- clicks -------------------------------------------------------------------------------------

  /** Use a click on the section; false where it is for others. */
  take(x, y) {
    if (this.picking && this.images.get(this.picking.file)) return this.picked(x, y);
    const role = this.roles[this.role];
    if (!role) return false;
    const near = (what) => this.list.filter((one) => !one.locked).flatMap((one) => this.lines(one, what))
      .map((line) => ({ line, far: distance(line.points.concat(what === "outlines" ? [line.points[0]] : []).flatMap((point) => this.section.screen(point)), x, y) }))
      .filter(({ far }) => far < NEAR).sort((a, b) => a.far - b.far)[0]?.line;
    const line = near(role.geometry === "polygon" ? "outlines" : "lines");
    if (line) this.takeOver([line]);
    else this.tell(role.geometry === "polygon" && near("lines") ? "This line is not part of a closed outline." : "There is no line of an unlocked underlay there.");
    return true;
  }

  async takeOver(lines) {
    const role = this.roles[this.role], changes = edits(this.state, role, lines), done = await this.hand.edit(changes);
    if (done) this.goTo(changes.at(-1).place);
    this.tell(done ? `Taken over as ${role.label}: ${lines.length === 1 ? `${lines[0].points.length} points` : `${lines.length} lines`}.` : this.state.refused);
  }

  /** Take a click as a point of a picture. */
  picked(x, y) {
    const { file, i } = this.picking, one = this.list.find((other) => other.file === file), { section: { view, origin } } = this, [A, B, left, top] = this.placeOf(one);
    const [dx, dy] = [view.worldX(x) + origin[0] - left, view.worldY(y) + origin[1] - top], square = A * A + B * B;
    const pixel = [(A * dx + B * dy) / square, (B * dx - A * dy) / square].map((value) => value.toFixed(1));
    this.picking = null;
    this.field(one, "pixels", i, 0, pixel[0]);
    this.field(one, "pixels", i, 1, pixel[1]);
    this.panel.querySelector(`[data-field="${one.file} points ${i} 0"]`)?.focus();
    return true;
  }

  /** Note a coordinate of a picture's points; all eight place it. */
  field(one, which, i, k, value) {
    const held = this.typed(one);
    held[which][i][k] = String(value);
    const numbers = { pixels: held.pixels.map((pair) => pair.map(Number)), points: held.points.map((pair) => pair.map(Number)) };
    const isWhole = [...held.pixels, ...held.points].flat().every((text) => text.trim() !== "" && Number.isFinite(Number(text)));
    const differ = Object.values(numbers).every(([a, b]) => a[0] !== b[0] || a[1] !== b[1]);
    if (isWhole && differ) this.set(one, numbers);
    else this.tell(isWhole ? "Two different points are needed." : "");
  }

  typed(one) {
    const pair = () => [["", ""], ["", ""]];
    if (!this.fields.has(one.file)) this.fields.set(one.file, { pixels: one.pixels ?? pair(), points: one.points ?? pair() });
    return this.fields.get(one.file);
  }

  // --- the list -----------------------------------------------------------------------------------

  tell(said) {
    this.said = said;
    this.show();
  }

  show() {
    const add = (e) => {
      e.preventDefault();
      const { value } = e.target.file;
      if (value && !this.list.some(({ file }) => file === value)) this.keep([...this.list, { file: value, opacity: this.isPicture(value) ? 0.5 : 1, shown: true, locked: false, hidden: [] }]);
      e.target.reset();
    };
    render(html`<form onSubmit=${add}><label>File in the folder of the case <input name="file" list="under-files" autocomplete="off" /></label> <button>add</button>
      <datalist id="under-files">${this.files.map((file) => html`<option value=${file} />`)}</datalist></form>
      <p role="status" class="said">${this.said}</p>
      ${this.list.some((one) => !this.isPicture(one.file)) && html`<label>Lines clicked become <select value=${this.role} onChange=${(e) => { this.role = Number(e.target.value); this.tell(""); }}>
        <option value="-1">nothing: clicks choose blocks</option>${this.roles.map(({ label }, i) => html`<option key=${i} value=${i}>${label}</option>`)}</select></label>`}
      ${this.list.map((one) => html`<fieldset key=${one.file}><legend>${one.file}</legend>${this.entry(one)}</fieldset>`)}`, this.panel);
    this.section.changed();
  }

  entry(one) {
    const { drawings: { [one.file]: drawing = {} }, picking } = this, layers = this.layers(one), box = (name) => html`<label><input type="checkbox" checked=${one[name]} onChange=${(e) => this.set(one, { [name]: e.target.checked })} /> ${name}</label>`;
    const hide = (layer) => (one.hidden.includes(layer) ? one.hidden.filter((other) => other !== layer) : [...one.hidden, layer]);
    return html`${drawing.trouble && html`<p class="fault">${drawing.trouble}</p>`}
      <p class="row">${box("shown")}${box("locked")}<label>opacity <input type="range" min="0.05" max="1" step="0.05" value=${one.opacity}
        onInput=${(e) => this.set(one, { opacity: Number(e.target.value) }, false)} onChange=${() => this.keep()} /></label>
      <button onClick=${() => this.zoomTo(one)}>zoom to it</button><button onClick=${() => { for (const held of [this.images, this.fields, this.begun, this.stamps]) held.delete(one.file); this.picking = null; this.keep(this.list.filter((other) => other !== one)); }}>remove</button></p>
      ${layers.map((layer, i) => html`<p class="row" key=${layer}><label><input type="checkbox" checked=${!one.hidden.includes(layer)} onChange=${() => this.set(one, { hidden: hide(layer) })} />
        <i class="patch" style=${{ background: COLOURS[i % COLOURS.length] }}></i> ${layer || "no layer"}</label>
        ${this.role >= 0 && !one.locked && html`<button onClick=${() => this.all(one, layer)}>take all</button>`}</p>`)}
      ${drawing.notes?.map((note) => html`<p class="help" key=${note}>${note}</p>`)}
      ${this.isPicture(one.file) && !one.locked && [0, 1].map((i) => html`<p class="row" key=${i}>point ${i + 1}
        <button aria-pressed=${picking?.file === one.file && picking.i === i} onClick=${() => { this.picking = { file: one.file, i }; this.tell(`Click point ${i + 1} of ${one.file} in the drawing, then type its place.`); }}>click it</button>
        <br />${["pixels", "points"].map((which) => html`${which === "pixels" ? "pixel" : " at"} ${["x", "y"].map((name, k) => html`<input type="text" inputmode="decimal" key=${which + name}
          aria-label=${which === "pixels" ? `Pixel ${name} of point ${i + 1}` : `${name} of point ${i + 1}, m`} data-field=${`${one.file} ${which} ${i} ${k}`}
          value=${this.typed(one)[which][i][k]} onChange=${(e) => this.field(one, which, i, k, e.target.value)} />`)}`)} m</p>`)}`;
  }

  /** Take all lines of a layer over. */
  all(one, layer) {
    const lines = this.lines({ ...one, shown: true, hidden: [] }, this.roles[this.role].geometry === "polygon" ? "outlines" : "lines").filter((line) => line.layer === layer);
    if (lines.length) this.takeOver(this.roles[this.role].kind === "one" ? lines.slice(0, 1) : lines);
    else this.tell(`Layer ${layer} has no closed outline.`);
  }

  zoomTo(one) {
    const list = this.list, { section } = this;
    this.list = [{ ...one, shown: true }];
    const local = this.points().map((point) => section.local(point)), [xs, ys] = [0, 1].map((k) => local.map((point) => point[k]));
    this.list = list;
    if (xs.length) section.view.fit(Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys));
    section.changed();
  }
}
