// What is drawn above the blocks, with a pen: contacts, chains, bolts, stresses, points, what is chosen.

import { outline } from "./draw_canvas.js";
import { scaleOfFaces } from "./colouring.js";
import { JOINTS } from "./colours.js";

const PULLED = "#b2182b";
const PRESSED = "#2166ac";
const FORCE = "#5b2a86";
const MOST_CROSSES = 4000;
/** Slip and opening beside the colours of blocks: as wide as they are large. */
const FACES = { slip: "#8e24aa", opening: "#00695c" };
const WIDTHS = 8;

/** Name of a layer -> its label and what draws it. */
export const LAYERS = {
  before: { label: "Outlines at the start", draw: drawBefore },
  joints: { label: "Edges by joint", draw: drawJoints },
  slip: { label: "Slip of joints, as line width", draw: (pen, seen) => drawFaces(pen, seen, "slip") },
  opening: { label: "Opening of joints, as line width", draw: (pen, seen) => drawFaces(pen, seen, "opening") },
  contacts: { label: "Contact forces", draw: drawContacts },
  chains: { label: "Force chains", draw: drawChains },
  crosses: { label: "Principal stresses", draw: drawCrosses },
  excavated: { label: "Excavated blocks", draw: drawExcavated },
  bolts: { label: "Bolts", draw: drawBolts },
  points: { label: "Measured points", draw: drawPoints },
};

/** Return the layers that a run has something for. */
export function layersOf(run) {
  const { scene } = run;
  const has = {
    before: true,
    joints: scene.joints.length > 1,
    slip: run.faces.slip?.shown > 0,
    opening: run.faces.opening?.shown > 0,
    contacts: run.contacts.shown > 0,
    chains: run.contacts.shown > 0,
    crosses: true,
    excavated: run.gone.some((frame) => frame < run.frameCount),
    bolts: Boolean(run.bolts),
    points: run.points.length > 0,
  };
  return Object.keys(LAYERS).filter((name) => has[name]);
}

function drawBefore(pen, { run, view, theme }) {
  const paths = [];
  for (let block = 0; block < run.blockCount; block++) {
    const path = outline(run, view, run.start, block);
    if (path) paths.push([...path, path[0], path[1]]);
  }
  pen.lines(paths, theme.faint, 0.8);
}

function drawExcavated(pen, { run, view, frame, theme }) {
  const here = run.vertices(frame);
  const paths = [];
  for (let block = 0; block < run.blockCount; block++) {
    const path = run.isGone(frame, block) && outline(run, view, here, block);
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
  for (const [joint, paths] of byJoint) pen.lines(paths, JOINTS[joint % JOINTS.length], 1.6);
}

/**
 * Draw slip or opening: in the colours of a scale where it is the field, else by width alone.
 * @param {any} pen @param {any} seen @param {string} field
 */
export function drawFaces(pen, seen, field) {
  const { run, view, frame, state } = seen;
  const own = state.field === field;
  const scale = own ? seen.scale : scaleOfFaces(run, { field, frame, share: null, limits: null });
  const faces = run.faces[field];
  // points are 4/3 pixels
  const [thin, thick] = run.scene.line_widths.map((width) => (4 / 3) * width);
  const groups = new Map();
  run.eachFace(field, frame, (k, value) => {
    const x0 = view.screenX(faces.x0[k]);
    const y0 = view.screenY(faces.y0[k]);
    const x1 = view.screenX(faces.x1[k]);
    const y1 = view.screenY(faces.y1[k]);
    if (Math.max(x0, x1) < 0 || Math.min(x0, x1) > view.width) return;
    if (Math.max(y0, y1) < 0 || Math.min(y0, y1) > view.height) return;
    const step = Math.min(WIDTHS - 1, Math.floor(WIDTHS * scale.share(value)));
    if (!own && step === 0 && scale.share(value) < 0.02) return;
    const colour = own ? scale.colour(value) : FACES[field];
    const key = `${colour} ${step}`;
    if (!groups.has(key)) groups.set(key, { colour, step, paths: [] });
    // one contact alone is a dot: no length would not be drawn
    groups.get(key).paths.push([x0, y0, x1 === x0 && y1 === y0 ? x1 + 0.01 : x1, y1]);
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

function drawContacts(pen, { run, view, frame }) {
  const { contacts } = run;
  const longest = 0.09 * Math.min(view.width, view.height);
  const paths = [];
  eachContact(run, frame, (k, size) => {
    if (size < 0.01 * contacts.largest) return;
    const length = (longest * size) / contacts.largest;
    const [ux, uy] = [contacts.fx[k] / size, -contacts.fy[k] / size];
    const x = view.screenX(contacts.x[k]);
    const y = view.screenY(contacts.y[k]);
    const head = Math.min(6, 0.4 * length);
    const [tipX, tipY] = [x + length * ux, y + length * uy];
    paths.push([x, y, tipX, tipY]);
    paths.push([
      tipX - head * (ux - 0.5 * uy), tipY - head * (uy + 0.5 * ux), tipX, tipY,
      tipX - head * (ux + 0.5 * uy), tipY - head * (uy - 0.5 * ux),
    ]);
  });
  pen.lines(paths, FORCE, 1.2);
}

function drawChains(pen, { run, view, frame }) {
  const { contacts, motion, middle, blockCount } = run;
  const byWidth = Array.from({ length: WIDTHS }, () => []);
  const at = (block) => [
    view.screenX(middle[2 * block] + motion.x[frame * blockCount + block]),
    view.screenY(middle[2 * block + 1] + motion.y[frame * blockCount + block]),
  ];
  eachContact(run, frame, (k, size) => {
    const share = size / contacts.largest;
    if (share < 0.005) return;
    const point = [view.screenX(contacts.x[k]), view.screenY(contacts.y[k])];
    // a fixed block may reach far: its chain begins at the contact
    const from = run.fixed[contacts.on[k]] ? point : at(contacts.on[k]);
    const to = run.fixed[contacts.by[k]] ? point : at(contacts.by[k]);
    byWidth[Math.min(WIDTHS - 1, Math.floor(WIDTHS * share))].push([...from, ...point, ...to]);
  });
  byWidth.forEach((paths, k) => pen.lines(paths, FORCE, 0.6 + (7 * (k + 0.5)) / WIDTHS));
}

function drawCrosses(pen, { run, view, frame }) {
  const step = Math.max(1, Math.ceil(run.blockCount / MOST_CROSSES));
  let largest = 0;
  for (let block = 0; block < run.blockCount; block += step) {
    if (run.fixed[block] || run.isGone(frame, block)) continue;
    const [most, least] = run.principal(frame * run.blockCount + block);
    largest = Math.max(largest, Math.abs(most), Math.abs(least));
  }
  if (!largest) return;
  const [pulled, pressed] = [[], []];
  for (let block = 0; block < run.blockCount; block += step) {
    if (run.fixed[block] || run.isGone(frame, block)) continue;
    const at = frame * run.blockCount + block;
    const [most, least, direction] = run.principal(at);
    const reach = 0.5 * Math.sqrt(run.area[block]) * view.scale;
    const x = view.screenX(run.middle[2 * block] + run.motion.x[at]);
    const y = view.screenY(run.middle[2 * block + 1] + run.motion.y[at]);
    for (const [value, turn] of [[most, direction], [least, direction + 0.5 * Math.PI]]) {
      const length = (reach * Math.abs(value)) / largest;
      const [dx, dy] = [length * Math.cos(turn), -length * Math.sin(turn)];
      (value > 0 ? pulled : pressed).push([x - dx, y - dy, x + dx, y + dy]);
    }
  }
  pen.lines(pressed, PRESSED, 1.2);
  pen.lines(pulled, PULLED, 1.2);
}

function drawBolts(pen, { run, view, frame, theme }) {
  const { bolts } = run;
  const width = bolts.bolt.length;
  const kinds = [[], [], [], []];
  for (let bolt = 0; bolt < bolts.names.length; bolt++) {
    const state = bolts.state[frame * bolts.names.length + bolt];
    if (state === 0 || state === 4) continue;
    const path = [];
    for (let k = 0; k < width; k++) {
      if (bolts.bolt[k] !== bolt) continue;
      path.push(view.screenX(bolts.x[frame * width + k]), view.screenY(bolts.y[frame * width + k]));
    }
    kinds[state].push(path);
  }
  pen.lines(kinds[1], theme.bolt, 2.5);
  pen.lines(kinds[2], "#d95f02", 3);
  pen.lines(kinds[3], PULLED, 2, [5, 4]);
}

function drawPoints(pen, { run, view, frame, theme }) {
  run.points.forEach(({ name, x: xs, y: ys }) => {
    const [x, y] = [xs[frame], ys[frame]];
    pen.circle(view.screenX(x), view.screenY(y), 4, theme.paper, theme.ink);
    pen.text(view.screenX(x) + 8, view.screenY(y) - 8, name, theme.ink, theme.paper);
  });
}

/** Outline the block that is chosen. */
export function drawChosen(pen, { run, view, frame, theme }, block) {
  const path = outline(run, view, run.vertices(frame), block);
  if (path) pen.lines([[...path, path[0], path[1]]], theme.chosen, 3);
}

/** Draw a bar of a round length, with its length. */
export function drawScaleBar(pen, { view, theme }) {
  const most = 0.2 * view.width / view.scale;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = power * [5, 2, 1].find((digit) => digit * power <= most);
  const [x, y] = [14, view.height - 16];
  pen.lines([[x, y - 5, x, y, x + length * view.scale, y, x + length * view.scale, y - 5]], theme.ink, 1.5);
  const text = length >= 1 ? `${length} m` : `${Number((1000 * length).toPrecision(2))} mm`;
  pen.text(x + length * view.scale + 6, y - 3, text, theme.ink, theme.paper);
}
