"""Compiles ahead of the first run what cases need: each process, law, rule and solver is tried.

What all have in common is compiled first, then two processes work side by side: one at what else
the convex process needs, with larger models, and one at the other processes.  What they compile
differs, and both find the rest on disk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context

from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.linear.solvers import PCG
from clast.run.simulate import simulate
from clast.studies.bench.scenes import SCENES
from clast.studies.bench.settings import Settings, method_for, schedule_of

Watch = Callable[[str], None]
"""Called with what is going on."""


@dataclass(frozen=True)
class SmallCase:
    """Three steps of two blocks."""

    title: str
    """What is tried."""
    settings: tuple[str, ...] = ()
    """What is different from the incline of the templates."""

    def run(self) -> None:
        """Simulate it."""
        Case.from_toml(INCLINE, ["time.end=0.003", *self.settings]).run()


@dataclass(frozen=True, kw_only=True)
class Larger:
    """One step of a scene of the benchmarks by the convex process with conjugate gradients."""

    title: str
    """What is tried."""
    scene: str = "wall"
    """Name of the scene."""
    size: int = 60
    """Blocks."""
    settings: Settings
    """Length of the step and stiffness."""
    solver: PCG
    """Solver."""

    def run(self) -> None:
        """Simulate it."""
        model = SCENES[self.scene].build(self.size)
        method = replace(method_for(model, self.settings), solver=self.solver)
        simulate(model, method, schedule_of(self.settings))


Trial = SmallCase | Larger

FIRST: tuple[Trial, ...] = (SmallCase("convex", ("method.process=convex",)),)
CONVEX: tuple[Trial, ...] = (
    Larger(title="conjugate gradients", settings=Settings(steps=1), solver=PCG()),
    Larger(title="coarse system", settings=Settings(steps=1), solver=PCG(plain=0)),
    Larger(title="slow motion", settings=Settings(step=1.0, steps=1), solver=PCG(plain=0)),
    Larger(
        title="interior point method",
        scene="slope",
        settings=Settings(step=1e-2, steps=1, share=1e3),
        solver=PCG(),
    ),
    Larger(title="many blocks", size=1600, settings=Settings(steps=1), solver=PCG()),
)
OTHERS: tuple[Trial, ...] = (
    SmallCase("modified", ("method.process=modified",)),
    SmallCase(
        "open-close, multipliers",
        ("method.process=open-close", "method.contact_law.name=augmented-lagrangian"),
    ),
    SmallCase(
        "implicit friction, exact rotation",
        ("method.process={name='modified', friction='implicit'}", "method.rotation=exact"),
    ),
    SmallCase(
        "passes, backward Euler",
        (
            "method.process={name='modified', passes=2}",
            "method.integrator=backward-euler",
            "method.rotation=linear",
        ),
    ),
    SmallCase("Shi's entrance lines", ("method.corner_rule=shi", "method.solver=cholesky")),
)


def warm_up(watch: Watch = lambda _: None) -> None:
    """Compile what cases need, as far as it is not on disk."""
    run_trials(FIRST, watch)
    # a forked process would have the threads of this one, but not their locks
    with ProcessPoolExecutor(max_workers=1, mp_context=get_context("spawn")) as helper:
        others = helper.submit(run_trials, OTHERS)
        run_trials(CONVEX, watch)
        watch("the other processes of a step")
        others.result()


def run_trials(trials: Sequence[Trial], watch: Watch | None = None) -> None:
    """Simulate one trial after the other."""
    for number, trial in enumerate(trials, start=1):
        if watch is not None:
            watch(f"{trial.title} ({number} of {len(trials)})")
        trial.run()
