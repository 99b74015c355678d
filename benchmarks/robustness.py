"""Where the convex process holds: walls and heaps over stiffness and step.

    python -m benchmarks.robustness --quick       a minute: the small wall, a small heap
    python -m benchmarks.robustness               all of it: hours
    python -m benchmarks.robustness --only small-wall heap

Every run that has ended is kept in build/robustness.jsonl and not repeated; the tables of what is
there are put into docs/robustness.md.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from tests.scenes import systems

from benchmarks.tables import put_tables
from clast.model.model import Model
from clast.step.method import StepResult

ROOT = Path(__file__).resolve().parents[1]
YOUNG = 5e9
SHARES = (0.01, 0.1, 1.0, 10.0, 50.0)
"""Normal stiffness in units of E times 1 m."""
STEPS = (5e-3, 1e-3, 2e-4)
"""Steps, s: the quick ones first."""
FRICTION = 26.57
"""Friction angle of the headline's walls, degrees: tan phi = 0.5."""
KEPT = ROOT / "build" / "robustness.jsonl"
PAGE = ROOT / "docs" / "robustness.md"


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """One run to make."""

    scene: str
    """Table that it belongs to."""
    share: float
    """p/E."""
    step: float
    """h, s."""
    end: float
    """End of the run, s."""

    @property
    def key(self) -> str:
        """Name of the run."""
        return f"{self.scene} {self.share:g} {self.step:g} {self.end:g}"


@dataclass(frozen=True, kw_only=True)
class Figures:
    """What a run showed."""

    stands: bool
    """The run reached its end."""
    drift: float
    """Largest horizontal movement of a vertex, m."""
    penetration: float
    """Largest penetration, averaged over the second half of the run, m."""
    base: float
    """Mean penetration of the contacts with block 0, averaged likewise, m."""
    peak: float
    """Largest penetration in the run, m."""
    iterations: float
    """Newton iterations per step."""
    failed: int
    """Steps cut because they did not converge, tunnelled or were not finite."""
    cut: int
    """Steps cut because something moved or turned too far."""
    created: float
    """Largest energy beyond what start and gravity gave, over the energy turned over."""
    unaccounted: float
    """What the ledger fails to explain, over the energy turned over."""
    overlap: float
    """Largest area in which two blocks overlap at the end, m2."""
    kinetic: float
    """Kinetic energy at the end over the energy turned over."""
    wall: float
    """Wall time, s."""


def headline_wall(courses: int, columns: int, bonded: bool) -> Callable[[], Model]:
    """Return a maker of a wall of the headline."""
    return lambda: systems.wall(courses, columns, bonded=bonded, friction_angle=FRICTION)


SCENES: dict[str, Callable[[], Model]] = {
    "small-wall": headline_wall(10, 10, True),
    "small-columns": headline_wall(10, 10, False),
    "large-wall": headline_wall(45, 22, True),
    "large-columns": headline_wall(45, 22, False),
    "brick-wall": lambda: systems.wall(10, 10, friction_angle=30.0),
    "heap": lambda: systems.heap(200, 20),
    "small-heap": lambda: systems.heap(30, 6),
}
WALLS = tuple(name for name in SCENES if "heap" not in name)


def wanted(quick: bool) -> Iterator[Wanted]:
    """Yield the runs in the order in which they are made."""
    if quick:
        for share in (0.1, 1.0, 10.0):
            yield Wanted(scene="small-wall", share=share, step=5e-3, end=0.3)
            yield Wanted(scene="small-heap", share=share, step=5e-3, end=1.0)
        return
    for step in STEPS:
        for scene in ("small-wall", "small-columns"):
            for share in SHARES:
                yield Wanted(scene=scene, share=share, step=step, end=1.0)
    for share in (0.2, 2.0, 20.0):
        yield Wanted(scene="brick-wall", share=share, step=1e-3, end=2.0)
    for share in (0.01, 0.1, 1.0, 10.0):
        yield Wanted(scene="heap", share=share, step=5e-3, end=3.0)
    for step in STEPS:
        for scene in ("large-wall", "large-columns"):
            for share in SHARES:
                yield Wanted(scene=scene, share=share, step=step, end=1.0)
        if step == 1e-3:
            for share in (0.01, 0.1, 1.0, 10.0):
                yield Wanted(scene="heap", share=share, step=step, end=3.0)


def made(wish: Wanted) -> Figures:
    """Return what one run shows."""
    model = SCENES[wish.scene]()
    how = systems.by_convex(wish.share * YOUNG)
    if "heap" in wish.scene:
        how = replace(how, max_displacement=0.05)
    start = time.perf_counter()
    base: list[float] = []

    def watch(result: StepResult) -> None:
        """Gather the mean penetration at the base in the second half of the run."""
        if result.state.time > 0.5 * wish.end:
            memory = result.state.memory
            depth = -memory.gap[(memory.block == 0) & (memory.gap < 0.0)]
            base.append(float(depth.mean()) if len(depth) else 0.0)

    done = systems.finish(model, how, wish.step, wish.end, may_stop=True, watch=watch)
    run = done.run
    rows = run.tables["steps"][run.tables["steps"]["time"] > 0.5 * wish.end]
    total = float(np.sum(rows["penetration"] * rows["step"]))
    areas = [area for *_, area in systems.overlaps(model, run.state.vertices)]
    return Figures(
        stands=run.report.finished,
        drift=done.drift,
        penetration=total / max(float(np.sum(rows["step"])), 1e-300),
        base=float(np.mean(base)) if base else 0.0,
        peak=run.report.largest_penetration,
        iterations=done.iterations,
        failed=done.failed_steps,
        cut=run.report.cut_steps - done.failed_steps,
        created=done.created / done.turnover,
        unaccounted=abs(run.report.ledger.unaccounted) / done.turnover,
        overlap=max(areas, default=0.0),
        kinetic=run.report.ledger.kinetic / done.turnover,
        wall=time.perf_counter() - start,
    )


def kept() -> dict[str, tuple[Wanted, Figures]]:
    """Return the runs made so far."""
    if not KEPT.exists():
        return {}
    rows = [json.loads(line) for line in KEPT.read_text().splitlines()]
    runs = [(Wanted(**row["wanted"]), Figures(**row["figures"])) for row in rows]
    return {wish.key: (wish, figures) for wish, figures in runs}


def keep(wish: Wanted, figures: Figures) -> None:
    """Add one run to those made."""
    KEPT.parent.mkdir(exist_ok=True)
    with KEPT.open("a") as file:
        file.write(json.dumps({"wanted": asdict(wish), "figures": asdict(figures)}) + "\n")


def resting_penetration(scene: str, share: float) -> float:
    """Return W/(n_c p) at the base: the wall's weight over its contacts there, m."""
    model = SCENES[scene]()
    free = ~model.fixed
    weight = float(model.mass[free].sum()) * systems.GRAVITY
    own = model.vertices[free[model.vertex_block]]
    contacts = int(np.sum(np.abs(own[:, 1]) < 1e-9))
    return weight / (contacts * share * YOUNG)


def wall_table(scene: str, runs: list[tuple[Wanted, Figures]]) -> list[str]:
    """Return the lines of one table of walls."""
    lines = [
        "| p/E | h, ms | stands | drift, mm | W/(n_c p), mm | base | largest "
        "| Newton/step | failed | cut | wall time, s |",
        "|--:|--:|:-:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for wish, one in sorted(runs, key=lambda run: (run[0].share, run[0].step)):
        rest = resting_penetration(scene, wish.share)
        lines.append(
            f"| {wish.share:g} | {1e3 * wish.step:g} | {'yes' if one.stands else 'NO'} "
            f"| {1e3 * one.drift:.2g} | {1e3 * rest:.3g} | {one.base / rest:.3f} "
            f"| {one.penetration / rest:.3f} | {one.iterations:.1f} | {one.failed} | {one.cut} "
            f"| {one.wall:.0f} |"
        )
    return lines


def heap_table(runs: list[tuple[Wanted, Figures]]) -> list[str]:
    """Return the lines of the table of heaps."""
    lines = [
        "| p/E | h, ms | finished | Newton/step | failed | cut | peak penetration, mm "
        "| largest overlap, cm2 | created | unaccounted | kinetic at the end | wall time, s |",
        "|--:|--:|:-:|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for wish, one in sorted(runs, key=lambda run: (run[0].share, run[0].step)):
        lines.append(
            f"| {wish.share:g} | {1e3 * wish.step:g} | {'yes' if one.stands else 'NO'} "
            f"| {one.iterations:.1f} | {one.failed} | {one.cut} "
            f"| {1e3 * one.peak:.3g} | {1e4 * one.overlap:.3g} | {one.created:.1e} "
            f"| {one.unaccounted:.1e} | {one.kinetic:.1e} | {one.wall:.0f} |"
        )
    return lines


def page_tables(runs: dict[str, tuple[Wanted, Figures]]) -> dict[str, list[str]]:
    """Return the tables of the runs made, by the names that docs/robustness.md has for them."""
    by_scene: dict[str, list[tuple[Wanted, Figures]]] = {}
    for run in runs.values():
        by_scene.setdefault(run[0].scene, []).append(run)
    return {
        scene: wall_table(scene, own) if scene in WALLS else heap_table(own)
        for scene, own in by_scene.items()
    }


def say(text: str) -> None:
    """Write a line to the terminal."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main() -> None:
    """Make the runs that are missing and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a minute instead of hours")
    parser.add_argument("--only", nargs="+", choices=list(SCENES), help="scenes to run")
    parser.add_argument("--table", action="store_true", help="write the page without new runs")
    arguments = parser.parse_args()
    runs = kept()
    for wish in () if arguments.table else wanted(arguments.quick):
        if wish.key in runs or (arguments.only and wish.scene not in arguments.only):
            continue
        figures = made(wish)
        keep(wish, figures)
        runs[wish.key] = wish, figures
        say(f"{wish.key}: {figures}")
    if arguments.quick:
        short = {key: run for key, run in runs.items() if run[0].end <= 1.0}
        for name, lines in page_tables(short).items():
            say("\n".join([name, "", *lines, ""]))
    else:
        put_tables(PAGE, page_tables(runs))
        say(f"Wrote {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
