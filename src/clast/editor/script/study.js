/** Studies of the case: the form that starts one, and its table and curve as they grow. */
const KINDS = { fos: "factor of safety", sweep: "sweep", montecarlo: "Monte Carlo" };
const NS = "http://www.w3.org/2000/svg", WIDTH = 420, HEIGHT = 220, EDGE = 34;

const made = (name, more = {}, ...inner) => {
  const one = Object.assign(document.createElement(name), more);
  one.append(...inner);
  return one;
};

/** The path of a value as `clast study --vary` has it: joint.bedding.friction_angle, bolt.1.pretension. */
export function pathOf(place) {
  return place.map((part) => (typeof part === "number" ? part + 1 : /^[^."\s,=]+$/.test(part) ? part : `"${part}"`)).join(".");
}

/** The form; ``start`` is called with what the server is to be asked for. */
export class StudyForm {
  constructor(root, { state, start }) {
    Object.assign(this, { root, state, start, picks: false });
    this.kind = made("select", { onchange: () => this.draw() }, ...Object.entries(KINDS).map(([value, name]) => new Option(name, value)));
    this.options = { by: ["strength"], tolerance: ["0.01"], vary: [], measure: [], fail: [""], runs: ["100"] };
    document.addEventListener("click", (e) => this.pick(e), true);
    this.draw();
  }

  draw() {
    const { options } = this, field = (name, label, k = 0, wide = false) => made("label", { className: "row" }, `${label} `, made("input", {
      type: "text", className: wide ? "wide" : "", value: options[name][k] ?? "", spellcheck: false, oninput: (e) => { options[name][k] = e.target.value; },
    }));
    const several = (name, label, button, add) => made("div", {}, ...options[name].map((_, k) => field(name, `${label} ${k + 1}`, k, true)),
      made("button", { type: "button", textContent: button, onclick: add, ariaPressed: name === "vary" ? String(this.picks) : null }));
    const isFactor = this.kind.value === "fos";
    const rows = isFactor ? [field("by", "by (strength, gravity, load NAME, pga)"), field("tolerance", "tolerance")] : [
      several("vary", "parameter", this.picks ? "click a value in the form ..." : "choose a parameter by clicking it", () => { this.picks = !this.picks; this.draw(); }),
      several("measure", "measure", "add a measure", () => { options.measure.push(this.measure()); this.draw(); }),
      field("fail", "fails where", 0, true), ...(this.kind.value === "montecarlo" ? [field("runs", "runs")] : []),
    ];
    document.body.classList.toggle("picks", this.picks);
    this.root.replaceChildren(made("label", { className: "row" }, "study ", this.kind), ...rows,
      made("button", { type: "button", id: "study-start", textContent: "Start the study", onclick: () => this.start({ kind: this.kind.value, options }) }));
  }

  /** A measure to begin with: how far the first measured point moves. */
  measure() {
    const name = this.state.content.measured_point?.[0]?.name;
    return name === undefined ? "" : `u${this.options.measure.length + 1} = displacement(${name})`;
  }

  /** Take the value whose row is clicked as a parameter, with values about its own. */
  pick(event) {
    const row = this.picks && event.target.closest?.("#forms [data-place]");
    if (!row) return;
    event.preventDefault();
    event.stopPropagation();
    const place = JSON.parse(row.dataset.place), value = place.reduce((inner, part) => inner?.[part], this.state.content);
    const short = (number) => Number(number.toPrecision(6));
    const values = typeof value !== "number" ? "[]" : this.kind.value === "sweep" ? `[${[0.8, 1, 1.2].map((by) => short(by * value)).join(", ")}]` : `normal(${value}, ${short(Math.abs(value) / 10)})`;
    this.options.vary.push(`${pathOf(place)} = ${values}`);
    this.picks = false;
    this.draw();
  }
}

/** Show the results of a study in an element: the table, and two of its columns as a curve. */
export function showStudy(root, { heads, rows }) {
  const numeric = heads.map((_, k) => k).filter((k) => heads[k] !== "run" && rows.some((row) => typeof row[k] === "number"));
  const before = [...root.querySelectorAll("select")].map((one) => one.value);
  const choice = (label, index, usual) => {
    const select = made("select", { ariaLabel: label, onchange: () => showStudy(root, { heads, rows }) }, ...numeric.map((k) => new Option(heads[k], heads[k])));
    select.value = numeric.some((k) => heads[k] === before[index]) ? before[index] : heads[usual] ?? "";
    return select;
  };
  const x = choice("across", 1, numeric[0]), y = choice("upwards", 0, numeric[1] ?? numeric[0]);
  const words = (one) => (typeof one === "number" ? Number(one.toPrecision(5)) : one === null ? "" : String(one));
  const table = made("table", {}, made("thead", {}, made("tr", {}, ...heads.map((head) => made("th", { textContent: head, scope: "col" })))),
    made("tbody", {}, ...rows.map((row) => made("tr", {}, ...row.map((one) => made("td", { textContent: words(one) }))))));
  const [across, upwards] = [x, y].map((one) => heads.indexOf(one.value));
  const points = rows.map((row) => [row[across], row[upwards]]).filter((point) => point.every((one) => typeof one === "number"));
  root.replaceChildren(made("div", { className: "curve" }, made("p", {}, y, " over ", x), curve(points, words)), made("div", { className: "rows-of-study", tabIndex: 0 }, table));
}

/** Points as a picture, joined in the order of x, with the ends of both axes. */
function curve(points, words) {
  const drawing = (name, given, text = "") => {
    const one = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(given)) one.setAttribute(key, value);
    one.textContent = text;
    return one;
  };
  const svg = drawing("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": "Curve of the study" });
  if (!points.length) return svg;
  const ends = [0, 1].map((k) => [Math.min(...points.map((one) => one[k])), Math.max(...points.map((one) => one[k]))]);
  const at = (one) => ends.map(([low, high], k) => {
    const share = high > low ? (one[k] - low) / (high - low) : 0.5;
    return k ? HEIGHT - EDGE - share * (HEIGHT - 2 * EDGE) : EDGE + share * (WIDTH - 2 * EDGE);
  });
  const sorted = [...points].sort((a, b) => a[0] - b[0]).map(at);
  svg.append(drawing("path", { d: `M${EDGE / 2} ${EDGE / 2}V${HEIGHT - EDGE / 2}H${WIDTH - EDGE / 2}`, class: "axis" }),
    drawing("polyline", { points: sorted.map((one) => one.join()).join(" "), class: "line" }), ...sorted.map(([cx, cy]) => drawing("circle", { cx, cy, r: 3 })),
    drawing("text", { x: EDGE, y: HEIGHT - 4 }, words(ends[0][0])), drawing("text", { x: WIDTH - EDGE, y: HEIGHT - 4, "text-anchor": "end" }, words(ends[0][1])),
    drawing("text", { x: EDGE / 2 + 4, y: HEIGHT - EDGE }, words(ends[1][0])), drawing("text", { x: EDGE / 2 + 4, y: EDGE }, words(ends[1][1])));
  return svg;
}
