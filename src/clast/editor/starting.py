"""The text of a new case: a template, a drawing beside it, or a section with nothing in it yet."""

from __future__ import annotations

from pathlib import Path

from clast.case.drawn_case import TO_BE_GIVEN, case_text, comment
from clast.case.templates import TEMPLATES
from clast.editor.underlay import beside
from clast.inputs.declaring import text as toml
from clast.rockmass.drawings.drawing import Drawing
from clast.rockmass.readers import read_drawing

UNTIMED = f'step = "{TO_BE_GIVEN}"\nend = "{TO_BE_GIVEN}"'


def templates() -> list[dict[str, str]]:
    """Return name and title of each template."""
    titles = {name: toml.parse(text, name).get("title", "") for name, text in TEMPLATES.items()}
    return [{"name": name, "title": str(title)} for name, title in titles.items()]


def started(case: Path, start: str) -> str:
    """Return the text of a new case from a template, a drawing in its folder, or "" for neither.

    Values that nobody has given are faults that lead to their fields.  Raises CaseError for
    drawings that cannot be read.
    """
    if start in TEMPLATES:
        return TEMPLATES[start]
    if start:
        return case_text(read_drawing(beside(case, start)))
    told = f'Draw or write [domain] boundary, and give a number for each "{TO_BE_GIVEN}".'
    tables = case_text(Drawing(file=case.name))
    tables = tables[tables.index("schema = ") :].replace(UNTIMED, "step = 1e-3\nend = 1.0")
    return "\n".join([*comment(told), "", tables])
