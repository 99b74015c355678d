// Numbers of joints that follow from the forces of their contacts, as in still pictures: see joint_values.py.

const STRAIGHT = 12;
/** Directions in half a turn that are told apart: faces of two blocks at a corner are two. */
const SLIDES = 1;
/** Mode of a contact that slides. */
const CORNER = 0.01;
/** Contacts nearer to each other than this share of the smaller block's size have no face between them. */

/** Name of a field -> its value, from the sums over a face: shear, normal, pressure, pressure that slides. */
const VALUES = {
  mobilised: ({ shear, normal }) => (180 / Math.PI) * Math.atan2(Math.abs(shear), Math.max(0, normal)),
  sliding: ({ pressed, sliding }) => (100 * sliding) / Math.max(pressed, 1e-300),
  utilisation: ({ shear, strength }) => (100 * Math.abs(shear)) / Math.max(strength, 1e-300),
  normal_stress: (face) => face.normal / lengthOf(face),
  shear_stress: (face) => Math.abs(face.shear) / lengthOf(face),
};

/** Return the length of a face between its outermost contacts, m; NaN at a corner. */
function lengthOf({ low, high, size }) {
  return high - low > CORNER * size ? high - low : NaN;
}

/** Return whether a field is one of these. */
export function isOfContacts(name) {
  return name in VALUES;
}

/**
 * Return the faces that the contacts of a frame lie along, as the faces of other fields are kept.
 * @param {import("./data.js").RunData} run @param {string} name mobilised or sliding
 */
export function facesOfContacts(run, name, frame) {
  const { contacts } = run;
  const every = gathered(run, frame).filter((face) => Number.isFinite(VALUES[name](face)));
  const found = { value: Float32Array.from(every, VALUES[name]) };
  for (const [end, of] of [["x0", "first"], ["x1", "last"]]) {
    found[end] = Float32Array.from(every, (face) => contacts.x[face[of]]);
    found[end.replace("x", "y")] = Float32Array.from(every, (face) => contacts.y[face[of]]);
  }
  return found;
}

/** Return the resultant of each face of a frame: its size and error, N/m, its place, m, its contacts' blocks. */
export function resultantsOf(run, frame) {
  return gathered(run, frame).map(({ fx, fy, weight, x, y, one, other, count }) => ({
    size: Math.hypot(fx, fy),
    error: count * run.contacts.error,
    x: x / Math.max(weight, 1e-300),
    y: y / Math.max(weight, 1e-300),
    one,
    other,
  }));
}

/** Return length, stresses and strength of the face that a contact (row) belongs to, as rows of a table. */
export function stressesOfFace(run, frame, row) {
  const { contacts } = run;
  const face = gathered(run, frame).find((one) => one.rows.includes(row));
  const length = lengthOf(face);
  if (!Number.isFinite(length)) return [];
  const off = (face.count * contacts.error) / length;
  return [
    ["Length of the face", length, "m", 0],
    ["Normal stress, compression positive", face.normal / length, "Pa", off],
    ["Shear stress", Math.abs(face.shear) / length, "Pa", off],
    ["Shear strength", face.strength / length, "Pa", off],
    ["Share of the strength used", (100 * Math.abs(face.shear)) / face.strength, "%", (100 * off * length) / face.strength],
  ];
}

/** Return the largest resultant of a face in all frames, N/m. */
export function largestResultant(run) {
  const { contacts } = run;
  if (contacts.largestResultant?.frames !== run.frameCount) {
    let largest = 0;
    for (let frame = 0; frame < run.frameCount; frame++) {
      for (const { size } of resultantsOf(run, frame)) largest = Math.max(largest, size);
    }
    contacts.largestResultant = { largest, frames: run.frameCount };
  }
  return contacts.largestResultant.largest;
}

/** Return the faces of a frame, with the sums of their contacts. */
function gathered(run, frame) {
  const { contacts } = run;
  const faces = new Map();
  for (let k = contacts.first[frame]; k < contacts.first[frame + 1]; k++) {
    const [one, other] = [contacts.on[k], contacts.by[k]];
    const [least, most] = one < other ? [one, other] : [other, one];
    // the edge runs across the normal; half a turn more is the same direction
    const turn = Math.round(((contacts.angle[k] + 0.5 * Math.PI) * STRAIGHT) / Math.PI);
    const direction = ((turn % STRAIGHT) + STRAIGHT) % STRAIGHT;
    const key = (least * run.blockCount + most) * STRAIGHT + direction;
    let face = faces.get(key);
    if (!face) faces.set(key, (face = faceFrom(run, k)));
    add(face, contacts, k);
  }
  return [...faces.values()];
}

function faceFrom({ contacts, area }, k) {
  const along = [-Math.sin(contacts.angle[k]), Math.cos(contacts.angle[k])];
  const [one, other] = [contacts.on[k], contacts.by[k]];
  const sums = { count: 0, shear: 0, strength: 0, normal: 0, pressed: 0, sliding: 0, fx: 0, fy: 0, weight: 0, x: 0, y: 0 };
  const size = Math.sqrt(Math.min(area[one], area[other]));
  return { along, one, other, size, low: Infinity, high: -Infinity, rows: [], ...sums };
}

function add(face, contacts, k) {
  const place = contacts.x[k] * face.along[0] + contacts.y[k] * face.along[1];
  if (place < face.low) [face.low, face.first] = [place, k];
  if (place > face.high) [face.high, face.last] = [place, k];
  const pressed = Math.max(0, contacts.normal[k]);
  face.count += 1;
  face.rows.push(k);
  face.shear += contacts.shear[k];
  face.strength += contacts.strength[k];
  face.normal += contacts.normal[k];
  face.pressed += pressed;
  if (contacts.mode[k] === SLIDES) face.sliding += pressed;
  // on the first block of the face, whichever has the vertex
  const side = contacts.on[k] === face.one ? 1 : -1;
  const [fx, fy] = [side * contacts.fx[k], side * contacts.fy[k]];
  const weight = Math.hypot(fx, fy);
  face.fx += fx;
  face.fy += fy;
  face.weight += weight;
  face.x += weight * contacts.x[k];
  face.y += weight * contacts.y[k];
}
