// Links, reactions, and N, Q, M along linings, as in still pictures: see pictures/supports.

import { plain, withOneUnit, withUnit } from "./colours.js";

const REACH = 0.018;
/** Half of the length of the bar of a link, in units of the picture's width. */
const TEETH = 8;
const SIZE = 4;
/** Radius of hinges, pixels. */
const [LONGEST, SHORTEST] = [0.16, 0.05];
/** Lengths of the arrows of the largest reaction and of small ones, in units of the picture's width. */
const TALLEST = 0.12;
/** Largest ordinate of a diagram, as a share of the smaller side of the picture. */
const SOFT = 1;
/** What a link does along, across and against rotation: 0 nothing, a spring, 2 rigid. */
const BROKEN = 3;

function line(colour, width, text) {
  return { colour, width, text, dash: false };
}

// --- links -----------------------------------------------------------------------------------

/** Return the states that links have in a frame, by their numbers. */
function statesOf({ links }, frame) {
  const count = links.names.length;
  return Array.from(links.state.subarray(frame * count, (frame + 1) * count));
}

/** Draw links: rings are hinges, squares hold rotation alone, bars hold one direction. */
export function drawLinks(pen, { run, view, frame, theme }) {
  const { links } = run;
  const { link_looks: looks, link_holds: holds } = run.scene.supports;
  statesOf(run, frame).forEach((state, link) => {
    const at = frame * links.names.length + link;
    const colour = looks[state][1];
    const [x0, y0] = [view.screenX(links.x0[at]), view.screenY(links.y0[at])];
    const [x1, y1] = [view.screenX(links.x1[at]), view.screenY(links.y1[at])];
    const [x, y] = [0.5 * (x0 + x1), 0.5 * (y0 + y1)];
    pen.lines([[x0, y0, x1, y1]], colour, 1.8);
    const [along, across, turning] = holds[link];
    const way = [links.alongX[at], -links.alongY[at]];
    if (way[0] || way[1]) {
      pen.lines([bar(x, y, way, REACH * view.width, Math.max(along, across) === SOFT)], colour, 1.8);
    }
    if (along && across) pen.circle(x, y, SIZE, turning ? colour : theme.paper, colour);
    else if (turning) pen.areas([box(x, y)], colour);
    if (state === BROKEN) {
      const far = 1.5 * SIZE;
      pen.lines([[x - far, y - far, x + far, y + far], [x - far, y + far, x + far, y - far]], colour, 1.8);
    }
  });
}

function box(x, y) {
  return [x - SIZE, y - SIZE, x + SIZE, y - SIZE, x + SIZE, y + SIZE, x - SIZE, y + SIZE];
}

/** Return the line of a link that holds one direction, in zigzag where it is a spring. */
function bar(x, y, [dx, dy], reach, soft) {
  const last = soft ? TEETH - 1 : 1;
  const path = [];
  for (let k = 0; k <= last; k++) {
    const place = reach * ((2 * k) / last - 1);
    const swing = k === 0 || k === last ? 0 : 0.35 * reach * (k % 2 ? 1 : -1);
    path.push(x + place * dx - swing * dy, y + place * dy + swing * dx);
  }
  return path;
}

/** Return the legend of links: an entry for each state. */
export function legendOfLinks({ run, frame }) {
  const seen = [...new Set(statesOf(run, frame))].sort();
  return seen.map((state) => line(run.scene.supports.link_looks[state][1], 3, run.scene.supports.link_looks[state][0]));
}

// --- reactions -------------------------------------------------------------------------------

/** Call back with every reaction of a frame: its name, place and force. */
function eachReaction({ reactions }, frame, call) {
  reactions.names.forEach((name, k) => {
    const at = frame * reactions.names.length + k;
    const size = Math.hypot(reactions.fx[at], reactions.fy[at]);
    if (size > 0) call(name, [reactions.x[at], reactions.y[at]], [reactions.fx[at], reactions.fy[at]], size);
  });
}

function largestReaction(run, frame) {
  let largest = 0;
  eachReaction(run, frame, (_, __, ___, size) => (largest = Math.max(largest, size)));
  return largest;
}

/** Draw reactions as arrows that push where supports push the blocks, with their forces. */
export function drawReactions(pen, { run, view, frame, theme }) {
  const colour = run.scene.supports.reaction_colour;
  const largest = largestReaction(run, frame);
  eachReaction(run, frame, (name, [px, py], [fx, fy], size) => {
    if (size < 1e-6 * largest) return;
    const length = view.width * Math.max(SHORTEST, (LONGEST * size) / largest);
    const [ux, uy] = [fx / size, -fy / size];
    const [x, y] = [view.screenX(px), view.screenY(py)];
    const [tailX, tailY] = [x - length * ux, y - length * uy];
    pen.lines([[tailX, tailY, x - 6 * ux, y - 6 * uy]], colour, 2.4);
    pen.areas([[x, y, x - 10 * ux + 4 * uy, y - 10 * uy - 4 * ux, x - 10 * ux - 4 * uy, y - 10 * uy + 4 * ux]], colour);
    pen.text(tailX + 6, tailY + (uy < 0 ? 10 : -8), `${name}: ${withOneUnit([size, largest], "N/m", 3)[0]}`, theme.ink, theme.paper);
  });
}

/** Return the legend of reactions. */
export function legendOfReactions({ run, frame }) {
  const largest = largestReaction(run, frame);
  const text = `reaction, up to ${withUnit(largest, "N/m", 3)}`;
  return largest > 0 ? [line(run.scene.supports.reaction_colour, 2.4, text)] : [];
}

// --- linings ---------------------------------------------------------------------------------

/** Return the values of a quantity along each lining in a frame; NaN where a joint does not bear. */
function valuesOf(run, frame, column) {
  const values = run.linings[column];
  const count = run.scene.supports.linings.reduce((sum, { face }) => sum + face.length, 0);
  let first = frame * count;
  return run.scene.supports.linings.map(({ face }) => values.subarray(first, (first += face.length)));
}

/** Return a force or moment of a lining in the unit of diagrams, kN/m or kN m/m. */
function inKilo(value, unit) {
  return `${plain(1e-3 * value, 3)} ${unit}`;
}

function extremes(values) {
  const known = values.flatMap((one) => Array.from(one).filter(Number.isFinite));
  return known.length ? [Math.min(...known), Math.max(...known)] : null;
}

/** Return the layer of a diagram, as scene.supports has it: letter, column, unit, colour. */
export function layerOfDiagram(name, label) {
  return {
    label,
    draw: (pen, seen) => drawDiagram(pen, seen, seen.run.scene.supports.diagrams[name]),
    legend: (seen) => legendOfDiagram(seen, seen.run.scene.supports.diagrams[name]),
  };
}

function legendOfDiagram({ run, frame }, [letter, column, unit, colour]) {
  const ends = extremes(valuesOf(run, frame, column));
  if (!ends) return [];
  const [least, most] = ends.map((value) => inKilo(value, unit));
  return [line(colour, 2, `${letter} of the lining, ${least} to ${most}`)];
}

/** Draw ordinates across linings, positive ones to the inside, with the least and the largest. */
function drawDiagram(pen, { run, view, frame, theme }, [letter, column, unit, colour]) {
  const every = valuesOf(run, frame, column);
  const largest = Math.max(...(extremes(every) ?? [0]).map(Math.abs));
  if (!largest) return;
  const scale = (TALLEST * Math.min(view.width, view.height)) / largest;
  const here = run.vertices(frame);
  const at = (v) => [view.screenX(here[2 * v]), view.screenY(here[2 * v + 1])];
  const [all, places] = [every.flatMap((values) => Array.from(values)), []];
  run.scene.supports.linings.forEach(({ face }, number) => {
    const values = every[number];
    const feet = face.map(([outer, inner], k) => {
      const [[x0, y0], [x1, y1]] = [at(outer), at(inner)];
      const far = (scale * values[k]) / Math.hypot(x1 - x0, y1 - y0);
      const [x, y] = [0.5 * (x0 + x1), 0.5 * (y0 + y1)];
      return [x, y, x + far * (x1 - x0), y + far * (y1 - y0)];
    });
    places.push(...feet);
    pen.lines(feet.filter((_, k) => Number.isFinite(values[k])), colour, 0.5);
    const known = Array.from(values).filter(Number.isFinite);
    if (!known.length) return;
    for (const value of new Set([Math.min(...known), Math.max(...known)])) {
      const [, , x, y] = feet[values.indexOf(value)];
      pen.text(x + 4, y, `${letter} ${inKilo(value, unit)}`, theme.ink, theme.paper);
    }
  });
  const borne = run.scene.supports.lining_pairs.filter((pair) => pair.every((k) => Number.isFinite(all[k])));
  for (const [from, width] of [[0, 0.7], [2, 1.8]]) {
    const lines = borne.map(([k, next]) => [...places[k].slice(from, from + 2), ...places[next].slice(from, from + 2)]);
    pen.lines(lines, colour, width);
  }
}
