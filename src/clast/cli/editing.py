"""The command of the editor: edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clast.cli.options import HERE, Settings, address_of
from clast.cli.terminal import say
from clast.errors import CaseError


def edit(
    case: Annotated[
        Path | None,
        typer.Argument(metavar="CASE", help="Case file (TOML); without --view a new name too."),
    ] = None,
    view: Annotated[
        bool, typer.Option("--view", help="Show the section only, beside another text editor.")
    ] = False,
    at: Annotated[
        str,
        typer.Option("--at", metavar="HOST:PORT", help="Address of the window."),
    ] = HERE,
    settings: Settings = None,
) -> None:
    """Edit a case file in a browser on this machine: forms, its text, faults at their fields."""
    from clast.run.progress import compilation_told

    if case is None:
        here = [f"'{one}'" for one in sorted(map(str, Path().glob("*.toml")))[:5]]
        several = f"name one here ({', '.join(here)}), or " if here else ""
        remedy = f"{several}begin a new one: clast edit new.toml"
        raise CaseError("needs the name of a case file", where="clast edit", remedy=remedy)
    if settings and not view:
        remedy = "change the value in the window, or look on with --view"
        raise CaseError("is for runs and views", where="--set", remedy=remedy)
    from clast.editor.document import begins
    from clast.editor.server import EditServer, ViewServer, serve
    from clast.inputs.declaring.text import read_text

    if view:
        read_text(case)  # a file that is not there is refused at once
    elif begins(case):
        say(f"new: {case} is written when the window has a case for it")
    kind, name = (ViewServer, "view") if view else (EditServer, "edit")
    host, _, port = address_of(at, "--at").rpartition(":")
    if host != "localhost" and not host.startswith("127."):
        say(f"warning: --at {at}: whoever reads what goes to this address can edit the case")
    with compilation_told(say):
        try:
            server = kind((host, int(port)), case, settings or ())
        except OSError as error:
            what, remedy = f"cannot be served: {error.strerror}", "name another address or port"
            raise CaseError(what, where=f"--at {at}", remedy=remedy) from None
        serve(server, lambda address: say(f"{name}: {address}"))
