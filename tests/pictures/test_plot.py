"""Pictures of results: that they are drawn, explained, and refused with a remedy."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest

from clast.pictures.fields import KINDS, SCALARS, prefixed, round_below
from clast.pictures.plot import plot_history, plot_results
from clast.results import Results
from scenes.drawings import text_of

matplotlib = pytest.importorskip("matplotlib")

Wall = Callable[..., Results]


@pytest.fixture
def readable_svg():
    """Make SVG pictures keep their text as text."""
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        yield


def colours_of(path: Path) -> int:
    """The number of different colours in a picture."""
    from matplotlib.image import imread

    red, green, blue = np.round(255 * imread(path)[:, :, :3]).astype(int).reshape(-1, 3).T
    return len(np.unique(red << 16 | green << 8 | blue))


@pytest.mark.parametrize("field", [*SCALARS, *KINDS])
@pytest.mark.one_in(3)
def test_every_field_has_a_picture(wall: Wall, tmp_path: Path, field: str):
    path = plot_results(wall(4, 3), tmp_path / f"{field}.png", field=field)
    assert path == tmp_path / f"{field}.png"
    assert colours_of(path) > 20


@pytest.mark.usefixtures("readable_svg")
def test_picture_says_what_it_shows(wall: Wall, tmp_path: Path):
    words = text_of(plot_results(wall(4, 3, "A wall that leans"), tmp_path / "wall.svg"))
    for expected in (
        "A wall that leans",
        "Displacement (mm)",
        "x (m)",
        "y (m)",
        "start",
        "fixed",
        "top",
        "contact force, 50 kN/m",
    ):
        assert expected in words


@pytest.mark.usefixtures("readable_svg")
def test_picture_without_contacts(wall: Wall, tmp_path: Path):
    results = wall(4, 3)
    words = text_of(plot_results(results, tmp_path / "wall.svg", contacts=False))
    assert "contact force" not in words
    first = text_of(plot_results(results, tmp_path / "first.svg", frame=0))
    assert "contact force" not in first


@pytest.mark.usefixtures("readable_svg")
def test_rocks_and_blocks_are_named(wall: Wall, tmp_path: Path):
    results = wall(4, 3)
    assert "granite marl" in text_of(plot_results(results, tmp_path / "r.svg", field="rock"))
    names = text_of(plot_results(results, tmp_path / "b.svg", field="block")).split()
    assert {str(number) for number in range(1, 13)} <= set(names)


@pytest.mark.usefixtures("readable_svg")
def test_signs_of_money_are_no_formulas(wall: Wall, tmp_path: Path):
    words = text_of(plot_results(wall(2, 2, "from 5 $ to 7 $ a brick"), tmp_path / "w.svg"))
    assert "from 5 $ to 7 $ a brick" in words


def test_thousands_of_blocks(wall: Wall, tmp_path: Path):
    results = wall(51, 100)
    start = perf_counter()
    path = plot_results(results, tmp_path / "wall.png", field="sigma_yy")
    # 2 s where this was written.
    assert perf_counter() - start < 20.0
    assert colours_of(path) > 1000
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        words = text_of(plot_results(results, tmp_path / "wall.svg"))
    drawn = re.search(r"\(the largest of each place: (\d+) of 5,000\)", words)
    assert drawn is not None
    assert 100 < int(drawn[1]) < 1500


@pytest.mark.parametrize(("rows", "columns"), [(2, 80), (80, 2), (2, 1)])
@pytest.mark.parametrize("field", ["displacement", "rock"])
def test_slender_systems_keep_a_sensible_sheet(
    wall: Wall, tmp_path: Path, rows: int, columns: int, field: str
):
    from matplotlib.image import imread

    title = "A system of blocks whose title is far too long for a single line of a picture"
    path = plot_results(wall(rows, columns, title), tmp_path / "wall.png", field=field)
    height, width = imread(path).shape[:2]
    assert 500 < width < 2000
    assert 350 < height < 2000


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_formats(wall: Wall, tmp_path: Path, suffix: str):
    results = wall(2, 2)
    assert plot_results(results, tmp_path / f"a.{suffix}").stat().st_size > 1000
    assert plot_history(results, tmp_path / f"b.{suffix}", "top").stat().st_size > 1000


@pytest.mark.usefixtures("readable_svg")
def test_history_says_what_it_shows(wall: Wall, tmp_path: Path):
    words = text_of(plot_history(wall(4, 3), tmp_path / "top.svg", "top"))
    for expected in ("Measured point top", "Displacement (mm)", "Velocity (mm/s)", "Time (s)"):
        assert expected in words


def test_nothing_global_is_touched(wall: Wall, tmp_path: Path):
    code = """if True:
        import sys
        import clast.pictures.plot, clast.results
        assert "matplotlib" not in sys.modules and "h5py" not in sys.modules
        import matplotlib
        def settings():
            # Looking at "backend" would choose one.
            return {k: matplotlib.rcParams[k] for k in matplotlib.rcParams if k != "backend"}
        before = settings()
        from clast.results import read_results
        clast.pictures.plot.plot_results(read_results(sys.argv[1]), sys.argv[2])
        assert settings() == before
        assert "matplotlib.pyplot" not in sys.modules
    """
    results = wall(2, 2)
    subprocess.run(
        [sys.executable, "-c", code, str(results.path), str(tmp_path / "a.png")], check=True
    )


def test_prefixes():
    assert prefixed(0.0021, "m") == (1e3, "mm")
    assert prefixed(2100.0, "m") == (1.0, "m")
    assert prefixed(2.1e7, "Pa") == (1e-6, "MPa")
    assert prefixed(1000.0, "N/m") == (1e-3, "kN/m")
    assert prefixed(0.0, "Pa") == (1.0, "Pa")
    assert prefixed(1e-14, "m/s") == (1e9, "nm/s")
    assert prefixed(0.004, "°") == (1.0, "°")
    # moments large and small in one unit
    assert {prefixed(size, "N m/m") for size in (0.0, 0.08, 87.0, 13200.0, 2e7)} == {
        (1e-3, "kN m/m")
    }


def test_round_numbers():
    assert [round_below(value) for value in (1.0, 1.99, 2.0, 4.9, 9.9, 73.0)] == pytest.approx(
        [1.0, 1.0, 2.0, 2.0, 5.0, 50.0]
    )
    assert round_below(5e-7) == pytest.approx(5e-7)
