"""Water on faces and in joints: what it presses with, what contacts bear beside it, its work."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

import clast
from clast.actions.water import pressed_by
from clast.model.model import Floats, Model
from scenes.ledgers import assert_closed

WAYS = [
    (process, law)
    for process in ("modified", "open-close", "convex")
    for law in ("penalty", "augmented-lagrangian")
]
SETTLING = [way for way in WAYS if way != ("open-close", "augmented-lagrangian")]
"""Ways that come to rest: that one chatters about sideways pressures, those of loads as well."""
GRAVITY, ROCK, WATER = 9.81, 2600.0, 1000.0


def builder_of(**keys: float) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("rock", young=1e10, poisson=0.2, density=ROCK)
    builder.add_joint(friction_angle=30.0, **keys)
    return builder


def rectangle(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def stack(heights: tuple[float, ...] = (1.0, 2.0, 1.5), width: float = 2.0) -> clast.ModelBuilder:
    """A fixed base with its top at y = 0, and blocks of a width one on the other."""
    builder = builder_of()
    builder.block(name="base", vertices=rectangle(-2.0, -1.0, width + 4.0, 1.0), fixed=True)
    foot = 0.0
    for number, height in enumerate(heights, 1):
        builder.block(name=f"b{number}", vertices=rectangle(0.0, foot, width, height))
        foot += height
    return builder


def at_rest(builder: clast.ModelBuilder, way: tuple[str, str], **keys: float) -> clast.Run:
    # springs of the other processes follow from the step, and it takes as many to settle
    soft = way[0] != "convex"
    usual = {"end": 0.6, "step": 1e-3} if soft else {"end": 0.3, "step": 2e-3}
    return clast.simulate(
        builder, process=way[0], contact_law=way[1], dynamic_ratio=0.0, **{**usual, **keys}
    )


def borne(run: clast.Run, upper: int) -> float:
    """What contacts bear between a block and the one below it, N/m."""
    memory, owner = run.state.memory, run.model.vertex_block
    ends = np.sort(np.stack([owner[memory.vertex], memory.block]), axis=0)
    here = (ends[0] == upper - 1) & (ends[1] == upper)
    return float(memory.normal_force[here].sum())


# What it presses with -----------------------------------------------------------------------------


def by_sampling(model: Model, number: int = 200_001) -> Floats:
    """Resultant on one free block: pressure at many points of its outline, m."""
    water = model.water[0]
    ring = np.concatenate([model.polygon(0), model.polygon(0)[:1]])
    found = np.zeros(2)
    for a, b in pairwise(ring):
        share = (np.arange(number) + 0.5) / number
        points = a + share[:, None] * (b - a)
        level = np.interp(points[:, 0], *(water.surface + model.origin).T)
        pressure = WATER * GRAVITY * np.maximum(0.0, level - points[:, 1])
        found += pressure.mean() * np.array([-(b - a)[1], (b - a)[0]])
    return found


@pytest.mark.parametrize("seed", range(6))
def test_resultant_is_the_sum_over_the_outline_under_any_line(seed: int):
    rng = np.random.default_rng(seed)
    hull = shapely.convex_hull(shapely.multipoints(rng.uniform(0.0, 4.0, (8, 2))))
    corners = np.array(hull.exterior.coords)[:-1][::-1]
    line = np.stack([np.sort(rng.uniform(-1.0, 5.0, 6)), rng.uniform(0.5, 3.5, 6)], axis=1)
    builder = builder_of()
    builder.block(vertices=corners)
    builder.water(line=line, acts_on="faces")
    model = builder.build()
    pressed = pressed_by(model.water[0], model, model.vertices, 0.0)
    force = pressed.forces(np.zeros((1, 2)))[0][:, :2].sum(axis=0)
    # midpoints of 200,000 pieces, whose error is that of the kinks and the level
    scale = WATER * GRAVITY * 4.0 * 4.0
    np.testing.assert_allclose(force, by_sampling(model), atol=1e-8 * scale)
    assert (pressed.pressure >= 0.0).all()


@pytest.mark.parametrize("level", [0.3, 1.0, 7.0])
def test_a_block_under_water_is_lifted_by_what_it_displaces(level: float):
    corners = [(0.0, 0.0), (2.0, 0.0), (2.5, 1.0), (0.5, 1.5)]
    builder = builder_of()
    builder.block(vertices=corners)
    builder.water(level, acts_on="faces")
    model = builder.build()
    pressed = pressed_by(model.water[0], model, model.vertices, 0.0)
    force = pressed.forces(np.zeros((1, 2)))[0].sum(axis=0)
    below = shapely.intersection(shapely.Polygon(corners), shapely.box(-9.0, -9.0, 9.0, level))
    lift = WATER * GRAVITY * below.area
    np.testing.assert_allclose(force[:2], [0.0, lift], atol=1e-12 * lift)
    assert force[2] == pytest.approx(lift * below.centroid.x, rel=1e-12)


def tilted_wall() -> clast.ModelBuilder:
    """Blocks of different lengths about T-joints, turned by an odd angle."""
    builder = builder_of()
    cosine, sine = np.cos(0.3), np.sin(0.3)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    for x, y, width in ((0, 0, 3.1), (3.1, 0, 0.9), (0, 1, 1.3), (1.3, 1, 2.7)):
        builder.block(vertices=np.array(rectangle(x, y, width, 1.0)) @ turn)
    return builder


def test_both_faces_of_a_joint_are_pressed_alike_to_the_last_bit():
    builder = tilted_wall()
    builder.water(9.0, acts_on="joints")
    model = builder.build()
    water = model.water[0]
    ends = pressed_by(water, model, model.vertices, 0.0).ends
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    # 2 heads, and 3 beds of the T-joints
    np.testing.assert_allclose(sorted(lengths), [0.9, 1.0, 1.0, 1.3, 1.8], rtol=1e-9)
    rng = np.random.default_rng(1)
    moved = model.vertices + rng.normal(scale=0.02, size=model.vertices.shape)
    left, right = pressed_by(water, model, moved, 0.0).forces(np.zeros((4, 2)))
    assert np.abs(left).max() > 0.0
    assert (left + right == 0.0).all()  # forces and moments about one point


def test_water_follows_the_blocks():
    builder = builder_of()
    builder.block(vertices=rectangle(0.0, 0.0, 1.0, 1.0))
    builder.block(vertices=rectangle(1.0, 0.0, 1.0, 1.0))
    builder.water(3.0, acts_on="joints")
    model = builder.build()
    moved = model.vertices + np.array([[0.0, -0.5]])
    moved[4:, 0] += 0.2
    pressed = pressed_by(model.water[0], model, moved, 0.0)
    np.testing.assert_allclose(pressed.ends[0, :, 0], 1.1)  # halfway between the faces
    pressures = WATER * GRAVITY * (3.0 - np.array([-0.5, 0.5]))
    np.testing.assert_allclose(pressed.pressure[0], pressures, rtol=1e-12)


@pytest.mark.parametrize(("wetted", "length"), [("open-and-closed", 1.0), ("closed", 0.0)])
def test_a_joint_that_opens_keeps_its_water_or_loses_it(wetted: str, length: float):
    builder = builder_of()
    builder.block(vertices=rectangle(0.0, 0.0, 1.0, 1.0))
    builder.block(vertices=rectangle(1.0, 0.0, 1.0, 1.0))
    builder.water(3.0, acts_on="joints", wetted=wetted)
    model = builder.build()
    water = model.water[0]

    def wet(opening: float, slip: float = 0.0, turned: float = 0.0) -> float:
        moved = model.vertices.copy()
        moved[4:] += [opening, slip]
        moved[4:, 0] += turned * moved[4:, 1]
        ends = pressed_by(water, model, moved, 0.0).ends
        return float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())

    assert wet(0.0) == wet(-1e-4) == wet(0.0, slip=0.1) == pytest.approx(1.0, rel=1e-9)
    assert wet(0.1) == pytest.approx(length, rel=1e-9)
    # it opens upwards: closed where that is less than a millionth of the block
    shut = 1e-6 / 0.1
    assert wet(0.0, turned=0.1) == pytest.approx(length or shut, rel=0.01)
    assert wet(1.1) == 0.0  # farther apart than the joint is long
    assert wet(0.0, slip=1.1) == 0.0


# What contacts bear beside it ---------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("way", SETTLING)
@pytest.mark.parametrize("where", ["both", "joints"])
@pytest.mark.one_in(6)
def test_contacts_bear_the_effective_stress(way: tuple[str, str], where: str):
    """Weight above less what that displaces; water in joints alone lifts by its pressure."""
    builder = stack()
    builder.water(2.2, acts_on=where)
    run = at_rest(builder, way)
    width, tops = 2.0, (0.0, 1.0, 3.0)
    for upper, foot in enumerate(tops, 1):
        weight = (4.5 - foot) * width * ROCK * GRAVITY
        lift = max(0.0, 2.2 - foot) * width * WATER * GRAVITY
        assert borne(run, upper) == pytest.approx(weight - lift, rel=2e-4)
    assert_closed(run)


@pytest.mark.slow
@pytest.mark.parametrize("way", SETTLING)
@pytest.mark.one_in(3)
def test_water_rises_by_a_table(way: tuple[str, str]):
    builder = stack((1.0,))
    builder.add_amplitude("rise", [0.0, 0.2, 0.3, 5.0], [0.0, 0.5, 0.5, 0.5])
    builder.water(1.0, amplitude="rise")
    run = at_rest(builder, way)
    weight, lift = 2.0 * ROCK * GRAVITY, 2.0 * WATER * GRAVITY
    assert borne(run, 1) == pytest.approx(weight - 0.5 * lift, rel=2e-4)
    assert run.energy["water"][0] == 0.0
    assert_closed(run)


@pytest.mark.slow
def test_a_floating_block_bobs_with_its_period():
    """w2 = rho_w g B/m; the force of a step is that of its start, which adds h w2/4 a second."""
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("wood", young=1e9, poisson=0.2, density=600.0)
    builder.block(vertices=rectangle(0.0, 0.0, 2.0, 1.0))
    builder.water(0.5, acts_on="faces")
    builder.measured_point("middle", (1.0, 0.5))
    run = clast.simulate(builder, end=2.0, step=2e-3)
    speed = np.sqrt(WATER * GRAVITY * 2.0 / (600.0 * 2.0))
    history = run.history("middle")
    exact = -0.1 * (1.0 - np.cos(speed * history.time))
    assert np.abs(history.displacement[:, 1] - exact).max() < 0.1 * 0.02
    assert_closed(run)


# Drains -------------------------------------------------------------------------------------------


def dam(drained_at: list[tuple[float, float]], line: list[tuple[float, float]]) -> Model:
    """A dam of 6 m x 10 m on rock, with water in its base joint."""
    builder = builder_of()
    builder.block(name="rock", vertices=rectangle(-4.0, -3.0, 14.0, 3.0), fixed=True)
    builder.block(name="dam", vertices=rectangle(0.0, 0.0, 6.0, 10.0))
    builder.water(line=line, acts_on="joints", drained_at=drained_at)
    return builder.build()


def uplift(model: Model) -> tuple[float, float]:
    """Force on the dam and its moment about the heel, N/m and N."""
    pressed = pressed_by(model.water[0], model, model.vertices, 0.0)
    left, right = pressed.forces(np.zeros((2, 2)))
    on_dam = left[pressed.block == 1].sum(axis=0) + right[pressed.other == 1].sum(axis=0)
    return float(on_dam[1]), float(on_dam[2])


@pytest.mark.parametrize("drain", [1.0, 2.5, 4.0])
def test_uplift_under_a_dam_falls_to_its_drain(drain: float):
    line = [(0.0, 8.0), (6.0, 0.0)]
    full, moment = uplift(dam([], line))
    assert full == pytest.approx(0.5 * WATER * GRAVITY * 8.0 * 6.0, rel=1e-12)
    assert moment == pytest.approx(full * 2.0, rel=1e-12)
    force, moment = uplift(dam([(drain, 0.0)], line))
    assert force == pytest.approx(0.5 * WATER * GRAVITY * 8.0 * drain, rel=1e-9)
    assert moment == pytest.approx(force * drain / 3.0, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("way", SETTLING)
@pytest.mark.one_in(3)
def test_the_base_of_a_dam_bears_its_weight_less_the_uplift(way: tuple[str, str]):
    builder = builder_of()
    builder.block(name="rock", vertices=rectangle(-4.0, -3.0, 14.0, 3.0), fixed=True)
    builder.block(name="dam", vertices=rectangle(0.0, 0.0, 6.0, 10.0))
    builder.water(line=[(0.0, 8.0), (6.0, 0.0)], drained_at=[(2.0, 0.0)])
    run = at_rest(builder, way, step=5e-3, end=1.0)
    weight, lift = 60.0 * ROCK * GRAVITY, 0.5 * WATER * GRAVITY * 8.0 * 2.0
    assert borne(run, 1) == pytest.approx(weight - lift, rel=2e-4)
    thrust = 0.5 * WATER * GRAVITY * 8.0**2
    assert abs(run.state.memory.shear_force.sum()) == pytest.approx(thrust, rel=5e-3)
    assert_closed(run)


@pytest.mark.parametrize("behind", ["one rock", "the plane goes on"])
def test_a_plane_below_a_crack_has_the_pressures_of_hoek_and_bray(behind: str):
    """U = 1/2 w zw A on the plane, V = 1/2 w zw2 in the crack."""
    builder = builder_of()
    if behind == "one rock":
        rock = [(-1, -2), (8, -2), (8, 8), (6, 8), (6, 3), (0, 0), (-1, 0)]
        builder.block(name="rock", vertices=rock, fixed=True)
    else:
        rock = [(-1, -2), (8, -2), (8, 4), (0, 0), (-1, 0)]
        builder.block(name="rock", vertices=rock, fixed=True)
        builder.block(vertices=[(6, 3), (8, 4), (8, 8), (6, 8)], fixed=True)
    slab = builder.block(name="slab", vertices=[(0, 0), (6, 3), (6, 8), (2, 6)])
    builder.water(6.0, acts_on="joints", drained_at=[(0.0, 0.0)])
    model = builder.build()
    pressed = pressed_by(model.water[0], model, model.vertices, 0.0)
    on_slab = pressed.other == model.block_name.index(slab)
    force = pressed.forces(np.zeros((model.block_count, 2)))[1][on_slab, :2]
    left = pressed.block == model.block_name.index(slab)
    force = np.concatenate([force, pressed.forces(np.zeros((model.block_count, 2)))[0][left, :2]])
    zw, length = 3.0, np.hypot(6.0, 3.0)
    plane, crack = 0.5 * WATER * GRAVITY * zw * length, 0.5 * WATER * GRAVITY * zw**2
    exact = plane * np.array([-3.0, 6.0]) / length + [-crack, 0.0]
    np.testing.assert_allclose(force.sum(axis=0), exact, rtol=1e-9)
    assert sorted(np.hypot(*force.T)) == pytest.approx(sorted([plane, crack]), rel=1e-9)
