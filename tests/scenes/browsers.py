"""The browser that pages are looked at with, its two ways of drawing, and how to wait for it."""

import shutil
import time

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
RENDERERS = {
    "canvas": ["--disable-gpu"],
    "webgl2": ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
}
"""Name, as ``?renderer=`` of a page has it -> arguments of the browser."""


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
