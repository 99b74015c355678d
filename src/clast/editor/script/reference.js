/** The reference of the case file within the window, from the schema: what docs/reference/case-file.md says, offline. */
import { kindOf, tablesOf, toml, unitOf, variants } from "./values.js";
const { html, render } = htmPreact;

const SIGNS = { exclusiveMinimum: ">", minimum: "≥", exclusiveMaximum: "<", maximum: "≤" };
const isLong = (form) => Boolean(form.properties?.name); // of a choice, which has a section of its own

/** The type of a value in words, with its limits. */
export function typeOf(schema, one) {
  const forms = variants(schema, one), plain = forms.length > 1 ? forms.filter((form) => !isLong(form)) : forms;
  return [...new Set(plain.map((form) => wordOf(schema, form)))].join(" or ") || "any";
}

function wordOf(schema, form) {
  const words = {
    table: () => "table", map: () => "tables by name", fixed: () => toml(form.const), choice: () => form.enum.map(toml).join(" or "),
    tuple: () => `[${form.prefixItems.map((inner) => typeOf(schema, inner)).join(", ")}]`,
    list: () => (variants(schema, form.items ?? {}).every((inner) => kindOf(inner) === "table") ? "tables" : `list of ${typeOf(schema, form.items)}`),
  };
  const limits = Object.entries(SIGNS).filter(([key]) => key in form).map(([key, sign]) => `${sign} ${Math.abs(form[key]) < 1e6 ? form[key] : form[key].toPrecision(6).replace(/\.?0+e/, "e")}`);
  return words[kindOf(form)]?.() ?? [form.type, limits.join(", ")].filter(Boolean).join(" ");
}

/** The default of a key as TOML has it; "" where it has none. */
const defaultOf = ({ default: given }) => (given === undefined || given === null || !Object.keys(Object(given)).length && typeof given === "object" ? "" : toml(given));

const unitsOf = (one) => (Array.isArray(one["x-clast"]?.unit) ? [...new Set(one["x-clast"].unit)].join(", ") : unitOf(one));

/** Type, unit, and default of a key, in a line. */
export function factsOf(schema, one, isNeeded) {
  const given = defaultOf(one), unit = unitsOf(one);
  return [typeOf(schema, one) + (unit && ` in ${unit}`), isNeeded ? "needed" : given ? `default ${given}` : "may be left out"].join("; ");
}

/** Sections of a table and of those within it: heading, words, and the table itself. */
function sectionsOf(schema, heading, node) {
  const inner = Object.entries(node.properties).flatMap(([name, one]) => {
    const forms = variants(schema, one).flatMap((form) => [form, form.items, form.additionalProperties].filter(Boolean).flatMap((inner) => variants(schema, inner)));
    return forms.filter((form) => kindOf(form) === "table").flatMap((form) => sectionsOf(schema, `${heading} ${name}${form.properties.name?.const ? ` = ${toml(form.properties.name.const)}` : ""}`, form));
  });
  return [{ heading, node }, ...inner];
}

function sectionsFor(schema, table) {
  const one = schema.properties[table];
  if (!one) return [{ heading: "Top of the file", node: { ...schema, owner: "Case", description: "" } }];
  const heading = { list: `[[${table}]]`, named: `[${table}.NAME]`, one: `[${table}]` }[tablesOf(schema, one)];
  return sectionsOf(schema, "", { properties: { [heading]: one } }).slice(1).map((section) => ({ ...section, heading: section.heading.trim() }));
}

/** Return what opens the reference in a dialog: at a table, "" for the top of the file, and a key there. */
export function offerReference(dialog, { schema }) {
  const tables = Object.keys(schema.properties).filter((name) => tablesOf(schema, schema.properties[name]));
  const open = (table, wanted = "") => {
    const row = (node, [name, one]) => html`<tr key=${name} data-entry=${`${node.owner ?? node.title}.${name}`} class=${wanted === `${node.owner ?? node.title}.${name}` ? "wanted" : ""}>
      <th scope="row">${name}</th><td>${typeOf(schema, one)}</td><td>${unitsOf(one)}</td><td>${node.required?.includes(name) ? "needed" : defaultOf(one)}</td><td>${one.description}</td></tr>`;
    const chosen = tables.includes(table) ? table : "";
    render(html`<form method="dialog"><h2 id="reference-head">Reference</h2><label>of <select value=${chosen} onChange=${(e) => open(e.target.value)}>
        <option value="">the top of the file</option>${tables.map((name) => html`<option key=${name} value=${name}>${name}</option>`)}</select></label> <button>close</button></form>
      <div class="sections" tabindex="0">${sectionsFor(schema, chosen).map(({ heading, node }) => html`<section key=${heading}><h3>${heading}</h3><p class="help">${node.description}</p>
        <table><thead><tr>${["key", "type", "unit", "default", "meaning"].map((head) => html`<th scope="col">${head}</th>`)}</tr></thead>
        <tbody>${Object.entries(node.properties).map((each) => row(node, each))}</tbody></table></section>`)}</div>`, dialog);
    if (!dialog.open) dialog.showModal();
    (dialog.querySelector(".wanted") ?? dialog.querySelector("h3")).scrollIntoView({ block: "center" });
  };
  return open;
}
