"""The pages of `clast edit`: forms, text, section, each in one file that asks no other server."""

from __future__ import annotations

from clast.pictures.page.document import closed_page, file, module

HERE = "clast.editor"
OF_PAGES = (
    "packing moving magnified contact_faces data colours colouring flow pens view draw_canvas "
    "joints chosen supports axes layers legend"
).split()
"""Modules of the page of a run that draw the section, each after those that it imports."""
SCRIPTS = (
    "values hand reference handles curve copies form snaps choices signs draw underlay start text "
    "search picture version study run stages edit"
).split()
"""Modules of the page, each after those that it imports."""


def editor_text(name: str) -> str:
    """Return the page of the editor of a case file of this name."""
    own = [module(one, HERE) for one in ("section", *SCRIPTS)]
    start = f"modules.{SCRIPTS[-1]}.main();"
    program = ['"use strict";', "const modules = {};", *map(module, OF_PAGES), *own, start]
    style = file("edit.css", HERE) + file("section.css", HERE)
    scripts = [file("vendor/htm-preact.umd.js", HERE), "\n".join(program)]
    return closed_page(name, [file("edit.html", HERE)], style, scripts, "'self'", "'self'")
