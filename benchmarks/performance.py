"""The page docs/performance.md, written from figures that were kept."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import groupby
from textwrap import fill
from typing import Any

from benchmarks.tables import (
    BENCH_HEADINGS,
    PEER_HEADINGS,
    WHOLE_HEADINGS,
    bench_cells,
    machine_text,
    markdown_table,
    peer_cells,
    whole_cells,
)

INTRODUCTION = """\
# Performance

Written by `make performance`, which takes hours, from figures of one machine: {machine}.{note} It
times scenes by stage (`python -m benchmarks.bench`, with *whole* scenes from beginning to end),
then other programs beside clast (`python -m benchmarks.peers`), and writes this page from what both
keep in `build` (`python -m benchmarks.peers --page`).

## Beside other programs

Made by `python -m benchmarks.peers`, one program after the other. All have the same outlines,
tan phi = 0.5, 2600 kg/m3, no damping, no sleeping of blocks, and one thread. The blocks of Chipmunk
and Box2D are rigid and their steps explicit; clast's blocks are deformable (E 5 GPa, nu 0, so that
any drift is an error) and its steps are implicit, so they may be longer. *Drift* is the largest
horizontal displacement of a corner of a wall that should stand still, *overlap* the thickness of
the thickest overlap of two blocks, both at the end. The comparison is by processor time at the
accuracy stated.

Implicit steps are most efficient for walls at rest: they are fifty to a hundred times as long as
those of the others, with less drift. In heaps of falling blocks contacts open, close, stick and
slide everywhere at once, and a step of 2.5 ms takes 10 to 35 iterations. Islands, groups of blocks
connected by contacts, are minimised one by one (docs/solver-performance.md); the gain increases
with the number of blocks. Blocks may move by a tenth of their size in a step, twice the default
max_displacement.

A run that is *stopped* after ten minutes of wall time is measured over the time simulated by
then.
"""
SCENES = """\
## Cost by scene and size

Made by `python -m benchmarks.bench -o build/bench.json`: h = {step:g} s, p/E = {stiffness:g},
solver {solver}, on {machine}. *Product* is the matrix product of Newton's directions, as a share of
a triad over as many bytes (which fit in the cache up to about 10,000 blocks), and of the triad in
main memory, which reaches {triad:.3g} GB/s. *Solves* are the share of a step spent on systems of
equations, factors and couplings included; *small islands* is the share of the minimisation of small
groups of blocks without other contacts, from the first to the last iteration, with their systems
(docs/solver-performance.md). Blocks at rest or in free fall need hardly any solution.

The first steps of a wall or a slope are the most expensive: the weight is applied at once, and
undamped waves run through the blocks. From 1,000 to 10,000 blocks the height of the scenes also
increases (see below).
"""
WHOLE = """\
## Scenes from beginning to end

Made by `python -m benchmarks.bench whole --size 100,1000`, on {machine}: h = 2.5 ms,
p/E = 0.1. Squares that fall into a trough and come to *rest*; the *collapse* of a wall that loses
the ground under its right half; rows of *dominoes*; a *slide* of blocks down a hillside. Times are
processor times without compilation: *detection*, *impacts* and *minimisation* (law,
small islands, assembly, solve, line search) are shares of them. *Overlap* and *speed* are the
largest at the end; *numerical* is the energy removed or added by the time integration, and
*unaccounted* the error of the energy balance, as shares of the energy turned over.

A change to detection, impacts, minimisation or the sequence of a step is judged by this table,
with runs before and after it alternating on one machine.
"""
TITLES = {
    "wall": "Wall at rest",
    "heap": "Heap, the first two seconds",
    "rest": "Heap to rest",
    "collapse": "Collapsing wall",
    "dominoes": "Dominoes",
    "slide": "Slide over terrain",
}
"""Titles of the scenes of the first tables."""
ORDER = list(TITLES)
CUTTING = """\
## Cutting

`python -m benchmarks.bench cut` cuts a square by two joint sets, from drawn lines to blocks with
their report, and gives the time of each stage. On one core of a slow machine shared with other
programs (AMD EPYC, 23.5 GiB) the processor times were

- 10.7 s for 101,844 blocks of persistent sets (target 20 s), with at most 563 MiB of memory,
- 19.1 s for 98,732 blocks of Baecher traces (target 40 s), with 758 MiB.

The sum of the areas equals that of the domain to the last bit or two. Half of the time is spent on
intersections (*noding*), a sixth each on faces and on short edges and small blocks.
"""
STATICS = """\
## Statics of 20,000 blocks

The slope of the table above (h = 5 ms, p/E = 1), loaded by its weight in one static stage until it
is in equilibrium, on 27 November 2026, on an AMD EPYC with 2 cores shared with other programs.
Processor time without compilation and construction of the model:

| blocks | contacts | steps | passes | factorisations | pcg | processor |
| ---: | ---: | ---: | ---: | ---: | ---: | ---: |
| 1,008 | 7,339 | 3 | 94 | 91 | 1,469 | 0.8 s |
| 4,986 | 38,271 | 4 | 120 | 232 | 3,370 | 5.5 s |
| 20,236 | 157,205 | 4 | 213 | 398 | 9,033 | 31.3 s |

- The four steps of 20,236 blocks take 112, 57, 33 and 11 passes, and 13.5, 8.5, 5.8 and 3.2 s, with
  at most 659 MiB of memory. At the end the unbalanced force on every block is at most 5e-6 of its
  forces.
- Conjugate gradients take 44 % of the time, preconditioners and assembly 19 %, and contact
  detection, once a step, 19 %.
- The narrow phase of detection takes twice as long per contact as with 4,986 blocks in as many
  rows.
- With the mass term of the 5 ms steps instead of the path of equilibria (decision 70), which is how
  the modified process still settles, 1,008 blocks are not in equilibrium after 950 steps and 80 s.
"""
LARGE = """\
## A million blocks, height, order, and threads

Apart from the runs above, on an Intel Xeon with 2 cores and 23.5 GiB, before impacts became events:

- At constant height the cost per block hardly increases with the number of blocks: in their first
  steps walls of 50 courses with 1,026, 10,026 and 100,026 bricks take 33, 22 and 27 µs per block
  and step at 1 ms (five steps), where the blocks with the largest residual are minimised first
  (docs/solver-performance.md), and 16.0, 22.8 and 23.4 µs at 5 ms (ten steps), where the largest
  need 15 iterations of conjugate gradients for a direction instead of 9. In the table above the
  height increases: scenes of 1,000 blocks are 32 storeys or 45 courses high.
- Two threads with 10,000 blocks, one and two threads alternating, medians of four: the first
  four steps of a wall at 5 ms are 1.69 times as fast as with one thread, at 1 ms 1.69, of a slope
  1.87 and 1.73, of towers 1.80, of a heap at 0.8 s 1.69, at 1.4 s 1.74, at 1.9 s 1.88, if
  the second core is idle. Below 800 blocks one thread is used. The results are the
  same to the last bit.
- `python -m benchmarks.bench heap --size 1e6 --step 2.5e-3 --steps 100 --results build`: a million
  falling squares are built in 6 s and take 1.2 µs per block and step, 2.1 minutes with first and
  last state saved (0.7 GB), and 2.7 GiB of memory at most.
- `NUMBA_NUM_THREADS=2 python -m benchmarks.bench stack --size 1e6 --steps 100 --results build`:
  20,000 towers of 50 squares at rest on 3,960,000 contacts, h = 1 ms, take 2.3 µs per block and
  step, 4 minutes with first and last state saved (1 GB), and 6.0 GiB of memory at most; the matrix
  product reaches 27 GB/s there, 91 % of the triad over as many bytes by as many threads.

Before the rough first minimum (docs/solver-performance.md), on an AMD EPYC with 2 cores and
23.5 GiB:

- Numbered at random instead of course by course, walls of 1,011, 10,026 and 100,026 bricks take
  1.2 to 1.4 times as long at 1 ms; 1.6, 2.1 and 3.0 times before they were numbered anew.
- Where Newton's directions have K in single precision the product reads each block once, 144
  bytes instead of 288. For 100,026 bricks it takes 3.3 to 5.6 ms by one thread and 2.7 to 3.2
  by two; in double precision, as `modified` and `open-close` have it, 7.5 to 12.7 and 6.1 to
  7.6. That is 12 to 20 and 20 to 25 GB/s, 75 to 85 % and 76 to 84 % of the triad in main memory
  by as many threads, measured in turns with it.
"""


def page(peers: Mapping[str, Any], bench: Mapping[str, Any] | None, note: str = "") -> str:
    """Return the page from the content of build/peers.json and, if there is one, bench.json.

    ``note`` says what else the machine had to do.
    """
    beside = f"\n{fill(note, 100)}" if note else ""
    lines = [INTRODUCTION.format(machine=machine_text(peers["machine"]), note=beside)]

    def title(row: Mapping[str, Any]) -> str:
        return f"{TITLES[row['scene']]}, {row['blocks']:,} blocks"

    rows = sorted(peers["rows"], key=lambda row: (ORDER.index(row["scene"]), row["blocks"]))
    for name, group in groupby(rows, key=title):
        lines += [f"### {name}", ""]
        lines += [*markdown_table(PEER_HEADINGS, [peer_cells(row) for row in group]), ""]
    if bench is not None and bench.get("wholes"):
        lines.append(WHOLE.format(machine=machine_text(bench["machine"])))
        cells = [whole_cells(row) for row in bench["wholes"]]
        lines += [*markdown_table(WHOLE_HEADINGS, cells), ""]
    if bench is not None and bench["rows"]:
        settings = bench["settings"]
        machine = machine_text(bench["machine"])
        lines.append(SCENES.format(machine=machine, triad=bench["triad"] / 1e9, **settings))
        cells = [bench_cells(row, bench["triad"]) for row in bench["rows"]]
        lines += [*markdown_table(BENCH_HEADINGS, cells), "", STATICS, CUTTING, LARGE]
    return "\n".join(lines).rstrip() + "\n"
