"""Scales that one block would spoil, arrows that can be told apart, sizes, parts, limits."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from clast.errors import CaseError
from clast.pictures import canvas
from clast.pictures.fields import colours_between, largest_but_few, scale_of
from clast.pictures.figure_options import Look
from clast.pictures.forces import APART, FARTHER, keep_apart
from clast.pictures.plot import plot_results
from clast.results import Results
from scenes.drawings import text_of

matplotlib = pytest.importorskip("matplotlib")

Wall = Callable[..., Results]
EQUAL = np.ones(1000)


def with_one(value: float, rest: np.ndarray) -> np.ndarray:
    return np.concatenate([rest, [value]])


def test_one_extreme_value_does_not_spoil_the_scale():
    rest = -np.linspace(1e3, 5e5, 999)
    scale = scale_of(with_one(-6e7, rest), EQUAL)
    assert (scale.low, scale.high) == (-5e5, 0.0)
    assert (scale.extend, scale.beyond) == ("min", 1)
    both = scale_of(with_one(6e7, rest * np.where(np.arange(999) % 2, 1, -1)), EQUAL)
    assert (both.low, both.high, both.extend) == (pytest.approx(-5e5), pytest.approx(5e5), "max")


def test_a_sliver_among_few_blocks_does_not_spoil_it_either():
    values, area = np.array([-1e5, -2e5, -9e6]), np.array([1.0, 0.5, 1e-3])
    assert scale_of(values, area).low == -2e5


@pytest.mark.parametrize(
    "values",
    [
        np.linspace(0.0, 2.0, 1000),
        with_one(5.9, np.linspace(0.0, 2.0, 999)),  # large, but not so that nothing else is seen
        with_one(2.0, np.zeros(999)),  # one block moves, and that is what is to be seen
        with_one(2.0, np.full(999, 1e-9)),
        np.concatenate([np.full(980, 0.1), np.full(20, 9.0)]),  # not few
    ],
)
def test_a_scale_that_is_not_spoilt_holds_all_values(values):
    scale = scale_of(values, EQUAL)
    assert (scale.low, scale.high) == (0.0, values.max())
    assert (scale.extend, scale.beyond) == ("neither", 0)


def test_a_little_on_the_other_side_of_zero_is_not_beyond():
    scale = scale_of(with_one(100.0, -np.linspace(1e3, 5e5, 999)), EQUAL)
    assert (scale.low, scale.high, scale.extend) == (-5e5, 0.0, "neither")


def test_values_that_are_all_zero_have_a_scale():
    assert scale_of(np.zeros(3), np.ones(3)).high == 1.0
    assert largest_but_few(np.zeros(0), np.zeros(0)) == 0.0


def test_limits_are_taken_as_they_are():
    values = np.linspace(-3.0, 3.0, 1000)
    scale = scale_of(values, EQUAL, (-1.0, 2.0))
    assert (scale.low, scale.high, scale.extend) == (-1.0, 2.0, "both")
    assert scale.beyond == np.sum((values < -1) | (values > 2))


def test_zero_has_the_same_colour_whatever_the_limits():
    neutral = colours_between(-1.0, 1.0)(0.5)
    assert colours_between(-1.0, 3.0)(0.25) == pytest.approx(neutral, abs=0.02)
    assert colours_between(-5.0, 1.0)(5 / 6) == pytest.approx(neutral, abs=0.02)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list:
    """The figures that are drawn, none of them written."""
    figures: list = []
    monkeypatch.setattr(canvas, "save", lambda figure, path: figures.append(figure) or path)
    return figures


def arrows_in(figure) -> tuple[np.ndarray, np.ndarray]:
    """Where arrows begin and end, m, (k, 2) each."""
    (quiver,) = (c for c in figure.axes[0].collections if hasattr(c, "U"))
    return quiver.XY, quiver.XY + np.column_stack([quiver.U, quiver.V])


def inside(figure, points: np.ndarray) -> bool:
    axes = figure.axes[0]
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    return bool(((points >= low) & (points <= high)).all())


def spread_over(results: Results, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the contacts all over the blocks, to their very edges, with forces in all directions."""
    found = results.contacts()
    rng, rows = np.random.default_rng(5), found.rows
    vertices = results.vertices()
    rows["position"] = rng.uniform(vertices.min(axis=0), vertices.max(axis=0), (len(rows), 2))
    corner = rng.integers(0, 2, (len(rows) // 2, 2))
    rows["position"][: len(corner)] = np.choose(
        corner, [vertices.min(axis=0), vertices.max(axis=0)]
    )
    angle = rng.uniform(0.0, 2.0 * np.pi, len(rows))
    rows["normal"] = np.column_stack([np.cos(angle), np.sin(angle)])
    rows["normal_force"] = 1e5
    monkeypatch.setattr(Results, "contacts", lambda self, frame=-1: found)


@pytest.mark.parametrize(("rows", "columns"), [(4, 12), (5, 4), (2, 60), (60, 2), (30, 30)])
@pytest.mark.parametrize("part", [None, (0.25, 0.25, 0.75, 0.75)])
def test_no_arrow_is_cut_at_the_edge(
    wall: Wall, drawn: list, monkeypatch: pytest.MonkeyPatch, rows, columns, part
):
    results = wall(rows, columns)
    spread_over(results, monkeypatch)
    zoom = part and tuple(np.multiply(part, 2 * (columns, rows)).tolist())
    plot_results(results, "a.png", look=Look(zoom=zoom))
    begin, end = arrows_in(drawn[0])
    assert len(begin) >= 2
    assert inside(drawn[0], begin)
    assert inside(drawn[0], end)


@pytest.mark.parametrize(("size", "apart"), [((5, 4), APART), ((40, 60), FARTHER)])
def test_arrows_are_apart(wall: Wall, drawn: list, size, apart):
    plot_results(wall(*size), "a.png")
    begin, _ = arrows_in(drawn[0])
    at = begin[: len(begin) // 2]
    per_inch = np.ptp(drawn[0].axes[0].get_xlim()) / (
        drawn[0].axes[0].get_position().width * drawn[0].get_size_inches()[0]
    )
    distance = np.hypot(*(at[:, None] - at).transpose(2, 0, 1)) + 1e9 * np.eye(len(at))
    # arrows at the edge make the picture show a little more than when they were chosen
    assert distance.min() >= 0.97 * apart * per_inch
    assert len(at) > 10


def test_of_points_near_each_other_the_largest_is_kept():
    rng = np.random.default_rng(3)
    at, size = rng.uniform(0.0, 10.0, (3000, 2)), rng.uniform(0.0, 1.0, 3000)
    kept = keep_apart(at, size, 0.5)
    left = np.setdiff1d(np.arange(3000), kept)
    distance = np.hypot(*(at[left][:, None] - at[kept]).transpose(2, 0, 1))
    assert ((distance < 0.5) & (size[kept] >= size[left][:, None])).any(axis=1).all()
    assert len(keep_apart(at[:0], size[:0], 0.5)) == 0


def test_a_few_huge_forces_do_not_hide_the_others(wall: Wall, drawn: list, monkeypatch):
    results = wall(12, 12)
    found = results.contacts()
    found.rows["normal_force"][:3] *= 1e4
    monkeypatch.setattr(Results, "contacts", lambda self, frame=-1: found)
    plot_results(results, "a.png")
    begin, end = arrows_in(drawn[0])
    length = np.hypot(*(end - begin).T)
    assert np.median(length) > 0.1 * length.max()
    (key,) = (a for a in drawn[0].axes[0].get_children() if hasattr(a, "labelsep"))
    assert re.search(r"3 above .* drawn as long as that", key.text.get_text())


def test_size_and_dots(wall: Wall, tmp_path: Path):
    from matplotlib.image import imread

    for size, dpi in (((16.0, 10.0), 127), ((30.0, 12.0), 60), ((8.0, 20.0), 100)):
        path = plot_results(wall(4, 3), tmp_path / "a.png", look=Look(size=size, dpi=dpi))
        height, width = imread(path).shape[:2]
        assert (width, height) == pytest.approx(np.array(size) / 2.54 * dpi, abs=1.5)
    path = plot_results(wall(4, 3), tmp_path / "a.png", look=Look(size=(20.0,), dpi=127))
    assert imread(path).shape[1] == pytest.approx(1000, abs=1.5)


def test_zoom_scales_by_what_is_seen(wall: Wall, drawn: list):
    results = wall(20, 3)
    plot_results(results, "a.png", field="sigma_yy", look=Look(zoom=(0, 15, 3, 20)))
    plot_results(results, "a.png", field="sigma_yy")
    coloured = [
        next(one for one in figure.axes[0].collections if one.get_array() is not None)
        for figure in drawn
    ]
    part, whole = (float(one.get_clim()[0]) for one in coloured)
    assert part == pytest.approx(0.3 * whole, rel=0.2)


def test_texts_fit_into_narrow_pictures(wall: Wall, tmp_path: Path):
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        results, path = wall(2, 300), tmp_path / "a.svg"
        assert "the largest of each place" in text_of(plot_results(results, path))
        words = text_of(plot_results(results, path, look=Look(size=(9.0, 10.0))))
    assert re.search(r"\(\d+ of 300\)", words)
    assert "each place" not in words


def test_a_frame_without_contacts_says_so(wall: Wall, tmp_path: Path):
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        words = text_of(plot_results(wall(4, 3), tmp_path / "a.svg", frame=0))
    assert "no contact carries a force" in words


def test_looks_that_leave_no_room(wall: Wall, tmp_path: Path):
    with pytest.raises(CaseError, match=r"are too small\n  give .* cm or more"):
        plot_results(wall(4, 3), tmp_path / "a.png", look=Look(size=(6.0, 6.0)))
    with pytest.raises(CaseError, match=r"no block lies in this area\n  the blocks lie between"):
        plot_results(wall(4, 3), tmp_path / "a.png", look=Look(zoom=(50, 50, 60, 60)))
    assert not (tmp_path / "a.png").exists()
