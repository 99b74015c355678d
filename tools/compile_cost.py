"""What compilation costs, kernel by kernel, and the list of kernels that `clast warmup` compiles.

    python tools/compile_cost.py            seconds of processor time, in an empty cache: minutes
    python tools/compile_cost.py --count    statements that are compiled, which costs nothing
    python tools/compile_cost.py --write    list anew what a few runs call (compute/roots.json)

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

from clast.compute import roots
from clast.compute.roots import Root
from clast.studies.warmup import FIRST, TRIALS, run_trials


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
    run_trials(FIRST)
    first = set(roots.called())
    run_trials(TRIALS)
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
            command = [sys.executable, __file__, "--here"]
            return subprocess.run(command, env=environment, check=False).returncode
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
