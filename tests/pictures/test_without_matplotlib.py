"""Everything that draws, where matplotlib is not installed: a message, and no traceback."""

import sys

import pytest

import clast
from clast.errors import CaseError
from clast.pictures.film import write_film
from clast.pictures.page.scene import scene_of


@pytest.fixture
def without(monkeypatch):
    """Make imports of matplotlib fail, also where parts of it are loaded."""
    for name in [one for one in sys.modules if one.partition(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)


DRAWN = {
    "picture": lambda run, path: clast.plot_results(run, path / "a.png"),
    "run.plot": lambda run, path: run.plot(),
    "joints": lambda run, path: clast.plot_results(run, path / "a.png", field="opening"),
    "film": lambda run, path: write_film(run, path / "a.gif"),
    "page": lambda run, path: scene_of(run, 1e6),
}


@pytest.mark.parametrize("name", DRAWN)
def test_what_draws_says_so(wall, tmp_path, without, name):
    run = clast.read(wall(2, 2).path)
    with pytest.raises(CaseError, match="pictures need matplotlib, which is not installed") as said:
        DRAWN[name](run, tmp_path)
    assert "clast[plot]" in said.value.remedy and not list(tmp_path.glob("a.*"))
