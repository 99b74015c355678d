"""Compiles the kernels of cases ahead of the first run, by as many processes as there are cores.

Kernels that Python calls are listed (compute/roots.py), and each kernel of the list can be compiled
by itself.  Those of one file use the same others and are compiled by one process, unless a file is
so large that the rest would wait for it.  The longest begin first.

The list is made of the kernels that a few runs call, ``TRIALS``: each process, law, rule and solver
once.

Python's own bytecode is written with it.  Where it is missing, and PYTHONDONTWRITEBYTECODE keeps
commands from writing it, each of them translates 200 files anew, for a third of a second.
"""

from __future__ import annotations

import compileall
import os
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing import get_context

from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.compute.jit import PACKAGE
from clast.compute.roots import Root, TypingError, listed, statements
from clast.linear.solvers import PCG
from clast.run.simulate import simulate
from clast.studies.bench.scenes import SCENES
from clast.studies.bench.settings import BenchSettings, method_for, schedule_of

Watch = Callable[[str, float], None]
"""Called with the kernel that has been compiled last, and the share of all that is done, 0 to 1."""


@dataclass(frozen=True)
class SmallCase:
    """Three steps of two blocks."""

    title: str
    """The title of the trial."""
    settings: tuple[str, ...] = ()
    """Keys that differ from the incline of the templates."""

    def run(self) -> None:
        """Simulate it."""
        Case.from_toml(INCLINE, ["time.end=0.003", *self.settings]).run()


@dataclass(frozen=True, kw_only=True)
class Larger:
    """One step of a scene of the benchmarks by the convex process with conjugate gradients."""

    title: str
    """The title of the trial."""
    scene: str = "wall"
    """Name of the scene."""
    size: int = 60
    """Blocks."""
    settings: BenchSettings
    """Length of the step and stiffness."""
    solver: PCG
    """Solver."""

    def run(self) -> None:
        """Simulate it."""
        model = SCENES[self.scene].build(self.size)
        method = replace(method_for(model, self.settings), solver=self.solver)
        simulate(model, method, schedule_of(self.settings))


Trial = SmallCase | Larger

FIRST: tuple[Trial, ...] = (SmallCase("convex", ("method.process=convex", "time.end=0.5")),)
"""The case that comes first."""
CONVEX: tuple[Trial, ...] = (
    Larger(title="conjugate gradients", settings=BenchSettings(steps=1), solver=PCG()),
    Larger(title="coarse system", settings=BenchSettings(steps=1), solver=PCG(plain=0)),
    Larger(title="slow motion", settings=BenchSettings(step=1.0, steps=1), solver=PCG(plain=0)),
    Larger(
        title="interior point method",
        scene="slope",
        settings=BenchSettings(step=1e-2, steps=1, share=1e3),
        solver=PCG(),
    ),
    Larger(title="many blocks", size=1600, settings=BenchSettings(steps=1), solver=PCG()),
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
    SmallCase("impacts", ("geometry.blocks.2.velocity=[-1.0,-1.0,0.0]",)),
    SmallCase(
        "bonded blocks round a point",
        (
            "joint.default={friction_angle=30.0, cohesion=1e9, tensile_strength=1e9}",
            "geometry.vertices=[[0,0],[5,0],[3,4],[0,5],[-5,1],[-5,-2],[3,-4]]",
            "geometry.blocks=[{loop=[1,2,3],rock='granite'},{loop=[1,3,4],rock='granite'},"
            "{loop=[1,4,5],rock='granite'},{loop=[1,5,6],rock='granite'},"
            "{loop=[1,6,7],rock='granite'},{loop=[1,7,2],rock='granite'}]",
            "fixed_point=[{at=[5,0],block='1'},{at=[3,-4],block='6'}]",
            "measured_point=[]",
        ),
    ),
    SmallCase("Shi's entrance lines", ("method.corner_rule=shi", "method.solver=cholesky")),
)


TRIALS: tuple[Trial, ...] = (*CONVEX, *OTHERS)
"""The cases of the others."""


def warm_up(
    watch: Watch = lambda _text, _share: None,
    *,
    workers: int | None = None,
    of: Sequence[str] = ("first", "others"),
) -> None:
    """Compile the kernels of cases, as far as they are not on disk, by so many ``workers``.

    One for each core if not given.  ``of`` are parts of the list: "first" has the kernels of the
    incline.
    """
    compileall.compile_dir(PACKAGE, quiet=2)  # where it may not write there is no bytecode
    roots = listed()
    jobs = shared_out([root for part in of for root in roots[part]], workers or cores())
    whole, over = sum(job.weight for job in jobs), 0
    # a forked process would have the threads of this one, but not their locks
    with ProcessPoolExecutor(workers or cores(), mp_context=get_context("spawn")) as pool:
        going_on = {pool.submit(job.compile): job for job in jobs}
        for ended in as_completed(going_on):
            ended.result()
            over += going_on[ended].weight
            watch(going_on[ended].title, over / whole)


def cores() -> int:
    """Return how many cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not everywhere
        return os.cpu_count() or 1


@dataclass(frozen=True)
class CompileJob:
    """Kernels that one process compiles."""

    roots: tuple[Root, ...]
    """The kernels."""
    weight: int
    """Statements that are compiled."""

    @property
    def title(self) -> str:
        """Their purpose."""
        return self.roots[0].module.removeprefix("clast.").replace(".", "/")

    def compile(self) -> None:
        """Compile them, or find them on disk.

        One that the list has wrong, after a change of its arguments, is compiled when it is
        first needed.
        """
        for root in self.roots:
            with suppress(LookupError, TypeError, TypingError):
                root.compile()


def shared_out(roots: Iterable[Root], workers: int) -> list[CompileJob]:
    """Return the groups of kernels that are compiled together, the largest first.

    A file that has more than half of the work of a process is taken apart.
    """
    known = [root for root in roots if root.is_there]
    files: dict[str, list[tuple[Root, int]]] = defaultdict(list)
    for root, weight in zip(known, statements(*(one.kernel() for one in known)), strict=True):
        files[root.module].append((root, weight))
    fair = sum(weight for own in files.values() for _, weight in own) / (2 * workers)
    jobs = []
    for own in files.values():
        whole = sum(weight for _, weight in own)
        parts = [[one] for one in own] if whole > fair else [own]
        jobs += [CompileJob(tuple(r for r, _ in part), sum(w for _, w in part)) for part in parts]
    return sorted(jobs, key=lambda job: -job.weight)


def run_trials(trials: Sequence[Trial]) -> None:
    """Simulate one trial after the other."""
    for trial in trials:
        trial.run()
