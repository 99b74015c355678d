"""Flush blocks make one surface; a step higher than the contacts give way is an obstacle."""

import itertools

import numpy as np
import pytest

from clast.contact.laws import AugmentedLagrangian, Penalty
from clast.model.model import Floats
from clast.step.convex import Convex
from scenes.systems import box, by_convex, march, method, system, turned

LENGTH, HEIGHT, TILE = 0.8, 0.4, 0.5
STIFFNESS = 1e9


def slider(x: float, pieces: int = 1) -> list[Floats]:
    """Return a slider on the level 0, its left end at ``x``, m, of one block or of several."""
    width = LENGTH / pieces
    return [box(x + k * width, 0.0, width, HEIGHT) for k in range(pieces)]


def tiles(count: int, gap: float = 0.0, rise: float = 0.0) -> list[Floats]:
    """Return tiles with their tops on the level 0, every second one higher by ``rise``, m."""
    return [box(k * (TILE + gap), -0.5, TILE, 0.5 + rise * (k % 2)) for k in range(count)]


def way(
    base: list[Floats],
    sliders: list[Floats],
    *,
    loose: bool = False,
    slope: float = 0.0,
    mirrored: bool = False,
    speed: float = 2.0,
    phi: float = 0.0,
    how=None,
    step: float = 1e-3,
    end: float = 0.3,
) -> tuple[Floats, Floats]:
    """Return how far the sliders go along the surface, m, and the energy ledger's numbers.

    The surface falls by ``slope``, rad, in the direction in which they go.
    """
    bed = [box(-1.0, -1.0, 8.0, 0.5)] if loose else []
    outlines = [*bed, *base, *sliders]
    side = -1.0 if mirrored else 1.0
    outlines = [np.array([side, 1.0]) * one for one in outlines]
    outlines = [turned(one[::-1] if mirrored else one, -side * slope) for one in outlines]
    along = side * np.array([np.cos(slope), -side * np.sin(slope)])
    first = len(outlines) - len(sliders)
    model = system(
        outlines,
        fixed=[0] if loose else range(first),
        friction_angle=phi,
        velocity={k: (*(speed * along), 0.0) for k in range(first, len(outlines))},
    )
    how = how or by_convex(STIFFNESS)
    results = march(model, how, step, end)
    moved = results[-1].state.vertices - model.vertices
    return moved[model.block_start[first] :] @ along, results[-1].state.ledger.numerical


LAWS = {
    "penalty": Penalty(STIFFNESS),
    "soft": Penalty(5e7),
    "stiff": Penalty(5e10),
    "multipliers": AugmentedLagrangian(STIFFNESS),
}


@pytest.mark.parametrize(("gap", "loose"), [(0.0, False), (1e-2, False), (1e-3, True)])
@pytest.mark.parametrize("law", LAWS)
def test_without_friction_a_block_slides_over_seams_as_fast_as_before(gap, loose, law):
    how = method(process=Convex(), contact_law=LAWS[law])
    moved, lost = way(tiles(4, gap), slider(0.1), loose=loose, how=how, step=2e-3)
    assert moved == pytest.approx(0.6, rel=1e-3)
    assert lost < 0.01 * 0.5 * 2500.0 * LENGTH * HEIGHT * 2.0**2


@pytest.mark.parametrize(("gap", "rise"), [(0.0, 3.6e-6), (1e-3, 0.0), (1e-2, 2e-6)])
@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.one_in(3)
def test_a_body_with_steps_and_notches_is_as_its_pieces(gap, rise, mirrored):
    """Tiles that stand on a bed are fixed with it as one body; it is penetrated by 4e-6 m."""
    base, bed = tiles(4, gap, rise), box(-1.0, -1.0, 8.0, 0.5)
    pieces, body = (way(one, slider(0.1), mirrored=mirrored)[0] for one in (base, [bed, *base]))
    assert pieces == pytest.approx(0.6, rel=1e-3)
    assert body == pytest.approx(pieces, rel=1e-6)


@pytest.mark.parametrize("speed", [0.05, 10.0])
@pytest.mark.parametrize("step", [2e-4, 1e-2])
@pytest.mark.parametrize("mirrored", [False, True])
def test_seams_are_passed_at_any_speed_and_step(speed, step, mirrored):
    end = 0.08 if speed > 1.0 else 0.15
    how = method(process=Convex(), contact_law=Penalty(STIFFNESS), max_displacement=0.1)
    start = TILE * 2 - LENGTH - (0.005 if speed < 1.0 else 0.1)
    moved, _ = way(
        tiles(6), slider(start), speed=speed, step=step, end=end, mirrored=mirrored, how=how
    )
    assert moved == pytest.approx(speed * end, rel=2e-3)


@pytest.mark.parametrize(("phi", "slides"), [(24.9, True), (25.1, False)])
@pytest.mark.parametrize("pieces", [1, 2, 16])
def test_a_slope_in_pieces_holds_up_to_the_same_angle(phi, slides, pieces):
    base = [box(k * 4.0 / pieces, -0.5, 4.0 / pieces, 0.5) for k in range(pieces)]
    moved, _ = way(base, slider(1.3), slope=np.radians(25.0), phi=phi, speed=0.0, end=0.5)
    assert (moved.mean() > 1e-3) == slides
    if not slides:
        assert abs(moved.mean()) < 1e-4


@pytest.mark.parametrize("pieces", [2, 3])
def test_a_slider_of_several_blocks_passes_seams(pieces):
    moved, _ = way(tiles(4, 4e-3), slider(0.1, pieces))
    assert moved == pytest.approx(0.6, rel=2e-3)


@pytest.mark.parametrize(("courses", "stiffness"), [(3, 5e7), (6, 5e9)])
def test_columns_that_settle_under_the_load_are_still_one_surface(courses, stiffness):
    """The column under the block is lower than the next by the sum of what gives way."""
    outlines = [box(-1.0, -1.0, 5.0, 1.0)]
    outlines += [box(x, 0.5 * k, 1.0, 0.5) for x in range(3) for k in range(courses)]
    outlines += [box(0.1, 0.5 * courses, 1.2, 1.0)]
    last = len(outlines) - 1
    model = system(outlines, fixed=[0], friction_angle=30.0, velocity={last: (4.0, 0.0, 0.0)})
    slab = [outlines[0], box(0.0, 0.0, 3.0, 0.5 * courses), outlines[last]]
    whole = system(slab, fixed=[0], friction_angle=30.0, velocity={2: (4.0, 0.0, 0.0)})
    ways = []
    for one in (whole, model):
        end = march(one, by_convex(stiffness), 1e-3, 0.15)[-1].state
        ways.append((end.vertices - one.vertices)[-4:, 0].mean())
    assert ways[1] == pytest.approx(ways[0], rel=0.01)


@pytest.mark.parametrize(("penetrations", "passes"), [(-100, True), (0.5, True), (3, False)])
def test_a_step_higher_than_the_contacts_give_way_holds_a_block_that_is_pushed(
    penetrations, passes
):
    pressed_in = 2500.0 * LENGTH * HEIGHT * 9.8 / 2.0 / STIFFNESS
    base, block = tiles(2, rise=penetrations * pressed_in), slider(TILE - LENGTH - 0.01)
    base[0] = box(-2.0, -0.5, 2.0 + TILE, 0.5)
    mass = 2500.0 * LENGTH * HEIGHT
    model = system([*base, *block], fixed=[0, 1], friction_angle=0.0, gravity=np.array([4.9, -9.8]))
    how = method(process=Convex(), contact_law=Penalty(STIFFNESS), dynamic_ratio=0.0)
    moved = (march(model, how, 5e-3, 1.0)[-1].state.vertices - model.vertices)[8:, 0]
    pushed_in = 0.5 * mass * 9.8 / STIFFNESS
    free = 0.5 * 4.9 * 5e-3 * 1.0
    assert moved.mean() == pytest.approx(free if passes else 0.01 + pushed_in, rel=0.01)


@pytest.mark.parametrize("rise", [1e-4, 1e-2])
def test_a_real_step_stops_a_block_that_slides(rise):
    base = [box(0.0, -0.5, 1.0, 0.5), box(1.0, -0.5, 1.0, 0.5 + rise)]
    moved, _ = way(base, slider(0.1), speed=1.0, how=by_convex(5e9))
    assert np.all(moved < 0.11)


BENDS = {
    "valley": [-10, -10, -5, 0, 5],
    "crest": [5, 5, 0, -5, -10],
    "sharp valley": [-20, -20, 0, 0],
    "sharp crest": [0, 0, -30, -30],
    "rough": [-20, -15, -25, -18, -22],
}


@pytest.mark.parametrize(
    ("bends", "phi"), list(zip(BENDS, [0.0, 15.0, 0.0, 15.0, 0.0], strict=True))
)
@pytest.mark.one_in(3)
def test_terrain_in_pieces_is_terrain_in_one(bends, phi):
    """Each piece ends where the ground bends; one outline with all bends is right."""
    rise = np.tan(np.radians(BENDS[bends]))
    ground = np.stack([np.arange(len(rise) + 1.0), [0.0, *np.cumsum(rise)]], axis=1)
    low = ground[:, 1].min() - 0.5
    whole = [np.array([(0.0, low), (len(rise), low), *ground[::-1]])]
    pieces = [
        np.array([(left[0], low), (right[0], low), right, left])
        for left, right in itertools.pairwise(ground)
    ]
    angle = np.arctan(rise[0])
    block = turned(box(0.2, 0.0, 0.6, 0.3), angle)
    ends = []
    for base in (whole, pieces):
        velocity = {len(base): (2.0 * np.cos(angle), 2.0 * np.sin(angle), 0.0)}
        model = system(
            [*base, block], fixed=range(len(base)), friction_angle=phi, velocity=velocity
        )
        ends.append(march(model, by_convex(5e9), 2e-3, 0.8)[-1].state.vertices[-4:])
    went = np.abs(ends[0] - block).max()
    assert np.abs(ends[1] - ends[0]).max() < 0.001 * went


def test_a_block_beside_another_on_one_floor_is_pushed_by_it():
    """Their lower corners are flush with the floor, and their faces bear all the same."""
    outlines = [box(0.0, -1.0, 6.0, 1.0), box(0.5, 0.0), box(1.5, 0.0)]
    model = system(outlines, fixed=[0], friction_angle=0.0, velocity={1: (1.0, 0.0, 0.0)})
    end = march(model, by_convex(STIFFNESS), 1e-3, 0.2)[-1].state
    assert end.vertices[8:, 0].min() >= end.vertices[4:8, 0].max() - 1e-4


def test_a_free_corner_is_left_to_the_corner_rule():
    """Two corners that meet at speed, without a third block, stop each other."""
    tip = turned(box(0.0, 0.0), 0.3)
    leading = tip[np.argmin(tip.sum(axis=1))]
    model = system(
        [box(0.0, 0.0), tip - leading + 1.012],
        fixed=[0],
        velocity={1: (-5.0, -5.0, 0.0)},
        gravity=(0.0, 0.0),
    )
    results = march(model, by_convex(STIFFNESS), 1e-3, 0.02)
    found_deep = [one.contacts.gap[~one.contacts.known].min(initial=0.0) for one in results]
    assert min(found_deep) > -1e-3
