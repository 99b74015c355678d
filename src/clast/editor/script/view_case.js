// The window of `clast edit --view`: the section, and what is said of the case, each at its place.

import { Section, marksOf } from "./section.js";

const AGAIN = 1000;
/** Milliseconds after which a server that does not answer is asked again. */
const $ = (id) => document.getElementById(id);

/** Return the entry of a mark in the list: where, what, what to do. */
function entryOf(mark, section) {
  const item = document.createElement("li");
  const button = document.createElement("button");
  item.className = mark.kind;
  button.type = "button";
  const parts = [
    ["b", [mark.kind === "note" ? "" : mark.kind, mark.line ? `line ${mark.line}` : "", mark.where].filter(Boolean).join(", ")],
    ["div", mark.what],
    ["span", mark.remedy],
  ];
  for (const [kind, text] of parts) {
    if (!text) continue;
    const part = document.createElement(kind);
    part.textContent = text;
    button.append(part);
  }
  for (const event of ["mouseenter", "focus"]) button.addEventListener(event, () => section.light(mark));
  button.addEventListener("mouseleave", () => section.light(null));
  button.addEventListener("click", () => section.light(mark, true));
  mark.button = button;
  item.append(button);
  return item;
}

function countsOf(news) {
  const many = (count, what) => (count ? [`${count.toLocaleString("en")} ${what}${count === 1 ? "" : "s"}`] : []);
  const said = [...many(news.faults.length, "fault"), ...many(news.blocks, "block"), ...many(news.steps, "step"), ...many(news.warnings.length, "warning")];
  return said.join(", ");
}

/** Give kind and data of events as they come. */
async function* eventsOf(stream) {
  const reader = stream.pipeThrough(new TextDecoderStream()).getReader();
  for (let text = ""; ; ) {
    const { value, done } = await reader.read();
    if (done) return;
    const events = (text + value).split("\n\n");
    text = events.pop();
    for (const event of events) yield /^event: (\w+)\ndata: ([^]*)$/.exec(event).slice(1);
  }
}

/** Show what the server tells, until the window is closed. */
export async function main() {
  const token = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";
  const section = new Section($("section"), (mark) => mark.button.focus());
  document.querySelector("main").dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  $("fit").addEventListener("click", () => section.fit());
  const shown = { count: 0 };
  globalThis.clastView = { section, shown };
  for (;;) {
    try {
      const answer = await fetch("/news", { headers: { Authorization: `Bearer ${token}` }, cache: "no-store" });
      if (!answer.ok) throw new Error(await answer.text());
      for await (const [kind, data] of eventsOf(answer.body)) {
        $("gone").hidden = true;
        if (kind !== "section") continue;
        const news = JSON.parse(data);
        const marks = marksOf(news);
        $("file").textContent = news.title || news.file;
        document.title = `${news.title || news.file} - clast`;
        $("counts").textContent = countsOf(news);
        $("said").textContent = marks.length ? "Faults and notes" : "Nothing to object to";
        $("list").replaceChildren(...marks.map((mark) => entryOf(mark, section)));
        await section.show(news, marks);
        shown.count++;
      }
    } catch (fault) {
      console.warn(fault.message);
    }
    $("gone").hidden = false;
    await new Promise((done) => setTimeout(done, AGAIN));
  }
}
