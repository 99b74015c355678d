/** What the schema says of a value, and a value as TOML writes it. */

/** Possible forms of a value, references followed; "absent" is none of them. */
export function variants(schema, one) {
  if (one.$ref) {
    const name = one.$ref.split("/").pop();
    return variants(schema, { owner: name, ...schema.$defs[name] });
  }
  const several = one.anyOf ?? one.oneOf;
  if (several) return several.flatMap((inner) => variants(schema, inner));
  const isKnown = ["type", "properties", "enum", "const"].some((key) => key in one); // a key that no table has is none of them
  return isKnown && one.type !== "null" ? [one] : [];
}

/** How a value is entered: "choice", "yes", "number", "text", "fixed", "tuple", "list", "table" or "map". */
export function kindOf(node) {
  if ("const" in node) return "fixed";
  if (node.enum) return "choice";
  if (node.prefixItems) return "tuple";
  const kinds = { boolean: "yes", number: "number", integer: "number", string: "text", array: "list" };
  return kinds[node.type] ?? (node.properties ? "table" : "map");
}

/** Whether a form has one field, which may be empty. */
export const isPlain = (node) => ["number", "text", "choice", "yes", "fixed"].includes(kindOf(node));

/** Whether a value has this form. */
export function fits(schema, node, value) {
  const kind = kindOf(node), is = (inner) => (item) => variants(schema, inner).some((form) => fits(schema, form, item));
  if (kind === "fixed") return node.const === value;
  if (kind === "choice") return node.enum.includes(value);
  if (kind === "tuple") return Array.isArray(value) && node.prefixItems.every((inner, i) => is(inner)(value[i]));
  if (kind === "list") return Array.isArray(value) && value.every(is(node.items ?? {}));
  if (kind === "yes") return typeof value === "boolean";
  if (kind === "number") return typeof value === "number";
  if (kind === "text") return typeof value === "string";
  if (!isTable(value)) return false;
  if (kind === "map") return Object.values(value).every(is(node.additionalProperties ?? {}));
  const fixed = Object.entries(node.properties).filter(([, inner]) => "const" in inner);
  return fixed.every(([key, inner]) => value[key] === inner.const) && Object.keys(value).every((key) => key in node.properties);
}

export const isTable = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

/** Of several forms the one that a value has, or the most likely one. */
export function formOf(schema, forms, value) {
  if (value === undefined) return forms.find((form) => isPlain(form)) ?? forms[0];
  const like = { number: "number", string: "text", boolean: "yes" }[typeof value] ?? (Array.isArray(value) ? "list" : "table");
  const knows = (form) => isTable(value) && kindOf(form) === "table" && Object.keys(value).every((key) => key in form.properties);
  return forms.find((form) => fits(schema, form, value)) ?? forms.find(knows) ?? forms.find((form) => kindOf(form) === like) ?? forms[0];
}

/** Whether a key holds tables of its own: "one", "list" or "named"; null for plain values. */
export function tablesOf(schema, one) {
  const forms = variants(schema, one), table = (inner) => variants(schema, inner ?? {}).some((form) => kindOf(form) === "table");
  if (forms.some((form) => kindOf(form) === "list" && table(form.items))) return "list";
  if (forms.some((form) => kindOf(form) === "map" && table(form.additionalProperties))) return "named";
  return forms.some((form) => kindOf(form) === "table") ? "one" : null;
}

/** What a new value begins with: its default, the name that there is, or as little as may be. */
export function blank(schema, node, nameOf = () => undefined) {
  const kind = kindOf(node), first = (one) => blank(schema, { ...variants(schema, one)[0], ...notesOf(one), "x-clast": one["x-clast"] }, nameOf);
  if (node.default !== undefined && node.default !== null && !(kind === "list" && !node.default.length)) return node.default;
  if (kind === "fixed") return node.const;
  if (kind === "choice") return node.enum[0];
  if (kind === "yes") return true;
  if (kind === "number" && node["x-clast"]?.typical) return Number((node["x-clast"].typical[0] / 2 + node["x-clast"].typical[1] / 2).toPrecision(2));
  if (kind === "number") return node.minimum ?? (node.exclusiveMinimum === undefined ? 0 : node.exclusiveMinimum + 1);
  if (kind === "text") return nameOf(node) ?? "";
  if (kind === "tuple") return node.prefixItems.map(first);
  if (kind === "list") return Array.from({ length: node.minItems ?? 0 }, () => first(node.items ?? {}));
  if (kind === "map") return {};
  const needed = Object.entries(node.properties).filter(([key, one]) => node.required?.includes(key) || "const" in one);
  return Object.fromEntries(needed.map(([key, one]) => [key, first(one)]));
}

const notesOf = ({ default: given }) => (given === undefined || given === null ? {} : { default: given });

const BARE = /^[A-Za-z0-9_-]+$/;
const quoted = (text) => JSON.stringify(text).replaceAll("\x7f", "\\u007f");

export const keyText = (key) => (BARE.test(key) ? key : quoted(key));

/** A value as TOML writes it. */
export function toml(value) {
  if (typeof value === "string") return quoted(value);
  if (Array.isArray(value)) return `[${value.map(toml).join(", ")}]`;
  if (!isTable(value)) return String(value);
  return `{${Object.entries(value).map(([key, inner]) => `${keyText(key)} = ${toml(inner)}`).join(", ")}}`;
}

const PREFIXES = { G: 9, M: 6, k: 3, d: -1, c: -2, m: -3, "µ": -6, u: -6 };
const SAME = { "°": "degrees", deg: "degrees", "t/m3": ["kg/m3", 3], "g/cm3": ["kg/m3", 3], "%": ["", -2] };
const NUMBER = /^([+-]?(?:\d[\d_]*\.?\d*|\.\d+))(?:[eE]([+-]?\d+))?\s*(\S*)$/;

/** The TOML of a number that somebody typed, with or without a unit; null where it is none. */
export function numberFrom(text, unit, isWhole) {
  const found = text.trim().replaceAll("³", "3").replaceAll("²", "2").match(NUMBER);
  if (!found) return null;
  const [, digits, exponent, given] = found, shift = given ? shiftOf(given, unit) : 0;
  if (shift === null) return null;
  const power = Number(exponent ?? 0) + shift;
  // digits as they were typed, in the ways that TOML knows
  const plain = digits.replace(/^([+-]?)0+(?=\d)/, "$1").replace(/^([+-]?)\./, "$10.").replace(/\.$/, ".0");
  const written = power || exponent !== undefined ? `${plain}e${power}` : plain;
  if (isWhole) return Number.isInteger(Number(written)) ? String(Number(written)) : null;
  return written;
}

function shiftOf(given, unit) {
  const [same, shift] = [SAME[given] ?? given].flat();
  if (same === unit) return shift ?? 0;
  return given[0] in PREFIXES && given.slice(1) === unit ? PREFIXES[given[0]] : null;
}

/** Unit of a key, "" where it has none; of item `i` of several values. */
export function unitOf(one, i = 0) {
  const given = one["x-clast"]?.unit ?? "";
  const unit = Array.isArray(given) ? given[i] ?? "" : given;
  return unit === "-" ? "" : unit;
}
