/** The text of the file beside the forms: what is chosen is marked in it, and its caret chooses. */
import { tableAt } from "./form.js";

const key = (place) => JSON.stringify(place);
const isIn = (place, above) => above.every((part, i) => place[i] === part);

/** Draws the text into a field, and its numbers of lines beside it. */
export class TextPane {
  /** `state`, `hand` and `choose` are the window's. */
  constructor(field, lines, tools) {
    Object.assign(this, { field, lines, ...tools, typing: 0, marked: "", drawn: "", within: [] });
    field.addEventListener("focus", () => { this.typing += 1; });
    field.addEventListener("input", () => this.hand.text(field.value, `text ${this.typing}`));
    field.addEventListener("scroll", () => { lines.scrollTop = field.scrollTop; });
    document.addEventListener("selectionchange", () => this.follow());
    field.closest("details")?.addEventListener("toggle", () => this.bring());
    // a field of a form that gets the cursor is marked itself
    document.addEventListener("focusin", ({ target }) => {
      const row = target.closest?.("[data-place]");
      if (row) this.mark(JSON.parse(row.dataset.place));
    });
  }

  get isUsed() { return document.activeElement === this.field; }

  /** Show the newest text, with caret and view where they were. */
  show() {
    const { field, state, hand } = this, text = state.text.replaceAll("\r\n", "\n"), old = field.value; // as a field has it
    if (text !== old && !(this.isUsed && (hand.isBusy || hand.waiting.length))) {
      let [head, tail] = [0, 0];
      const least = Math.min(text.length, old.length), top = field.scrollTop;
      while (head < least && text[head] === old[head]) head++;
      while (tail < least - head && text.at(-1 - tail) === old.at(-1 - tail)) tail++;
      field.setRangeText(text.slice(head, text.length - tail), head, old.length - tail, "preserve");
      field.scrollTop = top;
    }
    const chosen = key(state.chosen);
    if (chosen !== this.last && !isIn(this.within, state.chosen)) this.within = state.chosen;
    this.last = chosen;
    this.mark(isIn(this.within, state.chosen) ? this.within : state.chosen);
  }

  /** First and last line of a place, or of the table around it; null where the text has none. */
  linesOf(place) {
    for (let above = place; above.length; above = above.slice(0, -1)) {
      const own = this.state.spans.filter(([at]) => isIn(at, above));
      if (own.length) return [Math.min(...own.map(([, first]) => first)), Math.max(...own.map(([, , last]) => last))];
    }
    return null;
  }

  /** Mark the lines of a place, and bring them into sight unless somebody works in the text. */
  mark(place) {
    this.within = place;
    const { state, field } = this, found = this.linesOf(place), [first, last] = found ?? [1, 0], bad = new Set(state.faults.map(({ line }) => line));
    field.style.setProperty("--from", first - 1);
    field.style.setProperty("--count", last - first + 1);
    const many = state.text.split("\n").length, drawn = key([many, first, last, ...bad]);
    if (drawn !== this.drawn) {
      this.drawn = drawn;
      this.lines.replaceChildren(...Array.from({ length: many }, (_, i) => {
        const line = document.createElement(bad.has(i + 1) ? "b" : i + 1 >= first && i + 1 <= last ? "mark" : "span");
        line.textContent = `${i + 1}\n`;
        return line;
      }));
    }
    if (this.marked !== key(place) && !this.isUsed) this.bring();
    this.marked = key(place);
  }

  /** Bring the marked lines into sight. */
  bring() {
    const { field } = this, height = parseFloat(getComputedStyle(field).lineHeight), [first, last] = this.linesOf(this.within) ?? [0, 0];
    if (!first || !field.clientHeight) return;
    const [top, bottom] = [(first - 1) * height, last * height];
    if (top < field.scrollTop || bottom > field.scrollTop + field.clientHeight) field.scrollTop = Math.max(0, top - 2 * height);
    this.lines.scrollTop = field.scrollTop;
  }

  /** Choose the table in which the caret stands. */
  follow() {
    const { field, state } = this;
    if (!this.isUsed || field.value !== state.text.replaceAll("\r\n", "\n")) return;
    const line = field.value.slice(0, field.selectionStart).split("\n").length;
    const around = state.spans.filter(([, first, last]) => first <= line && line <= last).sort(([a], [b]) => b.length - a.length)[0];
    if (!around || key(around[0]) === this.marked) return;
    this.within = around[0];
    this.choose(tableAt(state, around[0]));
  }

  /** Put the caret at the beginning of a line. */
  goTo(line) {
    const { field } = this, at = field.value.split("\n").slice(0, line - 1).join("\n").length + (line > 1);
    const place = field.closest("details");
    if (place) place.open = true;
    field.focus();
    field.setSelectionRange(at, at);
    field.scrollTop = Math.max(0, (line - 3) * parseFloat(getComputedStyle(field).lineHeight));
  }
}
