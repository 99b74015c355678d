// Curves over time by uPlot, with a cursor at the time of the frame that is shown.

import { rounded, withOneUnit, withUnit } from "./colours.js";

const HEIGHT = 224;
/** Height of a chart without its legend, pixels. */

/** A list of curves, one of which is drawn. */
export class Charts {
  /**
   * @param {HTMLElement} place @param {any[]} curves of the scene
   * @param {string[]} inks colours of lines, in turn
   * @param {(time: number) => void} goTo called with a time that is clicked
   */
  constructor(place, curves, inks, goTo) {
    this.place = place;
    this.inks = inks;
    this.curves = curves;
    this.goTo = goTo;
    this.time = 0;
  }

  /** Draw a curve in the colours of a theme. */
  show(curve, theme) {
    this.curve = curve;
    this.theme = theme;
    this.plot?.destroy();
    const axis = {
      stroke: theme.ink,
      grid: { stroke: theme.grid, width: 1 },
      ticks: { stroke: theme.grid },
      font: "11px system-ui, sans-serif",
    };
    this.plot = new uPlot(
      {
        width: this.place.clientWidth,
        height: HEIGHT,
        scales: { x: { time: false } },
        axes: [
          { ...axis, values: (_, marks) => marks.map((mark) => `${mark} ${curve.along ? "m" : "s"}`) },
          { ...axis, size: 74, values: (_, marks) => withOneUnit(marks, curve.unit) },
        ],
        series: [
          { label: curve.along ? "distance" : "time", value: (_, value) => (value == null ? "" : withUnit(value, curve.along ? "m" : "s", 5)) },
          ...curve.lines.map((line, k) => ({
            label: line.name || curve.name,
            stroke: this.inks[k % this.inks.length],
            dash: k >= this.inks.length ? [6, 3] : [],
            width: 1.5,
            points: { show: false },
            value: (_, value) => (value == null ? "" : withUnit(value, curve.unit, 4, line.error)),
          })),
        ],
        // uPlot empties its legend when it draws first
        hooks: { draw: [(plot) => this.mark(plot)], ready: [() => setTimeout(() => this.tell())] },
      },
      [curve.along ?? curve.time, ...curve.lines.map((line) => line.values)],
      this.place,
    );
    this.plot.over.addEventListener("mouseleave", () => this.tell());
    this.tell();
    this.plot.over.addEventListener("click", (event) => {
      if (curve.along) return;
      const left = event.clientX - this.plot.over.getBoundingClientRect().left;
      this.goTo(this.plot.posToVal(left, "x"));
    });
  }

  /** Draw the line at the time of the frame. */
  mark(plot) {
    if (this.curve.along) return;
    const x = plot.valToPos(this.time, "x", true);
    const { left, top, width, height } = plot.bbox;
    if (x < left || x > left + width) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = this.theme.chosen;
    plot.ctx.lineWidth = 2;
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, top);
    plot.ctx.lineTo(x, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  }

  /** Move the line to a time, s. */
  at(time) {
    this.time = time;
    this.plot?.redraw(false);
    this.tell();
  }

  /** Say the values at the time of the frame, where no pointer asks for others. */
  tell() {
    if (this.plot?.data[0].length && !this.curve.along) this.plot.setLegend({ idx: this.plot.valToIdx(this.time) });
  }

  /** Fit the chart to its place. */
  resize() {
    this.plot?.setSize({ width: this.place.clientWidth, height: HEIGHT });
  }

  /** Return the curve as a table for other programs. */
  csv() {
    const quoted = (text) => `"${String(text).replace(/"/g, '""')}"`;
    const unit = this.curve.unit ? ` (${this.curve.unit})` : "";
    const known = ({ error }) => (error ? ` ± ${error.toPrecision(1)}` : "");
    const head = [this.curve.along ? "distance (m)" : "time (s)", ...this.curve.lines.map((line) => (line.name || this.curve.name) + unit + known(line))];
    const rows = (this.curve.along ?? this.curve.time).map((place, k) =>
      [place, ...this.curve.lines.map(({ values, error }) => (values[k] == null ? "" : rounded(values[k], error)))].join(","),
    );
    return `${[head.map(quoted).join(","), ...rows].join("\n")}\n`;
  }
}
