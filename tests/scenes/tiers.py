"""In which tier a test is, which tests of a run are drawn, and how long a core test may take.

The folder decides, so that nobody marks tests by hand.  ``tests/<chapter>`` is core, and
``tests/system/<chapter>`` and ``tests/long/<chapter>`` are what their names say; a few chapters
belong to a tier as a whole.
"""

from __future__ import annotations

import os
import subprocess
import time
from functools import cache
from hashlib import sha256
from itertools import combinations, product
from pathlib import Path
from typing import Any

from scenes.places import TESTS

TIERS = {
    "core": "one formula, kernel or refusal, in this process, within a second",
    "system": "whole runs, stages, restarts, pages of the documentation, brief verification",
    "long": "killed runs, threads, forks, cold caches, random systems, whole verification",
}
"""Tiers in the order in which they are run."""

WHOLE_CHAPTERS = {
    "benchmarks": "system",
    "docs": "system",
    "exports": "system",
    "pictures": "system",
    "robustness": "system",
    "run": "system",
    "studies": "system",
    "verification": "system",
}
"""Chapters of what a whole run does or leaves, and folders that mirror no chapter of src/."""

EACH_BY_ITSELF = (
    "long/verification/test_all_problems.py",
    "docs/test_snippets.py",
    "verification/test_problems.py",
)
"""Files of long tests that share nothing, of which each may go to another process."""
LONGEST = (
    "long/run/test_threads.py",
    "long/compute/test_forks.py",
    *EACH_BY_ITSELF,
    "system/editor/test_edit_in_browser.py",
    "system/editor/test_templates_drawn.py",
    "system/editor/test_drawing.py",
    "pictures/test_hands_on_pages.py",
    "pictures/test_page_in_browser.py",
    "run/test_in_situ.py",
    "system/study/test_runs.py",
    "system/study/test_factors.py",
    "run/test_forged_checkpoints.py",
    "system/study/test_fit.py",
    "system/actions/test_motions.py",
    "system/contact/test_seams.py",
    "contact/test_joint_stiffness.py",
    "contact/test_faces.py",
    "actions/test_bolts.py",
    "pictures/test_live.py",
    "results/test_torn_file.py",
)
"""Files that begin before the others of their tier, so that no process ends by itself with one."""
LONG_FILE = 60.0
"""Time of a file that deserves a line in LONGEST, s."""

LIMIT = 1.0
"""Processor time of a core test, s, on a machine as quick as that of REFERENCE."""
NEIGHBOURS = 1.5
"""By how much others that share the caches and cores may slow a test down, at most."""
REFERENCE = 0.025
"""Processor time of ``reference_work`` on the machine on which LIMIT was chosen, s."""


@cache  # tests of a file have one path, and to resolve it takes a while
def tier_of(path: Path) -> str:
    """Return the tier of the tests of a file."""
    first = path.resolve().relative_to(TESTS).parts[0]
    return first if first in TIERS else WHOLE_CHAPTERS.get(first, "core")


def lifted(tier: str) -> str:
    """Return the tier after this one: that of a test that is marked slow."""
    names = list(TIERS)
    return names[min(names.index(tier) + 1, len(names) - 1)]


def can_have(path: Path, tier: str) -> bool:
    """Return whether a file may have tests of a tier, its slow ones included."""
    own = tier_of(path)
    return tier in (own, lifted(own))


# Order -------------------------------------------------------------------------------------------


@cache
def name_of(path: Path) -> str:
    """Return how a file is named here: below tests/."""
    return path.resolve().relative_to(TESTS).as_posix()


def longest_first(path: Path, tier: str) -> tuple[int, int]:
    """Return the place of a test where several processes share all: what takes longest is first.

    Tiers from long to core, and in each LONGEST before the rest; so what is left for the end is
    small, and all processes end together.
    """
    name = name_of(path)
    rank = LONGEST.index(name) if name in LONGEST else len(LONGEST)
    return -list(TIERS).index(tier), rank


def one_process(nodeid: str) -> str:
    """Return what is given to one process at a time: the file of a test, or this test alone."""
    file = nodeid.split("::", 1)[0]
    return nodeid if file.removeprefix("tests/") in EACH_BY_ITSELF else file


# Drawing -----------------------------------------------------------------------------------------


@cache
def commit() -> str:
    """Return what decides which tests are drawn: the commit, or TESTS_DRAWN_BY."""
    if "TESTS_DRAWN_BY" in os.environ:
        return os.environ["TESTS_DRAWN_BY"]
    done = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=TESTS, capture_output=True, text=True, check=False
    )
    return done.stdout.strip() or "no commit"


def drawn(name: str, one_in: int, by: str) -> bool:
    """Return whether ``name`` is among the one in so many that ``by`` chooses."""
    return int(sha256(f"{by} {name}".encode()).hexdigest(), 16) % one_in == 0


def pairwise(*options: Any) -> list[tuple[Any, ...]]:
    """Return rows, one of each option, in which every two values of two options meet.

    Ten values of three options have as many rows as the two longest have pairs, or few more, where
    their product has as many as all three.
    """
    rows = list(product(*(range(len(list(one))) for one in options)))
    places = list(combinations(range(len(options)), 2))

    def pairs(row: tuple[int, ...]) -> set[tuple[int, int, int, int]]:
        return {(a, b, row[a], row[b]) for a, b in places}

    left = set().union(*(pairs(row) for row in rows))
    chosen = []
    while left:
        best = max(rows, key=lambda row: len(pairs(row) & left))
        left -= pairs(best)
        chosen.append(best)
    return [tuple(list(options[k])[i] for k, i in enumerate(row)) for row in sorted(chosen)]


# Time --------------------------------------------------------------------------------------------


def processor_time() -> float:
    """Return the processor time of this process and of those that it has waited for, s."""
    used = os.times()
    return time.process_time() + used.children_user + used.children_system


def reference_work() -> float:
    """Return the processor time of a fixed piece of work in plain Python, s."""
    start = time.process_time()
    total = 0.0
    for k in range(400_000):
        total += k * 0.5
    return time.process_time() - start


def slowness() -> float:
    """Return by how much this machine is slower now than that of REFERENCE, 1 at least."""
    return max(1.0, min(reference_work() for _ in range(3)) / REFERENCE)


def too_long(seconds: float) -> str:
    """Return what is said of a core test that took so much processor time twice; "" if nothing."""
    if seconds <= LIMIT * NEIGHBOURS:
        return ""
    slower = slowness()
    if seconds <= LIMIT * NEIGHBOURS * slower:
        return ""
    return (
        f"took {seconds:.2f} s of processor time, the second time, with its kernels loaded; a core "
        f"test has {LIMIT:g} s (x {NEIGHBOURS:g} for neighbours, x {slower:.1f} for this "
        "machine). Make it smaller, or move it to tests/system/."
    )
