"""Which blocks overlap: networks that touch in whole edges, and a plain oracle beside shapely's."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial import Voronoi

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.errors import ModelError
from clast.inputs.builder import InputBuilder
from clast.run.preflight import examine
from clast.run.simulate import simulate
from scenes.brick_wall import listed_wall
from scenes.common_areas import area_in_common

# GEOS without a grid says that these two have the whole second block in common
TOUCHING_TO_ROUND_OFF = (
    [
        (3.8164866180706647, 4.374324600305128),
        (2.351374795555103, 0.765438671978869),
        (2.5960227955884645, -0.0036163741097442665),
        (3.9885152466558336, -0.0036163741097442665),
        (4.86690639547246, 2.160050185544255),
        (4.162512334408244, 4.374324600305128),
    ],
    [
        (2.538716006197904, 4.374324600305128),
        (1.790009597586176, 2.530099483175635),
        (2.351374795555103, 0.7654386719788691),
        (3.8164866180706647, 4.374324600305128),
    ],
)


def built(*loops):
    builder = InputBuilder()
    builder.add_rock("granite", young=50e9, poisson=0.2, density=2700.0)
    for loop in loops:
        builder.block(vertices=loop)
    return builder.build()


def moved(loop, angle=0.0, scale=1.0, shift=(0.0, 0.0)):
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    return scale * (np.asarray(loop, float) @ turn) + np.asarray(shift, float)


def network(rng, count):
    """Return the cells of a random Voronoi diagram, some of them joined to non-convex blocks."""
    cells = Voronoi(rng.random((count, 2)))
    loops = [
        cells.vertices[region]
        for region in cells.regions
        if region and -1 not in region and (np.abs(cells.vertices[region] - 0.5) < 0.6).all()
    ]
    sides = [np.hypot(*(np.roll(loop, -1, axis=0) - loop).T).min() for loop in loops]
    return [loop for loop, side in zip(loops, sides, strict=True) if side > 1e-6]


def joined(loops, rng):
    """Return the loops with some pairs that share an edge made one, non-convex as a rule."""
    owner, done, result = {}, set(), []
    keys = [[tuple(np.round(v, 12)) for v in oriented(loop)] for loop in loops]
    for k, key in enumerate(keys):
        for a, b in zip(key, key[1:] + key[:1], strict=True):
            owner[a, b] = k
    for k, key in enumerate(keys):
        if k in done:
            continue
        done.add(k)
        for i, (a, b) in enumerate(zip(key, key[1:] + key[:1], strict=True)):
            other = owner.get((b, a))
            if other is not None and other not in done and rng.random() < 0.4:
                done.add(other)
                j = keys[other].index(b)
                ring = keys[other][j:] + keys[other][:j]
                key = key[i + 1 :] + key[: i + 1] + ring[2:]
                break
        if len(set(key)) == len(key):
            result.append(np.array(key))
    return result


def oriented(loop):
    x, y = loop.T
    area = np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))
    return loop if area > 0.0 else loop[::-1]


def cut(loop, point, normal):
    """Return the two parts of a convex polygon on both sides of a line."""
    side = (loop - point) @ normal
    parts = [], []
    for k, corner in enumerate(loop):
        after = (k + 1) % len(loop)
        parts[int(side[k] < 0.0)].append(corner)
        if (side[k] < 0.0) != (side[after] < 0.0):
            share = side[k] / (side[k] - side[after])
            for part in parts:
                part.append(corner + share * (loop[after] - corner))
    return [np.array(part) for part in parts]


def cut_up(_, rng):
    """Return a square cut up by lines that end at each other, so that corners lie on edges."""
    loops = [moved([(0, 0), (1, 0), (1, 1), (0, 1)], angle=0.4)]
    while len(loops) < 150:
        loop = loops.pop(rng.integers(len(loops)))
        angle = rng.uniform(0.0, 2.0 * math.pi)
        parts = cut(loop, loop.mean(axis=0), np.array([math.cos(angle), math.sin(angle)]))
        sides = [np.hypot(*(np.roll(part, -1, axis=0) - part).T).min() for part in parts]
        loops += parts if min(sides) > 1e-4 else [loop]
    # every block has its own last digit, as from different ways to compute it
    return [np.nextafter(loop, loop + rng.choice([-1, 0, 1], size=loop.shape)) for loop in loops]


PLACES = {
    "as it is": {},
    "turned": {"angle": 0.7},
    "small": {"scale": 1e-3, "angle": 1.1},
    "large": {"scale": 1e4, "angle": 2.3},
    "far from the origin": {"scale": 20.0, "angle": 0.3, "shift": (3.5e6, -5.4e6)},
}


@pytest.mark.parametrize("place", PLACES)
def test_networks_that_touch_do_not_overlap(place):
    rng = np.random.default_rng(7)
    for mixed in (lambda loops, _: loops, joined, cut_up):
        loops = [moved(loop, **PLACES[place]) for loop in mixed(network(rng, 400), rng)]
        model = built(*loops)
        assert model.block_count == len(loops) >= 100
        assert len(model.overlaps.pair) == 0
        assert not model.notes or "reversed" in model.notes[0]


def test_two_blocks_that_touch_to_round_off():
    assert area_in_common(*TOUCHING_TO_ROUND_OFF) < 1e-12
    for k in range(200):
        place = {"angle": 0.1 * k, "scale": 10.0 ** (k % 7 - 3), "shift": (k % 3 * 1e3, 0.0)}
        assert (
            len(built(*(moved(loop, **place) for loop in TOUCHING_TO_ROUND_OFF)).overlaps.pair) == 0
        )


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.one_in(3)
def test_what_overlaps_is_found(place):
    """Cells moved a little into their neighbours: found where the oracle finds a common area."""
    rng = np.random.default_rng(11)
    found = refused = 0
    scale = PLACES[place].get("scale", 1.0)
    for loops in (network(rng, 60), joined(network(rng, 60), rng)):
        for k in range(0, len(loops), 3):
            size = math.sqrt(area_in_common(loops[k], loops[k]))
            way = size * 10.0 ** rng.uniform(-4.0, 0.3) * moved([(1, 0)], rng.uniform(0, 7))
            pushed = loops[k] + way
            near = [
                (loop, area)
                for n, loop in enumerate(loops)
                if n != k and (area := area_in_common(loop, pushed)) > 0.0
            ]
            for loop, area in near:
                width = area / math.sqrt(max(area_in_common(loop, loop), size**2))
                if width < 3e-6 * size:
                    continue
                try:
                    overlaps = built(
                        *(moved(one, **PLACES[place]) for one in (loop, pushed))
                    ).overlaps
                    assert overlaps.pair.tolist() == [[0, 1]]
                    assert overlaps.depth[0] < 0.1 * size * scale
                    found += 1
                except ModelError as error:
                    assert "block 1: overlaps block 2 to a depth of" in str(error)
                    refused += 1
    assert found > 10
    assert refused > 5


def test_blocks_in_each_other_are_refused_whatever_their_size():
    for size in (0.5, 0.05, 1e-3, 1e-5):
        inner = moved([(-1, -1), (1, -1), (1, 1), (-1, 1)], angle=0.2, scale=0.5 * size)
        outer = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        with pytest.raises(ModelError, match="block 1: overlaps block 2"):
            built(outer, inner)
        with pytest.raises(ModelError, match="block 1: overlaps block 2"):
            built(outer, outer)


def continued(run, **rock):
    """Return the last state of a run as a model of its own."""
    state, model = run.final, run.model
    builder = InputBuilder()
    builder.add_rock(model.rocks[0].name, **rock)
    builder.add_joint(friction_angle=30.0)
    builder.blocks(
        vertices=state.vertices,
        start=model.block_start,
        names=model.block_name,
        fixed=model.fixed,
        velocity=state.velocity[:, :3],
        initial_stress=state.stress,
    )
    return builder.build()


@pytest.mark.parametrize("stiffness", ["5e9", "5e7", "1e7"])
def test_the_last_state_of_a_run_is_a_model(stiffness):
    settings = ["time.end=0.1", f"method.contact_law.normal_stiffness={stiffness}"]
    case = Case.from_toml(listed_wall(3, 3), settings)
    model = continued(case.run(), young=5e9, poisson=0.2, density=2000.0)
    assert len(model.overlaps.pair) > 5
    method = case.method(model)
    (said,) = (
        text for text in examine(model, method, case.schedule()).warnings if "overlap" in text
    )
    assert f"overlap by {model.overlaps.depth.max():.3g} m at the start" in said
    again = simulate(model, method, case.schedule())
    assert again.report.finished
    # what settles anew are the shear springs, which begin without force
    assert np.abs(again.state.vertices - model.vertices).max() < 2.0 * model.overlaps.depth.max()


def test_an_overlap_that_no_contact_leaves_is_refused_by_the_run():
    text = listed_wall(3, 3).replace(
        "[[0, 0], [1, 0], [1, 0.5]", "[[0, 0], [1.01, 0], [1.01, 0.5]", 1
    )
    soft = Case.from_toml(text, ["method.contact_law.normal_stiffness=1e6"])
    assert any("overlap by 0.01 m at the start" in text for text in soft.examine().warnings)
    stiff = Case.from_toml(text)
    with pytest.raises(ModelError, match=r"block 'row 1 brick 1': overlaps .* depth of 0\.01 m"):
        stiff.run()
    with pytest.raises(ModelError, match=r"5e\+07 N/m, and all blocks weigh"):
        simulate(stiff.model(), stiff.method(), stiff.schedule())


@pytest.mark.slow
def test_the_overlaps_of_a_moving_heap_are_explained():
    case = Case.from_toml(TEMPLATES["heap"], ["time.end=0.5"])
    deepest = []
    run = case.run(progress=lambda step: deepest.append(step.penetration))
    assert max(deepest) > 0.0
    assert continued(run, young=5e9, poisson=0.2, density=2500.0).block_count == 67
