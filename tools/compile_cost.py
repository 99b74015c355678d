"""What compilation costs, kernel by kernel: the list of kernels that `clast warmup` compiles.

    python -m tools.compile_cost            the kernels of the list, the slowest first
    python -m tools.compile_cost --write    list anew what a few runs call (compute/roots.json)

A kernel that several others call is compiled with the first of them and costs the others less, so
single lines depend on the order; the sum does not.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace

from benchmarks.scenes import SCENES, BenchSettings, method_for
from clast.case.case_file import Case
from clast.case.templates import INCLINE, TEMPLATES
from clast.compute import roots
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


@dataclass(frozen=True)
class OfTemplate:
    """The case of a template as it is, or the path of its first rock."""

    title: str
    """The title of the trial, and of the template."""

    def run(self) -> None:
        """Simulate it, or follow the rock."""
        case = Case.from_toml(TEMPLATES[self.title])
        if case.rockfall is None:
            case.run()
        else:
            case.campaign().follow(1)


Trial = SmallCase | Larger | OfTemplate

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
    OfTemplate("rockfall"),
    OfTemplate("dam"),
)


TRIALS: tuple[Trial, ...] = (*CONVEX, *OTHERS)
"""The cases of the others."""


def tell(text: str) -> None:
    """Print a line at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def show() -> None:
    """Print the list."""
    every = sorted(
        (one for part in roots.listed().values() for one in part), key=lambda r: r.seconds
    )
    for root in reversed(every):
        tell(f"{root.seconds:6.1f} s  {root.module}.{root.name}")
    tell(f"{sum(root.seconds for root in every):6.1f} s for {len(every)} kernels")


def write() -> None:
    """List what the trials call, with nothing on disk."""
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
    for option in ("--write", "--here"):
        parser.add_argument(option, action="store_true")
    given = parser.parse_args(arguments)
    if given.here:
        write()
    elif given.write:
        with tempfile.TemporaryDirectory() as folder:
            environment = {**os.environ, "NUMBA_CACHE_DIR": folder}
            command = [sys.executable, "-m", "tools.compile_cost", "--here"]
            return subprocess.run(command, env=environment, check=False).returncode
    else:
        show()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
