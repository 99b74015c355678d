"""What compilation costs, kernel by kernel, and the list of kernels that `clast warmup` compiles.

    python -m tools.compile_cost            seconds of processor time, in an empty cache: minutes
    python -m tools.compile_cost --count    statements that are compiled, which costs nothing
    python -m tools.compile_cost --write    list anew what a few runs call (compute/roots.json)

A kernel that several others call is compiled with the first of them and costs the others less, so
single lines depend on the order; the sum does not.  It takes some 20 ms for a statement.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from benchmarks.scenes import SCENES, BenchSettings, method_for
from clast.case.case_file import Case
from clast.case.templates import INCLINE
from clast.compute import roots
from clast.compute.roots import Root
from clast.linear.solvers import PCG
from clast.run.simulate import simulate


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
        simulate(model, method, self.settings.schedule)


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
        "exact rotation",
        ("method.process=modified", "method.rotation=exact"),
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


def counted() -> list[tuple[int, Root]]:
    """Return how many statements are compiled for each kernel of the list, the most first."""
    every = [root for part in roots.listed().values() for root in part]
    listed = [root for root in every if root.is_there]
    numbers = roots.statements(*(root.kernel() for root in listed))
    found = list(zip(numbers, listed, strict=True))
    return sorted(found, key=lambda row: (-row[0], str(row[1])))


def tell(text: str) -> None:
    """Print a line at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def measure() -> None:
    """Compile each kernel of the list, and tell what it took."""
    rows, start = [], time.process_time()
    for number, root in counted():
        begun = time.process_time()
        root.compile()
        rows.append((time.process_time() - begun, number, root))
    whole = time.process_time() - start
    for seconds, number, root in sorted(rows, key=lambda row: -row[0]):
        tell(f"{seconds:8.2f} s {number:6} statements  {root.module}.{root.name}")
    tell(f"{whole:8.2f} s of processor time for {len(rows)} kernels")


def write() -> None:
    """List what the trials call."""
    for trial in FIRST:
        trial.run()
    first = set(roots.called())
    for trial in TRIALS:
        trial.run()
    others = set(roots.called()) - first
    roots.LISTED.write_text(roots.written({"first": first, "others": others}), "utf-8")
    tell(f"wrote {len(first)} kernels of the first case and {len(others)} others")


def main(arguments: Sequence[str]) -> int:
    """Run the tool; return its exit status."""
    parser = argparse.ArgumentParser(description="What compilation costs.")
    for option in ("--count", "--write", "--here"):
        parser.add_argument(option, action="store_true")
    given = parser.parse_args(arguments)
    if given.write:
        write()
    elif given.count:
        for number, root in counted():
            tell(f"{number:6} {root.module}.{root.name}")
    elif given.here:
        measure()
    else:
        with tempfile.TemporaryDirectory() as folder:
            environment = {**os.environ, "NUMBA_CACHE_DIR": folder}
            command = [sys.executable, "-m", "tools.compile_cost", "--here"]
            return subprocess.run(command, env=environment, check=False).returncode
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
