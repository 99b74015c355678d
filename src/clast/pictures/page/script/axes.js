// Axes with the coordinates of the case, along the lower and the left side of the drawing.

const APART = 90;
/** Least distance of two numbers, pixels. */
const TICK = 6;

/** Return round coordinates between two, m, far enough apart on the screen, with their texts. */
function marksOf(low, high, scale) {
  const least = APART / scale;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * [1, 2, 5, 10].find((digit) => digit * power >= least);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const marks = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) {
    marks.push([k * step, (k * step).toFixed(digits).replace("-", "−")]);
  }
  return marks;
}

/** Draw ticks and numbers; the scene has its own origin, the numbers that of the case. */
export function drawAxes(pen, { run, view, theme }) {
  const [x0, y0] = run.scene.origin;
  const [paths, texts] = [[], []];
  const foot = view.height - 1;
  for (const [x, text] of marksOf(view.worldX(50) + x0, view.worldX(view.width - 20) + x0, view.scale)) {
    const at = view.screenX(x - x0);
    paths.push([at, foot, at, foot - TICK]);
    texts.push([at, foot - TICK - 8, text, "middle"]);
  }
  for (const [y, text] of marksOf(view.worldY(view.height - 30) + y0, view.worldY(12) + y0, view.scale)) {
    const at = view.screenY(y - y0);
    paths.push([1, at, 1 + TICK, at]);
    texts.push([TICK + 5, at, text, "start"]);
  }
  pen.lines([[1, 0, 1, foot, view.width, foot]], theme.ink, 1);
  pen.lines(paths, theme.ink, 1.2);
  for (const [x, y, text, anchor] of texts) pen.text(x, y, text, theme.ink, theme.paper, anchor);
  pen.text(view.width - 8, foot - TICK - 8, "m", theme.ink, theme.paper, "end");
}
