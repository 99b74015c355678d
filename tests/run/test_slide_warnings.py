"""Slides over bent ground: which are warned of, however they are turned, mirrored and numbered."""

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.run.model_warnings import slide_warnings
from scenes.systems import system, turned

UPPER, LOWER = np.radians(45.0), np.radians(20.0)


def slide(cut, lower=LOWER):
    """Return ground and a slide over a bend at (0, 0), cut at an angle, degrees from +x, or not."""
    head = 10.0 * np.array([-np.cos(UPPER), np.sin(UPPER)])
    foot = 10.0 * np.array([np.cos(lower), -np.sin(lower)])
    ground = np.array([head, [head[0], -12.0], [foot[0], -12.0], foot, [0.0, 0.0]])
    top = [head + np.array([0.0, 3.0]), foot + np.array([0.0, 3.0])]
    if cut is None:
        return [ground, np.array([[0.0, 0.0], foot, top[1], [0.0, 4.0], top[0], head])]
    at = (
        4.0 / np.sin(np.radians(cut)) * np.array([np.cos(np.radians(cut)), np.sin(np.radians(cut))])
    )
    return [
        ground,
        np.array([[0.0, 0.0], at, top[0], head]),
        np.array([[0.0, 0.0], foot, top[1], at]),
    ]


BISECTOR = 90.0 - 0.5 * (45.0 + 20.0)


@pytest.mark.parametrize("mirrored", [1.0, -1.0])
@pytest.mark.parametrize("scale", [0.1, 30.0])
@pytest.mark.parametrize(
    ("cut", "said"),
    [
        (None, "locked"),
        (90.0, "flattens under 1 cut(s)"),
        (BISECTOR, "flattens under 1 cut(s)"),
        (120.0, "by 25 degrees"),
    ],
)
def test_a_slide_over_a_bend_is_warned_of(cut, said, scale, mirrored):
    outlines = [scale * one * [mirrored, 1.0] for one in slide(cut)]
    outlines = [one[::-1] if mirrored < 0.0 else one for one in outlines]
    for order in (outlines, outlines[::-1]):
        fixed = [0 if order is outlines else len(order) - 1]
        found = list(slide_warnings(system(order, fixed=fixed)))
        assert len(found) == bool(said)
        assert all(said in text and "(0, 0)" in text.replace("-0", "0") for text in found)


@pytest.mark.parametrize(("cut", "said"), [(None, "locked"), (90.0, "flattens under 1 cut(s)")])
def test_a_bend_between_blocks_of_ground_is_warned_of(cut, said):
    """As where each plane has a friction angle of its own."""
    ground, *slices = slide(cut)
    head, low, deep, foot, bend = ground
    below = np.array([0.0, -12.0])
    parts = [np.array([head, low, below, bend]), np.array([below, deep, foot, bend])]
    (text,) = slide_warnings(system([*parts, *slices], fixed=[0, 1]))
    assert said in text and "25 degrees" in text


def test_a_slide_that_is_turned_with_its_gravity_is_the_same():
    angle = 0.6
    outlines = [turned(one, angle) for one in slide(90.0)]
    gravity = turned(np.array([[0.0, -9.8]]), angle)[0]
    (text,) = slide_warnings(system(outlines, fixed=[0], gravity=tuple(gravity)))
    assert "by 25 degrees" in text


def test_slices_over_ground_that_steepens_are_free():
    steeper = np.radians(60.0)
    assert not list(slide_warnings(system(slide(90.0, lower=steeper), fixed=[0])))
    (text,) = slide_warnings(system(slide(None, lower=steeper), fixed=[0]))
    assert "locked" in text


def corner(floor: float, ends: float) -> list[np.ndarray]:
    """Return ground with a floor at an angle, degrees, before a plane of 35, and a wedge on it.

    The wedge ends so far above the floor, m; the plane goes on behind it.
    """
    up, flat = (np.array([np.cos(a), np.sin(a)]) for a in np.radians([35.0, floor]))
    foot, head = ends * up, 10.0 * up
    front, back = -8.0 * flat, 14.0 * up
    ground = [front, [front[0], -20.0], [back[0], -20.0], back, [0.0, 0.0]]
    wedge = [foot, head, head + np.array([0.0, 4.0]), foot + np.array([3.0, 8.0])]
    return [np.array(ground), np.array(wedge)]


@pytest.mark.parametrize("mirrored", [1.0, -1.0])
@pytest.mark.parametrize("angle", [0.0, 0.6])
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize(
    ("floor", "ends", "said"),
    [
        (0.0, 0.0, "by 35 degrees"),
        (20.0, 0.0, "by 15 degrees"),
        (0.0, 0.5, ""),
        (35.0, 0.0, ""),
        (50.0, 0.0, ""),
    ],
)
def test_a_plane_that_comes_out_in_a_corner_is_warned_of(floor, ends, said, order, angle, mirrored):
    """Its toe is held by the floor: limit equilibrium, and what is above the floor, slide."""
    outlines = [one * [mirrored, 1.0] for one in corner(floor, ends)]
    outlines = [turned(one[::-1] if mirrored < 0.0 else one, angle) for one in outlines]
    gravity = tuple(turned(np.array([[0.0, -9.8]]), angle)[0])
    blocks = system(outlines[::order], fixed=[0 if order > 0 else 1], gravity=gravity)
    found = list(slide_warnings(blocks))
    assert len(found) == bool(said)
    assert all(said in text and "comes out in a corner" in text for text in found)


def test_even_ground_and_other_systems_are_not_warned_of():
    assert not list(slide_warnings(system(slide(90.0, lower=UPPER), fixed=[0])))
    assert not list(slide_warnings(system(slide(None), fixed=[])))
    for name in set(TEMPLATES) - {"rockfall"}:  # it has no blocks
        assert not list(slide_warnings(Case.from_toml(TEMPLATES[name]).model())), name
