"""The command of the editor: edit."""

from __future__ import annotations

from typing import Annotated

import typer

from clast.cli.options import CaseFile, Settings
from clast.cli.terminal import say
from clast.errors import CaseError

HERE = ("127.0.0.1", 0)
"""This machine alone, and a port that is free."""


def edit(
    case: CaseFile,
    view: Annotated[
        bool, typer.Option("--view", help="Show the section only, beside another text editor.")
    ] = False,
    settings: Settings = None,
) -> None:
    """Edit a case file in a browser on this machine: forms, its text, faults at their fields."""
    from clast.run.progress import compilation_told

    if settings and not view:
        remedy = "change the value in the window, or look on with --view"
        raise CaseError("is for runs and views", where="--set", remedy=remedy)
    with compilation_told(say):
        if view:
            from clast.editor.view import view as look_on

            look_on(case, HERE, lambda address: say(f"view: {address}"), settings or ())
        else:
            from clast.editor.server import edit as serve

            serve(case, HERE, lambda address: say(f"edit: {address}"))
