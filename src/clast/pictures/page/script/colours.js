// Colours of values, and where their scale ends; the same as in still pictures.

const KINDS = ["#e0c9a0", "#a9b88f", "#d9a384", "#c3b9c9", "#c9c07a", "#b59a7a", "#e3b7b7", "#9c9c8e"];
export const FIXED = "#dcdcdc";
/** Fill of blocks where their joints have the colours. */
export const PLAIN = "#f3efe6";

/** Return the colour of a rock or block by its number; rows of eight do not line up. */
export function kindColour(kind) {
  return KINDS[(kind + Math.floor(kind / KINDS.length)) % KINDS.length];
}

// these are those of scale.py
const FEW = 0.01;
const SPOILT = 3;
const NOISE = 1e-6;
const ONE_SIDED = 0.02;

/**
 * Return the ends of a scale of values (n,): 0 is one of them, or the middle.
 * @param {Float32Array} values
 * @param {Float32Array} weights area or length of each (n,)
 * @param {number | null} share of the values that the scale holds, 0 to 1; null for all but a few
 *   that would spoil it, as in still pictures
 * @param {number} error how far values may be from the true ones: a scale is no finer than ten times that
 */
export function endsOf(values, weights, share, error = 0) {
  const size = Math.max(10 * error, share === null ? largestButFew(values, weights) : quantile(values, share));
  if (!(size > 0)) return [0, 1];
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (Math.max(-size, low) >= -ONE_SIDED * size) return [0, size];
  if (Math.min(size, high) <= ONE_SIDED * size) return [-size, 0];
  return [-size, size];
}

function quantile(values, share) {
  const sizes = Float32Array.from(values, Math.abs).sort();
  return sizes.length ? sizes[Math.min(sizes.length - 1, Math.ceil(share * sizes.length) - 1)] : 0;
}

/** Return the largest size of values (n,), but for those of a hundredth of the weight that stand out. */
export function largestButFew(values, weights) {
  const sizes = Float32Array.from(values, Math.abs);
  const order = Array.from(sizes.keys()).sort((a, b) => sizes[b] - sizes[a]);
  if (!order.length) return 0;
  const total = weights.reduce((sum, one) => sum + one, 0);
  let before = 0;
  const usual = order.find((k) => (before += weights[k]) > FEW * total);
  const largest = sizes[order[0]];
  if (usual === undefined || sizes[usual] <= NOISE * largest) return largest;
  return sizes[order.find((k) => sizes[k] <= SPOILT * sizes[usual])];
}

/** Colours between two values. */
export class Scale {
  /** @param {any} colours by kind @param {number} low @param {number} high */
  constructor(colours, low, high) {
    this.low = low;
    this.high = high;
    /** What lies beyond, by colour, value that is furthest away, and word. */
    this.beyond = [];
    const kind = low >= 0 ? "rising" : high <= 0 ? "falling" : "both";
    this.colours = colours[kind];
    [this.under, this.over] = colours.beyond[kind];
    // a scale on both sides is drawn about zero: its colours are those of the larger side
    const half = Math.max(-low, high);
    [this.first, this.last] = kind === "both" ? [-half, half] : [low, high];
  }

  /** Take note of the values of a frame, known to an error: how far they go beyond the scale, by more than a ``slack``. */
  holds(values, slack, error = 0) {
    const [least, most] = values.reduce(([a, b], one) => [Math.min(a, one), Math.max(b, one)], [Infinity, -Infinity]);
    const room = slack * (this.high - this.low);
    this.error = error;
    this.beyond = [];
    if (least < this.low - room) this.beyond.push({ colour: this.under, value: least, word: "below" });
    if (most > this.high + room) this.beyond.push({ colour: this.over, value: most, word: "above" });
    return this;
  }

  /** Return a value's colour. */
  colour(value) {
    if (value < this.low) return this.under;
    if (value > this.high) return this.over;
    const share = (value - this.first) / (this.last - this.first || 1);
    return this.colours[Math.max(0, Math.min(this.colours.length - 1, Math.floor(share * this.colours.length)))];
  }

  /** Return how large a value is beside the largest of the scale, 0 to 1. */
  share(value) {
    return Math.min(1, Math.abs(value) / Math.max(-this.low, this.high));
  }
}

/** Values beyond a scale by less than this share are not told, as in still pictures: see scale.py. */
export const SLACK = { limits: 1e-9, ends: 0.02 };

const PREFIXES = { "-3": "n", "-2": "µ", "-1": "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T" };

const FEWEST = 3;
/** Digits of a number at least; where fewer are known its error stands behind it. */

/**
 * Return a number with a unit and a prefix, 1.25 MPa, in the digits that are known: 0.12 ± 0.02 MPa.
 * @param {number} error how far the number may be from the true one
 */
export function withUnit(value, unit, digits = 4, error = 0) {
  if (!Number.isFinite(value)) return "–";
  // of the last digit that is shown the error is a tenth at most
  const known = error > 0 ? Math.floor(Math.log10(Math.abs(value))) - Math.ceil(Math.log10(10 * error)) + 1 : digits;
  if (known >= Math.min(FEWEST, digits)) return inUnits([value], unit, Math.min(digits, known));
  const last = lastDigit(error);
  const near = rounded(value, error);
  const bound = last * Math.ceil((error + Math.abs(value - near)) / last - 1e-9);
  return inUnits([near, bound], unit, 12);
}

function lastDigit(error) {
  return 10 ** Math.floor(Math.log10(error));
}

/** Return a number to the digit of its error. */
export function rounded(value, error) {
  return error > 0 ? Number((Math.round(value / lastDigit(error)) * lastDigit(error)).toPrecision(12)) : value;
}

/** Return numbers of one axis, all with the same unit and prefix. */
export function withOneUnit(values, unit, digits = 4) {
  const thousands = thousandsOf(values, unit);
  return values.map((one) => `${plain(one * 10 ** (-3 * thousands), digits)} ${PREFIXES[thousands]}${unit}`.trim());
}

/** Return the power of a thousand in which numbers with a unit are shown; moments always in kN m/m. */
function thousandsOf(numbers, unit) {
  if (unit === "N m/m") return 1;
  const size = Math.max(...numbers.map(Math.abs));
  let thousands = 0;
  // µm2 are not a millionth of m2
  if (size > 0 && !["°", "%", ""].includes(unit) && !unit.startsWith("m2")) {
    thousands = Math.floor(Math.log10(size * (1 + 1e-12)) / 3);
    thousands = Math.max(-3, Math.min(unit.startsWith("m") || unit === "s" ? 0 : 4, thousands));
  }
  return thousands;
}

function inUnits(numbers, unit, digits) {
  const thousands = thousandsOf(numbers, unit);
  const text = numbers.map((one) => plain(one * 10 ** (-3 * thousands), digits)).join(" ± ");
  return unit === "°" ? `${text}°` : `${text} ${PREFIXES[thousands]}${unit}`.trim();
}

/** Return a number with a few digits and a true minus sign. */
export function plain(value, digits = 4) {
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}
