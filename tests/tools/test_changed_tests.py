"""After a change the core tests of its chapter and of those above are run."""

from __future__ import annotations

import pytest
from changed_tests import above, layers, selection

ORDER = [{"cli"}, {"run", "rockmass"}, {"step"}, {"contact"}, {"compute"}]


def test_the_layers_are_those_of_the_package():
    order = layers()
    assert order[0] == {"cli"}
    place = {one: number for number, layer in enumerate(order) for one in layer}
    assert place["cli"] < place["step"] < place["contact"] < place["compute"] < place["errors"]


def test_chapters_above_are_those_that_may_import_it():
    assert above({"step"}, ORDER) == {"cli", "run", "rockmass", "step"}
    assert above({"rockmass"}, ORDER) == {"cli", "rockmass"}
    assert above(set(), ORDER) == set()


def test_the_lowest_chapter_is_used_by_all():
    found = selection(["src/clast/compute/jit.py"], layers())
    assert {"tests/cli", "tests/step", "tests/contact", "tests/compute"} <= set(found.core)
    assert found.whole == ()


def test_the_highest_is_used_by_none():
    found = selection(["src/clast/cli/terminal_tables.py", "README.md"], layers())
    assert found.core == ("tests/cli", "tests/test_house.py")


def test_tests_that_changed_are_run_whole():
    found = selection(["tests/test_house.py", "tests/contact/test_gone.py"], layers())
    assert (found.core, found.whole) == ((), ("tests/test_house.py",))


@pytest.mark.parametrize("name", ["pyproject.toml", "tests/scenes/systems.py"])
def test_what_all_depend_on_makes_all_run(name: str):
    assert selection([name, "src/clast/cli/terminal_tables.py"], layers()).core == ("tests",)
