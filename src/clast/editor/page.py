"""The pages of `clast edit`: forms, text, section, each in one file that asks no other server."""

from __future__ import annotations

from collections.abc import Sequence

from clast.pictures.page.document import closed_page, file, module

HERE = "clast.editor"
OF_PAGES = (
    "packing moving magnified contact_faces data colours colouring flow pens view draw_canvas "
    "joints chosen supports axes layers legend"
).split()
"""Modules of the page of a run that draw the section, each after those that it imports."""
SCRIPTS = (
    "values hand form handles snaps choices signs draw underlay start text search picture "
    "study run stages edit"
).split()
"""Modules of the page, each after those that it imports."""


def editor_text(name: str) -> str:
    """Return the page of the editor of a case file of this name."""
    return _text(name, "edit", [file("vendor/htm-preact.umd.js", HERE)], SCRIPTS)


def view_text(name: str) -> str:
    """Return the page that shows the section of a case file of this name."""
    return _text(name, "view", [], ("view_case",))


def _text(name: str, kind: str, libraries: list[str], scripts: Sequence[str]) -> str:
    """Return a page whose last module starts it."""
    own = [module(one, HERE) for one in ("section", *scripts)]
    start = f"modules.{scripts[-1]}.main();"
    program = ['"use strict";', "const modules = {};", *map(module, OF_PAGES), *own, start]
    style = file(f"{kind}.css", HERE) + file("section.css", HERE)
    markup = [file(f"{kind}.html", HERE)]
    return closed_page(name, markup, style, [*libraries, "\n".join(program)], "'self'", "'self'")
