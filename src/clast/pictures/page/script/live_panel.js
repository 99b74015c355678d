// The part of the page that leads a run which goes on, and takes up what comes of it.

import { withUnit } from "./colours.js";
import { layersOf } from "./layers.js";
import { fillReport } from "./report.js";

const KILLED = "the run was killed: it ended without a report";

/** The buttons of a run that goes on, and what is said of it. */
export class LivePanel {
  /** @param {any} page @param {import("./live.js").Live} live */
  constructor(page, live) {
    this.page = page;
    this.live = live;
    const $ = (name) => page.$(name);
    $("live").hidden = false;
    $("pause").addEventListener("click", () => this.do(live.status.paused ? "go" : "pause"));
    for (const name of ["step", "checkpoint"]) $(name).addEventListener("click", () => this.do(name));
    // a second click within three seconds: a run is not ended by accident
    $("end").addEventListener("click", () => (this.ending ? this.do("end") : this.askAgain()));
    $("keep").addEventListener("click", () => this.keep());
    page.root.dataset.live = "on";
    this.show(live.status);
  }

  /** Follow the run to its end. */
  async follow() {
    await this.live.follow({
      frames: (part) => this.take(part),
      words: (told) => this.tell(told),
      status: (status) => this.show(status),
      gone: () => this.say("no answer from the run; asking again"),
    });
  }

  async take(part) {
    const { page } = this;
    const { run } = page;
    const layers = layersOf(run).join();
    await run.append(part);
    run.scene.frames.of += part.times.length;
    page.fillCounts();
    page.fillTicks();
    if (layers !== layersOf(run).join()) page.fillLayers();
    page.root.dataset.frames = String(run.frameCount);
    if (page.$("newest").checked) page.goTo(run.frameCount - 1);
    else page.changed();
  }

  tell(told) {
    const { page } = this;
    Object.assign(page.run.scene, told);
    page.fillCurves();
    page.showCurve();
    page.fillTicks();
    fillReport(page.$("report"), page.run.scene);
  }

  show(status) {
    const { page } = this;
    page.root.dataset.live = status.over ? "over" : status.paused ? "paused" : "on";
    page.$("pause").textContent = status.paused ? "Go on" : "Pause";
    for (const name of ["pause", "step", "end", "checkpoint"]) page.$(name).disabled = Boolean(status.over);
    const parts = [];
    if (status.killed) this.mourn();
    if (status.over) parts.push(status.killed ? KILLED : "the run is over");
    else if (status.paused) parts.push("paused");
    if (status.stage) parts.push(`stage ${status.stage}`);
    if (status.time !== undefined) {
      parts.push(`t ${withUnit(status.time, "s", 5)} of ${withUnit(status.end, "s", 5)}`);
      parts.push(`step ${withUnit(status.step, "s", 3)}`, `${status.steps} steps`, `${status.contacts} contacts`);
    }
    if (status.said) parts.push(status.said);
    this.say(parts.join(", "));
  }

  /** Say in the report, too, that there will be none. */
  mourn() {
    const { page } = this;
    if (page.run.scene.report.outcome === KILLED) return;
    page.run.scene.report.outcome = KILLED;
    fillReport(page.$("report"), page.run.scene);
  }

  say(text) {
    const place = this.page.$("status");
    if (place.textContent !== text) place.textContent = text;
  }

  async do(what) {
    try {
      await this.live.do(what);
    } catch (fault) {
      this.say(`the run cannot be asked: ${fault.message}`);
    }
  }

  askAgain() {
    this.ending = true;
    this.page.$("end").textContent = "Really end?";
    setTimeout(() => {
      this.ending = false;
      this.page.$("end").textContent = "End";
    }, 3000);
  }

  /** Save the page as clast page would write it. */
  async keep() {
    try {
      this.page.save(await this.live.file(), "html");
    } catch (fault) {
      this.say(`the page cannot be saved: ${fault.message}`);
    }
  }
}
