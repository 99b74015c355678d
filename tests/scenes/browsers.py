"""The browser that pages are looked at with, and its two ways of drawing."""

import shutil

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
RENDERERS = {
    "canvas": ["--disable-gpu"],
    "webgl2": ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
}
"""Name, as ``?renderer=`` of a page has it -> arguments of the browser."""
