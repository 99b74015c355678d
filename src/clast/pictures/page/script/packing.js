// Numbers as packing.py writes them.

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
  const planes = await inflated(text);
  const bytes = new Uint8Array(planes.length);
  const count = planes.length / 4;
  for (let k = 0; k < count; k++) {
    for (let plane = 0; plane < 4; plane++) bytes[4 * k + plane] = planes[plane * count + k];
  }
  return new Kind(bytes.buffer);
}

/**
 * Return the numbers (frames x width) of a packed table, with the ``step`` that they are rounded to: see packing.py.
 * @param {{low: number, high: number, levels: number, order: number, data: string}} table
 * @param {number} width numbers a frame
 * @returns {Promise<Float32Array>}
 */
export async function unpacked(table, width) {
  const bytes = await inflated(table.data);
  const count = bytes.length / 2;
  const found = new Float32Array(count);
  const step = (table.high - table.low) / table.levels;
  const level = new Uint16Array(width);
  // of the second order the change itself changes; both go on from 65,535 to 0
  const slope = table.order === 2 ? new Uint16Array(width) : null;
  for (let k = 0; k < count; k++) {
    const coded = bytes[k] | (bytes[count + k] << 8);
    const change = coded & 1 ? -((coded + 1) >> 1) : coded >> 1;
    const block = k % width;
    if (slope) slope[block] += change;
    level[block] += slope ? slope[block] : change;
    const value = table.low + step * level[block];
    // zero is a level
    found[k] = Math.abs(value) < 1e-6 * step ? 0 : value;
  }
  found.step = step;
  return found;
}

