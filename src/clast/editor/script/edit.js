/** The window: shows the newest state of the case, and hands on what is done in it. */
import { Hand } from "./hand.js";
import { showForms, tableAt } from "./form.js";
import { RunPanel } from "./run.js";
import { Strip } from "./stages.js";
import { Section, marksOf } from "./section.js";
import { Tools } from "./draw.js";
import { offerPictures } from "./picture.js";
import { offerSearch } from "./search.js";
import { offerStarts } from "./start.js";
import { offerReference } from "./reference.js";
import { TextPane } from "./text.js";
import { Underlays } from "./underlay.js";
import { Version } from "./version.js";

const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
const own = sessionStorage.getItem("window") ?? Math.random().toString(36).slice(2); // it stays over a reload
sessionStorage.setItem("window", own);
const headers = { Authorization: `Bearer ${token}`, Window: own };
const state = { schema: null, content: {}, literals: {}, faults: [], warnings: [], notes: [], undo: [0, 0], chosen: [], stamp: -1, looks_on: false };
const TEXT_EDITOR = "text editor";
/** Leads where no window edits. */
const LONG = 2000;
/** How long a cut may take until it can be stopped, ms. */
const STEP = 6e-4, BLOCK = 2e-5;
/** Time of a step on a usual machine and of each block in it, s, before any run has told better. */
let said = "", hand = null, pane = null, section = null, sections = 0, patience = 0, tools = null, refer = null, runs = null, strip = null, under = null;

async function fetched(path, body) {
  const answer = await fetch(path, { method: body ? "POST" : "GET", headers, body: body && JSON.stringify(body) });
  if (!answer.ok) throw new Error(await answer.text());
  return answer;
}

const ask = async (path, body) => (await fetched(path, body)).json();

/** Show an answer, unless a newer one is shown. */
function show(answer) {
  if (answer.stamp !== undefined && answer.stamp >= state.stamp) {
    const content = answer.content ?? state.content; // of a text that is no TOML the forms keep the last
    Object.assign(state, answer, { content, refused: answer.refused ?? "" });
    hand.version = state.version;
    hand.looksOn = state.looks_on = Boolean(state.leads) && state.leads !== own;
    if (answer.lines?.length) section.move(answer.lines);
  } else if (answer.refused) state.refused = answer.refused;
  draw();
}

function draw() {
  document.body.dataset.looks = state.looks_on ? "on" : "";
  $("take-over").hidden = !state.looks_on || state.leads === TEXT_EDITOR;
  $("text").readOnly = state.looks_on;
  showForms($("forms"), { ...state, hand, choose, pick: (...asked) => tools.pick(...asked), refer: (...at) => (refer ??= offerReference($("reference"), state))(...at) });
  $("undo").disabled = !state.undo[0];
  $("redo").disabled = !state.undo[1];
  const count = state.faults.length, many = `${count} ${count === 1 ? "fault" : "faults"}`;
  const saved = state.conflict !== null ? "not saved: another program wrote the file" : !state.unsaved ? (state.text ? "saved" : "nothing is in the file yet")
    : state.refused_as_case ? `not saved: ${many}` : "not saved yet";
  const pace = runs.shown?.pace, takes = state.steps * (pace ? pace * state.blocks : STEP + BLOCK * state.blocks); // as the run that is shown
  const size = state.blocks === null ? "" : [`${state.blocks} blocks`, state.steps !== null && `some ${state.steps} steps`, takes > 0 && `${pace ? "some" : "perhaps"} ${takes < 90 ? `${Math.ceil(takes)} s` : `${Math.round(takes / 60)} min`}`, section.sizes].filter(Boolean).join(", ");
  const news = [state.looks_on && `${state.leads === TEXT_EDITOR ? "a text editor" : "another window"} edits this case`, saved, size, state.off, state.trouble, state.refused].filter(Boolean).join(" - "), told = JSON.stringify([state.faults, state.warnings, state.notes]);
  if ($("saved").textContent !== news) $("saved").textContent = news;
  if (said !== told) { // what is told already is not told again
    said = told;
    $("faults").replaceChildren(...state.faults.map((one) => remark(one, "fault")), ...state.warnings.map((one) => remark(one, "warning")));
    $("notes").replaceChildren(...state.notes.map((one) => remark(one, "note")));
    $("notes-count").textContent = `Notes of the check: ${state.notes.length}`;
  }
  $("write").hidden = !(state.unsaved && state.refused_as_case && state.conflict === null);
  $("cut").hidden = !state.off || state.checked || state.is_cutting;
  showPatience();
  $("conflict").hidden = state.conflict === null;
  showMarks();
  section.choose(state.chosen);
  tools?.changed();
  if (state.sections > sections) drawSection();
  if (state.conflict !== null) $("conflict").querySelector("pre").textContent = differing(state.text, state.conflict);
  runs.draw();
  strip.draw();
  pane?.show();
  under?.follow(state.under);
}

/** Draw the newest section. */
async function drawSection() {
  sections = state.sections;
  const news = await ask("/section");
  await section.show(news, marksOf(state));
  showMarks(); // there may be more meanwhile
  draw();
}

function showMarks() {
  section.marks = marksOf(state);
  section.changed();
}

/** Show the button that stops a cut when it has gone on for a while. */
function showPatience() {
  if (!state.is_cutting) {
    clearTimeout(patience);
    patience = 0;
    $("stop-cut").hidden = true;
  } else patience ||= setTimeout(() => { $("stop-cut").hidden = false; }, LONG);
}

/** A fault, a warning or a note, which leads to its field, and to its mark in the section. */
function remark(one, kind) {
  const button = document.createElement("button");
  button.className = kind;
  button.textContent = [[one.where, one.line && !/^line /.test(one.where) && `line ${one.line}`].filter(Boolean).join(", "), [one.what, one.remedy].filter(Boolean).join(". ")].filter(Boolean).join(": ");
  button.disabled = !one.place.length && !one.at.length && !one.line;
  const light = (bring) => section.light(section.marks.find((mark) => mark.what === one.what && mark.where === one.where), bring);
  for (const event of ["mouseenter", "focus"]) button.addEventListener(event, () => light(false));
  button.addEventListener("mouseleave", () => section.light(null));
  button.addEventListener("click", () => { if (one.place.length) goTo(one.place); else if (one.line) pane.goTo(one.line); light(true); });
  return button;
}

/** Show the form of a value and put the cursor into its field. */
function goTo(place) {
  state.wanted = place;
  choose(tableAt(state, place));
  for (let length = place.length; length; length--) {
    const row = document.querySelector(`[data-place=${CSS.escape(JSON.stringify(place.slice(0, length)))}]`);
    if (row) return row.querySelector("input, select, button")?.focus();
  }
}

function choose(place) {
  state.chosen = place;
  draw();
}

/** Lines of two texts that are not in the other, the second called by a name. */
function differing(mine, theirs, name = "file") {
  const [here, there] = [mine.split("\n"), theirs.split("\n")], [own, other] = [new Set(here), new Set(there)];
  return [...here.filter((line) => !other.has(line)).map((line) => `here:  ${line}`), ...there.filter((line) => !own.has(line)).map((line) => `${name}:  ${line}`)].join("\n");
}

/** Listen to news of the file until the server goes; then ask again. */
async function listen() {
  for (;;) {
    try {
      const answer = await fetch("/news", { headers });
      const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
      for (let rest = "", part = await reader.read(); !part.done; part = await reader.read()) {
        const events = (rest + part.value).split("\n\n");
        rest = events.pop();
        for (const event of events) {
          const news = JSON.parse(event.slice(event.indexOf("data: ") + 6));
          if (event.startsWith("event: runs")) runs.show(news).then(() => runs.shown?.over && draw()); else show(news);
        }
      }
    } catch { $("saved").textContent = "the editor has ended, or does not answer"; }
    await new Promise((done) => setTimeout(done, 1000));
  }
}

export async function main() {
  hand = new Hand(ask, show);
  section = new Section($("section"), (mark) => goTo(mark.place));
  strip = new Strip($("strip"), { state, hand, choose, section });
  runs = new RunPanel({ state, hand, ask, token, differing });
  try { show(await ask("/case")); } catch (error) { $("saved").textContent = error.message; return; }
  pane = new TextPane($("text"), $("lines"), { state, hand, choose });
  pane.show();
  tools = new Tools(section, { state, hand, choose });
  $("file").textContent = state.file.split(/[\\/]/).at(-1);
  $("undo").addEventListener("click", () => hand.undo());
  $("redo").addEventListener("click", () => hand.redo());
  $("write").addEventListener("click", () => hand.send("/write", {}));
  $("cut").addEventListener("click", () => hand.send("/cut", {}));
  $("stop-cut").addEventListener("click", () => hand.send("/stop-cut", {}));
  $("take-over").addEventListener("click", async () => show(await ask("/take-over", {})));
  $("mine").addEventListener("click", () => hand.send("/keep-mine", {}));
  $("theirs").addEventListener("click", () => hand.send("/keep-theirs", {}));
  addEventListener("keydown", (e) => {
    if (!(e.ctrlKey || e.metaKey) || e.key.toLowerCase() !== "z") return;
    e.preventDefault(); // the browser would undo letters that are not the file's any more
    document.activeElement?.blur();
    if (e.shiftKey) hand.redo(); else hand.undo();
  });
  under = new Underlays(section, { ask, fetched, state, hand, goTo });
  offerPictures(section, state);
  new Version(section, { state, differing });
  offerSearch($("search"), $("found"), { state, hand, choose, goTo });
  offerStarts($("start"), { state, hand, ask });
  globalThis.clastEditor = { state, hand, goTo, section, tools, under, pane, runs, strip };
  document.body.dataset.ready = "yes";
  listen();
}
