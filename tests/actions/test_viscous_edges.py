"""Viscous edges: their matrix, what they hold, waves that come in, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.actions.action import StepStart
from clast.actions.viscous_edges import BoundaryDashpots
from clast.block.inertia import block_frames
from clast.errors import ModelError
from clast.model.state import initial_state
from scenes.ledgers import assert_closed

WAYS = [
    (process, law)
    for process in ("modified", "open-close", "convex")
    for law in ("penalty", "augmented-lagrangian")
]
YOUNG, POISSON, DENSITY = 1e8, 0.25, 2000.0


def rock(gravity: float = 0.0, **keys: object) -> clast.ModelBuilder:
    """Return a builder with a rock and a strong joint."""
    builder = clast.ModelBuilder(gravity=(0.0, -gravity), **keys)
    builder.add_rock("rock", young=YOUNG, poisson=POISSON, density=DENSITY)
    builder.add_joint("default", friction_angle=30.0)
    return builder


def column(builder: clast.ModelBuilder, count: int = 2) -> clast.ModelBuilder:
    """Put blocks of 2 m x 1 m upon each other."""
    for k in range(count):
        corners = [(0, k), (2, k), (2, k + 1), (0, k + 1)]
        builder.block(name=f"b{k}", vertices=corners)
    return builder


@pytest.mark.parametrize(
    ("plane", "modulus"),
    [
        (clast.PlaneStress(), YOUNG / (1.0 - POISSON**2)),
        (clast.PlaneStrain(), YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))),
    ],
)
def test_dashpots_are_the_integral_over_the_edge(plane: object, modulus: float):
    builder = rock(plane=plane)
    builder.block(vertices=[(0, 0), (3, -1), (2.5, 2)])
    builder.viscous_boundary(edges=[((0, 0), (3, -1))], normal=0.5, tangential=2.0)
    model = builder.build()
    state = initial_state(model)
    start = StepStart(model=model, state=state, frames=block_frames(model, state), step=0.1)
    action = BoundaryDashpots(1e9)
    contribution = action.contribution(start, action.begin(model))
    line = np.array([3.0, -1.0])
    length, normal = np.sqrt(10.0), np.array([-1.0, -3.0]) / np.sqrt(10.0)
    along = line / length
    shear = YOUNG / (2.0 * (1.0 + POISSON))
    dashpot = 0.5 * np.sqrt(DENSITY * modulus) * np.outer(normal, normal)
    dashpot += 2.0 * np.sqrt(DENSITY * shear) * np.outer(along, along)
    exact, centroid = np.zeros((6, 6)), np.array([5.5, 1.0]) / 3.0
    points, weights = np.polynomial.legendre.leggauss(5)
    for point, weight in zip(0.5 * (points + 1.0), 0.5 * weights, strict=True):
        x, y = point * line - centroid
        t = np.array([[1, 0, -y, x, 0, 0.5 * y], [0, 1, x, 0, y, 0.5 * x]])
        exact += weight * length * t.T @ dashpot @ t / 0.1
    np.testing.assert_allclose(contribution.stiffness[0], exact, atol=1e-12 * np.abs(exact).max())
    assert not contribution.force.any()


@pytest.mark.parametrize("way", WAYS)
def test_a_wave_from_below_moves_the_surface_twice_as_far(way: tuple[str, str]):
    """Every step brings the exact impulse: 2 rho c (2 u_in - u) is 0 at rest, however coarse."""
    time = np.array([0.0, 0.1, 0.1, 0.2])
    push = np.array([1.0, 1.0, -1.0, -1.0])[:, None] * np.array([[0.3, -0.2]])
    wave = clast.IncomingWave(clast.Accelerogram(time, push))
    exact = 2.0 * wave.accelerogram.displacement(1.0)
    builder = rock(ground_motion=wave)
    builder.block(vertices=[(0, 0), (2, 0), (2, 1), (0, 1)])
    builder.viscous_boundary(side="bottom")
    run = clast.simulate(
        builder, process=way[0], contact_law=way[1], step=7e-3, end=1.0, max_displacement=0.1
    )
    moved = run.final.vertices.mean(axis=0) - run.model.vertices.mean(axis=0) - run.model.origin
    np.testing.assert_allclose(moved, exact, rtol=1e-4)
    assert_closed(run)


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.one_in(3)
def test_what_springs_bear_stays_when_dashpots_begin(way: tuple[str, str]):
    moved = {}
    for static in ("hold", "none"):
        builder = column(rock(9.8))
        builder.viscous_boundary(side="bottom", begins=0.4, static=static)
        builder.measured_point("foot", (1, 0))
        law = {"name": way[1], "normal_stiffness": 1e8}
        run = clast.simulate(
            builder,
            process=way[0],
            contact_law=law,
            step=1e-3,
            end=0.6,
            damping="adaptive",
            max_displacement=0.02,
        )
        assert_closed(run)
        history = run.history("foot")
        at = int(np.searchsorted(history.time, 0.4))
        moved[static] = np.abs(history.displacement[at:, 1] - history.displacement[at, 1]).max()
        weight = 2.0 * 2.0 * DENSITY * 9.8
        if static == "hold":
            held = run.final.actions[-1].force[..., 1].sum()
            assert held == pytest.approx(weight, rel=1e-3)
    assert moved["hold"] < 1e-5
    # m v' = m g - rho c_p L v: it sinks
    assert moved["none"] > 0.01


@pytest.mark.slow
def test_in_situ_stress_stays_on_viscous_edges():
    for plane in (clast.PlaneStress(), clast.PlaneStrain()):
        builder = column(rock(9.8, plane=plane), 4)
        builder.in_situ = clast.Overburden(k0=0.4)
        builder.viscous_boundary(side="bottom")
        run = clast.simulate(builder, process="convex", step=1e-3, end=0.1)
        moved = np.abs(run.final.vertices - run.model.vertices - run.model.origin).max()
        assert moved < 1e-6
        assert_closed(run)


def test_springs_hold_the_directions_that_have_dashpots():
    builder = column(rock(9.8), 1)
    builder.viscous_boundary(side="bottom", tangential=0.0, begins=5.0)
    builder.point_load((1, 0), (1e3, 0.0))
    builder.measured_point("foot", (1, 0))
    run = clast.simulate(builder, process="convex", step=1e-3, end=0.1)
    moved = run.history("foot").displacement[-1]
    assert moved[0] == pytest.approx(0.5 * 1e3 / 4000.0 * 0.1**2, rel=0.02)
    assert abs(moved[1]) < 1e-5


def two_columns() -> clast.ModelBuilder:
    builder = rock()
    for x in (0.0, 1.0):
        builder.block(name=f"at {x:g}", vertices=[(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)])
    return builder


def test_fixed_blocks_and_corners_have_no_viscous_edges():
    builder = two_columns()
    builder.block(name="held", vertices=[(2, 0), (3, 0), (3, 1), (2, 1)], fixed=True)
    builder.viscous_boundary(side="right")
    with pytest.raises(ModelError, match="'held' is on a fixed block"):
        builder.build()
    builder = rock()
    builder.block(vertices=[(0, 0), (1, 1), (-1, 1)])
    builder.viscous_boundary(side="bottom")
    with pytest.raises(ModelError, match="only corners"):
        builder.build()


def test_a_wave_needs_edges_that_face_down():
    wave = clast.IncomingWave(clast.Accelerogram(np.array([0.0, 1.0]), np.ones((2, 2))))
    for side in (None, "left"):
        builder = two_columns()
        builder.ground_motion = wave
        if side:
            builder.viscous_boundary(side=side)
        with pytest.raises(ModelError, match="the wave needs a boundary to enter through, but"):
            builder.build()


def test_a_polygon_takes_the_outer_edges_within():
    builder = two_columns()
    builder.viscous_boundary(polygon=[(-1, -1), (1.2, -1), (1.2, 0.9), (-1, 0.9)])
    model = builder.build()
    middle = model.vertices[model.viscous_edges.edge] + model.origin
    assert sorted(map(tuple, middle.tolist())) == [(0.0, 0.0), (0.0, 1.0)]


def test_doubtful_viscous_boundaries_are_warned_of():
    builder = column(rock(9.8))
    builder.viscous_boundary(side="bottom")
    assert any("carry no weight" in text for text in builder.case().examine().warnings)
    builder = column(rock(9.8))
    builder.viscous_boundary(side="bottom", begins=2.0)
    said = builder.case(end=1.0).examine().warnings
    assert any("springs hold it all the time" in text for text in said)
    assert not any("carry no weight" in text for text in said)


def test_dashpots_may_begin_with_a_stage(tmp_path):
    """The same bits as from the time at which it begins, also from a case file."""
    stages = [
        clast.Stage(name="swing", until="time", time=0.1),
        clast.Stage(name="quake", until="time", time=0.1),
    ]
    ends = {}
    for name, key in {"by time": {"begins": 0.1}, "by stage": {"stage": "quake"}}.items():
        builder = column(rock(10.0))
        builder.viscous_boundary(side="bottom", **key)
        case = builder.case(step=1e-2, end=1.0, stages=stages)
        path = tmp_path / f"{name}.toml"
        path.write_text(case.to_toml())
        assert f"{next(iter(key))} = " in path.read_text()
        read = clast.load(path)
        assert not [text for text in read.examine().warnings if "viscous boundary" in text]
        ends[name] = read.run(progress=False)
        assert_closed(ends[name])
    one, other = ends.values()
    assert (one.state.vertices == other.state.vertices).all()
    assert (one.state.velocity == other.state.velocity).all()
    assert other.report.ledger.boundary == one.report.ledger.boundary != 0.0
