/** A version of the case kept beside the section: the same place drawn as it was, and the lines of the text that differ. */
import { layersOf } from "../../pictures/page/script/layers.js";
import { View } from "../../pictures/page/script/view.js";

/** Keeps a drawing when it is asked to; ``differing`` writes the lines that two texts do not share. */
export class Version {
  constructor(section, { state, differing }) {
    Object.assign(this, { section, state, differing, kept: null, text: "", drawn: "" });
    const button = document.createElement("button");
    Object.assign(button, { textContent: "Compare", title: "Keep this version beside those that follow" });
    section.root.querySelector(".legend details").before(button);
    this.panel = document.createElement("section");
    Object.assign(this.panel, { className: "version", hidden: true, ariaLabel: "Version that is kept" });
    this.panel.innerHTML = '<div><canvas role="img" aria-label="Drawing of the version that is kept"></canvas></div><p>Kept to compare <button>close</button></p><pre tabindex="0" aria-label="What differs from the version that is kept"></pre>';
    section.root.querySelector(".beside").append(this.panel);
    button.addEventListener("click", () => this.keep());
    this.panel.querySelector("button").addEventListener("click", () => { this.kept = null; section.changed(); });
    section.beside = this;
  }

  /** Keep what is seen now: a section of its own that stays, with the tables of its file, looked at from the same place. */
  keep() {
    const { section, state } = this, { run, origin, lines, marks, showsFile } = section;
    const tools = Object.assign(Object.create(section.tools), { state: { ...state, chosen: [] }, where: "" });
    const own = { view: new View(), lit: null, place: [], moving: [], tools, under: null };
    this.kept = tools.section = origin && Object.assign(Object.create(section), { run, origin, lines, marks, showsFile, ...own });
    [this.text, this.drawn] = [state.text, ""];
    section.changed();
  }

  /** Draw it at the place, stage and with the layers that the section shows, and the lines that differ, where any has changed. */
  draw() {
    const { section, kept, panel, state } = this, { x, y, scale } = section.view;
    panel.hidden = !kept;
    if (!kept) return;
    const canvas = panel.querySelector("canvas"), { clientWidth: width, clientHeight: height } = canvas.parentElement, dots = Math.min(2, devicePixelRatio || 1);
    const drawn = [x, y, scale, width, height, section.origin, section.state.frame, ...section.wanted, state.version].join();
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    [canvas.width, canvas.height] = [width * dots, height * dots];
    const { run } = kept, shown = run && { frame: Math.min(section.state.frame, run.frameCount - 1), layers: new Set(layersOf(run).filter((name) => section.isOn(name))) };
    kept.state = { ...section.state, chosen: -1, ...shown };
    Object.assign(kept.view, { width, height, scale, x: x + section.origin[0] - kept.origin[0], y: y + section.origin[1] - kept.origin[1] });
    const pen = kept.penOf(canvas, kept.theme.paper);
    kept.drawBelow(pen);
    kept.drawAbove(pen);
    panel.querySelector("pre").textContent = this.differing(state.text, this.text, "kept") || "The same text.";
  }
}
