"""What objects print as: a few lines, no arrays."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast import studies
from clast.case.case_file import Case
from clast.case.templates import INCLINE
from scenes.systems import contacts_of, wall


@pytest.fixture(scope="module")
def things(tmp_path_factory) -> dict[str, object]:
    file = tmp_path_factory.mktemp("texts") / "a.vtkhdf"
    case = Case.from_toml(INCLINE, ["time.end=0.01", "method.process=modified"])
    run = case.run(output=file)
    model = wall(4, 5)
    return {
        "Case": case,
        "Run": run,
        "Results": clast.read(file),
        "Report": run.report,
        "State": run.final,
        "Model": run.model,
        "PointHistory": run.history("A"),
        "FrameContacts": run.contacts(),
        "BlockHistory": run.block("slider"),
        "Frame": run.frame(),
        "Columns": run.energy,
        "ContactMemory": run.state.memory,
        "Contacts": contacts_of(model),
        "Accelerogram": clast.Accelerogram(np.arange(9.0), np.ones((9, 2))),
        "ComparedMethods": studies.compare(case, ["convex"], ["penalty"]),
    }


def test_all_are_short_and_say_what_they_are(things):
    for name, thing in things.items():
        text = repr(thing)
        assert text.startswith(name), name
        assert len(text.splitlines()) <= 4, text
        assert max(map(len, text.splitlines())) <= 400 if name != "ComparedMethods" else True, text
        assert "array(" not in text, text
