"""Forces that follow their blocks bring no energy and take none: swings keep their amplitude."""

import numpy as np
import pytest
import shapely

import clast

GRAVITY, WATER = 9.81, 1000.0
PERIODS = 20


def floating(corners, density: float, water: float = 0.0) -> clast.ModelBuilder:
    builder = clast.ModelBuilder(gravity=(0.0, -GRAVITY))
    builder.add_rock("wood", young=1e9, poisson=0.2, density=density)
    builder.block(vertices=corners)
    builder.water(water, acts_on="faces")
    builder.measured_point("middle", tuple(np.mean(corners, axis=0)))
    return builder


def box(width: float, height: float, draught: float, roll: float = 0.0):
    """A box that floats at a draught in still water at 0, then turned about its middle, rad."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners *= 0.5 * np.array([width, height])
    cosine, sine = np.cos(roll), np.sin(roll)
    turned = corners @ np.array([[cosine, sine], [-sine, cosine]])
    return turned + np.array([0.0, 0.5 * height - draught])


def amplitudes(history, swing: np.ndarray, period: float) -> tuple[float, float]:
    """Largest swing in the first and in the last period."""
    time = history.time
    first, last = time <= period, time >= time[-1] - period
    return float(np.abs(swing[first]).max()), float(np.abs(swing[last]).max())


@pytest.mark.parametrize("process", ["convex", "modified", "open-close"])
@pytest.mark.one_in(3)
def test_a_raft_pushed_under_swings_for_ever(process: str):
    """w2 = rho g B/m; with the pressures of the start of a step it grew by exp(w2 h t/4)."""
    width, height, density, push = 3.0, 1.0, 500.0, 0.08
    builder = floating(box(width, height, 0.5) - [0.0, push], density)
    speed = np.sqrt(WATER * GRAVITY / (density * height))
    period = 2.0 * np.pi / speed
    run = clast.simulate(builder, process=process, step=0.02, end=PERIODS * period)
    history = run.history("middle")
    swing = history.displacement[:, 1] - push
    first, last = amplitudes(history, swing, period)
    assert first == pytest.approx(push, rel=2e-3)
    assert last == pytest.approx(push, rel=2e-3)
    # one period is short by s2/24, s = w h: 3e-4, and so much late by 20
    assert np.abs(swing + push * np.cos(speed * history.time)).max() < 0.06 * push


def test_a_raft_rolls_for_ever_about_its_metacentre():
    """w2 = m g GM/I with GM = B^2/(12 D) - (H - D)/2."""
    width, height, density, roll = 3.0, 1.0, 500.0, 0.05
    builder = floating(box(width, height, 0.5, roll), density)
    draught = density / WATER * height
    arm = width**2 / (12.0 * draught) - 0.5 * (height - draught)
    speed = np.sqrt(GRAVITY * arm * 12.0 / (width**2 + height**2))
    period = 2.0 * np.pi / speed
    run = clast.simulate(builder, step=0.02, end=PERIODS * period)
    history = run.history("middle")
    angle = history.rotation + roll
    first, last = amplitudes(history, angle, period)
    assert first == pytest.approx(roll, rel=1e-3)
    assert last == pytest.approx(roll, rel=1e-3)
    falls = np.flatnonzero((angle[:-1] > 0.0) & (angle[1:] <= 0.0))
    at = history.time[falls] + 0.02 * angle[falls] / (angle[falls] - angle[falls + 1])
    # the arm of a roll of 0.05 rad is longer by 1 + tan2/2, on the average of a swing
    assert np.diff(at).mean() == pytest.approx(period, rel=2e-3)


def potential(corners) -> float:
    """Energy of the displaced water: rho g int of the depth over what is submerged, J/m."""
    below = shapely.intersection(shapely.Polygon(corners), shapely.box(-99.0, -99.0, 99.0, 0.0))
    return -WATER * GRAVITY * below.area * below.centroid.y


def test_the_work_of_water_is_what_the_displaced_water_loses():
    """Heave, sway and roll of an odd body, in an independent count of energy."""
    corners = np.array([[-1.5, -0.9], [1.0, -0.7], [1.6, 0.3], [-0.2, 0.6], [-1.4, 0.3]])
    run = clast.simulate(floating(corners, 400.0), step=0.01, end=10.0)
    energy, stored = (
        run.energy,
        np.array([potential(run.vertices(k)) for k in range(len(run.times))]),
    )
    at = np.searchsorted(energy["time"], run.times - 1e-9)
    turnover = energy["kinetic"].max()
    assert turnover > 1000.0
    # the water's work, and that of the moving body with it: what is left is s2 of the turnover
    brought = energy["water"][at] - (stored[0] - stored)
    total = energy["kinetic"][at] + energy["gravity"][at] + stored - stored[0]
    assert np.abs(brought).max() < 2e-3 * turnover
    assert np.abs(total).max() < 2e-3 * turnover


@pytest.mark.parametrize("kind", ["points", "line"])
def test_a_block_pulled_at_both_ends_swings_for_ever(kind: str):
    """Dead loads F at either end of a block of length L: w2 = F L/I about the direction of F."""
    length, depth, pull, turn = 2.0, 0.5, 1e4, 0.1
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=1e10, poisson=0.2, density=2500.0)
    cosine, sine = np.cos(turn), np.sin(turn)
    turned = np.array([[cosine, sine], [-sine, cosine]])
    half = 0.5 * np.array([length, depth])
    corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    builder.block(name="bar", vertices=corners @ turned)
    for side in (-1.0, 1.0):
        low, high = (np.array([side, top]) * half @ turned for top in (-1.0, 1.0))
        if kind == "points":
            builder.point_load(tuple(0.5 * (low + high)), (side * pull, 0.0), block="bar")
        else:
            builder.line_load(tuple(low), tuple(high), (side * pull / depth, 0.0), block="bar")
    builder.measured_point("middle", (0.0, 0.0), block="bar")
    speed = np.sqrt(pull * 12.0 / (2500.0 * depth * (length**2 + depth**2)))
    period = 2.0 * np.pi / speed
    run = clast.simulate(builder, step=0.02, end=PERIODS * period)
    history = run.history("middle")
    first, last = amplitudes(history, history.rotation + turn, period)
    assert first == pytest.approx(turn, rel=2e-3)
    assert last == pytest.approx(turn, rel=2e-3)
