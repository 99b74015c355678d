/** The strip of stages at the foot of the section: in order, each with what it brings; the drawing shows the chosen one. */
import { toml } from "./values.js";

const TABLES = ["bolt", "bolt_pattern", "lining", "viscous_boundary"];
/** Tables whose entries name the stage that they come with. */
const LOADS = ["point_load", "line_load", "pressure", "fill", "load_train", "water"];
const HELD = { opening: "excavate", well: "install", ...Object.fromEntries(LOADS.map((table) => [table, "loads"])) };
/** Tables whose entries a stage names -> the key of the stage. */
const BRINGS = [["excavate", "digs"], ["install", "installs"], ["loads", "loads"], ["flow_boundary", "heads at"], ["joint", "joints"]];
const OFFERS = [
  ["excavate", ({ opening }) => namesOf(opening), "dug here ..."],
  ["install", ({ bolt = [], bolt_pattern = [], well = [] }) => unstaged([bolt, bolt_pattern, well].flat()).flatMap((one) => [one.name, one.kind]), "installed from here ..."],
  ["loads", (content) => [...LOADS.flatMap((table) => namesOf(content[table])), ...Object.keys(content.amplitude ?? {})], "acts from here ..."],
];
/** Keys of a stage, the names that they may have, and what is offered in words. */

const unstaged = (bolts) => bolts.filter((one) => one && one.stage === undefined);

function namesOf(table) {
  return Array.isArray(table) ? table.map((one) => one?.name).filter((name) => typeof name === "string") : [];
}

/** Show stages in an element; a click on one chooses its form and shows in the section what is there by then. */
export class Strip {
  constructor(root, { state, hand, choose, section }) {
    Object.assign(this, { root, state, hand, choose, section, number: -1, shown: "" });
    root.addEventListener("keydown", (e) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
      if (by && e.target.matches("ol button")) this.show(this.number + by, true);
    });
  }

  get stages() {
    return Array.isArray(this.state.content.stage) ? this.state.content.stage : [];
  }

  /** Choose a stage by its number, from 0; -1 is the start. */
  show(number, takesFocus = false) {
    this.number = Math.max(-1, Math.min(number, this.stages.length - 1));
    this.choose(this.number < 0 ? [] : ["stage", this.number]);
    if (takesFocus) this.root.querySelectorAll("ol button")[this.number + 1].focus();
  }

  /** Draw it where the stages, or the chosen one, have changed. */
  draw() {
    const { chosen, content } = this.state, { stages } = this;
    if (chosen[0] === "stage" && typeof chosen[1] === "number") this.number = chosen[1];
    this.number = Math.min(this.number, stages.length - 1);
    if (this.section.state.frame !== this.number + 1 && this.section.run) {
      this.section.state.frame = Math.max(0, Math.min(this.number + 1, this.section.run.frameCount - 1));
      this.section.changed();
    }
    const now = JSON.stringify([this.number, content, this.state.looks_on]);
    if (now === this.shown) return;
    this.shown = now;
    this.root.hidden = !("time" in content);
    const list = document.createElement("ol");
    list.append(this.cell(-1, { name: "start" }), ...stages.map((stage, k) => this.cell(k, stage)));
    const at = [...this.root.querySelectorAll("ol button")].indexOf(document.activeElement), tool = document.activeElement?.dataset?.tool;
    this.root.replaceChildren(list, ...(this.state.looks_on ? [] : [this.tools()]));
    if (at >= 0) list.querySelectorAll("button")[Math.min(at, stages.length)].focus();
    if (tool && this.root.contains(document.activeElement) === false) this.root.querySelector(`[data-tool="${tool}"]`)?.focus();
  }

  cell(number, stage) {
    const item = document.createElement("li"), button = document.createElement("button"), name = document.createElement("b");
    name.textContent = number < 0 ? "start" : `${number + 1} ${stage?.name ?? ""}`;
    button.append(name, ...this.brought(stage ?? {}).map((line) => Object.assign(document.createElement("small"), { textContent: line })));
    if (number === this.number) button.setAttribute("aria-current", "true");
    button.addEventListener("click", () => this.show(number));
    const dragged = (e) => e.dataTransfer.types.find((type) => type.startsWith("clast/") && [...TABLES, ...Object.keys(HELD)].includes(type.slice(6)));
    if (stage?.name !== undefined && number >= 0) {
      item.addEventListener("dragover", (e) => { if (dragged(e) && !this.state.looks_on) e.preventDefault(); });
      item.addEventListener("drop", (e) => { e.preventDefault(); this.bring(JSON.parse(e.dataTransfer.getData(dragged(e))), number); });
    }
    item.append(button);
    return item;
  }

  /** Let an entry of the case come with a stage, and with no other any more. */
  bring([table, k], number) {
    const entry = this.state.content[table]?.[k], { name } = this.stages[number], saysIt = TABLES.includes(table), key = HELD[table] ?? "install";
    const edits = saysIt ? [{ do: "set", place: [table, k, "stage"], toml: toml(name) }] : [];
    if (!saysIt && entry?.name === undefined) return;
    this.stages.forEach((stage, at) => {
      const held = Array.isArray(stage?.[key]) ? stage[key] : [], place = ["stage", at, key], isHere = at === number && !saysIt;
      if (held.includes(entry?.name) === isHere) return;
      const now = isHere ? [...held, entry.name] : held.filter((one) => one !== entry.name);
      edits.push(now.length ? { do: "set", place, toml: toml(now) } : { do: "remove", place });
    });
    this.hand.edit(edits).then((done) => done && this.show(number));
  }

  /** What a stage brings, a line each. */
  brought(stage) {
    const own = BRINGS.map(([key, word]) => [word, Array.isArray(stage[key]) ? stage[key] : Object.keys(stage[key] ?? {})]);
    for (const table of TABLES) {
      const some = (Array.isArray(this.state.content[table]) ? this.state.content[table] : []).filter((one) => stage.name !== undefined && one?.stage === stage.name);
      if (some.length) own.push([table.replace("_", " "), some.map((one, k) => one.name ?? `${k + 1}`)]);
    }
    if (stage.ground_motion === true) own.push(["the ground moves", []]);
    return own.filter(([word, names]) => names.length || word.startsWith("the")).map(([word, names]) => `${word} ${names.join(", ")}`.trim());
  }

  tools() {
    const { number, stages } = this, tools = document.createElement("p"), stage = stages[number];
    const button = (tool, text, title, isOff, act) => {
      const one = Object.assign(document.createElement("button"), { textContent: text, title, disabled: isOff });
      Object.assign(one.dataset, { tool });
      one.setAttribute("aria-label", title);
      one.addEventListener("click", act);
      return one;
    };
    tools.append(button("add", "+ stage", "Add a stage behind this one", false, () => this.add()));
    if (!stage) return tools;
    const name = Object.assign(document.createElement("input"), { type: "text", value: stage.name ?? "" });
    name.setAttribute("aria-label", "Name of the stage");
    name.dataset.tool = "name";
    name.addEventListener("change", () => this.rename(name.value.trim()));
    tools.append(name,
      button("earlier", "◀", "Earlier", number === 0, () => this.move(number - 1, number - 1)),
      button("later", "▶", "Later", number === stages.length - 1, () => this.move(number, number + 1)),
      button("remove", "×", "Remove this stage", false, () => this.hand.edit([{ do: "remove", place: ["stage", number] }]).then(() => this.show(number - 1))));
    for (const [key, offered, words] of OFFERS) {
      const held = Array.isArray(stage[key]) ? stage[key] : [], taken = new Set(stages.flatMap((one) => (key === "excavate" ? one?.[key] ?? [] : [])));
      const free = [...new Set(offered(this.state.content))].filter((one) => one && !held.includes(one) && !taken.has(one));
      if (!free.length) continue;
      const select = document.createElement("select");
      select.setAttribute("aria-label", words);
      select.dataset.tool = key;
      select.append(new Option(words, ""), ...free.map((one) => new Option(one, one)));
      select.addEventListener("change", () => this.hand.edit([{ do: "set", place: ["stage", number, key], toml: toml([...held, select.value]) }]));
      tools.append(select);
    }
    return tools;
  }

  add() {
    const names = this.stages.map((one) => one?.name), at = this.number + 1;
    const free = Array.from({ length: names.length + 1 }, (_, k) => `stage ${names.length + k + 1}`).find((name) => !names.includes(name));
    this.hand.edit([{ do: "insert", place: ["stage", at], toml: toml({ name: free }) }]).then((done) => done && this.show(at));
  }

  /** Put a stage behind the next one; the chosen one stays chosen where it is then. */
  move(first, to) {
    this.hand.edit([{ do: "swap", place: ["stage", first] }]).then((done) => done && this.show(to));
  }

  /** Give the stage another name, and all that comes with it. */
  rename(name) {
    const old = this.stages[this.number]?.name, { content } = this.state;
    if (!name || name === old) return;
    const edits = [{ do: "set", place: ["stage", this.number, "name"], toml: toml(name) }];
    const follow = (value, place) => {
      if (Array.isArray(value)) value.forEach((one, k) => follow(one, [...place, k]));
      else if (value && typeof value === "object") for (const [key, one] of Object.entries(value)) {
        if (["stage", "until"].includes(key) && one === old) edits.push({ do: "set", place: [...place, key], toml: toml(name) });
        else follow(one, [...place, key]);
      }
    };
    for (const [table, value] of Object.entries(content)) if (table !== "stage") follow(value, [table]);
    this.hand.edit(edits);
  }
}
