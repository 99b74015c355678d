// Numbers of the page: decoded once, then asked for by frame.  Lengths in m about scene.origin.

import { facesOfContacts, isOfContacts } from "./contact_faces.js";
import { magnified } from "./magnified.js";
import { decodeMoving, joined } from "./moving.js";
import { rawArray } from "./packing.js";

const SINGLE = 2 ** -24;
/** Rounding of 32-bit floats, as a share of the number. */

/** What the page knows of a run. */
export class RunData {
  /** @param {any} scene what scene.py made */
  constructor(scene) {
    this.scene = scene;
    this.blockCount = scene.blocks.length;
    this.fixed = new Uint8Array(this.blockCount);
    for (const block of scene.fixed) this.fixed[block] = 1;
    this.lined = new Set(scene.lined);
    /** Displacements are drawn this many times as large as they are. */
    this.factor = 1;
    /** Whether compression counts as positive; stresses of a file have tension positive. */
    this.pressedPositive = false;
  }

  /** Decode everything; the page can draw afterwards. */
  async decode() {
    const { scene } = this;
    this.start = await rawArray(scene.vertices, Float32Array);
    this.blockStart = await rawArray(scene.block_start, Int32Array);
    this.edgeJoint = await rawArray(scene.edge_joint, Int32Array);
    this.measure();
    this.take(await decodeMoving(scene, this.blockStart));
  }

  /** Put frames behind that the run has made since. */
  async append(part) {
    this.take(joined(this.moving, await decodeMoving(part, this.blockStart), this.blockCount));
  }

  take(moving) {
    this.moving = moving;
    this.magnify(this.factor);
  }

  /** Draw displacements from the start some times as large as they are. */
  magnify(factor) {
    const { moving } = this;
    this.factor = factor;
    this.placed = -1;
    this.ofContacts = {};
    this.frameCount = moving.times.length;
    for (const name of ["times", "stages", "gone", "motion", "fields", "contacts", "faces", "bolts", "points", "levels", "flows", "links", "reactions", "linings"]) {
      this[name] = moving[name];
    }
    Object.assign(this, magnified(this, factor));
  }

  /** Work out centroids, m, x and y by turns, and areas, m2, of the blocks at the start, and how far areas may be off. */
  measure() {
    this.middle = new Float32Array(2 * this.blockCount);
    this.area = new Float32Array(this.blockCount);
    this.areaError = new Float32Array(this.blockCount);
    for (let block = 0; block < this.blockCount; block++) {
      const first = this.blockStart[block];
      const past = this.blockStart[block + 1];
      const [x0, y0] = [this.start[2 * first], this.start[2 * first + 1]];
      const reach = SINGLE * Math.max(Math.abs(x0), Math.abs(y0));
      let [twice, sumX, sumY, around] = [0, 0, 0, 0];
      for (let v = first, before = past - 1; v < past; before = v++) {
        // from the first vertex, so that nothing is lost far from the origin
        const [ax, ay] = [this.start[2 * before] - x0, this.start[2 * before + 1] - y0];
        const [bx, by] = [this.start[2 * v] - x0, this.start[2 * v + 1] - y0];
        const cross = ax * by - ay * bx;
        twice += cross;
        sumX += cross * (ax + bx);
        sumY += cross * (ay + by);
        around += Math.hypot(bx - ax, by - ay);
      }
      this.area[block] = 0.5 * twice;
      this.areaError[block] = reach * around;
      this.middle[2 * block] = x0 + sumX / (3 * twice);
      this.middle[2 * block + 1] = y0 + sumY / (3 * twice);
    }
  }

  /**
   * Write a block's map in a frame, as it is drawn: x' = a x + b y + e, y' = c x + d y + f about its middle.
   * @param {number} frame @param {number} block @param {Float32Array} into of six
   */
  mapOf(frame, block, into) {
    this.trueMapOf(frame, block, into);
    if (this.factor === 1) return;
    const still = [1, 0, 0, 1, this.middle[2 * block], this.middle[2 * block + 1]];
    for (let k = 0; k < 6; k++) into[k] = still[k] + this.factor * (into[k] - still[k]);
  }

  /** Write a block's map in a frame, as in ``mapOf``, with the displacements that it has. */
  trueMapOf(frame, block, into) {
    const at = frame * this.blockCount + block;
    const { x, y, angle, xx, yy, xy } = this.moving.motion;
    const cosine = Math.cos(angle[at]);
    const sine = Math.sin(angle[at]);
    into[0] = cosine * (1 + xx[at]) - sine * xy[at];
    into[1] = cosine * xy[at] - sine * (1 + yy[at]);
    into[2] = sine * (1 + xx[at]) + cosine * xy[at];
    into[3] = sine * xy[at] + cosine * (1 + yy[at]);
    into[4] = this.middle[2 * block] + x[at];
    into[5] = this.middle[2 * block + 1] + y[at];
  }

  /**
   * Return all vertices of a frame, m, x and y by turns; the array is used again.
   * @param {number} frame
   */
  vertices(frame) {
    if (this.placed === frame) return this.here;
    this.placed = frame;
    this.here ??= new Float32Array(this.start.length);
    const map = new Float32Array(6);
    for (let block = 0; block < this.blockCount; block++) {
      this.mapOf(frame, block, map);
      const x0 = this.middle[2 * block];
      const y0 = this.middle[2 * block + 1];
      for (let v = this.blockStart[block]; v < this.blockStart[block + 1]; v++) {
        const x = this.start[2 * v] - x0;
        const y = this.start[2 * v + 1] - y0;
        this.here[2 * v] = map[0] * x + map[1] * y + map[4];
        this.here[2 * v + 1] = map[2] * x + map[3] * y + map[5];
      }
    }
    return this.here;
  }

  /** Return where the centroid of a block is drawn in a frame, m. */
  centre(frame, block) {
    const at = frame * this.blockCount + block;
    const { x, y } = this.moving.motion;
    return [this.middle[2 * block] + this.factor * x[at], this.middle[2 * block + 1] + this.factor * y[at]];
  }

  /** Return the box of points x and y by turns, of those of some blocks: left, low, right, high, m. */
  boxOf(points, counts = () => true) {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (let block = 0; block < this.blockCount; block++) {
      if (!counts(block)) continue;
      for (let k = 2 * this.blockStart[block]; k < 2 * this.blockStart[block + 1]; k += 2) {
        box[0] = Math.min(box[0], points[k]);
        box[1] = Math.min(box[1], points[k + 1]);
        box[2] = Math.max(box[2], points[k]);
        box[3] = Math.max(box[3], points[k + 1]);
      }
    }
    return box;
  }

  /** Return where one vertex of a block is in a frame, m. */
  vertex(frame, block, vertex) {
    const map = new Float32Array(6);
    this.mapOf(frame, block, map);
    const x = this.start[2 * vertex] - this.middle[2 * block];
    const y = this.start[2 * vertex + 1] - this.middle[2 * block + 1];
    return [map[0] * x + map[1] * y + map[4], map[2] * x + map[3] * y + map[5]];
  }

  /** Return whether a block is not there in a frame: it has been excavated, or comes later. */
  isGone(frame, block) {
    const past = this.gone[block].findIndex((change) => change > frame);
    return (past < 0 ? this.gone[block].length : past) % 2 === 1;
  }

  /** Return whether a block is a segment of a lining that comes after a frame. */
  isAwaited(frame, block) {
    const [first, second = Infinity] = this.gone[block];
    return this.lined.has(block) && first === 0 && frame < second;
  }

  /**
   * Return one number of a block in a frame, in SI units; degrees for rotation.
   * @param {string} field
   */
  value(field, frame, block) {
    const at = frame * this.blockCount + block;
    const { fields } = this;
    switch (field) {
      case "displacement":
        return Math.hypot(fields.displacement_x[at], fields.displacement_y[at]);
      case "rotation":
        return (fields.rotation[at] * 180) / Math.PI;
      case "velocity":
        return Math.hypot(fields.velocity_x[at], fields.velocity_y[at]);
      case "sigma_1":
      case "sigma_3": {
        // the largest compression is the largest stress where compression is positive
        const [most, least] = this.principal(at);
        if (this.pressedPositive) return field === "sigma_1" ? -least : -most;
        return field === "sigma_1" ? most : least;
      }
      case "sigma_xx":
      case "sigma_yy":
      case "sigma_xy":
        return this.pressedPositive ? -fields[field][at] : fields[field][at];
      case "max_shear": {
        const [most, least] = this.principal(at);
        return 0.5 * (most - least);
      }
      default:
        return fields[field][at];
    }
  }

  /** Return how far a number of a block may be from that of the run, for it was rounded. */
  error(field) {
    const half = (name) => 0.5 * this.fields[name].step;
    const stress = () => ["sigma_xx", "sigma_yy", "sigma_xy"].map(half);
    switch (field) {
      case "displacement":
      case "velocity":
        return Math.hypot(half(`${field}_x`), half(`${field}_y`));
      case "rotation":
        return (half("rotation") * 180) / Math.PI;
      case "sigma_1":
      case "sigma_3": {
        const [xx, yy, xy] = stress();
        return Math.max(xx, yy) + xy;
      }
      case "max_shear": {
        const [xx, yy, xy] = stress();
        return Math.hypot(0.5 * (xx + yy), xy);
      }
      default:
        return half(field);
    }
  }

  /** Return largest and smallest principal stress, Pa, and the direction of the largest, rad. */
  principal(at) {
    const { sigma_xx: xx, sigma_yy: yy, sigma_xy: xy } = this.fields;
    const mean = 0.5 * (xx[at] + yy[at]);
    const half = 0.5 * (xx[at] - yy[at]);
    const radius = Math.hypot(half, xy[at]);
    return [mean + radius, mean - radius, 0.5 * Math.atan2(xy[at], half)];
  }

  /** Return the values of all blocks in a frame; the array is new. */
  values(field, frame) {
    const found = new Float32Array(this.blockCount);
    for (let block = 0; block < this.blockCount; block++) {
      found[block] = this.value(field, frame, block);
    }
    return found;
  }

  /** Corners of fill, and wheels, m. */
  get surroundings() {
    const { fill = [], axles = [] } = this.scene.surcharge ?? {};
    return [...fill.flatMap(({ outline }) => outline), ...axles.map(({ at }) => at[0])];
  }

  /** Return the frame nearest to a time, s. */
  frameAt(time) {
    let low = 0;
    let high = this.frameCount - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle;
    }
    return time - this.times[low] <= this.times[high] - time ? low : high;
  }

  /**
   * Return the block at a point of a frame, -1 for none.
   * @param {number} frame @param {number} x m @param {number} y m
   */
  blockAt(frame, x, y) {
    return this.blockOfOutline(this.vertices(frame), x, y, (block) => this.isGone(frame, block));
  }

  /** Return the block whose outline, of those of all blocks, holds a point; -1 for none. */
  blockOfOutline(here, x, y, isGone = () => false) {
    for (let block = this.blockCount - 1; block >= 0; block--) {
      if (isGone(block)) continue;
      let inside = false;
      const past = this.blockStart[block + 1];
      for (let v = this.blockStart[block], before = past - 1; v < past; before = v++) {
        const y1 = here[2 * v + 1];
        const y2 = here[2 * before + 1];
        if (y1 > y === y2 > y) continue;
        const crossing = here[2 * v] + ((y - y1) / (y2 - y1)) * (here[2 * before] - here[2 * v]);
        if (x < crossing) inside = !inside;
      }
      if (inside) return block;
    }
    return -1;
  }

  /** Return whether joints have a field. */
  hasFaces(name) {
    return isOfContacts(name) ? this.contacts.shown > 0 : name in this.faces;
  }

  /**
   * Call back with every face of the joints in a frame: its ends x0, y0, x1, y1, value, length, and its
   * width as a share of the widest, undefined where it is that of the value.
   * @param {string} name slip, opening, mobilised, ...
   */
  eachFace(name, frame, call) {
    const [faces, first, past] = this.facesIn(name, frame);
    for (let k = first; k < past; k++) {
      const ends = [faces.x0[k], faces.y0[k], faces.x1[k], faces.y1[k]];
      call(ends, faces.value[k], Math.hypot(ends[2] - ends[0], ends[3] - ends[1]), faces.width?.[k]);
    }
  }

  /** Return a table of faces, and the first row and the one past the last of a frame. */
  facesIn(name, frame) {
    if (!isOfContacts(name)) {
      const faces = this.faces[name];
      return [faces, faces.first[frame], faces.first[frame + 1]];
    }
    if (this.ofContacts.name !== name || this.ofContacts.frame !== frame) {
      this.ofContacts = { name, frame, faces: facesOfContacts(this, name, frame) };
    }
    const { faces } = this.ofContacts;
    return [faces, 0, faces.value.length];
  }
}
