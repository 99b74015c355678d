"""The examples of the README, of docstrings and of the contact law do what is said of them."""

from __future__ import annotations

import itertools
import re
import textwrap
from typing import Any

import numpy as np
import pytest

import clast
from clast.case import api
from clast.case.case_file import Case
from clast.case.templates import FOLDER, INCLINE
from clast.inputs import builder as model_builder
from scenes.places import ROOT


def executed(text: str, name: str) -> dict[str, Any]:
    """Return what an example leaves behind."""
    names: dict[str, Any] = {}
    exec(compile(text, name, "exec", dont_inherit=True), names)
    return names


def indented(docstring: str | None) -> str:
    """Return the first example of a docstring: its first indented lines."""
    lines = (docstring or "").splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("    "))
    rest = itertools.takewhile(lambda line: not line or line.startswith("    "), lines[first:])
    return textwrap.dedent("\n".join(rest))


def snippets(document: str) -> list[str]:
    """Return the Python examples of a document."""
    return re.findall(r"```python\n(.*?)```", (ROOT / document).read_text("utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def hardening() -> Any:
    """The contact law of the how-to page."""
    page = "docs/how-to/extend.md"
    return executed(snippets(page)[0], page)["Hardening"]


def test_the_readme_builds_and_runs_a_model():
    names = executed(snippets("README.md")[0], "README.md")
    run = names["run"]
    assert len(snippets("README.md")) == 1
    assert run.report.finished
    assert run.block("brick").displacement[-1, 0] == pytest.approx(0.0884, rel=0.01)
    assert run.block("brick").velocity[-1] == pytest.approx([0.0, 0.0], abs=1e-3)
    again = Case.from_toml(names["text"]).run()
    np.testing.assert_array_equal(again.field("vertices"), run.field("vertices"))


@pytest.mark.parametrize("module", [clast, model_builder, api], ids=lambda m: m.__name__)
def test_the_examples_of_docstrings_run(module, monkeypatch):
    monkeypatch.chdir(FOLDER)
    executed(indented(module.__doc__), module.__name__)


def test_the_law_of_the_page_is_one(hardening):
    assert clast.check_law(hardening()) == ()


@pytest.mark.parametrize(
    ("process", "tolerance"), [("modified", 2e-3), ("open-close", 2e-3), ("convex", 3e-4)]
)
@pytest.mark.one_in(3)
def test_the_law_of_the_page_slides_as_it_should(hardening, process, tolerance):
    """Incline of 45 degrees, friction 20: friction lags by a step but in the convex process."""
    case = Case.from_toml(INCLINE, [f"method.process={process}"])
    run = case.with_method(contact_law=hardening()).run()
    assert run.history("A").displacement[-1] == pytest.approx([1.558273, -1.558273], rel=tolerance)
    assert not [text for text in run.report.warnings if "contact law" in text]
