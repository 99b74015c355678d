// Colours of values, and where their scale ends; the same as in still pictures.

const KINDS = ["#e0c9a0", "#a9b88f", "#d9a384", "#c3b9c9", "#c9c07a", "#b59a7a", "#e3b7b7", "#9c9c8e"];
export const JOINTS = ["#332288", "#cc6677", "#117733", "#aa4499", "#88ccee", "#999933", "#882255", "#44aa99"];
export const FIXED = "#dcdcdc";
export const PLAIN = "#efece4";

/** Return the colour of a rock or block by its number; rows of eight do not line up. */
export function kindColour(kind) {
  return KINDS[(kind + Math.floor(kind / KINDS.length)) % KINDS.length];
}

/**
 * Return the ends of a scale of values (n,): 0 is one of them, or the middle.
 * @param {Float32Array | number[]} values
 * @param {number} share of the values that the scale holds, 0 to 1
 */
export function endsOf(values, share) {
  const sizes = Float32Array.from(values, Math.abs).sort();
  const size = sizes.length ? sizes[Math.min(sizes.length - 1, Math.ceil(share * sizes.length) - 1)] : 0;
  if (!(size > 0)) return [0, 1];
  let low = 0;
  let high = 0;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low >= -0.02 * size) return [0, size];
  if (high <= 0.02 * size) return [-size, 0];
  return [-size, size];
}

/** Colours between two values. */
export class Scale {
  /** @param {Record<string, string[]>} colours by kind @param {number} low @param {number} high */
  constructor(colours, low, high) {
    this.low = low;
    this.high = high;
    const kind = low >= 0 ? "rising" : high <= 0 ? "falling" : "both";
    this.colours = colours[kind];
    // a scale on both sides is drawn about zero: its colours are those of the larger side
    const half = Math.max(-low, high);
    [this.first, this.last] = kind === "both" ? [-half, half] : [low, high];
  }

  /** Return the number of a value's colour. */
  number(value) {
    const share = (value - this.first) / (this.last - this.first || 1);
    return Math.max(0, Math.min(this.colours.length - 1, Math.floor(share * this.colours.length)));
  }

  /** Return a value's colour. */
  colour(value) {
    return this.colours[this.number(Math.max(this.low, Math.min(this.high, value)))];
  }
}

const PREFIXES = { "-3": "n", "-2": "µ", "-1": "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T" };

/** Return a number with a unit and a prefix: 1.25 MPa. */
export function withUnit(value, unit, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0 || unit === "°" || unit === "") return `${plain(value, digits)} ${unit}`.trim();
  let thousands = Math.floor(Math.log10(Math.abs(value) * (1 + 1e-12)) / 3);
  thousands = Math.max(-3, Math.min(unit.startsWith("m") || unit === "s" ? 0 : 4, thousands));
  return `${plain(value * 10 ** (-3 * thousands), digits)} ${PREFIXES[thousands]}${unit}`;
}

/** Return a number with a few digits and a true minus sign. */
export function plain(value, digits = 4) {
  return String(Number(value.toPrecision(digits))).replace("-", "−");
}
