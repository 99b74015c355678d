// What is drawn above the blocks, with a pen: contacts, chains, bolts, stresses, points, what is chosen.

import { drawAxes } from "./axes.js";
import { outline } from "./draw_canvas.js";
import { scaleOfFaces } from "./colouring.js";
import { withOneUnit, withUnit } from "./colours.js";
import { placeOfChosen } from "./chosen.js";
import { largestResultant, resultantsOf } from "./contact_faces.js";
import { drawLinks, drawReactions, layerOfDiagram, legendOfLinks, legendOfReactions } from "./supports.js";

const PULLED = "#b2182b";
const PRESSED = "#2166ac";
const FORCE = "#5b2a86";
/** Width of a letter of a name, pixels. */
const LETTER = 7;
const MOST_CROSSES = 4000;
const VECTORS = { displacement: "#1b5e20", velocity: "#8d4a00" };
/** Slip and opening beside the colours of blocks: as wide as they are large. */
const FACES = { slip: "#8e24aa", opening: "#00695c", water: "#1f6fb4" };
const LEVEL = "#1f6fb4";
const WIDTHS = 8;
/** Widths of bolts without a force and with the largest, pixels. */
const BOLTS = [1.7, 4.8];

/** Name of a layer -> its label, what draws it, and its entries of the legend. */
export const LAYERS = {
  before: {
    label: "Outlines at the start",
    draw: drawBefore,
    legend: ({ theme }) => [line(theme.faint, 1, "start")],
  },
  joints: { label: "Edges by joint", draw: drawJoints, legend: legendOfJoints },
  slip: layerOfFaces("slip", "Slip of joints, as line width"),
  opening: layerOfFaces("opening", "Opening of joints, as line width"),
  water: {
    ...layerOfFaces("water", "Water"),
    draw: drawWater,
    legend: legendOfWater,
  },
  surcharge: { label: "Fill and axles", draw: drawSurcharge, legend: legendOfSurcharge },
  displacements: layerOfVectors("displacement", "Displacement vectors"),
  velocities: layerOfVectors("velocity", "Velocity vectors"),
  contacts: { label: "Contact forces", draw: drawContacts, legend: legendOfForces },
  chains: { label: "Force chains", draw: drawChains, legend: legendOfChains },
  crosses: { label: "Principal stresses", draw: drawCrosses, legend: legendOfCrosses },
  excavated: {
    label: "Excavated blocks",
    draw: drawExcavated,
    legend: ({ theme }) => [line(theme.faint, 1, "excavated", true)],
  },
  bolts: { label: "Bolts", draw: drawBolts, legend: legendOfBolts },
  "normal-forces": layerOfDiagram("normal-forces", "Normal forces of linings"),
  "shear-forces": layerOfDiagram("shear-forces", "Shear forces of linings"),
  moments: layerOfDiagram("moments", "Moments of linings"),
  links: { label: "Links", draw: drawLinks, legend: legendOfLinks },
  reactions: { label: "Reactions of supports", draw: drawReactions, legend: legendOfReactions },
  points: { label: "Measured points", draw: drawPoints, legend: () => [] },
  axes: { label: "Axes", draw: drawAxes, legend: () => [] },
};

function line(colour, width, text, dash = false) {
  return { colour, width, text, dash };
}

function layerOfFaces(name, label) {
  return {
    label,
    draw: (pen, seen) => drawFaces(pen, seen, name),
    legend: (seen) => legendOfFaces(seen, name),
  };
}

/** Return the layers that a run has something for. */
export function layersOf(run) {
  const { scene } = run;
  const has = {
    before: true,
    joints: scene.joints.length > 1,
    slip: run.faces.slip?.shown > 0,
    opening: run.faces.opening?.shown > 0,
    water: scene.waters?.length > 0 || run.flows.some(({ tables }) => tables.length),
    surcharge: scene.surcharge?.fill.length > 0 || scene.surcharge?.axles.length > 0,
    displacements: true,
    velocities: true,
    contacts: run.contacts.shown > 0,
    chains: run.contacts.shown > 0,
    crosses: true,
    excavated: scene.blocks.some((_, block) => run.isGone(run.frameCount - 1, block) && !run.isAwaited(run.frameCount - 1, block)),
    bolts: Boolean(run.bolts),
    "normal-forces": Boolean(run.linings),
    "shear-forces": Boolean(run.linings),
    moments: Boolean(run.linings),
    links: Boolean(run.links),
    reactions: Boolean(run.reactions),
    points: run.points.length > 0,
    axes: true,
  };
  return Object.keys(LAYERS).filter((name) => has[name]);
}

function drawBefore(pen, { run, view, frame, theme }) {
  const paths = [];
  for (let block = 0; block < run.blockCount; block++) {
    const path = !run.isAwaited(frame, block) && outline(run, view, run.start, block);
    if (path) paths.push([...path, path[0], path[1]]);
  }
  pen.lines(paths, theme.faint, 0.8);
}

function drawExcavated(pen, { run, view, frame, theme }) {
  const here = run.vertices(frame);
  const paths = [];
  for (let block = 0; block < run.blockCount; block++) {
    const isExcavated = run.isGone(frame, block) && !run.isAwaited(frame, block);
    const path = isExcavated && outline(run, view, here, block);
    if (path) paths.push([...path, path[0], path[1]]);
  }
  pen.lines(paths, theme.faint, 0.8, [4, 3]);
}

function drawJoints(pen, { run, view, frame }) {
  const here = run.vertices(frame);
  const byJoint = new Map();
  for (let block = 0; block < run.blockCount; block++) {
    if (run.isGone(frame, block)) continue;
    const past = run.blockStart[block + 1];
    for (let v = run.blockStart[block]; v < past; v++) {
      const joint = run.edgeJoint[v];
      if (joint < 0) continue;
      const next = v + 1 < past ? v + 1 : run.blockStart[block];
      const edge = [v, next].flatMap((k) => [view.screenX(here[2 * k]), view.screenY(here[2 * k + 1])]);
      if (!byJoint.has(joint)) byJoint.set(joint, []);
      byJoint.get(joint).push(edge);
    }
  }
  for (const [joint, paths] of byJoint) {
    const [, colour, dash] = run.scene.joint_looks[joint];
    pen.lines(paths, colour, 1.6, dash);
  }
}

function legendOfJoints({ run }) {
  const looks = Object.values(run.scene.joint_looks).map(([name, colour, dash]) => line(colour, 2, name, dash.length > 0));
  // construction joints of several openings look alike
  return looks.filter((one, k) => looks.findIndex(({ text, colour }) => text === one.text && colour === one.colour) === k);
}

function legendOfFaces({ run, frame }, name) {
  let largest = 0;
  run.eachFace(name, frame, (_, value) => (largest = Math.max(largest, Math.abs(value))));
  const [label, unit] = run.scene.joint_labels[name];
  return largest > 0 ? [line(FACES[name], 4, `${label.toLowerCase()}, up to ${withUnit(largest, unit, 3)}`)] : [];
}

/** Return the height of a surface at x, m; it is level beyond its ends. */
function heightOf(surface, x) {
  const k = surface.findIndex(([at]) => at >= x);
  if (k < 0) return surface.at(-1)[1];
  if (k === 0) return surface[0][1];
  const [[x0, y0], [x1, y1]] = [surface[k - 1], surface[k]];
  return y0 + ((x - x0) / (x1 - x0)) * (y1 - y0);
}

function legendOfWater(seen) {
  const { run, frame } = seen;
  const table = run.flows[frame].tables.length ? [line(LEVEL, 1, "water table")] : [];
  if (!run.faces.water) return table;
  return [line(LEVEL, 1, "water level"), ...legendOfFaces(seen, "water"), ...table];
}

/** Draw the sign of a level at a place on the screen. */
function drawSign(pen, x, y, theme) {
  pen.areas([[x, y, x - 5, y - 9, x + 5, y - 9]], theme.paper);
  pen.lines([[x, y, x - 5, y - 9, x + 5, y - 9, x, y]], LEVEL, 1.2);
}

/** Draw what water wets, as wide as its pressure is large, and the levels. */
function drawWater(pen, seen) {
  const { run, view, frame, theme } = seen;
  for (const table of run.flows[frame].tables) {
    const points = table.map(([x, y]) => [view.screenX(x), view.screenY(y)]);
    pen.lines([points.flat()], LEVEL, 1.2);
    drawSign(pen, ...points[Math.floor((points.length - 1) / 4)], theme);
  }
  if (!run.faces.water) return;
  drawFaces(pen, seen, "water");
  const [left, right] = [view.worldX(-10), view.worldX(view.width + 10)];
  run.levels[frame].forEach(([number, dry], place) => {
    const surface = run.scene.waters[number];
    const ends = [left, ...dry.flat().map((x) => Math.max(left, Math.min(right, x))), right];
    const wet = ends.flatMap((low, k) => (k % 2 === 0 && low < ends[k + 1] ? [[low, ends[k + 1]]] : []));
    const screen = (x) => [view.screenX(x), view.screenY(heightOf(surface, x))];
    const paths = wet.map(([low, high]) => {
      const inner = surface.map(([x]) => x).filter((x) => x > low && x < high);
      return [low, ...inner, high].flatMap(screen);
    });
    pen.lines(paths, LEVEL, 1.2);
    if (!wet.length) return;
    // the sign of a level, on the first part of it that is seen, or else on the widest
    const first = view.worldX((0.06 + 0.04 * place) * view.width);
    const [low, high] = wet.reduce((one, other) => (other[1] - other[0] > one[1] - one[0] ? other : one));
    const [x, y] = screen(wet.some((one) => one[0] < first && first < one[1]) ? first : 0.5 * (low + high));
    drawSign(pen, x, y, theme);
  });
}

/** Return fill and axles that act in a frame. */
function surchargeOf({ run, frame }) {
  const acts = ({ since }) => since !== null && since <= run.times[frame];
  return { fill: run.scene.surcharge.fill.filter(acts), axles: run.scene.surcharge.axles.filter(acts) };
}

/** Draw the outlines of fill, and axles as arrows, as long as they are heavy, with their loads. */
function drawSurcharge(pen, seen) {
  const { run, view, theme } = seen;
  const { fill, axles } = surchargeOf(seen);
  const [ground, colour] = run.scene.surcharge.colours;
  const screen = ([x, y]) => [view.screenX(x), view.screenY(y)];
  pen.lines(fill.map(({ outline }) => [...outline, outline[0]].flatMap(screen)), ground, 2);
  const largest = Math.max(...axles.map(({ load }) => load));
  for (const { at, load } of axles) {
    const [[x, y], ...feet] = at.map(screen);
    const tail = y - 12 - (24 * load) / largest;
    pen.lines(feet.map((foot) => [x, y, ...foot]), colour, 0.8, [4, 3]);
    pen.lines([[x, tail, x, y - 6]], colour, 2.2);
    pen.areas([[x, y, x - 4, y - 9, x + 4, y - 9]], colour);
    pen.text(x, tail - 8, withUnit(load, "N/m", 3), theme.ink, theme.paper, "middle");
  }
}

function legendOfSurcharge(seen) {
  const { fill, axles } = surchargeOf(seen);
  const [ground, colour] = seen.run.scene.surcharge.colours;
  return [...(fill.length ? [line(ground, 2, "fill")] : []), ...(axles.length ? [line(colour, 2.2, "axle")] : [])];
}

/**
 * Draw slip or opening: in the colours of a scale where it is the field, else by width alone.
 * @param {any} pen @param {any} seen @param {string} field
 */
export function drawFaces(pen, seen, field) {
  const { run, view, frame, state } = seen;
  const own = state.field === field;
  const scale = own ? seen.scale : scaleOfFaces(run, { field, frame, share: null, limits: null });
  // points are 4/3 pixels
  const [thin, thick] = run.scene.line_widths.map((width) => (4 / 3) * width);
  const groups = new Map();
  run.eachFace(field, frame, (ends, value, _, width) => {
    const [x0, x1] = [view.screenX(ends[0]), view.screenX(ends[2])];
    const [y0, y1] = [view.screenY(ends[1]), view.screenY(ends[3])];
    if (Math.max(x0, x1) < 0 || Math.min(x0, x1) > view.width) return;
    if (Math.max(y0, y1) < 0 || Math.min(y0, y1) > view.height) return;
    const step = Math.min(WIDTHS - 1, Math.floor(WIDTHS * (width ?? scale.share(value))));
    if (!own && scale.share(value) < 0.02) return;
    const colour = own ? scale.colour(value) : FACES[field];
    const key = `${colour} ${step}`;
    if (!groups.has(key)) groups.set(key, { colour, step, paths: [] });
    // one contact alone is a dot: no length would not be drawn
    const dot = x1 === x0 && y1 === y0 ? 1 : 0;
    groups.get(key).paths.push([x0 - dot, y0, x1 + dot, y1]);
  });
  const order = [...groups.values()].sort((a, b) => a.step - b.step);
  for (const { colour, step, paths } of order) {
    pen.lines(paths, colour, thin + ((thick - thin) * (step + 0.5)) / WIDTHS);
  }
}

/** Call back with every contact of a frame: its number and the size of its force. */
function eachContact(run, frame, call) {
  const { contacts } = run;
  for (let k = contacts.first[frame]; k < contacts.first[frame + 1]; k++) {
    call(k, Math.hypot(contacts.fx[k], contacts.fy[k]));
  }
}

function legendOfForces({ run, frame }) {
  let largest = 0;
  eachContact(run, frame, (_, size) => (largest = Math.max(largest, size)));
  const text = `contact force, up to ${withUnit(largest, "N/m", 3, run.contacts.error)}`;
  return largest > 0 ? [line(FORCE, 1.2, text)] : [];
}

function legendOfChains({ run, frame }) {
  const nothing = { size: 0, error: 0 };
  const { size: largest, error } = resultantsOf(run, frame).reduce((most, one) => (one.size > most.size ? one : most), nothing);
  const text = `force between blocks as width, up to ${withUnit(largest, "N/m", 3, error)}`;
  return largest > 0 ? [line(FORCE, widthOfChain(largest / largestResultant(run)), text)] : [];
}

/** Return the width of a chain whose force is a share of the largest of the run, pixels. */
function widthOfChain(share) {
  return 0.6 + (7 * (Math.min(WIDTHS - 1, Math.floor(WIDTHS * share)) + 0.5)) / WIDTHS;
}

function drawContacts(pen, { run, view, frame }) {
  const { contacts } = run;
  const longest = 0.09 * Math.min(view.width, view.height);
  const paths = [];
  eachContact(run, frame, (k, size) => {
    if (size < 0.01 * contacts.largest) return;
    const length = longest / contacts.largest;
    paths.push(...arrow(view.screenX(contacts.x[k]), view.screenY(contacts.y[k]), length * contacts.fx[k], -length * contacts.fy[k]));
  });
  pen.lines(paths, FORCE, 1.2);
}

/** Return the lines of an arrow from a place by dx and dy, pixels. */
function arrow(x, y, dx, dy) {
  const length = Math.hypot(dx, dy);
  const [ux, uy] = [dx / length, dy / length];
  const head = Math.min(6, 0.4 * length);
  const [tipX, tipY] = [x + dx, y + dy];
  return [
    [x, y, tipX, tipY],
    [
      tipX - head * (ux - 0.5 * uy), tipY - head * (uy + 0.5 * ux), tipX, tipY,
      tipX - head * (ux + 0.5 * uy), tipY - head * (uy - 0.5 * ux),
    ],
  ];
}

/** Return the layer of arrows at the centroids of blocks, the longest that of the largest vector of the frame. */
function layerOfVectors(field, label) {
  const largestOf = (run, frame) => {
    let largest = 0;
    for (let block = 0; block < run.blockCount; block++) {
      if (!run.isGone(frame, block)) largest = Math.max(largest, run.value(field, frame, block));
    }
    return largest;
  };
  const draw = (pen, { run, view, frame }) => {
    const length = (0.09 * Math.min(view.width, view.height)) / largestOf(run, frame);
    if (!Number.isFinite(length)) return;
    const [xs, ys] = ["x", "y"].map((axis) => run.fields[`${field}_${axis}`]);
    const paths = [];
    for (let block = 0; block < run.blockCount; block += stepOfCrosses(run)) {
      const at = frame * run.blockCount + block;
      if (run.isGone(frame, block) || Math.hypot(xs[at], ys[at]) * length < 1) continue;
      const [x, y] = run.centre(frame, block);
      paths.push(...arrow(view.screenX(x), view.screenY(y), length * xs[at], -length * ys[at]));
    }
    pen.lines(paths, VECTORS[field], 1.4);
  };
  const legend = ({ run, frame }) => {
    const largest = largestOf(run, frame);
    const text = `${field}, up to ${withUnit(largest, run.scene.labels[field][1], 3, run.error(field))}`;
    return largest > 0 ? [line(VECTORS[field], 1.4, text)] : [];
  };
  return { label, draw, legend };
}

function drawChains(pen, { run, view, frame }) {
  const byWidth = Array.from({ length: WIDTHS }, () => []);
  const at = (block) => {
    const [x, y] = run.centre(frame, block);
    return [view.screenX(x), view.screenY(y)];
  };
  const largest = largestResultant(run);
  for (const { size, x, y, one, other } of resultantsOf(run, frame)) {
    const share = size / largest;
    if (!(share >= 0.005)) continue;
    const point = [view.screenX(x), view.screenY(y)];
    // a fixed block may reach far: its chain begins at the face
    const [from, to] = [one, other].map((block) => (run.fixed[block] ? point : at(block)));
    byWidth[Math.min(WIDTHS - 1, Math.floor(WIDTHS * share))].push([...from, ...point, ...to]);
  }
  byWidth.forEach((paths, k) => pen.lines(paths, FORCE, widthOfChain(k / WIDTHS)));
}

/** Return largest compression and largest tension of the blocks whose crosses are drawn, Pa. */
function largestStresses(run, frame, step) {
  let [pressed, pulled] = [0, 0];
  for (let block = 0; block < run.blockCount; block += step) {
    if (run.fixed[block] || run.isGone(frame, block)) continue;
    const [most, least] = run.principal(frame * run.blockCount + block);
    pressed = Math.max(pressed, -least);
    pulled = Math.max(pulled, most);
  }
  return [pressed, pulled];
}

function stepOfCrosses(run) {
  return Math.max(1, Math.ceil(run.blockCount / MOST_CROSSES));
}

function legendOfCrosses({ run, frame }) {
  const [pressed, pulled] = largestStresses(run, frame, stepOfCrosses(run));
  const error = run.error("sigma_1");
  const text = (what, most) => `principal stress, ${what}, up to ${withUnit(most, "Pa", 3, error)}`;
  const found = [];
  if (pressed > 0) found.push(line(PRESSED, 2, text("compression", pressed)));
  if (pulled > 0) found.push(line(PULLED, 2, text("tension", pulled)));
  return found;
}

function drawCrosses(pen, { run, view, frame }) {
  const step = stepOfCrosses(run);
  const largest = Math.max(...largestStresses(run, frame, step));
  if (!largest) return;
  const [pulled, pressed] = [[], []];
  for (let block = 0; block < run.blockCount; block += step) {
    if (run.fixed[block] || run.isGone(frame, block)) continue;
    const at = frame * run.blockCount + block;
    const [most, least, direction] = run.principal(at);
    const reach = 0.5 * Math.sqrt(run.area[block]) * view.scale;
    const [x, y] = [0, 1].map((k) => [view.screenX, view.screenY][k].call(view, run.centre(frame, block)[k]));
    for (const [value, turn] of [[most, direction], [least, direction + 0.5 * Math.PI]]) {
      const length = (reach * Math.abs(value)) / largest;
      const [dx, dy] = [length * Math.cos(turn), -length * Math.sin(turn)];
      (value > 0 ? pulled : pressed).push([x - dx, y - dy, x + dx, y + dy]);
    }
  }
  pen.lines(pressed, PRESSED, 1.2);
  pen.lines(pulled, PULLED, 1.2);
}

const DASHES = [[2, 3], [], [], [5, 4]];

/** Return the largest force of bolts in each of their states in a frame, and how many they are. */
function forcesOfBolts({ bolts }, frame) {
  const [count, largest] = [[0, 0, 0, 0], [0, 0, 0, 0]];
  for (let bolt = 0; bolt < bolts.names.length; bolt++) {
    const at = frame * bolts.names.length + bolt;
    const state = bolts.state[at];
    if (state >= count.length) continue;
    count[state]++;
    largest[state] = Math.max(largest[state], Math.abs(bolts.force[at]));
  }
  return [count, largest];
}

function widthOfBolt(force, largest) {
  return BOLTS[0] + (largest > 0 ? ((BOLTS[1] - BOLTS[0]) * Math.abs(force)) / largest : 0);
}

/** Draw bolts in the colours of their states, as wide as their forces are large. */
function drawBolts(pen, { run, view, frame }) {
  const { bolts } = run;
  const width = bolts.bolt.length;
  const largest = Math.max(...forcesOfBolts(run, frame)[1]);
  for (let bolt = 0; bolt < bolts.names.length; bolt++) {
    const at = frame * bolts.names.length + bolt;
    const state = bolts.state[at];
    if (state >= DASHES.length) continue;
    const path = [];
    for (let k = 0; k < width; k++) {
      if (bolts.bolt[k] !== bolt) continue;
      path.push(view.screenX(bolts.x[frame * width + k]), view.screenY(bolts.y[frame * width + k]));
    }
    const wide = widthOfBolt(bolts.force[at], largest);
    // a white line around it parts it from what is below
    pen.lines([path], "#ffffff", wide + 2.4);
    pen.lines([path], run.scene.bolt_looks[state][1], wide, DASHES[state]);
  }
}

function legendOfBolts({ run, frame }) {
  const [count, largest] = forcesOfBolts(run, frame);
  return run.scene.bolt_looks.flatMap(([name, colour], state) => {
    if (!count[state]) return [];
    const force = largest[state] > 0 ? `, up to ${withOneUnit(largest, "N/m", 3)[state]}` : "";
    const wide = widthOfBolt(largest[state], Math.max(...largest));
    return [line(colour, wide, name + force, DASHES[state].length > 0)];
  });
}

function drawPoints(pen, { run, view, frame, theme }) {
  const joined = run.scene.supports.convergences.map((pair) => pair.flatMap((k) => [view.screenX(run.points[k].x[frame]), view.screenY(run.points[k].y[frame])]));
  pen.lines(joined, theme.ink, 1, [5, 4]);
  run.points.forEach(({ name, x: xs, y: ys }) => {
    const [x, y] = [xs[frame], ys[frame]];
    pen.circle(view.screenX(x), view.screenY(y), 4, theme.paper, theme.ink);
    // where there is no room on its right a name stands on its left, cut where there is none either
    const right = view.screenX(x) + 8;
    const [before, behind] = [(right - 16) / LETTER, (view.width - right) / LETTER];
    const fits = name.length < behind || behind >= before;
    const [at, anchor] = fits ? [right, "start"] : [right - 16, "end"];
    const room = Math.max(6, Math.floor(fits ? behind : before));
    const text = name.length > room ? `${Array.from(name).slice(0, room - 1).join("")}…` : name;
    pen.text(at, view.screenY(y) - 8, text, theme.ink, theme.paper, anchor);
  });
}

/** Outline the block that is chosen, or mark the joint. */
export function drawChosen(pen, { run, view, frame, theme, state }) {
  if (state.joint) {
    const place = placeOfChosen(run, state);
    if (!place) return;
    const [x, y] = [view.screenX(place[0]), view.screenY(place[1])];
    const ring = Array.from({ length: 25 }, (_, k) => (k * Math.PI) / 12);
    pen.lines([ring.flatMap((turn) => [x + 8 * Math.cos(turn), y + 8 * Math.sin(turn)])], theme.chosen, 3);
    return;
  }
  if (run.isGone(frame, state.chosen)) return;
  const path = outline(run, view, run.vertices(frame), state.chosen);
  if (path) pen.lines([[...path, path[0], path[1]]], theme.chosen, 3);
}

/** Say by how much displacements are magnified, where they are. */
export function drawFactor(pen, { run, view, theme }) {
  if (run.factor !== 1) pen.text(view.width - 8, view.height - 34, factorInWords(run), theme.ink, theme.paper, "end");
}

/** Return the words for displacements that are drawn larger than they are. */
export function factorInWords({ factor }) {
  return `displacements × ${factor.toLocaleString("en", { maximumSignificantDigits: 6 })}`;
}

/** Draw a bar of a round length, with its length; axes stand in its place. */
export function drawScaleBar(pen, { view, theme, state }) {
  if (state.layers.has("axes")) return;
  const most = 0.2 * view.width / view.scale;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = power * [5, 2, 1].find((digit) => digit * power <= most);
  const [x, y] = [14, view.height - 16];
  const bar = [[x, y - 5, x, y, x + length * view.scale, y, x + length * view.scale, y - 5]];
  pen.lines(bar, theme.paper, 4.5);
  pen.lines(bar, theme.ink, 1.5);
  const text = length >= 1 ? `${length} m` : `${Number((1000 * length).toPrecision(2))} mm`;
  pen.text(x + length * view.scale + 6, y - 3, text, theme.ink, theme.paper);
}
