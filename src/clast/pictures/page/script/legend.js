// The legend: the scale of colours, kinds, and what the layers that are on show; in the page and below pictures.

import { FIXED, kindColour, withUnit } from "./colours.js";
import { labelOf } from "./colouring.js";
import { isOfFlow, legendOfFlow } from "./flow.js";
import { LAYERS, layersOf } from "./layers.js";

const STEPS = 24;
const CLEAR = 0.15;
/** How far values beside a scale are from its ends at least, as a share of it. */
const LETTER = 6.6;
/** Width of a letter of a picture's legend, pixels. */
const LINE = 20;

/**
 * Return the entries of the legend: each has a text, and a fill, or a colour, width and dash of a line.
 * @param {any} seen run, state, theme and scale of a drawing
 */
export function entriesOf(seen) {
  const { run, state, scale } = seen;
  const entries = [];
  for (const { colour, value, word } of scale?.beyond ?? []) {
    entries.push({ fill: colour, text: `${word}, to ${withUnit(value, labelOf(run, state.field)[1], 3, scale.error)}` });
  }
  if (state.field === "rock") {
    run.scene.rocks.forEach((rock, k) => entries.push({ fill: kindColour(k), text: rock }));
  }
  if (run.scene.fixed.length) entries.push({ fill: FIXED, text: "fixed" });
  if (scale && isOfFlow(state.field)) entries.push(...legendOfFlow(seen));
  for (const name of layersOf(run)) {
    if (state.layers.has(name) && name !== state.field) entries.push(...LAYERS[name].legend(seen));
  }
  return entries;
}

/** Return the colours of a scale from its lower to its upper end. */
function coloursOfScale(scale) {
  const at = (k) => scale.low + ((k + 0.5) / STEPS) * (scale.high - scale.low);
  return Array.from({ length: STEPS }, (_, k) => scale.colour(at(k)));
}

/** Return round values within a scale, away from its ends, with zero where it is among them. */
function marksOf({ low, high }) {
  const span = high - low;
  const power = 10 ** Math.floor(Math.log10(span / 2));
  const step = power * [5, 2, 1].find((digit) => digit * power <= span / 2);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) {
    if (Math.min(k * step - low, high - k * step) > CLEAR * span) found.push(k * step);
  }
  return found;
}

/** Write the legend into an element, in the place of what was there. */
export function fillLegend(place, seen) {
  const { run, state, scale } = seen;
  const parts = [];
  const add = (kind, text) => {
    const element = document.createElement(kind);
    element.textContent = text;
    parts.push(element);
    return element;
  };
  if (scale) {
    const [label, unit] = labelOf(run, state.field);
    const whole = add("div", "");
    whole.className = "scale";
    const bar = document.createElement("span");
    bar.className = "bar";
    bar.style.background = `linear-gradient(to right, ${coloursOfScale(scale).join(",")})`;
    for (const value of marksOf(scale)) {
      const mark = document.createElement("i");
      mark.textContent = withUnit(value, unit, 3);
      mark.style.left = `${(100 * (value - scale.low)) / (scale.high - scale.low)}%`;
      bar.append(mark);
    }
    const [low, high] = [scale.low, scale.high].map((value) => withUnit(value, unit, 3));
    const row = document.createElement("span");
    row.className = "ends";
    row.append(low, bar, high);
    whole.append(label, " ", row);
  }
  for (const entry of entriesOf(seen)) {
    const mark = document.createElement("span");
    mark.className = entry.fill ? "patch" : "stroke";
    if (entry.fill) mark.style.background = entry.fill;
    else mark.style.borderTop = `${entry.width}px ${entry.dash ? "dashed" : "solid"} ${entry.colour}`;
    const line = add("div", "");
    line.append(mark, ` ${entry.text}`);
  }
  place.replaceChildren(...parts);
}

/** Return the lines that the legend of a picture of a width takes, each a list of entries. */
function linesOf(seen, width) {
  const { run, state, scale } = seen;
  const entries = entriesOf(seen).map((one) => ({ ...one, wide: 44 + LETTER * one.text.length }));
  if (scale) {
    const [label, unit] = labelOf(run, state.field);
    const ends = [scale.low, scale.high].map((value) => withUnit(value, unit, 3));
    const wide = 190 + LETTER * (label.length + ends[0].length + ends[1].length);
    entries.unshift({ text: label, ends, colours: coloursOfScale(scale), wide });
  }
  const lines = [[]];
  let room = width - 20;
  for (const entry of entries) {
    if (entry.wide > room && lines.at(-1).length) {
      lines.push([]);
      room = width - 20;
    }
    lines.at(-1).push(entry);
    room -= entry.wide;
  }
  return lines;
}

/** Return the height of title and legend of a picture of a width, pixels. */
export function heightOfLegend(seen, width) {
  return LINE * (1 + linesOf(seen, width).length) + 12;
}

/** Draw title, time and legend of a picture with a pen, from ``top`` down. */
export function drawLegend(pen, seen, width, top, title) {
  const { ink, paper } = seen.theme;
  let y = top + 14;
  pen.text(10, y, title, ink, paper);
  for (const line of linesOf(seen, width)) {
    y += LINE;
    let x = 10;
    for (const entry of line) {
      drawEntry(pen, entry, x, y, ink, paper);
      x += entry.wide;
    }
  }
}

function drawEntry(pen, entry, x, y, ink, paper) {
  const box = (left, wide) => [left, y - 5, left + wide, y - 5, left + wide, y + 5, left, y + 5];
  if (entry.ends) {
    pen.text(x, y, `${entry.text}:  ${entry.ends[0]}`, ink, paper);
    const left = x + LETTER * (entry.text.length + entry.ends[0].length + 4);
    entry.colours.forEach((colour, k) => pen.areas([box(left + 5 * k, 5)], colour));
    pen.text(left + 5 * STEPS + 6, y, entry.ends[1], ink, paper);
    return;
  }
  if (entry.fill) pen.areas([box(x, 10)], entry.fill);
  else pen.lines([[x, y, x + 20, y]], entry.colour, entry.width, entry.dash ? [4, 3] : []);
  pen.text(x + 26, y, entry.text, ink, paper);
}
