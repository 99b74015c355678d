// Two pens for the same drawing: on a canvas, or into an SVG text.  Coordinates are those of the screen.

const AT_ONCE = 200;
/** Lines of one stroke: where many cross a row of pixels, each is the slower for the others. */
const ROUND = 2;
/** Width from which the ends and corners of lines are round, pixels: below nobody sees it. */

/** Draws on a 2D canvas. */
export class CanvasPen {
  /** @param {CanvasRenderingContext2D} context */
  constructor(context) {
    this.context = context;
  }

  /** Draw lines: each of ``paths`` is x and y by turns. */
  lines(paths, colour, width, dash = []) {
    const { context } = this;
    const round = width >= ROUND && !dash.length;
    context.setLineDash(dash);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.lineJoin = round ? "round" : "miter";
    context.lineCap = round ? "round" : "butt";
    context.miterLimit = 2;
    for (let first = 0; first < paths.length; first += AT_ONCE) {
      const past = Math.min(paths.length, first + AT_ONCE);
      context.beginPath();
      for (let number = first; number < past; number++) {
        const path = paths[number];
        context.moveTo(path[0], path[1]);
        for (let k = 2; k < path.length; k += 2) context.lineTo(path[k], path[k + 1]);
      }
      context.stroke();
    }
    context.setLineDash([]);
  }

  /** Fill closed outlines. */
  areas(paths, colour) {
    const { context } = this;
    context.beginPath();
    for (const path of paths) {
      context.moveTo(path[0], path[1]);
      for (let k = 2; k < path.length; k += 2) context.lineTo(path[k], path[k + 1]);
      // filling closes outlines; closePath would look for the bounds of all of them each time
    }
    context.fillStyle = colour;
    context.fill();
  }

  circle(x, y, radius, fill, stroke) {
    const { context } = this;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = fill;
    context.fill();
    context.strokeStyle = stroke;
    context.lineWidth = 1.5;
    context.stroke();
  }

  /** Write a text of which the start, the middle or the end is at x. */
  text(x, y, text, colour, halo, anchor = "start") {
    const { context } = this;
    context.textAlign = anchor === "middle" ? "center" : anchor;
    context.font = "12px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.lineWidth = 3;
    context.strokeStyle = halo;
    context.strokeText(text, x, y);
    context.fillStyle = colour;
    context.fillText(text, x, y);
  }
}

/** Return a text that means itself in XML. */
export function escaped(text) {
  const signs = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" };
  return String(text).replace(/[&<>"]/g, (sign) => signs[sign]);
}

function pathOf(points, closed) {
  let text = "";
  for (let k = 0; k < points.length; k += 2) {
    text += `${k ? "L" : "M"}${points[k].toFixed(2)} ${points[k + 1].toFixed(2)}`;
  }
  return closed ? `${text}Z` : text;
}

/** Collects an SVG text. */
export class SvgPen {
  constructor(width, height, background) {
    this.parts = [
      `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" ` +
        `viewBox="0 0 ${width} ${height}"><rect width="100%" height="100%" fill="${background}"/>`,
    ];
  }

  lines(paths, colour, width, dash = []) {
    if (!paths.length) return;
    const data = paths.map((path) => pathOf(path, false)).join("");
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "";
    this.parts.push(
      `<path d="${data}" fill="none" stroke="${colour}" stroke-width="${width}" stroke-linejoin="round" ` +
        `${dash.length ? "" : 'stroke-linecap="round"'}${dashes}/>`,
    );
  }

  areas(paths, colour) {
    if (!paths.length) return;
    this.parts.push(`<path d="${paths.map((path) => pathOf(path, true)).join("")}" fill="${colour}"/>`);
  }

  circle(x, y, radius, fill, stroke) {
    this.parts.push(
      `<circle cx="${x.toFixed(2)}" cy="${y.toFixed(2)}" r="${radius}" fill="${fill}" stroke="${stroke}" stroke-width="1.5"/>`,
    );
  }

  text(x, y, text, colour, halo, anchor = "start") {
    this.parts.push(
      `<text x="${x.toFixed(2)}" y="${y.toFixed(2)}" font-family="system-ui, sans-serif" font-size="12" ` +
        `dominant-baseline="middle" text-anchor="${anchor}" fill="${colour}" stroke="${halo}" stroke-width="3" paint-order="stroke">${escaped(text)}</text>`,
    );
  }

  /** Show nothing of what ``draw`` draws beyond a width and a height. */
  within(width, height, draw) {
    this.parts.push(`<svg width="${width}" height="${height}">`);
    draw();
    this.parts.push("</svg>");
  }

  /** Return the whole text. */
  finish() {
    return `${this.parts.join("\n")}\n</svg>\n`;
  }
}
