"""Links, linings, motions and reactions of result files that are made up: one message each."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.results import read_results, summary
from scenes.crafted_files import crafted, replaced


def supported() -> clast.ModelBuilder:
    """Return a beam with strengths that is pushed, and a bar on a hinge, between two walls."""
    builder = clast.ModelBuilder(title="supports", gravity=(0.0, -9.8))
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2500.0)
    builder.add_joint("default", friction_angle=30.0)
    builder.block(name="wall", vertices=[(-1, -1), (0, -1), (0, 1), (-1, 1)], fixed=True)
    builder.block(name="bar", vertices=[(0, -3), (1, -3), (1, -2.9), (0, -2.9)])
    builder.link(name="hinge", at=(0, -2.95), block="bar", x="rigid", y="rigid")
    builder.measured_point("left/right", (1, -3), block="bar")
    section = {"thickness": 0.1, "tension": 3e6, "compression": 3e7, "young": 3e10}
    beam = [(0.0, 0.0), (1.0, 0.0)]
    ends = {"side": "middle", "segment": 0.25, "start": "clamped"}
    builder.lining("beam", polyline=beam, **ends, **section)
    builder.motion(name="push", block="beam/4", y=-0.01)
    builder.measured_reaction("wall", block="wall")
    return builder


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result file that is whole."""
    path = tmp_path_factory.mktemp("good") / "out.vtkhdf"
    clast.simulate(supported().build(), step=1e-3, end=4e-3, every=2e-3, output=path)
    return path


def everything(path: Path) -> None:
    """Read and draw all that a file has of supports."""
    results = read_results(path)
    summary(results)
    for name in results.link_name:
        assert np.isfinite(results.link(name).force).all()
    for name in results.lining_name:
        lining = results.lining(name)
        assert np.isfinite(lining.moment).all() and len(lining.section) == len(lining.along)
        clast.plot_interaction(results, path.with_suffix(".svg"), name)
    for name in results.reaction_name:
        assert np.isfinite(results.reaction(name).force).all()
    look = clast.Look(layers=("moments",))
    clast.plot_results(results, path.with_suffix(".svg"), reactions=True, look=look)


def column(place: str, name: str, row: int, value: float) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        values = file[place][...]
        values[name][row] = value
        file[place][...] = values

    return change


def shorter(place: str) -> Callable[[Any], None]:
    return lambda file: file[place].resize((2,))


MADE_UP = {
    "a place of a joint of a lining too few": replaced("model/lining_along", np.zeros(3)),
    "no place of a joint of a lining": replaced("model/lining_along", np.full(4, np.nan)),
    "places of joints in words": replaced("model/lining_along", [b"x"] * 4),
    "faces of vertices far away": replaced("model/lining_face", np.full((4, 2), 10**9)),
    "faces of vertices before all": replaced("model/lining_face", np.full((4, 2), -1)),
    "faces in halves": replaced("model/lining_face", np.zeros((4, 2))),
    "faces with one end": replaced("model/lining_face", np.zeros((4, 1), int)),
    "a section too few": replaced("model/lining_section", np.full((3, 3), 0.1)),
    "a section of two numbers": replaced("model/lining_section", np.full((4, 2), 0.1)),
    "sections thinner than nothing": replaced("model/lining_section", np.full((4, 3), -0.1)),
    "sections that are not numbers": replaced("model/lining_section", np.full((4, 3), np.nan)),
    "sections that are endless": replaced("model/lining_section", np.full((4, 3), np.inf)),
    "names of joints that are numbers": replaced("model/lining_joint_name", np.zeros(4)),
    "one name of a joint too many": replaced("model/lining_joint_name", [b"beam/1"] * 5),
    "links of blocks that are not": replaced("model/link_block", np.array([[0, 99]])),
    "links of blocks before all": replaced("model/link_block", np.array([[-1, 0]])),
    "links of three blocks": replaced("model/link_block", np.zeros((1, 3), int)),
    "links that hold more than all": replaced("model/link_holds", np.array([[2, 2, 9]])),
    "links nowhere": replaced("model/link_at", np.full((1, 2), np.inf)),
    "links without direction": replaced("model/link_along", np.full((1, 2), np.nan)),
    "links with two places": replaced("model/link_at", np.zeros((2, 2))),
    "lines of links that are not": replaced("model/link_line", np.array([7])),
    "names of links that are numbers": replaced("model/link_name", np.zeros(1)),
    "reactions of blocks that are not": replaced("model/reaction_of_block", np.array([[0, 99]])),
    "reactions that are not": replaced("model/reaction_of_block", np.array([[99, 0]])),
    "names of reactions that are numbers": replaced("model/reaction_name", np.zeros(3)),
    "tables that end early: linings": shorter("linings"),
    "tables that end early: links": shorter("links"),
    "tables that end early: reactions": shorter("reactions"),
    "moments that are not numbers": column("linings", "moment", -1, np.nan),
    "forces of links that are endless": column("links", "force", -1, np.inf),
    "reactions that are not numbers": column("reactions", "force", -1, np.nan),
    "states of joints that are not": column("linings", "state", -1, 99),
    "states of links that are not": column("links", "state", -1, 99),
    "states before all": column("links", "state", 0, -7),
    "a table of links without a column": replaced("links", np.zeros(5, [("time", "f8")])),
    "a table of linings in words": replaced("linings", [b"x"] * 5),
    **{
        f"without {place}": lambda file, place=place: file.__delitem__(place)
        for place in ("linings", "links", "reactions", "model/lining_face", "model/lining_along")
    },
}


@pytest.mark.parametrize("change", MADE_UP.values(), ids=MADE_UP.keys())
def test_supports_that_are_made_up_are_refused(
    good: Path, tmp_path: Path, change: Callable[[Any], None]
):
    path = tmp_path / "out.vtkhdf"
    crafted(good, path, change)
    with pytest.raises(CaseError) as caught:
        everything(path)
    assert caught.value.where == str(path)
    assert caught.value.remedy
