"""What a step costs besides its arithmetic: the calls of Python and C functions that it makes.

Small models take most of their time for these, and a mechanism that is made anew in every step,
or a stage that goes on with nothing to do, shows here before it shows in any time.
"""

from __future__ import annotations

import cProfile
import pstats
from collections.abc import Callable

import pytest

from benchmarks.scenes import SCENES, BenchSettings, method_for
from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.model.model import Model
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.method import Method

STEP = 1e-3
# some 40 of the calls take the arrays of the contacts' memory in the order of their contacts, one
# by one: 4 % of the time of the smallest step; some 70 compare the starts of islands by the
# points that they are, which spares kernels that took a quarter of the time of compilation


def incline() -> tuple[Model, Method]:
    case = Case.from_toml(INCLINE)
    model = case.model()
    return model, case.method(model)


def of_bench(name: str, size: int) -> tuple[Model, Method]:
    model = SCENES[name].build(size)
    return model, method_for(model, BenchSettings())


def calls(model: Model, method: Method, steps: int) -> int:
    profile = cProfile.Profile()
    profile.enable()
    end = steps * STEP
    simulate(model, method, Schedule(step=STEP, end=end, every=end))
    profile.disable()
    return int(pstats.Stats(profile).total_calls)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("scene", "most"),
    [
        pytest.param(incline, 930, id="two blocks and two fixed points"),
        pytest.param(lambda: of_bench("stack", 10), 820, id="ten squares at rest"),
        pytest.param(lambda: of_bench("wall", 100), 900, id="a hundred bricks that settle"),
    ],
)
def test_a_step_makes_few_calls_however_many_blocks(
    scene: Callable[[], tuple[Model, Method]], most: int
) -> None:
    model, method = scene()
    calls(model, method, 3)  # what is loaded or kept from then on is not part of a step
    few, more = 4, 12
    of_a_step = (calls(model, method, more) - calls(model, method, few)) / (more - few)
    assert of_a_step <= most
