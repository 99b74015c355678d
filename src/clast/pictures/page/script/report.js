// How the run went, in words.

const MOST_EVENTS = 200;

/** Return the events that are shown: of many, as many evenly over the run. */
export function eventsShown({ events }) {
  if (events.length <= MOST_EVENTS) return events;
  const at = (k) => Math.round((k * (events.length - 1)) / (MOST_EVENTS - 1));
  return Array.from({ length: MOST_EVENTS }, (_, k) => events[at(k)]);
}

/**
 * Write the report of a run into an element, in the place of what was there.
 * @param {HTMLElement} place @param {any} scene
 */
export function fillReport(place, scene) {
  const { report, events } = scene;
  const shown = eventsShown(scene);
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
    [shown.length < events.length ? `Events, ${shown.length} of ${events.length}` : "Events", shown.map(({ text }) => text)],
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
