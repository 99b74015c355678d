"""Cases of a study: the tables of a case, and the same case with other tables."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from clast.case.case_file import Case
from clast.errors import CaseError
from clast.inputs.declaring import text as case_text

Content = Mapping[str, Any]
"""Tables of a case file."""


def given_case(case: Any) -> Case:
    """Return a case that is given as one, or by its file; raises CaseError for anything else."""
    if isinstance(case, Case):
        return case
    if isinstance(case, str | Path):
        return Case.from_toml(Path(case))
    raise CaseError(
        f"a {type(case).__name__} is not a case",
        where="case",
        remedy='give the name of a case file, clast.load("case.toml") or builder.case(...)',
    )


def content_of(case: Case) -> dict[str, Any]:
    """Return the tables of a case without its references, which are those of one run.

    Raises CaseError where it holds objects of a script.
    """
    content = case_text.parse(case.to_toml(), case.file)
    content.pop("reference", None)
    return content


def changed(case: Case, content: Content) -> Case:
    """Return a case with other tables; raises CaseError naming file, table, key and remedy.

    Blocks are cut once where nothing that cuts them has changed.
    """
    other = Case.validated(dict(content), case.file)
    mass = other._rock_mass
    if mass is not None and mass == case._rock_mass:
        case.cut()
        other._cut = case._cut
    return other
