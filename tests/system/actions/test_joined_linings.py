"""Parts of linings that are joined: one ring in two parts, at once and in stages; refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import clast
from clast.errors import CaseError, ModelError
from clast.pictures.linings import DIAGRAMS, diagram
from clast.results import Run

COUNT, RADIUS, LOAD = 24, 2.0, 3e4
CONCRETE: dict[str, Any] = {"thickness": 0.2, "segment": 0.53, "young": 20e9, "density": 2400.0}
STATIC: dict[str, Any] = {"step": 0.05, "end": 0.5, "dynamic_ratio": 0.0, "max_displacement": 0.1}


def corners(first: int, last: int, turned: float = 0.0) -> list[tuple[float, float]]:
    """Return the corners of a ring from one to another, counter-clockwise, m."""
    angles = 2.0 * np.pi * np.arange(first, last + 1) / COUNT + np.radians(turned)
    points = RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if last - first == COUNT:
        points[-1] = points[0]
    return [(float(x), float(y)) for x, y in points]


def builder_of(parts: dict[str, dict[str, Any]], turned: float = 0.0) -> clast.ModelBuilder:
    """Return rings or parts of them, pressed together across their first segment."""
    builder = clast.ModelBuilder(title="ring", gravity=(0.0, 0.0))
    builder.add_rock("stone", young=2e10, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="away", vertices=[(90, 0), (91, 0), (91, 1), (90, 1)], fixed=True)
    for name, keys in parts.items():
        first, last = keys.pop("of")
        line = corners(first, last, turned)
        builder.lining(name, polyline=line, **{**CONCRETE, "side": "middle", **keys})
        for pressed in (3, 15):
            if first <= pressed < last:
                middle = np.mean(corners(pressed, pressed + 1, turned), axis=0)
                force = -LOAD * middle / np.hypot(*middle)
                block = f"{name}/{pressed - first + 1}"
                builder.point_load(tuple(middle), tuple(force), block, name=f"load {pressed}")
    return builder


def forces(run: Run, *names: str, row: int = -1) -> np.ndarray[Any, Any]:
    """Return N, Q and M of all joints of some linings, (k, 3)."""
    each = [run.lining(name) for name in names]
    columns = ("normal_force", "shear_force", "moment")
    return np.concatenate([np.stack([getattr(o, c)[row] for c in columns], 1) for o in each])


HALF = COUNT // 2


@pytest.mark.parametrize("side", ["middle", "left"])
@pytest.mark.parametrize("turned", [0.0, 33.0])
def test_a_ring_in_two_parts_is_the_whole_ring(side: str, turned: float):
    whole = builder_of({"ring": {"of": (0, COUNT), "side": side}}, turned)
    usual = forces(clast.simulate(whole.build(), **STATIC), "ring")
    # at an angle from the load P R (1/pi - sin/2): joints are half a segment away from it
    radius = RADIUS if side == "middle" else RADIUS - 0.1
    moment = LOAD * radius * (1.0 / np.pi - 0.5 * np.sin(np.pi / COUNT))
    assert np.abs(usual[:, 2]).max() == pytest.approx(moment, rel=0.01)
    parts = {
        "top": {"of": (0, HALF), "side": side},
        "bottom": {"of": (HALF, COUNT), "side": side, "joins": "top"},
    }
    found = forces(clast.simulate(builder_of(parts, turned).build(), **STATIC), "top", "bottom")
    assert found == pytest.approx(usual, rel=1e-6, abs=1e-3)


def test_which_of_the_two_names_the_other_does_not_matter():
    parts = {
        "top": {"of": (0, HALF), "joins": "bottom"},
        "bottom": {"of": (HALF, COUNT)},
    }
    one = forces(clast.simulate(builder_of(parts).build(), **STATIC), "top", "bottom")
    parts = {
        "top": {"of": (0, HALF), "joins": "bottom"},
        "bottom": {"of": (HALF, COUNT), "joins": "top"},
    }
    both = forces(clast.simulate(builder_of(parts).build(), **STATIC), "top", "bottom")
    assert both == pytest.approx(one, rel=1e-12, abs=1e-9)
    parts = {"top": {"of": (0, HALF)}, "bottom": {"of": (HALF, COUNT), "joins": "top"}}
    other = forces(clast.simulate(builder_of(parts).build(), **STATIC), "top", "bottom")
    # the joint at the first corner comes last, as that of the whole ring does
    assert one[1 : HALF + 1] == pytest.approx(other[:HALF], rel=1e-6, abs=1e-3)
    assert one[0] == pytest.approx(other[-1], rel=1e-6, abs=1e-3)


def test_a_hinge_bears_no_moment():
    parts = {
        "top": {"of": (0, HALF)},
        "bottom": {"of": (HALF, COUNT), "joins": "top", "connection": "hinged"},
    }
    bottom = forces(clast.simulate(builder_of(parts).build(), **STATIC), "bottom")
    assert bottom[[0, -1], 2] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(bottom[1:-1, 2]).max() > 0.1 * LOAD
    assert np.abs(bottom[[0, -1], 0]).min() > 0.1 * LOAD


@pytest.mark.parametrize("owner", ["top", "bottom"])
def test_a_part_that_comes_later_is_joined_without_stress(owner: str):
    """The top bends as a free arch; the joints are free until a load comes after the bottom."""
    parts: dict[str, dict[str, Any]] = {
        "top": {"of": (0, HALF), "stage": "dig"},
        "bottom": {"of": (HALF, COUNT), "stage": "bench"},
    }
    parts[owner]["joins"] = "bottom" if owner == "top" else "top"
    builder = builder_of(parts)
    builder.link(
        name="held", at=corners(6, 6)[0], block="top/6", x="rigid", y="rigid", rotation="rigid"
    )
    static = {"until": "time", "time": 0.5, "dynamic_ratio": 0.0}
    stages = [
        clast.Stage(name="dig", loads=["load 3"], **static),
        clast.Stage(name="bench", **static),
        clast.Stage(name="press", loads=["load 15"], **static),
    ]
    run = clast.simulate(builder.build(), stages=stages, step=0.05, max_displacement=0.1)
    names = ("top", "bottom")
    time = run.lining("bottom").time
    before, made, after = (
        forces(run, *names, row=int(np.searchsorted(time, end + 1e-9)) - 1)
        for end in (0.5, 1.0, 1.5)
    )
    across = [0, HALF] if owner == "top" else [HALF - 1, COUNT - 1]
    size = np.abs(after).max()
    assert np.abs(before[across]).max() == 0.0
    assert np.abs(made[across]).max() < 1e-6 * size
    assert np.abs(after[across]).max() > 0.1 * size
    assert run.lining(owner).state[-1].tolist() == [1] * len(run.lining(owner).along)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"joins": "topp"}, "did you mean 'top'"),
        ({"joins": "bottom"}, "joins itself"),
        ({"joins": "top", "of": (HALF + 1, COUNT - 1)}, "no end of it is at an end of lining"),
        ({"joins": "ring"}, "has no ends"),
        ({"joins": "top", "start": "hinged"}, "held by the ground as well"),
        ({"connection": "hinged"}, "name the lining that it joins"),
    ],
)
def test_joints_that_cannot_be_are_refused(keys: dict[str, Any], said: str):
    parts = {
        "top": {"of": (0, HALF)},
        "ring": {"of": (0, COUNT), "thickness": 0.1, "segment": 0.2},
        "bottom": {"of": (HALF, COUNT), **keys},
    }
    with pytest.raises((CaseError, ModelError)) as told:
        builder_of(parts).build()
    assert said in str(told.value)


@pytest.mark.parametrize("owner", ["top", "bottom"])
def test_diagrams_go_on_across_the_joints(owner: str):
    """A ring in two parts has the diagram of the whole ring, of as many pieces as segments."""

    def polygons(run: Run) -> np.ndarray[Any, Any]:
        axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(-3.0, 3.0), ylim=(-3.0, 3.0))
        diagram(DIAGRAMS["moments"], run, len(run.times) - 1)[1](axes)
        areas, tips = axes.collections[:2]
        assert len(areas.get_paths()) == len(tips.get_segments())
        return np.array([path.vertices[:4].mean(axis=0) for path in areas.get_paths()])

    whole = polygons(clast.simulate(builder_of({"ring": {"of": (0, COUNT)}}).build(), **STATIC))
    parts: dict[str, dict[str, Any]] = {"top": {"of": (0, HALF)}, "bottom": {"of": (HALF, COUNT)}}
    parts[owner]["joins"] = "bottom" if owner == "top" else "top"
    found = polygons(clast.simulate(builder_of(parts).build(), **STATIC))
    assert len(whole) == len(found) == COUNT
    order = [np.lexsort(np.round(one, 6).T) for one in (whole, found)]
    assert found[order[1]] == pytest.approx(whole[order[0]], abs=1e-4)
