// Numbers of the page: decoded once, then asked for by frame.  Lengths in m about scene.origin.

/**
 * Return the bytes of a text that Python packed: base64, deflated.
 * @param {string} text
 * @returns {Promise<Uint8Array>}
 */
export async function inflated(text) {
  const packed = Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/**
 * Return an array of floats or integers of 32 bits.
 * @param {string} text
 * @param {Float32ArrayConstructor | Int32ArrayConstructor} Kind
 */
export async function rawArray(text, Kind) {
  return new Kind((await inflated(text)).buffer);
}

/**
 * Return the numbers (frames x width) of a packed table: see packing.py.
 * @param {{low: number, high: number, data: string}} table
 * @param {number} width numbers a frame
 * @returns {Promise<Float32Array>}
 */
export async function unpacked(table, width) {
  const bytes = await inflated(table.data);
  const count = bytes.length / 2;
  const found = new Float32Array(count);
  const step = (table.high - table.low) / 65535;
  const level = new Uint16Array(width);
  for (let k = 0; k < count; k++) {
    const coded = bytes[k] | (bytes[count + k] << 8);
    const change = coded & 1 ? -((coded + 1) >> 1) : coded >> 1;
    const block = k % width;
    level[block] = (level[block] + change) & 0xffff;
    found[k] = table.low + step * level[block];
  }
  return found;
}

/** What the page knows of a run. */
export class RunData {
  /** @param {any} scene what scene.py made */
  constructor(scene) {
    this.scene = scene;
    this.times = scene.times;
    this.blockCount = scene.blocks.length;
    this.frameCount = scene.times.length;
    this.fixed = new Uint8Array(this.blockCount);
    for (const block of scene.fixed) this.fixed[block] = 1;
  }

  /** Decode everything; the page can draw afterwards. */
  async decode() {
    const { scene } = this;
    const wide = this.blockCount;
    this.start = await rawArray(scene.vertices, Float32Array);
    this.blockStart = await rawArray(scene.block_start, Int32Array);
    this.edgeJoint = await rawArray(scene.edge_joint, Int32Array);
    this.motion = {};
    for (const name of ["x", "y", "angle", "xx", "yy", "xy"]) {
      this.motion[name] = await unpacked(scene.motion[name], wide);
    }
    this.fields = {};
    for (const name of Object.keys(scene.fields)) {
      this.fields[name] = await unpacked(scene.fields[name], wide);
    }
    this.middle = this.middles();
    this.area = this.areas();
    await this.decodeContacts();
    if (scene.bolts) await this.decodeBolts();
  }

  async decodeContacts() {
    const from = this.scene.contacts;
    this.contacts = { first: new Int32Array(this.frameCount + 1) };
    from.count.forEach((count, k) => {
      this.contacts.first[k + 1] = this.contacts.first[k] + count;
    });
    for (const name of ["x", "y", "fx", "fy"]) {
      this.contacts[name] = await rawArray(from[name], Float32Array);
    }
    for (const name of ["on", "by", "mode"]) {
      this.contacts[name] = await rawArray(from[name], Int32Array);
    }
    let largest = 0;
    for (let k = 0; k < this.contacts.fx.length; k++) {
      largest = Math.max(largest, Math.hypot(this.contacts.fx[k], this.contacts.fy[k]));
    }
    this.contacts.largest = largest;
  }

  async decodeBolts() {
    const from = this.scene.bolts;
    this.bolts = { bolt: from.bolt, names: from.names };
    for (const name of ["x", "y", "force"]) this.bolts[name] = await rawArray(from[name], Float32Array);
    this.bolts.state = await rawArray(from.state, Int32Array);
  }

  /** Return the mean of the start vertices of each block, m, x and y by turns. */
  middles() {
    const found = new Float32Array(2 * this.blockCount);
    for (let block = 0; block < this.blockCount; block++) {
      const first = this.blockStart[block];
      const past = this.blockStart[block + 1];
      for (let v = first; v < past; v++) {
        found[2 * block] += this.start[2 * v] / (past - first);
        found[2 * block + 1] += this.start[2 * v + 1] / (past - first);
      }
    }
    return found;
  }

  /** Return the area of each block at the start, m2. */
  areas() {
    const found = new Float32Array(this.blockCount);
    for (let block = 0; block < this.blockCount; block++) {
      const first = this.blockStart[block];
      const past = this.blockStart[block + 1];
      let twice = 0;
      for (let v = first, before = past - 1; v < past; before = v++) {
        twice +=
          this.start[2 * before] * this.start[2 * v + 1] -
          this.start[2 * v] * this.start[2 * before + 1];
      }
      found[block] = 0.5 * twice;
    }
    return found;
  }

  /**
   * Write a block's map in a frame: x' = a x + b y + e, y' = c x + d y + f about its middle.
   * @param {number} frame @param {number} block @param {Float32Array} into of six
   */
  mapOf(frame, block, into) {
    const at = frame * this.blockCount + block;
    const { x, y, angle, xx, yy, xy } = this.motion;
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

  /** Return whether a block has been excavated in a frame. */
  isGone(frame, block) {
    return frame >= this.scene.gone[block];
  }

  /**
   * Return one number of a block in a frame, in SI units; degrees for rotation.
   * @param {string} field
   */
  value(field, frame, block) {
    const at = frame * this.blockCount + block;
    const { motion, fields } = this;
    switch (field) {
      case "displacement":
        return Math.hypot(motion.x[at], motion.y[at]);
      case "displacement_x":
        return motion.x[at];
      case "displacement_y":
        return motion.y[at];
      case "rotation":
        return (motion.angle[at] * 180) / Math.PI;
      case "velocity":
        return Math.hypot(fields.velocity_x[at], fields.velocity_y[at]);
      case "sigma_1":
        return this.principal(at)[0];
      case "sigma_3":
        return this.principal(at)[1];
      case "max_shear": {
        const [most, least] = this.principal(at);
        return 0.5 * (most - least);
      }
      default:
        return fields[field][at];
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
    const here = this.vertices(frame);
    for (let block = this.blockCount - 1; block >= 0; block--) {
      if (this.isGone(frame, block)) continue;
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
}
