"""Loads times a table of time: ramps against closed forms, and nothing else where there is none."""

import numpy as np
import pytest

import clast

WAYS = [
    (process, law)
    for process in ("modified", "open-close", "convex")
    for law in ("penalty", "augmented-lagrangian")
]
MASS, FORCE = 2500.0, 2e5
TIME, VALUE = [0.05, 0.15, 0.2], [0.25, 1.0, -0.5]


def block(**loads: str) -> clast.ModelBuilder:
    """A block of 1 m without weight, Poisson's ratio 0."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=1e9, poisson=0.0, density=MASS)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.add_amplitude("ramp", TIME, VALUE)
    return builder


def push(builder: clast.ModelBuilder, kind: str, factor: str | None = "ramp") -> None:
    """Push the block down by FORCE in one of three ways."""
    if kind == "point":
        builder.point_load((0.5, 0.5), (0.0, -FORCE), amplitude=factor)
    elif kind == "line":
        builder.line_load((0, 1), (1, 1), (0.0, -FORCE), amplitude=factor)
    else:
        builder.pressure((0, 1), (1, 1), FORCE, amplitude=factor)


def at(time: float) -> float:
    """Return the factor, written out."""
    if time <= 0.05:
        return 0.25
    if time <= 0.15:
        return 0.25 + 7.5 * (time - 0.05)
    return max(1.0 - 30.0 * (time - 0.15), -0.5)


@pytest.mark.parametrize(
    ("way", "kind"),
    [*((way, "pressure") for way in WAYS), (WAYS[-2], "point"), (WAYS[1], "line")],
)
def test_a_free_block_takes_up_the_impulse(way: tuple[str, str], kind: str):
    """m v = F times the sum of the factors at the ends of the steps, times h."""
    builder = block()
    push(builder, kind)
    step, steps = 2.5e-3, 100
    run = clast.simulate(builder, end=step * steps, step=step, process=way[0], contact_law=way[1])
    impulse = FORCE * step * sum(at((k + 1) * step) for k in range(steps))
    assert run.final.time == pytest.approx(0.25)
    # the strain, 2e-4, makes the edge under the pressure no longer: Poisson's ratio is 0
    assert -run.final.velocity[0, 1] == pytest.approx(impulse / MASS, rel=1e-6)
    energy = run.energy
    assert np.abs(energy["unaccounted"]).max() < 1e-6 * np.abs(energy["loads"]).max()


@pytest.mark.parametrize("way", WAYS)
def test_fixed_points_bear_the_ramp(way: tuple[str, str]):
    """Slow steps on two fixed points: both springs have F(t)/2 at the end of every step."""
    builder = block()
    builder.fixed_point((0, 0))
    builder.fixed_point((1, 0))
    push(builder, "pressure")
    run = clast.simulate(
        builder,
        end=0.25,
        step=0.0125,
        process=way[0],
        contact_law=way[1],
        dynamic_ratio=0.0,
        fixed_point_stiffness=1e11,
    )
    energy = run.energy
    borne = 2.0 * np.sqrt(energy["fixed_points"][1:] * 1e11)
    factor = np.array([at(one) for one in energy["time"][1:]])
    # a block that has no speed falls behind by 2 m/(h2 E) of what changes in a step
    behind = 2.0 * MASS / 0.0125**2 / 1e9 * np.abs(np.diff(factor, prepend=0.0)).max()
    np.testing.assert_allclose(borne, FORCE * np.abs(factor), atol=1.1 * behind * FORCE)
    assert behind < 0.03
    assert run.report.ledger.unaccounted == pytest.approx(0.0, abs=1e-6 * energy["loads"].max())


def test_a_table_is_constant_outside_its_instants():
    builder = block()
    (factor,) = builder.build().factors
    for time in (-1.0, 0.0, 0.05, 0.1, 0.15, 0.17, 0.2, 7.0):
        assert factor.at(time) == pytest.approx(at(time), abs=1e-15)
