/** Words for tables and keys: those of the schema, of UDEC, and of the trade. */
import { addTable } from "./form.js";
import { kindOf, tablesOf, variants } from "./values.js";
const { html, render } = htmPreact;

const MOST = 12;
/** Entries that are shown at most. */
const TRADE = {
  water: "water table groundwater piezometric line phreatic surface pore pressure", opening: "excavation tunnel cavern drift", domain: "external boundary outline section",
  joint_set: "discontinuities fractures bedding joint network", trace: "fault mapped joint", rock: "material properties", joint: "interface strength friction",
  in_situ: "field stress k0 initial", lining: "shotcrete liner support beam", bolt: "anchor tieback soil nail rockbolt", bolt_pattern: "pattern bolting", stage: "construction sequence excavate",
  source: "seeder", collector: "data collector", barrier: "fence rockfall net", rockfall: "rocfall slope trajectories", ground_motion: "earthquake seismic acceleration", viscous_boundary: "quiet absorbing lysmer",
  measured_point: "history monitoring", fixed_point: "support restraint pinned", amplitude: "time function table factor", method: "solver numerical", output: "results frames", region: "material boundary zone",
};
/** Words of other programs and of reports for a table. */

/** Tables and keys that words mean, the best first: `place` is a table or a key of it. */
export function found({ schema, udec }, text) {
  const words = text.toLowerCase().split(/[\s_.[\]]+/).filter(Boolean);
  if (!words.length) return [];
  const foreign = words.map((word) => udec[word]).filter(Boolean);
  const score = (name, about, more, table = "") => {
    const plain = name.replaceAll("_", " "), own = plain.split(" "), above = table.split("_");
    const each = words.map((word) => (own.includes(word) ? 8 : own.some((part) => part.startsWith(word)) ? 5 : new RegExp(`\\b${word.replace(/\W/g, "\\$&")}`).test(more) ? 4 : above.includes(word) ? 4 : about.includes(word) ? 2 : 0));
    const sum = each.reduce((a, b) => a + b, 0) * (each.every(Boolean) ? 2 : 1);
    return sum + (foreign.includes(name) ? 30 : 0) + ([plain, [...above, ...own].join(" ")].includes(words.join(" ")) ? 20 : 0);
  };
  const all = Object.entries(schema.properties).flatMap(([table, one]) => {
    const kind = tablesOf(schema, one), forms = kind ? variants(schema, one) : [];
    const inner = forms.flatMap((form) => (form.items ? variants(schema, form.items) : form.additionalProperties ? variants(schema, form.additionalProperties) : [form])).find((form) => kindOf(form) === "table");
    const keys = Object.entries(inner?.properties ?? {}).map(([name, node]) => ({ place: [table, name], about: node.description ?? "", worth: score(name, (node.description ?? "").toLowerCase(), "", table) }));
    return [{ place: [table], about: one.description ?? "", worth: 1.2 * score(table, (one.description ?? "").toLowerCase(), TRADE[table] ?? "") }, ...keys];
  });
  return all.filter(({ worth }) => worth > 3).sort((a, b) => b.worth - a.worth).slice(0, MOST);
}

/** Find while somebody types in a field; what is chosen leads to its form, and adds the table where there is none. */
export function offerSearch(field, root, { state, hand, choose, goTo }) {
  const close = () => { root.hidden = true; };
  const go = async ([table, name]) => {
    const one = state.schema.properties[table], kind = tablesOf(state.schema, one);
    field.value = "";
    close();
    if (kind && state.content[table] === undefined) await addTable({ ...state, hand, choose }, table, one, kind);
    const held = state.content[table], first = kind === "list" ? [0] : kind === "named" ? Object.keys(held ?? {}).slice(0, 1) : [];
    goTo(kind ? [table, ...first, ...(name ? [name] : [])] : [table]);
    if (!name) requestAnimationFrame(() => (document.querySelector(".form .rows :is(input, select)") ?? document.querySelector(".form .row button"))?.focus());
  };
  const show = () => {
    const entries = found(state, field.value);
    root.hidden = !field.value.trim();
    render(html`<p role="status">${entries.length ? `${entries.length} found` : "nothing found"}</p>
      ${entries.map(({ place, about }) => html`<button key=${place.join(" ")} onClick=${() => go(place)}>${place.join(" ").replaceAll("_", " ")}${state.content[place[0]] === undefined ? " (new)" : ""}<small>${about}</small></button>`)}`, root);
  };
  field.addEventListener("input", show);
  field.closest("search").addEventListener("keydown", (e) => {
    const buttons = [...root.querySelectorAll("button")], at = buttons.indexOf(document.activeElement);
    if (e.key === "Escape") { close(); field.focus(); }
    if (e.key === "Enter" && document.activeElement === field) buttons[0]?.click();
    const next = { ArrowDown: buttons[at + 1], ArrowUp: buttons[at - 1] ?? field }[e.key];
    if (!next) return;
    e.preventDefault();
    next.focus();
  });
  field.closest("search").addEventListener("focusout", (e) => { if (!field.closest("search").contains(e.relatedTarget)) close(); });
  addEventListener("keydown", (e) => {
    if (!(e.ctrlKey || e.metaKey) || e.key.toLowerCase() !== "k") return;
    e.preventDefault();
    field.focus();
  });
}
