/** Pictures of the section for a report: SVG, PNG, and PDF by the browser's print, with title and legend, without what is chosen. */
import { drawLegend, heightOfLegend } from "../../pictures/page/script/legend.js";
import { LIGHT } from "./section.js";
import { CanvasPen, SvgPen } from "../../pictures/page/script/pens.js";

const FINE = 3;
/** Dots of a PNG for each pixel of the window. */

/** Draw the section, and below it title and legend. */
function drawn(pen, section, title) {
  const { view, run, theme, state, place, tools } = section, { chosen } = state;
  Object.assign(section, { place: [] });
  state.chosen = -1;
  section.drawBelow(pen);
  section.drawAbove(pen);
  for (const shape of tools.chosen) tools.drawShape(pen, shape, theme.ink, 1.2, Boolean(section.showsFile) || !run);
  Object.assign(section, { place });
  state.chosen = chosen;
  return () => { if (run) drawLegend(pen, section.seen(), view.width, view.height, title); else pen.text(10, view.height + 14, title, theme.ink, theme.paper); };
}

/** The section as an SVG text. */
export function svgOf(section, title) {
  const { view, theme } = section, pen = new SvgPen(view.width, view.height + heightOf(section), theme.paper);
  let below = null;
  pen.within(view.width, view.height, () => { below = drawn(pen, section, title); });
  below();
  return pen.finish();
}

/** The section on a canvas. */
export function canvasOf(section, title) {
  const { view, theme } = section, canvas = document.createElement("canvas"), context = canvas.getContext("2d");
  [canvas.width, canvas.height] = [FINE * view.width, FINE * (view.height + heightOf(section))];
  context.setTransform(FINE, 0, 0, FINE, 0, 0);
  context.fillStyle = theme.paper;
  context.fillRect(0, 0, canvas.width, canvas.height);
  const below = drawn(new CanvasPen(context), section, title);
  context.fillStyle = theme.paper;
  context.fillRect(0, view.height, view.width, heightOf(section));
  below();
  return canvas;
}

const heightOf = (section) => (section.run ? heightOfLegend(section.seen(), section.view.width) : 24);

/** Offer pictures, and the view of what is chosen, above the section. */
export function offerPictures(section, state) {
  const place = document.createElement("details");
  place.innerHTML = '<summary>Picture</summary><div class="popup"><button>SVG</button> <button>PNG</button> <button title="Prints the section: save it as PDF there">PDF</button> <button title="z in the drawing">zoom to the chosen</button></div>';
  section.root.querySelector(".legend details").before(place);
  place.name = "panels";
  const [svg, png, pdf, near] = place.querySelectorAll("button"), title = () => state.content.title || state.file.split(/[\\/]/).at(-1);
  const save = (blob, ending) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = `${state.file.split(/[\\/]/).at(-1).replace(/\.[^.]*$/, "")}.${ending}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  };
  svg.addEventListener("click", () => save(new Blob([svgOf(section, title())], { type: "image/svg+xml" }), "svg"));
  png.addEventListener("click", () => canvasOf(section, title()).toBlob((blob) => save(blob, "png")));
  pdf.addEventListener("click", () => { place.open = false; print(); });
  offerSheet(section, title);
  near.addEventListener("click", () => section.zoomToChosen());
}

/** What is printed of the window, on paper or as PDF: the section alone, in light colours, on a page of its size. */
function offerSheet(section, title) {
  const sheet = Object.assign(document.createElement("div"), { id: "sheet" });
  document.body.append(sheet);
  addEventListener("beforeprint", () => {
    const { view: { width }, theme } = section;
    section.theme = LIGHT;
    const text = svgOf(section, title());
    section.theme = theme;
    sheet.innerHTML = `<style>@page { size: ${width}px ${section.view.height + heightOf(section)}px; margin: 0 }</style>${text}`;
  });
  addEventListener("afterprint", () => sheet.replaceChildren());
}
