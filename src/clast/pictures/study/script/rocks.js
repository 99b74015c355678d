// Paths of rocks over a profile: all of them as lines, and the rock of the chosen one, played.
"use strict";
const scene = JSON.parse(document.getElementById("scene").textContent);
const part = (name) => document.querySelector(`[data-part=${name}]`);
const drawing = part("drawing");
const PER_FLIGHT = 12;
const [TIME, X, Y, ANGLE, U, V, SPIN, FLIES] = [0, 1, 2, 3, 4, 5, 6, 7];
let chosen = 0;
let time = 0;
let last = null;

// place, angle, velocity and spin of a path at a time
function stateAt({ rows }, t) {
  let k = rows.findIndex((row) => row[TIME] > t) - 1;
  if (k < 0) k = t < rows[0][TIME] ? 0 : rows.length - 1;
  const [row, next] = [rows[k], rows[k + 1]];
  if (next === undefined) return row.slice(X, FLIES);
  const since = Math.max(0, t - row[TIME]);
  const [gx, gy] = scene.gravity;
  if (row[FLIES]) {
    const [u, v] = [row[U] + gx * since, row[V] + gy * since];
    const [x, y] = [row[X] + 0.5 * (row[U] + u) * since, row[Y] + 0.5 * (row[V] + v) * since];
    return [x, y, row[ANGLE] + row[SPIN] * since, u, v, row[SPIN]];
  }
  const whole = next[TIME] - row[TIME];
  const share = whole > 0 ? since / whole : 0;
  return [X, Y, ANGLE, U, V, SPIN].map((n) => row[n] + share * (next[n] - row[n]));
}

function lineOf(path) {
  const points = [];
  path.rows.forEach((row, k) => {
    const next = path.rows[k + 1];
    const count = next && row[FLIES] ? PER_FLIGHT : 1;
    for (let i = 0; i < count; i += 1) {
      const t = next ? row[TIME] + (i / count) * (next[TIME] - row[TIME]) : row[TIME];
      points.push(i === 0 ? [row[X], row[Y]] : stateAt(path, t).slice(0, 2));
    }
  });
  return points;
}

function add(kind, points, name) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", kind);
  made.setAttribute("points", points.map((one) => one.join(",")).join(" "));
  made.setAttribute("class", name);
  part("upright").append(made);
  return made;
}

scene.blocks.forEach((one) => add("polygon", one, "block"));
const points = scene.paths.map(lineOf);
const lines = points.map((one) => add("polyline", one, "path"));
scene.profile.forEach((one) => add("polyline", one, "profile"));
scene.barriers.forEach((one) => add("polyline", one, "barrier"));
const rock = add("polygon", [], "rock");

function showAll() {
  const all = [...scene.profile, ...points].flat();
  const [xs, ys] = [0, 1].map((axis) => all.map((one) => one[axis]));
  const edges = [xs, ys].map((one) => one.reduce(([a, b], c) => [Math.min(a, c), Math.max(b, c)],
    [Infinity, -Infinity]));
  const [[left, right], [low, high]] = edges;
  const margin = 0.03 * Math.max(right - left, high - low);
  see([left - margin, -high - margin, right - left + 2 * margin, high - low + 2 * margin]);
}

let box = [0, 0, 1, 1];
function see(wanted) {
  box = wanted;
  drawing.setAttribute("viewBox", box.join(" "));
}

function draw() {
  const path = scene.paths[chosen];
  const [x, y, angle, u, v, spin] = stateAt(path, time);
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const corners = path.corners.map(([a, b]) => [x + c * a - s * b, y + s * a + c * b]);
  rock.setAttribute("points", corners.map((one) => one.join(",")).join(" "));
  const energy = 0.5 * path.mass * (u * u + v * v) + 0.5 * path.inertia * spin * spin;
  part("told").textContent = `path ${path.number} of ${path.source}: ${path.end}; ` +
    `t = ${time.toFixed(2)} s, ${Math.hypot(u, v).toFixed(1)} m/s, ${(energy / 1e3).toFixed(1)} kJ`;
  part("time").value = time;
}

function choose(number) {
  lines[chosen].classList.remove("chosen");
  chosen = Math.min(Math.max(number, 0), scene.paths.length - 1);
  lines[chosen].classList.add("chosen");
  lines[chosen].after(rock);
  const end = scene.paths[chosen].rows.at(-1)[TIME];
  [time, part("time").max] = [0, end];
  part("path").value = scene.paths[chosen].number;
  draw();
}

function step(now) {
  if (last === null) return;
  time = Math.min(time + 1e-3 * (now - last), Number(part("time").max));
  last = now;
  draw();
  if (time < Number(part("time").max)) requestAnimationFrame(step);
  else play(false);
}

function play(on) {
  part("play").textContent = on ? "Pause" : "Play";
  last = on ? performance.now() : null;
  if (on && time >= Number(part("time").max)) time = 0;
  if (on) requestAnimationFrame(step);
}

// where a pointer is, m
function placeOf(event) {
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(
    part("upright").getScreenCTM().inverse());
  return [at.x, at.y];
}

function apart([x, y], [a, b], [c, d]) {
  const [dx, dy] = [c - a, d - b];
  const share = Math.min(1, Math.max(0, ((x - a) * dx + (y - b) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - a - share * dx, y - b - share * dy);
}

drawing.addEventListener("click", (event) => {
  const at = placeOf(event);
  const near = points.map((line) => line.reduce((best, one, k) =>
    k === 0 ? best : Math.min(best, apart(at, line[k - 1], one)), Infinity));
  choose(near.indexOf(Math.min(...near)));
});
drawing.addEventListener("wheel", (event) => {
  event.preventDefault();
  const [x, y] = placeOf(event);
  const k = Math.exp(1e-3 * event.deltaY);
  see([x + k * (box[0] - x), -y + k * (box[1] + y), k * box[2], k * box[3]]);
}, { passive: false });
part("play").addEventListener("click", () => play(last === null));
part("all").addEventListener("click", showAll);
part("time").addEventListener("input", () => { time = Number(part("time").value); draw(); });
part("path").addEventListener("change", () => {
  choose(scene.paths.findIndex(({ number }) => number >= Number(part("path").value)));
});
part("title").textContent = scene.title;
showAll();
choose(0);
document.querySelector("main").dataset.ready = "yes";
