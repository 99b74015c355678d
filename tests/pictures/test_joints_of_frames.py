"""Frames with their edges in the colours of their joints."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from clast.pictures.figure_options import Look
from clast.pictures.plot import plot_results
from clast.pictures.strokes import (
    CONSTRUCTED,
    GROUND,
    JOINT_COLOURS,
    UNNAMED,
    WELD,
    edges_by_joint,
    strokes_of,
)
from clast.results import Results
from clast.rockmass import CONSTRUCTION, WELDED
from scenes.drawings import text_of

matplotlib = pytest.importorskip("matplotlib")

Wall = Callable[..., Results]
ROWS, COLUMNS = 4, 3


def lengths(results: Results, frame: int, apart: float) -> dict[str, float]:
    """Return the length that is drawn of each kind of edge, m."""
    found = edges_by_joint(results, frame, apart)
    return {one.stroke.label: float(one.lengths.sum()) for one in found}


def test_edges_of_two_blocks_are_drawn_once_until_they_part(wall: Wall):
    results = wall(ROWS, COLUMNS)
    outside = 2 * (ROWS + COLUMNS)
    once = {"bed": (ROWS - 1) * COLUMNS, "head": ROWS * (COLUMNS - 1), "no joint named": outside}
    assert lengths(results, 0, 1e-6) == pytest.approx(once)
    assert lengths(results, -1, 1.0) == pytest.approx(once)
    # rows slide over each other, and stay whole
    apart = {**once, "bed": 2 * once["bed"]}
    assert lengths(results, -1, 1e-6) == pytest.approx(apart)


def test_edges_whose_sides_have_two_joints_are_both_drawn(wall: Wall):
    results = wall(ROWS, COLUMNS)
    joints = results.edge_joint.copy()
    above = 4 * COLUMNS  # the first edge of the second row lies on the first row
    assert results.joint_name[joints[above]] == "bed"
    joints[above] = results.joint_name.index("head")
    mixed = lengths(dataclasses.replace(results, edge_joint=joints), 0, 1e-6)
    assert mixed["bed"] == pytest.approx((ROWS - 1) * COLUMNS)
    assert mixed["head"] == pytest.approx(ROWS * (COLUMNS - 1) + 1.0)


def test_welds_have_no_colour_and_take_none():
    names = {1: f"{CONSTRUCTION}heading", 2: "fault", 4: WELDED, 5: "bed"}
    found = strokes_of(names)
    assert [found[k] for k in (-1, 1, 4)] == [UNNAMED, CONSTRUCTED, WELD]
    assert [found[k].colour for k in (2, 5)] == list(JOINT_COLOURS[:2])


@pytest.fixture
def readable_svg():
    """Make SVG pictures keep their text as text."""
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        yield


def colours_in(path: Path) -> set[str]:
    return set(re.findall(r"#[0-9a-f]{6}", path.read_text()))


@pytest.mark.usefixtures("readable_svg")
def test_the_legend_names_the_joints_that_are_shown(wall: Wall, tmp_path: Path):
    results = wall(ROWS, COLUMNS)
    path = plot_results(results, tmp_path / "all.svg", field="joint", contacts=False)
    words = text_of(path)
    for expected in ("bed", "head", "no joint named", "start", "fixed"):
        assert expected in words
    assert {*JOINT_COLOURS[:2], UNNAMED.colour, GROUND} <= colours_in(path)
    assert not set(JOINT_COLOURS[2:]) & colours_in(path)
    part = Look(zoom=(1.3, 1.3, 1.7, 2.7))  # the middle of a column: beds alone
    path = plot_results(results, tmp_path / "part.svg", field="joint", frame=0, look=part)
    words = text_of(path)
    assert "bed" in words
    assert "head" not in words
    assert "no joint named" not in words


def test_a_part_inside_one_block_has_no_edges(wall: Wall, tmp_path: Path):
    look = Look(zoom=(1.4, 1.4, 1.6, 1.6))
    path = plot_results(wall(3, 3), tmp_path / "in.svg", field="joint", frame=0, look=look)
    assert not set(JOINT_COLOURS) & colours_in(path)


def test_blocks_without_joints_are_grey(wall: Wall, tmp_path: Path):
    results = wall(3, 3)
    bare = dataclasses.replace(results, edge_joint=np.full_like(results.edge_joint, -1))
    path = plot_results(bare, tmp_path / "bare.svg", field="joint", contacts=False)
    assert not set(JOINT_COLOURS) & colours_in(path)
    assert UNNAMED.colour in colours_in(path)
