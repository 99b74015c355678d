"""The command of the editor: edit."""

from __future__ import annotations

from clast.cli.options import CaseFile
from clast.cli.terminal import say


def edit(case: CaseFile) -> None:
    """Edit a case file in a browser on this machine: forms, its text, faults at their fields."""
    from clast.editor.server import edit as serve

    serve(case, ("127.0.0.1", 0), lambda address: say(f"edit: {address}"))
