"""The page itself: one HTML file with its data, drawing by its own scripts, that asks no network.

The scripts are modules that name their imports; they are joined here in their order.  Names in a
case are data: they stand in JSON alone, and the scripts write them as text.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from clast.errors import CaseError
from clast.pictures.page.scene import scene_of
from clast.results import Recording
from clast.rockmass.drawings.drawing_files import replaced

SUFFIXES = (".html", ".htm")
"""Endings of the names of pages."""


def html_path(path: Path | str) -> Path:
    """Return the path of a page to write; raises CaseError for a name with another ending."""
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise CaseError(
            f"pages cannot be written as '{path.suffix or path.name}'",
            where=str(path),
            remedy=f"end the name in {' or '.join(SUFFIXES)}",
        )
    return path


def write_html(text: str, path: Path) -> Path:
    """Write a page and return its path; raises CaseError where it cannot, and leaves no part."""
    with replaced(path) as file:
        file.write(text.encode("utf-8"))
    return path


HERE = "clast.pictures.page"
SCRIPTS = (
    "packing moving magnified contact_faces data colours colouring flow pens view draw_canvas "
    "draw_webgl joints chosen supports axes layers legend ruler charts report live live_panel app"
).split()
"""Modules of the page, each after those that it imports."""
BUDGET = 12e6
"""Bytes of contacts and joints before they are compressed, unless another number is asked for."""
IMPORT = re.compile(r"^import (\{[^}]*\}) from \"\.[\w./]*/(\w+)\.js\";$", re.MULTILINE)
COMMENT = re.compile(r"^ *(?://.*|/\*\*(?:(?!\*/)[\s\S])*\*/)\n", re.MULTILINE)
"""Comments of scripts that have lines of their own; a seventh of the bytes of a page."""
EXPORT = re.compile(r"^export ((?:const|function|class|async function) (\w+))", re.MULTILINE)


def write_page(results: Recording, path: Path | str, *, budget: float = BUDGET) -> Path:
    """Write the page of a run, complete in one file; return its path.

    ``budget`` is the size of contacts and joints, bytes, uncompressed; the page says how many of
    how many it shows.  Raises CaseError where the page cannot be written; no part of a page is left
    then.
    """
    path = html_path(path)
    return write_html(page_text(scene_of(results, budget)), path)


def page_text(scene: dict[str, Any]) -> str:
    """Return the text of a page from the result of ``scene_of``."""
    return _text(scene, scene["title"], "'none'")


def live_text() -> str:
    """Return the text of a page that asks the server it came from for a run that goes on."""
    return _text(None, "clast", "'self'")


def widget_script() -> str:
    """Return the page as one module with ``export default {render}``, as anywidget wants it."""
    style = file("vendor/uPlot.min.css") + file("page.css")
    return "\n".join(
        [
            f"const uPlot = (() => {{ {file('vendor/uPlot.iife.min.js')}\nreturn uPlot; }})();",
            "const modules = {};",
            *map(module, SCRIPTS),
            f"const style = {json.dumps(style)};",
            f"const markup = {json.dumps(file('page.html'))};",
            "export default { render: ({ model, el }) => modules.app.embed(",
            '  el, markup, style, JSON.parse(model.get("scene"))) };',
            "",
        ]
    )


def _text(scene: dict[str, Any] | None, title: str, network: str) -> str:
    """Return the text of a page that may ask ``network``, as a policy has it."""
    scripts = ["const modules = {};", *map(module, SCRIPTS), "modules.app.main();"]
    # a closing tag within the data would end it
    data = json.dumps(scene, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return closed_page(
        title,
        [file("page.html"), f'<script type="application/json" id="scene">{data}</script>'],
        file("vendor/uPlot.min.css") + file("page.css"),
        [file("vendor/uPlot.iife.min.js"), "\n".join(['"use strict";', *scripts])],
        network,
    )


def closed_page(
    title: str,
    body: Sequence[str],
    style: str,
    scripts: Sequence[str],
    network: str,
    frames: str = "'none'",
) -> str:
    """Return a page that runs ``scripts`` alone, asks ``network``, has frames of ``frames``.

    Both are in the words of a policy.
    """
    policy = (
        f"default-src 'none'; connect-src {network}; frame-src {frames}; img-src data: blob:; "
        f"script-src {' '.join(map(_hash, scripts))}; style-src 'unsafe-inline'"
    )
    return "\n".join(
        [
            "<!doctype html>",
            '<html lang="en"><head><meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">',
            '<meta name="viewport" content="width=device-width,initial-scale=1">',
            f"<title>{escape(title)} - clast</title>",
            f"<style>{style}</style></head><body>",
            *body,
            *(f"<script>{script}</script>" for script in scripts),
            "</body></html>",
            "",
        ]
    )


def module(name: str, package: str = HERE) -> str:
    """Return a script as a function of its own, which returns what it exports."""
    text = COMMENT.sub("", file(f"script/{name}.js", package))
    exported = ", ".join(export[2] for export in EXPORT.finditer(text))
    text = EXPORT.sub(r"\1", IMPORT.sub(r"const \1 = modules.\2;", text))
    return f"modules.{name} = (() => {{\n{text}\nreturn {{ {exported} }};\n}})();"


def file(name: str, package: str = HERE) -> str:
    """Return the text of a file in the folder of a package."""
    return (files(package) / name).read_text(encoding="utf-8")


def _hash(script: str) -> str:
    """Return the hash by which a Content-Security-Policy knows a script."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"
