"""The browser that pages are looked at with, its two ways of drawing, and how to wait for it."""

import shutil
import time

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
RENDERERS = {
    "canvas": ["--disable-gpu"],
    "webgl2": ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
}
"""Name, as ``?renderer=`` of a page has it -> arguments of the browser."""


def colour_at(page, x, y, above=False):
    """Return red, green and blue of the drawing at a point of the world, m about its origin.

    It is that of the blocks, or of what is drawn ``above`` them.
    """
    return page.evaluate(
        """([x, y, above]) => {
          const { view } = clastPage;
          const canvas = above ? clastPage.above : clastPage.canvas;
          const copy = document.createElement("canvas");
          [copy.width, copy.height] = [canvas.width, canvas.height];
          const context = copy.getContext("2d");
          clastPage.draw();
          context.drawImage(canvas, 0, 0);
          const dots = canvas.width / view.width;
          const at = [view.screenX(x) * dots, view.screenY(y) * dots].map(Math.round);
          return [...context.getImageData(at[0], at[1], 1, 1).data].slice(0, 3);
        }""",
        [x, y, above],
    )


def settled(page):
    """Wait until what was asked for has been drawn, and the address tells it."""
    page.evaluate(
        """async () => {
          const frame = () => new Promise((done) => requestAnimationFrame(done));
          do await frame();
          while (clastPage.waiting || clastPage.addressDue !== null);
        }"""
    )


def until(page, condition, seconds=60.0):
    """Wait for a condition; the page's own policy forbids to hand it a text to evaluate."""
    end = time.monotonic() + seconds
    while not page.evaluate(condition):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(100)
