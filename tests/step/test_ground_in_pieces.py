"""Motion and losses do not depend on how the ground is cut: one piece against pieces."""

import itertools
from dataclasses import dataclass, replace

import numpy as np
import pytest

import clast
from clast.contact.laws import Penalty
from clast.inputs.builder import InputBuilder
from clast.model.model import Floats
from clast.model.state import State
from clast.step.convex import Convex
from scenes.systems import box, march, method, turned

LOW = -8.0
"""Level of the underside of the ground, m."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A block that meets the ground, whose surface is a row of points from left to right."""

    surface: Floats
    block: Floats
    velocity: tuple[float, float, float]
    step: float
    steps: int
    friction_angle: float = 0.0
    restitution: float = 0.0
    stiffness: float = 5e9
    young: float = 5e9
    mirrored: bool = False
    angle: float = 0.0

    def end(self, cuts: list[float], *, free: bool = False) -> State:
        """Return the last state, of the block alone, on ground that is cut at these x, m.

        Free pieces stand in a fixed trough.
        """
        x = np.unique([*self.surface[[0, -1], 0], *cuts])
        pieces = []
        for left, right in itertools.pairwise(x):
            inside = (self.surface[:, 0] > left) & (self.surface[:, 0] < right)
            ends = [(one, self.level(one)) for one in (right, left)]
            top = [ends[0], *self.surface[inside][::-1], ends[1]]
            pieces.append((np.array([(left, LOW), (right, LOW), *top]), not free))
        if free:
            (left, right), width = self.surface[[0, -1], 0], float(np.ptp(self.surface[:, 0]))
            pieces += [
                (box(left - 2.0, LOW - 1.0, width + 4.0, 1.0), True),
                (box(left - 2.0, LOW, 2.0, self.level(left) - LOW), True),
                (box(right, LOW, 2.0, self.level(right) - LOW), True),
            ]
        builder = InputBuilder(gravity=self.turned_vector((0.0, -9.81)))
        builder.add_rock("rock", young=self.young, poisson=0.2, density=2500.0)
        builder.add_joint(friction_angle=self.friction_angle, restitution=self.restitution)
        for outline, fixed in pieces:
            builder.block(vertices=self.placed(outline), fixed=fixed)
        u, v, spin = self.velocity
        speed = (*self.turned_vector((u, v)), -spin if self.mirrored else spin)
        builder.block(vertices=self.placed(self.block), velocity=speed)
        how = method(process=Convex(), contact_law=Penalty(self.stiffness), max_displacement=0.2)
        last = march(builder.build(), how, self.step, self.steps * self.step)[-1].state
        count = len(self.block)
        return replace(last, vertices=last.vertices[-count:], velocity=last.velocity[-1:])

    def level(self, x: float) -> float:
        """Return the level of the surface, m."""
        return float(np.interp(x, *self.surface.T))

    def turned_vector(self, vector: tuple[float, float]) -> tuple[float, float]:
        """Return a vector mirrored and turned as the scene is."""
        x, y = turned(np.array([vector]) * [-1.0 if self.mirrored else 1.0, 1.0], self.angle)[0]
        return float(x), float(y)

    def placed(self, outline: Floats) -> Floats:
        """Return an outline mirrored and turned as the scene is."""
        if self.mirrored:
            outline = (outline * [-1.0, 1.0])[::-1]
        return turned(outline, self.angle)

    def differ(self, one: State, other: State) -> float:
        """Return how far two ends differ, in units of the way and of the fastest corner."""
        start = self.placed(self.block)
        way = np.abs(one.vertices - start).max()
        size = float(np.ptp(self.block, axis=0).max())
        speed = [np.hypot(*state.velocity[0, :2]) for state in (one, other)]
        scale = max(*speed, np.hypot(*self.velocity[:2]), 0.1)
        change = one.velocity[0, :3] - other.velocity[0, :3]
        return max(
            float(np.abs(one.vertices - other.vertices).max()) / max(way, 1e-3),
            float(np.hypot(*change[:2])) / scale,
            0.5 * size * abs(float(change[2])) / scale,
        )


SLEDGE = np.array([(0.0, 0.0), (1.0, 0.0), (1.2, 0.2), (0.5, 0.5), (-0.2, 0.2)])
PLATE = box(0.0, 0.0, 1.0, 0.3)


def over_a_bend(bend: float, block: Floats = PLATE, **others) -> Trial:
    """Return a block that comes down a slope of 10 degrees to a bend, degrees, at x = 0."""
    before, speed = np.radians(-10.0), others.pop("speed")
    after = before + np.radians(bend)
    surface = np.array([(-5.0, -5.0 * np.tan(before)), (0.0, 0.0), (5.0, 5.0 * np.tan(after))])
    block = turned(block - [1.3, 0.0], before)
    velocity = speed * np.cos(before), speed * np.sin(before), 0.0
    return Trial(surface=surface, block=block, velocity=velocity, **others)


def landing(**others) -> Trial:
    """Return a column that turns about its corner at x = 0 and lands flat."""
    tilt, rate = 0.03, -1.0
    column = turned(box(0.0, 0.0, 0.8, 1.6), tilt)
    x, y = column.mean(axis=0)
    return Trial(
        surface=np.array([(-4.0, 0.0), (4.0, 0.0)]),
        block=column,
        velocity=(-rate * y, rate * x, rate),
        friction_angle=50.0,
        **others,
    )


TRIALS = {
    "slow over a slight crest": over_a_bend(-3.0, SLEDGE, speed=1.0, step=2e-3, steps=300),
    "chamfer at 45 degrees": over_a_bend(-6.0, SLEDGE, speed=8.0, step=1e-3, steps=120),
    "fast over a sharp crest": over_a_bend(-40.0, speed=30.0, step=2e-4, steps=150, angle=2.0),
    "into a valley": over_a_bend(
        20.0, speed=20.0, step=4e-3, steps=20, restitution=0.4, stiffness=5e7
    ),
    "into a sharp valley": over_a_bend(
        40.0, speed=3.0, step=1e-3, steps=150, restitution=1.0, mirrored=True
    ),
    "rough": over_a_bend(8.0, speed=5.0, step=5e-3, steps=50, friction_angle=30.0),
    "landing": landing(step=5e-4, steps=80),
    "landing, long steps": landing(step=5e-3, steps=10, mirrored=True, angle=-0.4),
    "landing, elastic": landing(step=1e-4, steps=350, restitution=0.7),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", TRIALS)
@pytest.mark.one_in(3)
def test_fixed_pieces_are_as_one(name):
    """To round-off: a rebound may make more of it."""
    trial, rng = TRIALS[name], np.random.default_rng(3)
    whole = trial.end([])
    for cuts in ([0.0], [0.0, 0.1, 0.2], [0.0, *rng.uniform(-1.5, 2.0, 8)]):
        pieces = trial.end(cuts)
        assert trial.differ(whole, pieces) < 1e-6
        assert pieces.ledger.impacts == pytest.approx(whole.ledger.impacts, rel=1e-6, abs=1e-3)


def stiff(trial: Trial) -> Trial:
    """Return a trial on ground that settles by a hundredth.

    Free pieces sink under their own weight, each by another amount: soft ground of 8 m by 0.1 mm,
    which makes steps of what was flush, and those are obstacles (decision 80).
    """
    return replace(trial, young=100.0 * trial.young, stiffness=100.0 * trial.stiffness)


@pytest.mark.slow
@pytest.mark.parametrize("name", TRIALS)
@pytest.mark.one_in(3)
def test_free_pieces_are_as_one(name):
    trial = stiff(TRIALS[name])
    whole = trial.end([], free=True)
    pieces = trial.end([0.0, 0.3, 0.45, 1.1], free=True)
    assert trial.differ(whole, pieces) < 0.01
    assert trial.differ(trial.end([]), whole) < 0.01


@pytest.mark.parametrize("cuts", [[], [0.1, 0.2], [0.08 * k for k in range(11)]])
@pytest.mark.parametrize("free", [False, True])
def test_the_column_loses_what_housner_says(cuts, free):
    """Of its rate 1 - 3/2 sin^2 of the slenderness is left, whatever the ground is cut into."""
    trial = stiff(landing(step=5e-4, steps=80)) if free else landing(step=5e-4, steps=80)
    fallen = trial.block[:, 1].mean() - 0.8
    mass, about = 2500.0 * 0.8 * 1.6, 2500.0 * 0.8 * 1.6 * 4.0 / 3.0 * 0.8
    before = 0.5 * about * 1.0**2 + mass * 9.81 * fallen
    left = (1.0 - 1.5 * 0.2) ** 2
    lost = trial.end(cuts, free=free).ledger.impacts
    assert lost == pytest.approx(before * (1.0 - left), rel=0.01)


RIM = """
schema = 1
title = "A block whose pad is taken out, beside a flush rim"
gravity = [0.0, -9.81]
time = {{step = 4e-3, end = 0.45}}
rock.stone = {{young = 5e9, poisson = {poisson}, density = 2200.0}}
joint.default = {{friction_angle = 32.0}}
[[block]]
name = "ground"
fixed = true
vertices = [[-2,-1],[2,-1],[2,0],[1,0],[1,-0.1],[-2,-0.1]]
[[block]]
name = "pad"
vertices = [[-2,-0.1],[1,-0.1],[1,0],[-2,0]]
[[block]]
name = "block"
vertices = [[0,0],[1,0],[1,1],[0,1]]
[[opening]]
name = "settle"
blocks = ["pad"]
[[stage]]
name = "weight"
dynamic_ratio = 0.0
time = 0.1
[[stage]]
name = "settlement"
excavate = ["settle"]
until = "time"
time = 0.35
"""


@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_a_block_falls_past_a_rim_that_is_flush_with_it(tmp_path, poisson):
    """Pressed into its pad, and wider by its weight, it does not come to hang on the rim."""
    case = tmp_path / "rim.toml"
    case.write_text(RIM.format(poisson=poisson), encoding="utf-8")
    run = clast.load(case).run(progress=False)
    block = run.final.vertices[-4:]
    assert block[:, 1].min() == pytest.approx(-0.1, abs=1e-4)
    assert np.abs(block[:, 0] - [0.0, 1.0, 1.0, 0.0]).max() < 1e-3
