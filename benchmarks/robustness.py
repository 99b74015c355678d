"""Where the convex process holds: walls and heaps over stiffness and step.

    python -m benchmarks.robustness --quick       a minute: the small wall, a small heap
    python -m benchmarks.robustness               all of it: hours
    python -m benchmarks.robustness --only small-wall heap

Every run that has ended is kept in build/robustness.jsonl and not repeated; the tables of what is
there are written to docs/robustness.md.
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
WALLS = {
    "small-wall": "Running bond, 105 bricks",
    "small-columns": "Aligned columns, 100 bricks",
    "large-wall": "Running bond, 1,012 bricks",
    "large-columns": "Aligned columns, 990 bricks",
    "brick-wall": "Running bond, 105 bricks, friction angle 30 degrees, for two seconds",
}


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
        f"### {WALLS[scene]}",
        "",
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
    return [*lines, ""]


def heap_table(title: str, runs: list[tuple[Wanted, Figures]]) -> list[str]:
    """Return the lines of the table of heaps."""
    lines = [
        f"### {title}",
        "",
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
    return [*lines, ""]


HEAD = """# Where the convex process holds

Written by `python -m benchmarks.robustness`; only completed runs are listed. No parameter
was tuned for any row: one method, penalty law, constant acceleration, default tolerance.
Repeated in November 2026, except the columns of 990 bricks at 0.2 ms, which predate
impacts as events (decision 41) and seams (40). The machine also ran many other programs, so that
wall times are five to thirty times those on a quiet one.

The heap's peak penetration of about 9 mm does not depend on the stiffness: a corner that passes
another one comes to lie behind an edge, its spring is unloaded at that position
(`step/spring_offset.py`), and the penetration remains until the blocks separate. Only the tip
overlaps: the area of overlap is a hundredth of a square centimetre on stiff springs. The drift of
990 soft bricks in columns (p/E = 0.01: each joint closes by 6 mm, 45 on top of each other) occurs
because a stack leans as it comes to rest; it is 0.5 to 12 mm depending on the step.

## Walls

Duration one second, unless the table says otherwise. Bricks of 1 m x 0.5 m, half bricks at the ends
of every second course, E 5 GPa, Poisson's ratio 0 (so that any drift is an error), 2600 kg/m3,
friction angle 26.57 degrees, no damping, on a fixed base. The wall starts without penetration and
settles under its weight.

*Drift* is the largest horizontal displacement of any vertex. W/(n_c p) is the penetration if the
weight of the wall were spread evenly over the corners on the base. The mean penetration at the base
(*base*) and the largest of any contact in the wall (*largest*) are given in units of it, both
averaged over the last half second, because an undamped wall on soft springs still bounces. In a
bond the load is not even, so the largest exceeds the mean; in columns it does not. From p = E up
all penetrations are within 20 % of W/(n_c p) and all drifts below 0.05 mm. Columns are held only by
friction at their feet; they stand because a corner that is flush with the adjacent face does not
rest on it (decision 20): before that change 990 bricks at p = E, h = 0.2 ms swayed by
0.16 mm and drifted by 0.05 mm. Softer walls bounce by millimetres and drift more. *Failed* counts
steps that did not converge or in which a vertex passed through an edge, *cut* those in which a
displacement or rotation exceeded the limit of a step. Wall times are for one thread beside other
programs; those of the first runs include the compilation of kernels.
"""

TAIL = """## Heaps

Random polygons of 4 to 7 corners and up to 1.1 m, every second one non-convex, fall into a trough
(E 5 GPa, friction angle 30 degrees, restitution 0) and come to rest. *Created* is the largest
excess over the initial energy at any time, *unaccounted* the error of the energy balance,
both divided by the energy turned over.
"""

END = """## Further tests

The tests in `tests/robustness` cover 50 storeys, a wedge between two blocks, piles of slabs of
1:50, block sizes that differ by a factor of 1000, and scenes reported to fail in other programs:
a wedge of 32 blocks that must rest on a slope of 26.5 degrees, a block exactly at its limit of
friction, a block without contacts, stacked boxes, an arch. Random small systems converge, give
the same results if moved, rotated, renumbered or scaled, and repeat bit for bit.

Random systems of 2 to 11 blocks (`tests/scenes/random_systems.py`: sizes 1:100, half of them not
convex, tight and loose, p/E 1e-3 to 50, h 0.2 to 20 ms, friction 0 to 60 degrees, some with
cohesion, velocities up to 20 m/s) are run for 50 to 150 steps and checked with a polygon
clipper. Of 2,088 none stops and none gains more than 0.1 % of the energy turned over. In 32 systems
two blocks overlap by more than 1.5 times the penetration of their contacts, 29 by micrometres,
three by 1 to 92 mm, with a warning in each case.

Random rock masses (`python -m benchmarks.networks`, drawn by `tests/scenes/networks.py`: one to 3
joint sets of all six models, with or without traces, an opening and a bed of another rock, 6 cm to
2 km across, a quarter of them 1,000 km from the origin, 1 to 1,045 blocks, median 19, held at their
sides or standing on a base) are cut, built, checked and run for 20 steps under gravity. In 22 of
1,000 a set cuts no block and is refused. None of the others is refused or stops, none gains energy,
all results are finite; of 20,000 steps 57 are cut. In 68 blocks overlap by more than the
penetration of their contacts, by less than a micrometre to 1.3 mm, where corners that have slid
past each other rest behind an edge, with a warning in each case.

critdis (default 5 mm) should be below a tenth of the thinnest block, and max_displacement below its
thickness: 0.5 mm and 1 mm for cubes of 1 cm below a block of 10 m.

Three limitations:

- Linear momentum is conserved to round-off, and so is the angular momentum of blocks that rotate
  and strain freely. Contacts do not conserve angular momentum exactly: friction acts on the vertex
  and on its foot on the edge, one penetration apart, which gives a couple of T x penetration, and
  forces are evaluated at the geometry of the start of a step. In an eccentric collision of two
  squares with friction the error is 9e-5 of the sum of their angular momenta at any p; on soft
  springs alone, p = E/100, it was 1.6e-3, nine tenths of it due to that couple.
- The tolerance of a step refers to the whole system, and a fast block elsewhere makes it coarser: a
  falling block moved a stack 10 m away by 8e-11 m in 0.2 s; with tolerance 1e-10 instead of 1e-7 it
  is less than 1e-12 m.
- A block released on unloaded springs gains some speed before friction develops. If slope
  and friction are in balance (tan phi = 0.5 on 26.565 degrees), it keeps this speed. Let
  such a system settle with dynamic_ratio = 0 first; the block then sticks at 0.50 and at 0.49
  slides the correct distance to 1e-11 m.
"""


def page(runs: dict[str, tuple[Wanted, Figures]]) -> str:
    """Return the page with the tables of the runs made."""

    def of(scene: str) -> list[tuple[Wanted, Figures]]:
        return [run for run in runs.values() if run[0].scene == scene]

    lines = [HEAD]
    for scene in WALLS:
        if of(scene):
            lines += wall_table(scene, of(scene))
    lines.append(TAIL)
    for scene, title in (
        ("heap", "Heap of 200 polygons, 3 s"),
        ("small-heap", "Heap of 30 polygons, 1 s"),
    ):
        if of(scene):
            lines += heap_table(title, of(scene))
    lines.append(END)
    return "\n".join(lines).rstrip() + "\n"


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
        say(page({key: run for key, run in runs.items() if run[0].end <= 1.0}))
    else:
        PAGE.write_text(page(runs))
        say(f"Wrote {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
