"""The examples of README and CONTRIBUTING do what is said of them."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import clast
from clast.case import Case
from clast.casefile.templates import INCLINE
from clast.simulate import simulate

ROOT = Path(__file__).parents[1]


def snippets(document: str) -> list[str]:
    """Return the Python examples of a document."""
    return re.findall(r"```python\n(.*?)```", (ROOT / document).read_text("utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def hardening() -> Any:
    """The contact law of CONTRIBUTING."""
    (text,) = snippets("CONTRIBUTING.md")
    names: dict[str, Any] = {}
    exec(compile(text, "CONTRIBUTING.md", "exec", dont_inherit=True), names)
    return names["Hardening"]


def test_the_law_of_contributing_is_one(hardening):
    assert clast.check_law(hardening()) == ()


@pytest.mark.parametrize(
    ("process", "tolerance"), [("modified", 2e-3), ("open-close", 2e-3), ("convex", 3e-4)]
)
def test_the_law_of_contributing_slides_as_it_should(hardening, process, tolerance):
    """Incline of 45 degrees, friction 20: friction lags by a step but in the convex process."""
    case = Case.from_toml(INCLINE, [f"method.process={process}"])
    model = case.model()
    method = replace(case.method(model), contact_law=hardening())
    run = simulate(model, method, case.schedule())
    assert run.history("A").displacement[-1] == pytest.approx([1.558273, -1.558273], rel=tolerance)
    assert not [text for text in run.report.warnings if "contact law" in text]
