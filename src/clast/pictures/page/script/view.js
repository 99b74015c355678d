// What part of the world is seen: a centre, m, and pixels per metre.  y goes up in the world.

const BAR = 24;
/** Height of the scale bar with its text, pixels. */

/** The part of the world that a drawing shows. */
export class View {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 1;
    this.width = 1;
    this.height = 1;
    /** Part of the world that is seen in any window, m. */
    this.wide = 1;
    this.tall = 1;
    /** The box that ``fit`` has been asked for, until the view is moved. */
    this.box = null;
  }

  /** Show a part of the world about a point, m: all of it, whatever the shape of the window. */
  show(x, y, wide, tall) {
    Object.assign(this, { x, y, wide, tall, box: null });
    this.resize(this.width, this.height);
  }

  /** Go on showing what is seen in a window of another size, pixels. */
  resize(width, height) {
    Object.assign(this, { width, height, scale: Math.min(width / this.wide, height / this.tall) });
    if (this.box) this.fit(...this.box);
  }

  /** Keep what is seen at its place on the screen, from its upper left corner, in a window of another size, pixels. */
  keep(width, height) {
    const [left, top] = [this.worldX(0), this.worldY(0)];
    Object.assign(this, { width, height, x: left + (0.5 * width) / this.scale, y: top - (0.5 * height) / this.scale });
    this.moved();
  }

  /** Take note of what is seen, after the view has been moved. */
  moved() {
    Object.assign(this, { wide: this.width / this.scale, tall: this.height / this.scale, box: null });
  }

  /** Show a box of the world, m, with a margin, and above the scale bar. */
  fit(left, low, right, high) {
    const wide = Math.max(right - left, 1e-9);
    const tall = Math.max(high - low, 1e-9);
    this.scale = 0.94 * Math.min(this.width / wide, Math.max(this.height - BAR, 1) / tall);
    this.x = 0.5 * (left + right);
    this.y = 0.5 * (low + high) - (0.5 * BAR) / this.scale;
    this.moved();
    this.box = [left, low, right, high];
  }

  screenX(x) {
    return 0.5 * this.width + (x - this.x) * this.scale;
  }

  screenY(y) {
    return 0.5 * this.height - (y - this.y) * this.scale;
  }

  worldX(x) {
    return this.x + (x - 0.5 * this.width) / this.scale;
  }

  worldY(y) {
    return this.y - (y - 0.5 * this.height) / this.scale;
  }

  /** Enlarge by a factor about a point of the screen, which stays where it is. */
  zoom(factor, x = 0.5 * this.width, y = 0.5 * this.height) {
    const [atX, atY] = [this.worldX(x), this.worldY(y)];
    this.scale = Math.max(1e-9, Math.min(1e12, this.scale * factor));
    this.x += atX - this.worldX(x);
    this.y += atY - this.worldY(y);
    this.moved();
  }

  /** Move by pixels of the screen. */
  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
    this.moved();
  }
}

/**
 * Let wheel, drag and two fingers move a view.
 * @param {HTMLElement} element @param {View} view
 * @param {{changed: () => void, clicked: (x: number, y: number) => void, over: (x: number, y: number) => void,
 *   ruled: () => ((from: {x: number, y: number}, to: {x: number, y: number}) => void) | null}} calls
 *   ``over`` has the place of the pointer, ``ruled`` gives what a drag does instead of moving the view
 */
export function followPointers(element, view, { changed, clicked, over, ruled }) {
  const down = new Map();
  let moved = 0;
  let begun = null;
  const here = (event) => {
    const box = element.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  element.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const at = here(event);
      view.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 20 : 1)), at.x, at.y);
      changed();
    },
    { passive: false },
  );
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    down.set(event.pointerId, here(event));
    if (down.size === 1) [moved, begun] = [0, here(event)];
  });
  element.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    const now = here(event);
    over(now.x, now.y);
    if (!before) return;
    const rule = down.size === 1 && ruled();
    if (rule) {
      rule(begun, now);
    } else if (down.size === 1) {
      view.pan(now.x - before.x, now.y - before.y);
    } else {
      const other = [...down].find(([id]) => id !== event.pointerId)[1];
      const grown =
        Math.hypot(now.x - other.x, now.y - other.y) /
        Math.max(1, Math.hypot(before.x - other.x, before.y - other.y));
      view.zoom(grown, 0.5 * (now.x + other.x), 0.5 * (now.y + other.y));
      view.pan(0.5 * (now.x - before.x), 0.5 * (now.y - before.y));
    }
    moved += Math.abs(now.x - before.x) + Math.abs(now.y - before.y);
    down.set(event.pointerId, now);
    changed();
  });
  const lift = (event) => {
    const at = down.get(event.pointerId);
    down.delete(event.pointerId);
    if (at && event.type === "pointerup" && moved < 5) clicked(at.x, at.y);
  };
  element.addEventListener("pointerup", lift);
  element.addEventListener("pointercancel", lift);
}
