"""The page of `clast edit`: forms, text and faults, in one file that asks no other server."""

from __future__ import annotations

from clast.pictures.page.document import closed_page, file, module

HERE = "clast.editor"
SCRIPTS = ("values", "hand", "form", "edit")
"""Modules of the page, each after those that it imports."""


def editor_text(name: str) -> str:
    """Return the page of the editor of a case file of this name."""
    scripts = ["const modules = {};", *(module(one, HERE) for one in SCRIPTS)]
    return closed_page(
        name,
        [file("edit.html", HERE)],
        file("edit.css", HERE),
        [
            file("vendor/htm-preact.umd.js", HERE),
            "\n".join(['"use strict";', *scripts, "modules.edit.main();"]),
        ],
        "'self'",
    )
