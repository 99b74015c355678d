"""clast beside Chipmunk and Box2D v3: the same scenes, one program after the other.

    pip install -c constraints.txt pymunk pyb2d3    Chipmunk and Box2D, the group "peers"
    python -m benchmarks.peers --walls 105          seconds: one small wall
    python -m benchmarks.peers --wholes rest        a heap to rest, 100 and 1000 squares
    python -m benchmarks.peers --walls --heaps 1000 --wholes    all but the heap of 10,000
    python -m benchmarks.peers                      all of it: hours
    python -m benchmarks.peers --page               put what is kept into docs/performance.md

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
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.bench import deepest_overlap
from benchmarks.machine import PACKAGES, this_machine
from benchmarks.programs import Box2D, Chipmunk, Clast, Outcome, Program, Setting
from benchmarks.scenes import WHOLE_SCENES, box, outlines_of_heap, outlines_of_wall
from benchmarks.tables import (
    BENCH_HEADINGS,
    PEER_HEADINGS,
    WHOLE_HEADINGS,
    bench_cells,
    machine_text,
    markdown_table,
    peer_cells,
    put_tables,
    whole_cells,
)

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
LIMIT = 600.0
"""Wall time of a run at most, s."""
TITLES = {
    "wall": "Wall at rest",
    "heap": "Heap, the first two seconds",
    "rest": "Heap to rest",
    "collapse": "Collapsing wall",
    "dominoes": "Dominoes",
    "slide": "Slide over terrain",
}
"""Titles of the scenes on the page, in its order."""


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


def programs(scene: str) -> list[Program]:
    """Return the programs for a scene: what moves has a step and stiffness of its own."""
    # stiffer springs take three times as long in large islands that slide
    share = 0.1 if scene in ("collapse", "slide") else 1.0
    own: list[Program] = [Clast(0.005, share, travel=2.0)]
    if scene == "wall":
        own = [Clast(0.05), Clast(0.005)]
    return [*own, Chipmunk(10), Chipmunk(50), Box2D(), Box2D(500.0)]


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
    settings = [(wall(bricks), 1.0) for bricks in arguments.walls]
    settings += [(heap(squares), 2.0) for squares in arguments.heaps]
    for name in arguments.wholes:
        settings += [(whole(name, size), WHOLE_SCENES[name].end(size)) for size in WHOLE_SIZES]
    for setting, end in settings:
        say(f"{setting.name} of {len(setting.free)} blocks, {end:g} s")
        for program in programs(setting.name):
            if program.missing:
                say(f"  {program.name}: left out, {program.missing} is not installed")
                continue
            found = figures(setting, program, program.simulate(setting, end, LIMIT))
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


def page_tables(peers: Mapping[str, Any], bench: Mapping[str, Any] | None) -> dict[str, list[str]]:
    """Return the parts of docs/performance.md from the content of build/peers.json and bench.json.

    Each begins with the machine that its figures belong to.
    """

    def title(row: Mapping[str, Any]) -> str:
        return f"{TITLES[row['scene']]}, {row['blocks']:,} blocks"

    order = list(TITLES)
    rows = sorted(peers["rows"], key=lambda row: (order.index(row["scene"]), row["blocks"]))
    lines = [f"{machine_text(peers['machine'])}."]
    for name, group in groupby(rows, key=title):
        lines += ["", f"### {name}", ""]
        lines += markdown_table(PEER_HEADINGS, [peer_cells(row) for row in group])
    tables = {"peers": lines}
    if bench is not None:
        text = f"{machine_text(bench['machine'])}."
        for part, headings, cells in (
            ("wholes", WHOLE_HEADINGS, whole_cells),
            ("rows", BENCH_HEADINGS, bench_cells),
        ):
            if bench.get(part):
                texts = [cells(row) for row in bench[part]]
                tables[part] = [text, "", *markdown_table(headings, texts)]
    return tables


def chosen(arguments: argparse.Namespace) -> argparse.Namespace:
    """Return what is to run: all of a kind that is named alone, and all kinds where none is."""
    kinds = {"walls": list(WALLS), "heaps": list(HEAPS), "wholes": list(WHOLE_SCENES)}
    given = {kind: getattr(arguments, kind) for kind in kinds}
    if all(some is None for some in given.values()):
        return argparse.Namespace(**kinds)
    named = {kind: kinds[kind] if some == [] else some or [] for kind, some in given.items()}
    return argparse.Namespace(**named)


def main() -> None:
    """Make the runs, or write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--walls", type=int, nargs="*", metavar="BRICKS", choices=list(WALLS))
    parser.add_argument("--heaps", type=int, nargs="*", metavar="SQUARES")
    parser.add_argument("--wholes", nargs="*", metavar="SCENE", choices=list(WHOLE_SCENES))
    parser.add_argument(
        "--page", action="store_true", help="put the tables into docs/performance.md"
    )
    arguments = parser.parse_args()
    if not arguments.page:
        run_all(chosen(arguments))
        return
    if not KEPT.exists():
        parser.error(f"there are no figures in {KEPT.relative_to(ROOT)}: run without --page first")
    bench = json.loads(BENCH.read_text(encoding="utf-8")) if BENCH.exists() else None
    put_tables(PAGE, page_tables(json.loads(KEPT.read_text(encoding="utf-8")), bench))
    say(f"Wrote {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
