// How the run went, in words.

/**
 * Write the report of a run into an element, in the place of what was there.
 * @param {HTMLElement} place @param {any} scene
 */
export function fillReport(place, scene) {
  const { report, events } = scene;
  place.replaceChildren();
  const say = (kind, text) => {
    const element = document.createElement(kind);
    element.textContent = text;
    place.append(element);
    return element;
  };
  say("p", report.outcome);
  const table = document.createElement("table");
  for (const [name, value] of report.rows) {
    const row = table.insertRow();
    const head = document.createElement("th");
    head.scope = "row";
    head.textContent = name;
    row.append(head);
    row.insertCell().textContent = value;
  }
  place.append(table);
  const lists = [
    ["Stages", report.stages ?? []],
    ["Warnings", report.warnings ?? []],
    ["Notes", report.notes ?? []],
    ["Events", events.slice(0, 200).map(({ text }) => text)],
  ];
  for (const [heading, texts] of lists) {
    if (!texts.length) continue;
    say("h3", heading);
    const list = say("ul", "");
    for (const text of texts) {
      const item = document.createElement("li");
      item.textContent = text;
      list.append(item);
    }
  }
}
