"""clast beside Chipmunk and Box2D v3: the same scenes, one program after the other.

    pip install -c constraints.txt pymunk pyb2d3    Chipmunk and Box2D, the group "peers"
    python -m benchmarks.peers --walls 105 --heaps --wholes    seconds: one small wall
    python -m benchmarks.peers --walls --heaps --wholes rest   a heap to rest, 100 and 1000 squares
    python -m benchmarks.peers                                 all of it: hours
    python -m benchmarks.peers --page               write docs/performance.md from what is kept

Measured are the time of the processor for a simulated second, the largest horizontal movement of a
brick that should stand still, and how deep blocks overlap at the end.  Whole scenes are those of
benchmarks.scenes, from beginning to end: a heap to rest, a wall that collapses, dominoes, a
slide.  A program that is not installed is left out.  Figures are kept in build/peers.json; they
belong to one machine, and another one starts anew.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.bench import deepest_overlap
from benchmarks.memory import PACKAGES, this_machine
from benchmarks.performance import page
from benchmarks.programs import Box2D, Chipmunk, Clast, Outcome, Program, Setting
from benchmarks.scenes import WHOLE_SCENES, box, outlines_of_heap, outlines_of_wall

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "peers.json"
BENCH = ROOT / "build" / "bench.json"
PAGE = ROOT / "docs" / "performance.md"

WALLS = {105: (10, 10), 1012: (45, 22), 5025: (50, 100), 10025: (50, 200)}
"""Bricks -> courses and columns."""
HEAPS = {1000: 32, 10000: 100}
"""Falling squares -> columns."""
WHOLE_SIZES = (100, 1000)
"""Blocks of whole scenes."""


@dataclass(frozen=True, kw_only=True)
class Figures:
    """What one program made of one setting."""

    scene: str
    """wall, heap, or the name of a whole scene."""
    blocks: int
    """Blocks that move."""
    program: str
    """Program with its settings."""
    simulated: float
    """Simulated time, s."""
    seconds: float
    """Time of the processor for the steps, s."""
    per_simulated_second: float
    """The same for one simulated second."""
    drift: float | None
    """Largest horizontal movement of a vertex, m; None for heaps."""
    overlap: float
    """Depth to which blocks overlap at the end, m: the thickest overlap of all."""
    remark: str
    """How the run ended where it did not reach its end."""

    @property
    def key(self) -> tuple[str, int, str]:
        """What tells one row from another."""
        return self.scene, self.blocks, self.program


def wall(bricks: int) -> Setting:
    """Return the running-bond wall of so many bricks on a fixed ground."""
    courses, columns = WALLS[bricks]
    return Setting(
        name="wall",
        free=outlines_of_wall(courses, columns),
        fixed=box(-1.0, -1.0, columns + 1.0, 0.0),
    )


def heap(squares: int) -> Setting:
    """Return so many loose squares above the floor of a trough."""
    columns = HEAPS.get(squares, max(1, round(np.sqrt(squares))))
    free, trough = outlines_of_heap(squares, columns)
    return Setting(name="heap", free=free, fixed=trough)


def whole(name: str, size: int) -> Setting:
    """Return a scene that is simulated from beginning to end, with about so many blocks."""
    free, fixed = WHOLE_SCENES[name].outlines(size)
    return Setting(name=name, free=free, fixed=fixed)


def programs(arguments: argparse.Namespace, scene: str) -> list[Program]:
    """Return the programs for a scene: what moves has a step and stiffness of its own."""
    if scene != "wall":
        step, share = arguments.heap_step, arguments.heap_stiffness
        own: list[Program] = [Clast(step, share, travel=arguments.heap_travel)]
    else:
        own = [Clast(step, arguments.stiffness) for step in arguments.steps]
    peers: list[Program] = [Chipmunk(10), Chipmunk(50), Box2D(), Box2D(500.0)]
    if arguments.programs:
        wanted = tuple(arguments.programs)
        return [one for one in (*own, *peers) if one.name.lower().startswith(wanted)]
    return [*own, *peers]


def figures(setting: Setting, program: Program, outcome: Outcome) -> Figures:
    """Return what is kept of a run."""
    shift = np.abs(outcome.free[..., 0] - setting.free[..., 0]).max()
    return Figures(
        scene=setting.name,
        blocks=len(setting.free),
        program=program.name,
        simulated=outcome.time,
        seconds=outcome.seconds,
        per_simulated_second=outcome.seconds / outcome.time if outcome.time else np.inf,
        drift=float(shift) if setting.name == "wall" else None,
        overlap=deepest_overlap(np.concatenate([outcome.free, setting.fixed])),
        remark=outcome.remark,
    )


def kept() -> dict[tuple[str, int, str], Figures]:
    """Return the figures of earlier runs on this machine."""
    if not KEPT.exists():
        return {}
    content = json.loads(KEPT.read_text(encoding="utf-8"))
    if content["machine"] != machine():
        return {}
    rows = [Figures(**row) for row in content["rows"]]
    return {row.key: row for row in rows}


def keep(rows: Sequence[Figures]) -> None:
    """Write all figures."""
    KEPT.parent.mkdir(exist_ok=True)
    content = {"machine": machine(), "rows": [asdict(row) for row in rows]}
    KEPT.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


def machine() -> dict[str, Any]:
    """Return the machine with the versions of all programs, ready for JSON."""
    return this_machine((*PACKAGES, "pymunk", "pyb2d3"))


def say(text: str) -> None:
    """Print a line at once."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def run_all(arguments: argparse.Namespace) -> None:
    """Make the runs that are asked for, keep and print their figures."""
    rows = kept()
    settings = [(wall(bricks), arguments.end) for bricks in arguments.walls]
    settings += [(heap(squares), arguments.heap_end) for squares in arguments.heaps]
    for name in arguments.wholes:
        sizes = arguments.whole_sizes
        settings += [(whole(name, size), WHOLE_SCENES[name].end(size)) for size in sizes]
    for setting, end in settings:
        say(f"{setting.name} of {len(setting.free)} blocks, {end:g} s")
        for program in programs(arguments, setting.name):
            if program.missing:
                say(f"  {program.name}: left out, {program.missing} is not installed")
                continue
            found = figures(setting, program, program.simulate(setting, end, arguments.limit))
            rows[found.key] = found
            keep(list(rows.values()))
            say("  " + line(found))


def line(row: Figures) -> str:
    """Return the figures of a run as a line for the terminal."""
    drift = "" if row.drift is None else f"drift {1e3 * row.drift:.3g} mm, "
    return (
        f"{row.program:<55}{row.per_simulated_second:>9.3g} s per s, {drift}"
        f"overlap {1e3 * row.overlap:.3g} mm {row.remark}"
    )


def main() -> None:
    """Make the runs, or write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--walls", type=int, nargs="*", default=list(WALLS), choices=list(WALLS), help="bricks"
    )
    parser.add_argument("--heaps", type=int, nargs="*", default=list(HEAPS), help="squares")
    parser.add_argument(
        "--wholes",
        nargs="*",
        default=list(WHOLE_SCENES),
        choices=list(WHOLE_SCENES),
        help="scenes from beginning to end",
    )
    parser.add_argument(
        "--whole-sizes", type=int, nargs="+", default=list(WHOLE_SIZES), help="blocks of these"
    )
    parser.add_argument("--end", type=float, default=1.0, help="simulated time of walls, s")
    parser.add_argument("--heap-end", type=float, default=2.0, help="simulated time of heaps, s")
    parser.add_argument("--steps", type=float, nargs="+", default=[0.05, 0.005], help="h, s")
    parser.add_argument("--stiffness", type=float, default=1.0, help="p/E")
    parser.add_argument("--heap-step", type=float, default=0.0025, help="h of heaps, s")
    parser.add_argument(
        "--heap-travel", type=float, default=2.0, help="max_displacement of heaps over the default"
    )
    parser.add_argument("--heap-stiffness", type=float, default=0.1, help="p/E of heaps")
    parser.add_argument("--programs", nargs="+", help="clast, chipmunk, box2d: only these")
    parser.add_argument("--limit", type=float, default=600.0, help="wall time of a run, s")
    parser.add_argument("--page", action="store_true", help="write docs/performance.md instead")
    parser.add_argument("--note", default="", help="what else the machine had to do, for the page")
    arguments = parser.parse_args()
    if not arguments.page:
        run_all(arguments)
        return
    if not KEPT.exists():
        parser.error(f"there are no figures in {KEPT.relative_to(ROOT)}: run without --page first")
    bench = json.loads(BENCH.read_text(encoding="utf-8")) if BENCH.exists() else None
    PAGE.write_text(
        page(json.loads(KEPT.read_text(encoding="utf-8")), bench, arguments.note), encoding="utf-8"
    )
    say(f"Wrote {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
