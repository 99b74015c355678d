/** Runs of the case: starts, pauses and ends them, shows their page in the middle, and what has changed since. */
import { withUnit } from "../../pictures/page/script/colours.js";

const $ = (id) => document.getElementById(id);

/** The run that is shown, of those that there are; ``differing`` writes the lines that two texts do not share. */
export class RunPanel {
  constructor({ state, hand, ask, token, differing }) {
    Object.assign(this, { state, hand, ask, token, differing, numbers: [], shown: null, text: "", of: 0 });
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
  async show({ numbers, shown }) {
    const before = this.shown;
    Object.assign(this, { numbers, shown });
    if (shown && shown.number !== this.of) {
      this.of = shown.number;
      this.text = (await this.ask("/ran")).text;
    }
    if (this.wanted === "newest" && shown && !shown.over) this.wanted = shown.number;
    const fails = shown?.over && !shown.frames && before?.number === shown.number && !before.over;
    if (fails) [this.wanted, $("messages").open] = [0, true]; // it has no page: its messages say why
    this.draw();
  }

  draw() {
    const { shown, state } = this, goesOn = Boolean(shown && !shown.over), wanted = this.wanted && this.wanted === shown?.number;
    $("run").disabled = goesOn || Boolean(state.refused_as_case);
    $("run").textContent = state.content.rockfall ? "Let rocks fall" : "Run";
    for (const name of ["pause", "end"]) $(name).hidden = !goesOn;
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
    $("ran").textContent = shown ? `run ${shown.number}: ${said}` : "";
    $("since").hidden = !changed;
    $("since").querySelector("summary").textContent = `Changed since run ${shown?.number}`;
    $("since").querySelector("pre").textContent = changed ? this.differing(state.text, this.text, "run") : "";
    $("messages").hidden = !shown;
    $("messages").querySelector("summary").textContent = `Messages of run ${shown?.number}, in ${shown?.folder}`;
    $("messages").querySelector("pre").textContent = shown?.log ?? "";
    this.frame(Boolean(wanted && shown.frames)); // until there is something to see the section stays
  }

  /** Show the page of the run in the place of the section, or the section. */
  frame(isWanted) {
    $("page").hidden = !isWanted;
    $("section").hidden = isWanted;
    const frame = $("page").querySelector("iframe"), number = String(this.shown?.number);
    if (!isWanted || frame.dataset.number === number) return;
    frame.dataset.number = number;
    frame.src = `/run?${number}#token=${this.token}`;
  }
}

/** Where a run is, in words. */
function where({ where: { time, end, steps, contacts, stage, paused, said }, ending, seconds }) {
  if (ending) return "ends after this step";
  if (time === undefined) return `begins, for ${seconds} s`;
  return [paused && "paused", stage && `stage ${stage}`, `t ${withUnit(time, "s", 4)} of ${withUnit(end, "s", 4)}`, `${steps} steps`, `${contacts} contacts`, said].filter(Boolean).join(", ");
}
