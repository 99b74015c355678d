/** An amplitude in the form as a curve: its points are dragged, added and taken away, by mouse or keys. */
import { plain } from "./handles.js";
const { html, useRef } = htmPreact;

const [WIDE, HIGH, ROOM] = [320, 130, 16];
/** Width, height and margin of the curve, pixels. */
const PARTS = 50;
/** Least number of steps that a pointer can tell along an axis. */
const MOST = 50;
/** Points that have a handle: a record has more than a hand can tell apart. */
const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
let gestures = 0;

/** Ends of both axes; the axis of time is in sight. */
function boxOf(time, value) {
  const [low, high] = [Math.min(0, ...value), Math.max(0, ...value)];
  return [[time[0], time.at(-1) > time[0] ? time.at(-1) : time[0] + 1], [low, high > low ? high : low + 1]];
}

/** The curve of [amplitude.NAME]; nothing where it has none. */
export function Curve({ ctx, name }) {
  const held = useRef(null), { time, value } = ctx.content.amplitude?.[name] ?? {};
  const isDrawn = [time, value].every((some) => Array.isArray(some) && some.length === time.length && some.every(Number.isFinite)) && time.length > 0;
  if (!isDrawn) return null;
  const place = ["amplitude", name], box = held.current?.box ?? boxOf(time, value), sizes = [WIDE, -HIGH], both = [time, value];
  const steps = box.map(([low, high]) => 10 ** Math.floor(Math.log10((high - low) / PARTS)));
  const on = (k, one) => ((one - box[k][0]) / (box[k][1] - box[k][0])) * (Math.abs(sizes[k]) - 2 * ROOM) + ROOM;
  const screen = (i) => [on(0, time[i]), HIGH - on(1, value[i])];
  const meant = ({ clientX, clientY, currentTarget }) => {
    const { left, bottom, width } = currentTarget.closest("svg").getBoundingClientRect(), dots = WIDE / width;
    return [clientX - left, bottom - clientY].map((one, k) => box[k][0] + ((one * dots - ROOM) / (Math.abs(sizes[k]) - 2 * ROOM)) * (box[k][1] - box[k][0]));
  };
  const round = (point) => point.map((one, k) => Number(plain(Math.round(one / steps[k]) * steps[k])));
  /** Move a point; it stays between its neighbours. */
  const move = (i, point, gesture) => {
    const [t, v] = round(point), between = [Math.min((time[i + 1] ?? Infinity) - steps[0], Math.max((time[i - 1] ?? -Infinity) + steps[0], t)), v];
    const edits = ["time", "value"].flatMap((key, k) => (between[k] === both[k][i] ? [] : [{ do: "set", place: [...place, key, i], toml: plain(between[k]) }]));
    if (edits.length) ctx.hand.edit(edits, gesture);
  };
  const add = (point) => {
    const [t, v] = round(point), i = time.findIndex((one) => one >= t), after = i < 0 ? time.length : i;
    if (time[after] !== t) ctx.hand.edit([["time", t], ["value", v]].map(([key, one]) => ({ do: "insert", place: [...place, key, after], toml: plain(one) })));
  };
  const press = (e, i) => {
    const by = MOVES[e.key], many = e.shiftKey ? 10 : 1;
    if (by) move(i, [time[i] + many * by[0] * steps[0], value[i] + many * by[1] * steps[1]], `curve ${gestures}`);
    else if (e.key === "Delete" && time.length > 2) ctx.hand.edit(["time", "value"].map((key) => ({ do: "remove", place: [...place, key, i] })));
    else return;
    e.preventDefault();
  };
  const drop = () => { held.current = null; };
  const dots = time.length <= MOST && time.map((_, i) => html`<circle key=${i} cx=${screen(i)[0]} cy=${screen(i)[1]} r="5" tabindex="0" role="slider" aria-label=${`Point ${i + 1} of ${name}`}
    aria-valuenow=${value[i]} aria-valuetext=${`${plain(value[i])} at ${plain(time[i])} s`} onFocus=${() => { gestures += 1; }} onKeyDown=${(e) => press(e, i)}
    onPointerDown=${(e) => { e.currentTarget.setPointerCapture(e.pointerId); held.current = { box, gesture: `curve ${++gestures}` }; }}
    onPointerMove=${(e) => held.current && move(i, meant(e), held.current.gesture)} onPointerUp=${drop} onPointerCancel=${drop}><title>${plain(value[i])} at ${plain(time[i])} s</title></circle>`);
  const level = HIGH - on(1, 0);
  return html`<figure class="curve amplitude"><svg viewBox=${`0 0 ${WIDE} ${HIGH}`} role="group" aria-label=${`Curve of ${name}: double click adds a point, Delete takes one away`}
      onDblClick=${(e) => add(meant(e))}>
    <path class="axis" d=${`M${ROOM} ${level}H${WIDE - ROOM}M${ROOM} ${ROOM}V${HIGH - ROOM}`} />
    <path class="line" d=${`M${time.map((_, i) => screen(i).join(" ")).join("L")}H${WIDE}`} />
    ${box[1].map((one, k) => one !== 0 && html`<text key=${k} x="2" y=${k ? ROOM - 5 : HIGH - 3}>${plain(one)}</text>`)}
    <text x=${WIDE - ROOM} y=${level > HIGH / 2 ? level + 13 : level - 5} text-anchor="end">${plain(box[0][1])} s</text>${dots}</svg>
    ${time.length > MOST ? html`<p class="help">${time.length} points</p>` : ""}<button onClick=${() => add([time.at(-1) + (time.length > 1 ? time.at(-1) - time.at(-2) : 1), value.at(-1)])}>add a point</button></figure>`;
}
