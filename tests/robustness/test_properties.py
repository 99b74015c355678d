"""What holds for any small system: drawn at random, compared after a change that must not matter.

Blocks start a few mm apart and collide within the steps that are run.
"""

from dataclasses import dataclass, replace
from random import Random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from clast.contact.laws import Penalty
from clast.inputs.builder import InputBuilder
from clast.linear.solvers import Direct
from clast.model.model import Model
from clast.model.state import State
from clast.step.method import Method
from scenes.systems import GRAVITY, Floats, box, by_convex, convex, finish, march, star, turned


@dataclass(frozen=True)
class Scene:
    """A random system and how it is simulated."""

    outlines: list[Floats]
    speed: Floats
    friction_angle: float
    share: float
    step: float

    def model(
        self, *, angle: float = 0.0, shift: tuple[float, float] = (0.0, 0.0), unit: float = 1.0
    ) -> Model:
        """Return the system, turned (rad) and moved (m), in a unit of length of ``unit`` m."""
        # kg and s stay: forces per length stay (N/m2 = kg/(m s2)) but for the unit of length
        length = 1.0 / unit
        pull = turned(np.array([[0.0, -GRAVITY]]), angle)[0] * length
        builder = InputBuilder(gravity=pull)
        builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0 / length**2)
        builder.add_joint(friction_angle=self.friction_angle)
        for k, outline in enumerate(self.outlines):
            vertices = (turned(outline, angle) + shift) * length
            velocity = turned(self.speed[k : k + 1, :2], angle)[0] * length
            builder.block(vertices=vertices, fixed=k == 0, velocity=[*velocity, self.speed[k, 2]])
        return builder.build()

    def method(self, unit: float = 1.0, **changes: object) -> Method:
        """Return the method in a unit of length of ``unit`` m."""
        length = 1.0 / unit
        usual = by_convex(self.share * 5e9, solver=Direct())
        scaled = replace(
            usual,
            critdis=usual.critdis * length,
            max_displacement=0.05 * length,
            contact_law=Penalty(normal_stiffness=self.share * 5e9),
        )
        return replace(scaled, **changes)  # type: ignore[arg-type]

    def run(self, model: Model, how: Method, steps: int) -> State:
        """Return the state after some steps."""
        return march(model, how, self.step, steps * self.step)[-1].state


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    """Draw two to five blocks in a column or two above a fixed floor, moving slowly."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(2, 5))
    outlines = [box(-4.0, -1.0, 8.0, 1.0)]
    height = [0.0, 0.0]
    for k in range(count):
        kind = draw(st.sampled_from(["box", "convex", "star"]))
        if kind == "box":
            shape = box(-0.5, -0.5) * rng.uniform(0.5, 1.0, 2)
        else:
            shape = (convex if kind == "convex" else star)(rng, int(rng.integers(4, 7)), 0.5)
        column = k % 2
        low = height[column] - shape[:, 1].min() + rng.uniform(0.001, 0.01)
        outlines.append(shape + np.array([1.3 * column, low]))
        height[column] += np.ptp(shape[:, 1]) + 0.01
    speed = np.zeros((len(outlines), 3))
    speed[1:] = rng.uniform(-0.3, 0.3, (count, 3))
    return Scene(
        outlines,
        speed,
        draw(st.sampled_from([0.0, 20.0, 35.0])),
        draw(st.sampled_from([0.01, 1.0, 10.0])),
        draw(st.sampled_from([1e-3, 5e-3])),
    )


FEW = settings(max_examples=15)
STEPS = 40


@FEW
@given(scenes())
def test_every_step_converges_and_energy_does_not_grow(scene: Scene) -> None:
    model = scene.model()
    done = finish(model, scene.method(), scene.step, 100 * scene.step)
    assert done.failed_steps == 0
    assert done.created <= 1e-9 * done.turnover
    assert abs(done.run.report.ledger.unaccounted) < 1e-6 * done.turnover


SAME = 1e-7
"""Movement, m, that the tolerance of a step leaves open after the steps run."""


def moved(model: Model, state: State) -> Floats:
    """Return the movement of every vertex, m."""
    return state.vertices - model.vertices


@FEW
@given(scenes(), st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_moving_a_system_moves_the_answer(scene: Scene, right: float, up: float) -> None:
    model, there = scene.model(), scene.model(shift=(right, up))
    one = moved(model, scene.run(model, scene.method(), STEPS))
    other = moved(there, scene.run(there, scene.method(), STEPS))
    assert np.abs(other - one).max() < SAME


@FEW
@given(scenes(), st.floats(-3.0, 3.0))
def test_turning_a_system_turns_the_answer(scene: Scene, angle: float) -> None:
    model, there = scene.model(), scene.model(angle=angle)
    one = moved(model, scene.run(model, scene.method(), STEPS))
    other = moved(there, scene.run(there, scene.method(), STEPS))
    assert np.abs(turned(other, -angle) - one).max() < SAME


@FEW
@given(scenes(), st.randoms(use_true_random=False))
def test_renumbering_a_system_renumbers_the_answer(scene: Scene, random: Random) -> None:
    """Blocks in another order, each from another of its vertices on."""
    order = [0, *random.sample(range(1, len(scene.outlines)), len(scene.outlines) - 1)]
    first = [random.randrange(len(outline)) for outline in scene.outlines]
    shuffled = replace(
        scene,
        outlines=[np.roll(scene.outlines[k], -first[k], axis=0) for k in order],
        speed=scene.speed[order],
    )
    model, there = scene.model(), shuffled.model()
    one = moved(model, scene.run(model, scene.method(), STEPS))
    other = moved(there, shuffled.run(there, scene.method(), STEPS))
    for place, k in enumerate(order):
        mine = one[model.block_start[k] : model.block_start[k + 1]]
        theirs = other[there.block_start[place] : there.block_start[place + 1]]
        assert np.abs(np.roll(theirs, first[k], axis=0) - mine).max() < SAME


@FEW
@given(scenes(), st.sampled_from([1e-3, 0.01, 0.3048]))
def test_another_unit_of_length_leaves_the_answer(scene: Scene, unit: float) -> None:
    """In mm instead of m: gravity times 1000, density over 1000 squared (the thickness stays)."""
    model, there = scene.model(), scene.model(unit=unit)
    one = moved(model, scene.run(model, scene.method(), STEPS))
    other = moved(there, scene.run(there, scene.method(unit), STEPS))
    assert np.abs(unit * other - one).max() < SAME
