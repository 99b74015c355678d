// Displacements drawn larger than they are: places that blocks carry, from the true ones.

/**
 * Return what changes from frame to frame with displacements from the start ``factor`` times as large.
 * @param {import("./data.js").RunData} run @param {number} factor
 */
export function magnified(run, factor) {
  const { moving, start } = run;
  if (factor === 1) return moving;
  const blockOf = new Int32Array(start.length / 2);
  for (let block = 0; block < run.blockCount; block++) blockOf.fill(block, run.blockStart[block], run.blockStart[block + 1]);
  const found = { ...moving };
  found.contacts = carried(run, moving.contacts, [["x", "y"]], (k) => moving.contacts.on[k], factor);
  found.faces = {};
  for (const [name, faces] of Object.entries(moving.faces)) {
    const ends = [["x0", "y0"], ["x1", "y1"]];
    found.faces[name] = carried(run, faces, ends, (k) => blockOf[faces.edge[k]], factor);
  }
  // points, bolts and links move with one block each: from where they are in the first frame
  const from = (values, wide) => values.map((value, k) => values[k % wide] + factor * (value - values[k % wide]));
  found.points = moving.points.map(({ name, x, y }) => ({ name, x: from(x, 1), y: from(y, 1) }));
  if (moving.bolts) {
    const wide = moving.bolts.bolt.length;
    found.bolts = { ...moving.bolts, x: from(moving.bolts.x, wide), y: from(moving.bolts.y, wide) };
  }
  if (moving.links) {
    const wide = moving.links.names.length;
    found.links = { ...moving.links };
    for (const end of ["x0", "y0", "x1", "y1"]) found.links[end] = from(moving.links[end], wide);
  }
  return found;
}

/** Return a table of rows of frames whose places are where their blocks carry them. */
function carried(run, table, places, blockOf, factor) {
  const found = { ...table };
  const map = new Float32Array(6);
  for (const [nameX, nameY] of places) {
    const [xs, ys] = [Float32Array.from(table[nameX]), Float32Array.from(table[nameY])];
    for (let frame = 0; frame + 1 < table.first.length; frame++) {
      for (let k = table.first[frame]; k < table.first[frame + 1]; k++) {
        const block = blockOf(k);
        run.trueMapOf(frame, block, map);
        const determinant = map[0] * map[3] - map[1] * map[2];
        const [px, py] = [xs[k] - map[4], ys[k] - map[5]];
        const x = run.middle[2 * block] + (map[3] * px - map[1] * py) / determinant;
        const y = run.middle[2 * block + 1] + (map[0] * py - map[2] * px) / determinant;
        xs[k] = x + factor * (xs[k] - x);
        ys[k] = y + factor * (ys[k] - y);
      }
    }
    [found[nameX], found[nameY]] = [xs, ys];
  }
  return found;
}

/** Return a round factor with which the largest displacement of a frame is a twentieth of the model. */
export function factorToBeSeen(run, frame) {
  const { x, y } = run.moving.motion;
  let largest = 0;
  for (let block = 0; block < run.blockCount; block++) {
    if (run.isGone(frame, block)) continue;
    const at = frame * run.blockCount + block;
    largest = Math.max(largest, Math.hypot(x[at], y[at]));
  }
  const box = run.boxOf(run.start);
  const wanted = (0.05 * Math.max(box[2] - box[0], box[3] - box[1])) / largest;
  if (!(wanted > 1) || !Number.isFinite(wanted)) return 1;
  const power = 10 ** Math.floor(Math.log10(wanted));
  return power * [5, 2, 1].find((digit) => digit * power <= wanted);
}
