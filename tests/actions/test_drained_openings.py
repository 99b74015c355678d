"""Openings that drain the joints beside them from the stage that excavates them."""

from pathlib import Path

import numpy as np
import pytest

import clast
from clast.actions.water import pressed_by
from clast.model.state import initial_state
from clast.pictures.draw_water import pressures_of, waters_of

WEIGHT = 9810.0
"""Weight of water, N/m3."""
CASE = """
schema = 1
plane = "strain"
gravity = [0, -9.81]
time = {step = 1e-2, end = 1.0, dynamic_ratio = 0.0}
rock.stone = {young = 10e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
opening = [{name = "room", blocks = ["core"]}]
water = [{level = 10.0, drained_at = DRAINS, acts_on = "joints"}]

[[block]]
name = "upper"
fixed = true
vertices = [[-10, 0], [0, 0], [0, 4], [-10, 4]]

[[block]]
name = "lower"
fixed = true
vertices = [[-10, -4], [0, -4], [0, 0], [-10, 0]]

[[block]]
name = "core"
vertices = [[0, -4], [6, -4], [6, 4], [0, 4]]

[[block]]
name = "right"
fixed = true
vertices = [[6, -4], [9, -4], [9, 4], [6, 4]]

[[block]]
name = "floor"
fixed = true
vertices = [[-10, -5], [9, -5], [9, -4], [-10, -4]]

[[stage]]
name = "rock"

[[stage]]
name = "dig"
excavate = ["room"]
"""


def case_of(drains: str, text: str = CASE) -> clast.Case:
    return clast.Case.from_text(text.replace("DRAINS", drains), "case")


@pytest.mark.parametrize("name", ["room", "core"])
def test_the_head_falls_to_nothing_at_the_wall(name: str):
    """Along the bedding it falls from 10 m at its far end to none at the wall, as does p."""
    case = case_of(f'"{name}"')
    model = case.model()
    before = pressed_by(model.water[0], model, model.vertices, 0.0)
    left, _ = clast.excavated(model, case.method(model), initial_state(model), np.array([2]))
    after = pressed_by(left.water[0], left, left.vertices, 0.0)
    for pressed, at_wall in ((before, 10.0), (after, 0.0)):
        level = np.isclose(pressed.ends[..., 1] + model.origin[1], 0.0).all(axis=1)
        ends, pressure = pressed.ends[level] + model.origin, pressed.pressure[level]
        assert pressure[ends[..., 0] == -10.0] == pytest.approx(10.0 * WEIGHT, rel=1e-12)
        assert pressure[ends[..., 0] == 0.0] == pytest.approx(at_wall * WEIGHT, rel=1e-12)


TUNNEL = """
schema = 1
plane = "strain"
gravity = [0, -10]
time = {step = 1e-2, end = 1.0, dynamic_ratio = 0.0}
rock.stone = {young = 10e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 40.0}
domain.boundary = [[-9, -9], [9, -9], [9, 9], [-9, 9]]
domain.fixed_sides = ["bottom", "left", "right"]
joint_set = [
    {name = "bedding", angle = 8, spacing = 2.1},
    {name = "cross", angle = 97, spacing = 2.3},
]
opening = [{name = "tunnel", shape = "box", corner = [-2.2, -1.6], size = [5, 4], excavated = VOID}]
water = [{level = 7.5, drained_at = "tunnel", acts_on = "joints"}]
"""
DIG = """
[[stage]]
name = "rock"

[[stage]]
name = "dig"
excavate = ["tunnel"]
"""


def pressures_at_the_end(run: clast.Run) -> dict[tuple[float, ...], list[float]]:
    """Return the pressures at the ends of joints by their places at the start, Pa."""
    last = len(run.times) - 1
    shown = pressures_of(run, waters_of(run, last), last, run.vertices(0))
    places = [tuple(point) for point in np.sort(shown.ends.round(6), axis=1).reshape(-1, 4)]
    return dict(zip(places, map(sorted, shown.pressure.tolist()), strict=True))


def test_a_tunnel_that_is_dug_drains_as_one_that_was_there(tmp_path: Path):
    """No pressure on the wall; around it the same heads; the reactions carry the rock alone."""
    void, dug = (
        case_of("", TUNNEL.replace("VOID", is_void) + stages).run(output=tmp_path / f"{is_void}.h5")
        for is_void, stages in (("true", ""), ("false", DIG))
    )
    there, later = pressures_at_the_end(void), pressures_at_the_end(dug)
    assert there.keys() == later.keys()
    for place, pressure in there.items():
        assert later[place] == pytest.approx(pressure, abs=1.0)
    assert max(map(max, later.values())) > 1e5
    model = dug.model
    rock = 10.0 * (float(model.mass[~model.fixed].sum()) - 2500.0 * 5.0 * 4.0)
    carried = dug.reaction("fixed blocks")
    assert carried.force[-1, 1] == pytest.approx(rock, rel=1e-6)
    assert carried.force[-1, 0] == pytest.approx(0.0, abs=1e-6 * rock)


def test_void_openings_and_lines_drain_as_dug_ones_do():
    """A line along the wall, in two halves or whole, is the wall."""
    lowered = [
        case_of(drains).model().water[0].joints.lowered
        for drains in ("[[[0, -4], [0, 4]]]", "[[[0, -4], [0, 1]], [[0, 1], [0, 4]]]")
    ]
    assert lowered[0].max() > 10.0
    np.testing.assert_array_equal(*lowered)


@pytest.mark.parametrize(
    ("drains", "what"),
    [
        ('"rom"', "there is no opening or block 'rom'"),
        ("[[-5, 1]]", "is not on a joint"),
        ("[[[-5, 1], [-4, 2]]]", "no joint that this water enters meets it"),
        ("[[-5]]", "drained_at"),
        ("[5]", "drained_at"),
        ("[[[-5, 1]]]", "drained_at"),
    ],
)
def test_impossible_drains_are_refused(drains: str, what: str):
    with pytest.raises(clast.ClastError, match=what) as refusal:
        case_of(drains).model()
    print(refusal.value)
