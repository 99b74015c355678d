/** Forms of a case, made from its schema: rows are patched where values change, never made anew. */
import { Copies, addition } from "./copies.js";
import { Curve } from "./curve.js";
import { factsOf } from "./reference.js";
import { drawnKeys, tableNode, withSurface } from "./handles.js";
import { variants, kindOf, formOf, tablesOf, isTable, isPlain, blank, toml, numberFrom, unitOf } from "./values.js";
const { html, render, useState, useRef } = htmPreact;

const key = (place) => JSON.stringify(place);
const startsWith = (place, above) => above.every((part, i) => place[i] === part);
const at = (content, place) => place.reduce((inner, part) => inner?.[part], content);
const LEVELS = ["basic", "more", "rare"];
let gestures = 0;

/**
 * Show the forms of a case in an element; call again with another state to change what they show.
 * The state has `schema`, `content`, `literals` (numbers as they are written), `faults`, the place
 * of the table that is `chosen`, `choose`, and the `hand`, which sends edits.
 */
export function showForms(root, state) {
  render(html`<${Forms} ctx=${state} />`, root);
}

/** Place of the table in whose form a value stands; [] for values of the case itself. */
export function tableAt({ schema, content }, place) {
  const one = schema.properties[place[0]], kind = one && isFilled(content[place[0]]) && tablesOf(schema, one);
  return kind ? place.slice(0, kind === "one" ? 1 : 2) : [];
}
const isFilled = (value) => typeof value === "object";

function Forms({ ctx }) {
  const [level, setLevel] = useState("basic");
  const place = at(ctx.content, ctx.chosen) === undefined ? [] : ctx.chosen;
  const inner = { ...ctx, level: LEVELS.indexOf(level) };
  return html`<div class="forms">
    <nav aria-label="Tables of the case"><${Tree} ctx=${inner} chosen=${place} /></nav>
    <section class="form" aria-label="Values" inert=${ctx.looks_on}>
      <label class="level">Keys shown <select value=${level} onChange=${(e) => setLevel(e.target.value)}>
        ${LEVELS.map((one) => html`<option value=${one}>${one === "rare" ? "all" : one}</option>`)}</select></label>
      <${Chosen} ctx=${inner} place=${place} key=${key(place)} />
    </section></div>`;
}

// --- the tables ----------------------------------------------------------------------------------

function Tree({ ctx, chosen }) {
  const { schema, content, choose } = ctx, kinds = Object.entries(schema.properties).map(([name, one]) => [name, one, tablesOf(schema, one)]);
  const order = Object.keys(content), there = kinds.filter(([name, , kind]) => kind && name in content);
  there.sort(([a], [b]) => order.indexOf(a) - order.indexOf(b));
  const add = (name) => {
    const [, one, kind] = kinds.find(([other]) => other === name);
    addTable(ctx, name, one, kind);
  };
  return html`<select class="add-table" aria-label="Add a table" value="" onChange=${(e) => { add(e.target.value); e.target.value = ""; }}>
      <option value="">add a table ...</option>
      ${kinds.filter(([name, , kind]) => kind && !(kind === "one" && name in content)).map(([name, one]) => html`<option key=${name} value=${name} title=${one.description}>${name}</option>`)}
    </select>
    <ul><${Branch} ctx=${ctx} place=${[]} chosen=${chosen} text="case" />
    ${there.map(([name, one, kind]) => {
      const value = content[name], entries = kind === "list" ? value.map?.((_, i) => i) ?? [] : kind === "named" ? Object.keys(value) : [];
      return html`<${Branch} key=${name} ctx=${ctx} place=${[name]} chosen=${chosen} text=${name} count=${kind === "one" ? null : entries.length}>
        ${entries.length > 0 && html`<ul>${entries.map((entry) => html`<${Branch} key=${entry} ctx=${ctx} place=${[name, entry]} chosen=${chosen}
          text=${typeof entry === "number" ? value[entry]?.name || `${entry + 1}` : entry} />`)}</ul>`}
      </${Branch}>`;
    })}
    </ul>`;
}

function Branch({ ctx, place, chosen, text, count = null, children }) {
  const faults = ctx.faults.filter((one) => place.length ? startsWith(one.place, place) : one.place.length < 2 && !isTable(at(ctx.content, one.place))).length;
  return html`<li><button aria-current=${key(place) === key(chosen) ? "true" : null} data-table=${key(place)}
    draggable=${place.length > 1} onDragStart=${(e) => e.dataTransfer.setData(`clast/${place[0]}`, key(place))} onClick=${() => ctx.choose(place)}>${text}
    ${count === null ? "" : html` <small>${count}</small>`}${faults ? html` <b class="mark" title=${`${faults} to put right`}>${faults}</b>` : ""}</button>${children}</li>`;
}

/** Add a table, or an entry to a list of them, and choose it. */
export function addTable(ctx, name, one, kind) {
  const forms = variants(ctx.schema, one), named = (node) => nameFor(ctx, node), held = ctx.content[name];
  const tables = (inner) => variants(ctx.schema, inner).find((form) => kindOf(form) === "table");
  if (kind === "one") return ctx.hand.edit([{ do: "set", place: [name], toml: toml(blank(ctx.schema, forms.find((form) => kindOf(form) === "table"), named)) }]).then(() => ctx.choose([name]));
  if (kind === "list") {
    const place = [name, held?.length ?? 0], node = tables(forms.find((form) => kindOf(form) === "list").items);
    return ctx.hand.edit([{ do: "insert", place, toml: toml(blank(ctx.schema, node, named)) }]).then(() => ctx.choose(place));
  }
  const node = tables(forms.find((form) => kindOf(form) === "map").additionalProperties), place = [name, freeName(held, name)];
  return ctx.hand.edit([{ do: "set", place, toml: toml(blank(ctx.schema, node, named)) }]).then(() => ctx.choose(place));
}

const freeName = (held, name) => { for (let n = 1; ; n++) if (!((held ?? {})[`${name} ${n}`])) return `${name} ${n}`; };

/** Names that a key may refer to: of [joint.NAME] and the like, or of entries that have a name. */
export function namesOf(ctx, node) {
  const refers = node["x-clast"]?.refers_to;
  return (refers ? [refers].flat() : []).flatMap((table) => {
    const held = ctx.content[table];
    return Array.isArray(held) ? held.map((one) => one?.name).filter((one) => typeof one === "string") : Object.keys(held ?? {});
  });
}
const nameFor = (ctx, node) => namesOf(ctx, node)[0];

function Chosen({ ctx, place }) {
  const [top, entry] = place, one = top === undefined ? ctx.schema : ctx.schema.properties[top], value = at(ctx.content, place);
  if (top === undefined) {
    const plain = Object.fromEntries(Object.entries(one.properties).filter(([, inner]) => !tablesOf(ctx.schema, inner) || variants(ctx.schema, inner).some((form) => kindOf(form) === "choice")));
    return html`<h2>case</h2><p class="row"><button onClick=${() => ctx.refer("")}>reference</button></p><${Rows} ctx=${ctx} place=${[]} node=${{ ...one, properties: plain, owner: "Case" }} value=${ctx.content} known=${one.properties} />`;
  }
  const kind = one && tablesOf(ctx.schema, one);
  const inner = kind === "list" && entry !== undefined ? variants(ctx.schema, one).find((form) => kindOf(form) === "list").items
    : kind === "named" && entry !== undefined ? variants(ctx.schema, one).find((form) => kindOf(form) === "map").additionalProperties : one;
  const name = typeof entry === "number" ? value?.name : entry, [isAsked, ask] = useState(false);
  const named = isAsked ? referring(ctx, top, name).filter((where) => !startsWith(where, place)) : [];
  const remove = (edits = []) => ctx.hand.edit([...edits, { do: "remove", place }]).then(() => ctx.choose([]));
  const askFirst = () => (name !== undefined && referring(ctx, top, name).some((where) => !startsWith(where, place)) ? ask(true) : remove());
  const move = (to) => ctx.hand.edit([{ do: "swap", place: [top, Math.min(entry, to)] }]).then((done) => done && ctx.choose([top, to]));
  const copy = () => {
    const twin = [top, freeName(ctx.content[top], entry)];
    const made = typeof entry === "number" ? addition(ctx, top, [[entry, value]], entry + 1) : { place: twin, edits: [{ do: "set", place: twin, toml: toml(value) }] };
    ctx.hand.edit(made.edits).then((done) => done && ctx.choose(made.place));
  };
  const isGroup = entry === undefined && kind !== "one";
  return html`<h2>${place.map((part) => (typeof part === "number" ? part + 1 : part)).join(" ")}</h2>
    <p class="help">${inner?.description ?? ""}</p>
    <p class="row">
      ${kind === "named" && entry !== undefined && html`<label>name <${Name} ctx=${ctx} place=${place} /></label>`}
      ${isGroup && html`<button onClick=${() => addTable(ctx, top, one, kind)}>add</button>`}
      ${entry !== undefined && html`<button onClick=${copy}>duplicate</button>`}
      ${entry > 0 && html`<button onClick=${() => move(entry - 1)}>up</button>`}
      ${entry < ctx.content[top].length - 1 && html`<button onClick=${() => move(entry + 1)}>down</button>`}
      <button onClick=${askFirst}>remove</button> <button onClick=${() => ctx.refer(top)}>reference</button></p>
    ${isAsked && html`<${Removal} ctx=${ctx} table=${top} name=${name} named=${named} remove=${remove} keep=${() => ask(false)} />`}
    ${kind === "list" && top !== "stage" && drawnKeys(tableNode(ctx.schema, one)).length > 0 && ctx.content[top].length > 0 && html`<${Copies} ctx=${ctx} table=${top} entry=${entry} node=${tableNode(ctx.schema, one)} />`}
    <${Faults} ctx=${ctx} place=${place} />
    ${top === "amplitude" && html`<${Curve} ctx=${ctx} name=${entry} />`}
    ${!isGroup && html`<${Value} ctx=${ctx} place=${place} one=${inner ?? {}} value=${value} isOpen=${true} />`}`;
}

/** Places of the values that name a table, or an entry of a list of tables. */
function referring(ctx, table, name) {
  const found = new Map();
  const look = (one, value, where) => variants(ctx.schema, one).forEach((node) => {
    if ([node["x-clast"]?.refers_to ?? one["x-clast"]?.refers_to].flat().includes(table) && value === name) found.set(key(where), where);
    if (Array.isArray(value)) value.forEach((item, i) => look({ ...(node.items ?? node.prefixItems?.[i] ?? {}), ...(one["x-clast"] && { "x-clast": one["x-clast"] }) }, item, [...where, i]));
    else if (isTable(value)) for (const [part, item] of Object.entries(value)) {
      const inner = node.properties?.[part] ?? node.additionalProperties;
      if (inner) look(inner, item, [...where, part]);
    }
  });
  look({ properties: ctx.schema.properties, type: "object" }, ctx.content, []);
  return [...found.values()];
}

/** The user's own name of a table; all that refers to it follows. */
function Name({ ctx, place }) {
  const [draft, setDraft] = useState(null);
  const [table, old] = place;
  const rename = (name) => {
    if (!name || name === old) return;
    const own = (where) => (startsWith(where, place) ? [table, name, ...where.slice(2)] : where);
    const edits = referring(ctx, table, old).map((where) => ({ do: "set", place: own(where), toml: toml(name) }));
    ctx.hand.edit([{ do: "rename", place, toml: name }, ...edits]).then((done) => done && ctx.choose([table, name]));
  };
  // news of the case must not undo what is typed
  return html`<input value=${draft ?? old} aria-label="name" onInput=${(e) => setDraft(e.target.value)} onChange=${(e) => { setDraft(null); rename(e.target.value.trim()); }} />`;
}

/** What is to become of the values that name a table which is removed. */
function Removal({ ctx, table, name, named, remove, keep }) {
  const others = namesOf(ctx, { "x-clast": { refers_to: table } }).filter((other) => other !== name);
  const replace = (other) => remove(named.map((place) => ({ do: "set", place, toml: toml(other) })));
  const leaveOut = () => remove([...named].reverse().map((place) => ({ do: "remove", place }))); // items from the last: the others keep their numbers
  return html`<div class="asked" role="group" aria-label=${`Remove ${name}`}>
    <p role="alert">${name} is named by ${named.map((place) => place.map((part) => (typeof part === "number" ? part + 1 : part)).join(" ")).join("; ")}.</p>
    ${others.length > 0 && html`<label>Name another there <select aria-label="Name another" onChange=${(e) => replace(e.target.value)}><option value=""></option>
      ${others.map((other) => html`<option key=${other} value=${other}>${other}</option>`)}</select></label>`}
    <button onClick=${leaveOut}>remove these values too</button><button onClick=${() => remove()}>remove it all the same</button><button onClick=${keep}>keep it</button></div>`;
}

// --- the values ----------------------------------------------------------------------------------

/** Faults of a value; they are announced below the section, once. */
function Faults({ ctx, place }) {
  const own = ctx.faults.filter((one) => key(one.place) === key(place));
  // a key of an earlier version, or of another program, is renamed on request
  const meant = own.map(({ what, remedy }) => what === "there is no such key" && remedy.match(/^(?:did you mean|UDEC's '.*' is) '(\w+)'(?:\?$| in clast$)/)?.[1]).find(Boolean);
  return html`<span class="fault">${own.map((one) => `${one.what}. ${one.remedy}`).join(" ")}</span>
    ${meant && html`<button class="rename" onClick=${() => ctx.hand.edit([{ do: "rename", place, toml: meant }])}>rename to ${meant}</button>`}`;
}

/** Whether a key goes with the values of a table. */
const goes = ({ "x-clast": { when } = {} }, value, node) => !when || Object.entries(when).some(([by, values]) => {
  const chosen = isTable(value[by]) ? value[by].name : value[by] ?? node.properties[by]?.default;
  return values.includes(chosen) || (values.includes("*") && by in value);
});

/** Edits of the keys that go with others of a table, when these get other values; undefined takes one away. */
function following(ctx, place, node, value, changes) {
  const after = Object.fromEntries(Object.entries({ ...value, ...changes }).filter(([, one]) => one !== undefined));
  const alone = new Set((node["x-clast"]?.one_of ?? []).flat());
  return Object.entries(node.properties).flatMap(([name, one]) => {
    const notes = one["x-clast"] ?? {};
    if (name in changes || !Object.keys(changes).some((by) => by in (notes.when ?? {}))) return [];
    if (name in value) return goes(one, after, node) ? [] : [{ do: "remove", place: [...place, name] }];
    if (notes.level !== "basic" || alone.has(name) || !goes(one, after, node)) return [];
    return [{ do: "set", place: [...place, name], toml: toml(begin(ctx, one)) }];
  });
}

/** What a key begins with. */
const begin = (ctx, one, form = variants(ctx.schema, one)[0]) => blank(ctx.schema, { ...form, "x-clast": one["x-clast"] }, (node) => nameFor(ctx, node));

/** Rows of a table: keys that are given, that have faults, and those of the level that go with the others. */
function Rows({ ctx, place, node, value = {}, known = node.properties }) {
  const met = useRef(new Set()); // a row whose last letter is deleted stays while its table is looked at
  const needed = node.required ?? [], strange = Object.keys(value).filter((name) => !(name in known));
  const isNear = (name) => name in value || needed.includes(name) || ctx.faults.some((fault) => startsWith(fault.place, [...place, name])) || startsWith(ctx.wanted ?? [], [...place, name]);
  const isAll = ctx.level === LEVELS.length - 1;
  const isShown = ([name, one]) => isNear(name) || ((isAll || goes(one, value, node)) && (met.current.has(name) || LEVELS.indexOf(one["x-clast"]?.level ?? "more") <= ctx.level));
  const follow = (changes) => following(ctx, place, node, value, changes);
  // of keys that stand in each other's place there is one row
  const groups = new Map((node["x-clast"]?.one_of ?? []).flatMap((keys) => keys.map((name) => [name, keys])));
  const stands = (name) => !groups.has(name) || isNear(name) || (!groups.get(name).some(isNear) && groups.get(name)[0] === name);
  const rows = Object.entries(node.properties).filter((row) => isShown(row) && stands(row[0]));
  for (const [name] of rows) if (name in value) met.current.add(name);
  const turn = (from, to) => ctx.hand.edit([...(from in value ? [{ do: "remove", place: [...place, from] }] : []),
    { do: "set", place: [...place, to], toml: toml(begin(ctx, node.properties[to])) }, ...follow({ [from]: undefined, [to]: true })]);
  return html`<div class="rows">${rows.map(([name, one]) => html`<${Row} key=${name} ctx=${ctx} place=${[...place, name]} one=${one} follow=${follow}
      value=${value[name]} isNeeded=${needed.includes(name)} owner=${node.owner ?? node.title}
      instead=${(groups.get(name) ?? []).filter((other) => isAll || other === name || (!(other in value) && goes(node.properties[other], value, node)))} turn=${(to) => turn(name, to)} />`)}
    ${strange.map((name) => html`<${Row} key=${name} ctx=${ctx} place=${[...place, name]} one=${{}} value=${value[name]} />`)}</div>`;
}

function Row({ ctx, place, one, value, isNeeded, owner, instead = [], turn, follow = () => [] }) {
  const [isOpen, open] = useState(false), name = place.at(-1), forms = variants(ctx.schema, one);
  const id = `at ${key(place)}`, isBad = ctx.faults.some((fault) => startsWith(fault.place, place));
  const add = () => ctx.hand.edit([{ do: "set", place, toml: toml(begin(ctx, one)) }, ...follow({ [name]: true })]);
  const leave = () => ctx.hand.edit([{ do: "remove", place }, ...follow({ [name]: undefined })]);
  return html`<div class=${isBad ? "row bad" : "row"} data-place=${key(place)} data-key=${`${owner}.${name}`}>
    ${instead.length > 1 ? html`<select class="form-of instead" aria-label=${`One of ${instead.join(", ")}`} value=${name} onChange=${(e) => turn(e.target.value)}>
      ${instead.map((other) => html`<option key=${other} value=${other}>${other.replaceAll("_", " ")}</option>`)}</select><label class="unseen" for=${id}>${name.replaceAll("_", " ")}</label>`
      : html`<label for=${id}>${name.replaceAll("_", " ")}</label>`}
    ${value === undefined && !forms.some(isPlain) && forms.length ? html`<button id=${id} onClick=${add}>add</button>`
      : html`<${Value} ctx=${ctx} place=${place} one=${one} value=${value} id=${id} isNeeded=${isNeeded} follow=${(to) => follow({ [name]: to })} />`}
    <small>${unitOf(one)}</small>
    ${one.description && html`<button class="what" aria-expanded=${isOpen} aria-label=${`What ${name} means`} onClick=${() => open(!isOpen)}>?</button>`}
    ${value !== undefined && !isNeeded && html`<button class="drop" aria-label=${`Leave ${name} out`} onClick=${leave}>×</button>`}
    ${isOpen && html`<p class="help">${one.description} (${factsOf(ctx.schema, one, isNeeded)}) <button class="link" onClick=${() => ctx.refer(place[0], `${owner}.${name}`)}>${name} in the reference</button></p>`}
    ${typeof value === "string" && one["x-clast"]?.refers_to?.includes("amplitude") && html`<${Curve} ctx=${ctx} name=${value} />`}
    <${Faults} ctx=${ctx} place=${place} />
  </div>`;
}

/** A value in the form that it has; where it may have several, with a choice of these. */
function Value(props) {
  const { ctx, place, one, value, id, isOpen } = props, forms = variants(ctx.schema, one);
  if (!forms.length) return html`<${Entry} ...${props} node=${{}} shown=${value === undefined ? "" : toml(value)} read=${(text) => text} />`;
  const node = formOf(ctx.schema, forms, value), shared = { ...one, ...node, "x-clast": node["x-clast"] ?? one["x-clast"] };
  const control = html`<${CONTROLS[kindOf(node)]} key=${forms.indexOf(node)} ...${props} node=${shared} />`;
  if (forms.length === 1) return control;
  const turn = (e) => {
    const to = begin(ctx, one, forms[e.target.value]);
    ctx.hand.edit([{ do: "set", place, toml: toml(to) }, ...(props.follow?.(to) ?? [])]);
  };
  return html`<span class="several"><select class="form-of" aria-label=${`Form of ${place.at(-1)}`} value=${forms.indexOf(node)} onChange=${turn}>
    ${forms.map((form, i) => html`<option key=${i} value=${i}>${formName(form)}</option>`)}</select>${control}</span>`;
}

function formName(form) {
  const kind = kindOf(form), named = form.properties?.name?.const;
  if (kind === "table") return `${named ?? form.title?.replace(/Table$/, "").toLowerCase() ?? ""} {...}`;
  const words = { fixed: toml(form.const ?? ""), choice: "name", yes: "yes or no", number: "number", text: "text", tuple: "values", list: form.items?.prefixItems ? "points" : "list", map: "named values" };
  return words[kind];
}

/** Name of a field that has no label of its own, of an item of a list. */
const unlabelled = (id, place) => (id ? null : place.slice(-2).map((part) => (typeof part === "number" ? part + 1 : part)).join(" "));

/** A field for typing: shows what the file has, and while it is typed in, that. */
function Entry({ ctx, place, node, value, id, isNeeded, shown, read, words = "is not TOML", look = "" }) {
  const [draft, setDraft] = useState(null), [wrong, setWrong] = useState(""), gesture = useRef("");
  const type = (text) => {
    setDraft(text);
    if (text.trim() === "" && kindOf({ type: "object", ...node }) !== "text") {
      setWrong(isNeeded ? "is needed" : "");
      return; // whoever leaves it empty leaves it out, with its comment: not who types another
    }
    const written = read(text);
    setWrong(written === null ? words : "");
    if (written !== null) ctx.hand.edit([{ do: "set", place, toml: written }], gesture.current);
  };
  const leave = () => {
    if (draft?.trim() === "" && !isNeeded && value !== undefined && value !== "") ctx.hand.edit([{ do: "remove", place }]);
    if (!wrong) setDraft(null);
  };
  const given = node.default ?? null;
  return html`<input type="text" class=${look} id=${id} aria-label=${unlabelled(id, place)} value=${draft ?? shown} placeholder=${given === null || isTable(given) ? "" : given}
      aria-invalid=${wrong ? "true" : null} spellcheck=${false}
      onFocus=${() => { gesture.current = `${key(place)} ${++gestures}`; }} onInput=${(e) => type(e.target.value)} onBlur=${leave} />
    ${wrong && html`<span class="fault" role="alert">${wrong}</span>`}`;
}

const CONTROLS = {
  fixed: ({ ctx, place, node, id, value }) => (value === undefined ? html`<button id=${id} onClick=${() => ctx.hand.edit([{ do: "set", place, toml: toml(node.const) }])}>${String(node.const)}</button>`
    : html`<output id=${id}>${String(value)}</output>`),
  yes: ({ ctx, place, value, id, node }) => html`<input type="checkbox" id=${id ?? null} aria-label=${unlabelled(id, place)} checked=${value ?? node.default ?? false}
    onChange=${(e) => ctx.hand.edit([{ do: "set", place, toml: String(e.target.checked) }])} />`,
  choice: (props) => html`<${Choice} ...${props} names=${props.node.enum} />`,
  text: (props) => {
    const names = namesOf(props.ctx, props.node);
    if (names.length && (props.value === undefined || names.includes(props.value))) return html`<${Choice} ...${props} names=${names} />`;
    return html`<${Entry} ...${props} shown=${props.value ?? ""} read=${toml} look="wide" />`;
  },
  number: (props) => {
    const { ctx, node, place, value } = props, unit = unitOf(node), isWhole = node.type === "integer";
    const shown = ctx.literals[key(place)] ?? (value === undefined ? "" : typeof value === "number" ? String(value) : toml(value));
    const words = `is not a ${isWhole ? "whole " : ""}number${unit && `, ${unit}`}`;
    return html`<${Entry} ...${props} shown=${shown} read=${(text) => numberFrom(text, unit, isWhole)} words=${words} /><${Slider} ...${props} />`;
  },
  tuple: (props) => html`<span class="tuple">${props.node.prefixItems.map((one, i) => html`<${Value} key=${i} ...${itemOf(props, one, i)} />`)}</span>`,
  list: List,
  table: (props) => html`<${Rows} ...${props} />`,
  map: Named,
};

/** What an item of a value inherits: its unit and what it refers to. */
const itemOf = ({ ctx, place, node, value, id }, one, i) => ({
  ctx, place: [...place, i], value: value?.[i], isNeeded: true, id: i === 0 ? id : null,
  one: { ...one, description: one.description ?? node.description, "x-clast": one["x-clast"] ?? node["x-clast"] },
});

function Choice({ ctx, place, value, id, isNeeded, node, names, follow = () => [] }) {
  const given = node.default ?? null, to = (e) => (e.target.value === "" ? undefined : names[e.target.value]);
  const choose = (e) => ctx.hand.edit([to(e) === undefined ? { do: "remove", place } : { do: "set", place, toml: toml(to(e)) }, ...follow(to(e))]);
  return html`<select id=${id ?? null} aria-label=${unlabelled(id, place)} value=${value === undefined ? "" : names.indexOf(value)} onChange=${choose}>
    ${(!isNeeded || value === undefined) && html`<option value="">${given === null ? "" : `${given} (default)`}</option>`}
    ${value !== undefined && !names.includes(value) && html`<option value="-1">${String(value)}</option>`}
    ${names.map((name, i) => html`<option key=${name} value=${i}>${String(name)}</option>`)}</select>`;
}

/** A slider of numbers that have a range of their own. */
function Slider({ ctx, place, node, value }) {
  const gesture = useRef(""), range = node["x-clast"]?.typical;
  if (!range || typeof value !== "number") return null;
  const [low, high] = [Math.min(range[0], value), Math.max(range[1], value)], step = 10 ** Math.floor(Math.log10((high - low) / 200));
  const move = (e) => ctx.hand.move([{ do: "set", place, toml: String(Number(Number(e.target.value).toPrecision(12))) }], gesture.current);
  return html`<input type="range" aria-label=${`${place.at(-1)} slider`} min=${low} max=${high} step=${step} value=${value}
    onPointerDown=${() => { gesture.current = `slider ${++gestures}`; }} onFocus=${() => { gesture.current = `slider ${++gestures}`; }}
    onInput=${move} />`;
}

function List(props) {
  const { ctx, place, node, value = [] } = props, one = node.items ?? {};
  const fresh = () => toml(value.length ? value.at(-1) : blank(ctx.schema, { ...variants(ctx.schema, one)[0], "x-clast": one["x-clast"] ?? node["x-clast"] }, (inner) => nameFor(ctx, inner)));
  return html`<ol class="list">${value.map((_, i) => html`<li key=${i}><${Value} ...${itemOf(props, one, i)} />
      <button class="drop" aria-label=${`Remove ${i + 1}`} onClick=${() => ctx.hand.edit(withSurface(ctx.content, { do: "remove", place: [...place, i] }))}>×</button><${Faults} ctx=${ctx} place=${[...place, i]} /></li>`)}
    <li><button onClick=${() => ctx.hand.edit(withSurface(ctx.content, { do: "insert", place: [...place, value.length], toml: fresh() }))}>add</button></li></ol>`;
}

function Named({ ctx, place, node, value = {} }) {
  const one = node.additionalProperties ?? {};
  const add = (e) => { if (e.target.value) ctx.hand.edit([{ do: "set", place: [...place, e.target.value], toml: toml(blank(ctx.schema, variants(ctx.schema, one)[0])) }]); e.target.value = ""; };
  return html`<div class="rows">${Object.keys(value).map((name) => html`<${Row} key=${name} ctx=${ctx} place=${[...place, name]} one=${one} value=${value[name]} />`)}
    <label class="row">new name <input class="new-name" onChange=${add} /></label></div>`;
}
