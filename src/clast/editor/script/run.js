/** Runs of the case: starts, pauses and ends them, shows their page in the middle, and what has changed since. */
import { withUnit } from "../../pictures/page/script/colours.js";
import { StudyForm, showStudy } from "./study.js";

const $ = (id) => document.getElementById(id);

/** The run that is shown, of those that there are; ``differing`` writes the lines that two texts do not share. */
export class RunPanel {
  constructor({ state, hand, ask, token, differing }) {
    Object.assign(this, { state, hand, ask, token, differing, numbers: [], shown: null, text: "", of: 0 });
    this.form = new StudyForm($("study-form"), { state, start: (study) => this.start("/start", { study }) });
    $("run").addEventListener("click", () => this.start("/start", {}));
    $("pause").addEventListener("click", () => this.ask("/do", { do: this.shown?.where.paused ? "go" : "pause" }));
    $("end").addEventListener("click", () => hand.send("/stop", {}));
    $("looking").addEventListener("change", (e) => this.look(Number(e.target.value)));
    $("back").addEventListener("click", () => hand.text(this.text, "")); // to the text that ran, as a step
  }

  /** Start a command on a copy of the text, and look at it. */
  async start(path, body) {
    if (await this.hand.send(path, body)) this.wanted = "newest";
  }

  /** Look at a run by its number; 0 is the section. */
  async look(number) {
    if (number && number !== this.shown?.number && !(await this.hand.send("/look", { number }))) number = 0;
    this.wanted = number;
    this.draw();
  }

  /** Take news of the runs. */
  async show({ numbers, shown, secret }) {
    const before = this.shown;
    Object.assign(this, { numbers, shown, secret });
    if (shown && shown.number !== this.of) {
      this.of = shown.number;
      this.text = (await this.ask("/ran")).text;
    }
    if (this.wanted === "newest" && shown && !shown.over) this.wanted = shown.number;
    const fails = shown?.over && !hasPage(shown) && before?.number === shown.number && !before.over;
    if (fails) [this.wanted, $("messages").open] = [0, true]; // it has no page: its messages say why
    this.draw();
  }

  draw() {
    const { shown, state } = this, goesOn = Boolean(shown && !shown.over), wanted = this.wanted && this.wanted === shown?.number;
    const isOff = goesOn || Boolean(state.refused_as_case || state.looks_on);
    $("study-start").disabled = isOff;
    $("run").disabled = isOff;
    $("run").textContent = state.content.rockfall ? "Let rocks fall" : "Run";
    for (const name of ["pause", "end"]) $(name).hidden = !goesOn || state.looks_on;
    $("pause").hidden ||= !shown.where.steps && !shown.where.paused;
    $("pause").textContent = shown?.where.paused ? "Go on" : "Pause";
    $("end").textContent = shown?.ending ? "Kill" : "End";
    $("end").title = shown?.ending ? "At once; what is not in its file is lost" : "After the step; results and a checkpoint are kept";
    const names = [[0, "Section"], ...[...this.numbers].reverse().map((number) => [number, `Run ${number}`])];
    if (names.join() !== this.names) $("looking").replaceChildren(...names.map(([value, name]) => new Option(name, value)));
    this.names = names.join();
    $("looking").value = wanted ? shown.number : 0;
    $("looking").hidden = names.length < 2;
    $("progress").hidden = !goesOn;
    if (goesOn) $("progress").value = shown.where.end ? shown.where.time / shown.where.end : 0;
    const changed = shown && this.of === shown.number && this.text !== state.text;
    const said = shown ? [goesOn ? where(shown) : shown.outcome, changed && "the case has changed since"].filter(Boolean).join("; ") : "";
    $("ran").textContent = shown ? `${shown.kind} ${shown.number}: ${said}` : "";
    $("since").hidden = !changed;
    $("since").querySelector("summary").textContent = `Changed since ${shown?.kind} ${shown?.number}`;
    $("since").querySelector("pre").textContent = changed ? this.differing(state.text, this.text, "run") : "";
    $("messages").hidden = !shown;
    $("messages").querySelector("summary").textContent = `Messages of ${shown?.kind} ${shown?.number}, in ${shown?.folder}`;
    $("messages").querySelector("pre").textContent = shown?.log ?? "";
    this.frame(Boolean(wanted && hasPage(shown))); // until there is something to see the section stays
  }

  /** Show the page of the run in the place of the section, or the section. */
  frame(isWanted) {
    $("page").hidden = !isWanted;
    $("section").hidden = isWanted;
    const { number, kind, table, report } = this.shown ?? {}, address = kind === "run" ? `/run?${number}#token=${this.token}` : report ? `/report?${this.secret}` : "";
    const results = $("page").querySelector(".study"), told = JSON.stringify([number, table]);
    results.hidden = !isWanted || !table?.rows.length || kind === "rockfall";
    if (!results.hidden && results.dataset.told !== told) showStudy(results, table);
    results.dataset.told = told;
    const frame = $("page").querySelector("iframe"), of = `${number} ${address}`;
    frame.hidden = !address;
    if (!isWanted || !address || frame.dataset.of === of) return;
    const fresh = document.createElement("iframe"); // of a study: of no origin, so that its scripts can ask for nothing
    if (kind !== "run") fresh.setAttribute("sandbox", "allow-scripts allow-downloads");
    Object.assign(fresh, { title: frame.title, src: address });
    fresh.dataset.of = of;
    frame.replaceWith(fresh);
  }
}

/** Whether there is something to look at of a run or a study. */
function hasPage({ kind, frames, table, report }) {
  return kind === "run" ? frames > 0 : report || Boolean(table?.rows.length);
}

/** Where a run is, in words. */
function where({ kind, table, where: { time, end, steps, contacts, stage, paused, said }, ending, seconds }) {
  if (kind !== "run" && !ending) return `${table?.rows.length ?? 0} runs are finished, after ${seconds} s`;
  if (ending) return "ends after this step";
  if (time === undefined) return `begins, for ${seconds} s`;
  return [paused && "paused", stage && `stage ${stage}`, `t ${withUnit(time, "s", 4)} of ${withUnit(end, "s", 4)}`, `${steps} steps`, `${contacts} contacts`, said].filter(Boolean).join(", ");
}
