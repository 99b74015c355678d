"""Random rock masses, cut, checked and run: a thousand of them, and what went wrong.

    python -m benchmarks.networks                    seeds 0 to 999: an hour or two
    python -m benchmarks.networks 0 40 --largest 300    some small ones
    python -m benchmarks.networks --table            what has been run so far

Every seed is a case of tests/scenes/networks.py: one to three joint sets of all six models, with
or without traces, an opening and a bed of another rock, 0.1 m to 1 km wide, some of it 1,000 km
from the origin.  It is cut, built, checked, and run for 20 steps under gravity.  What comes of it
is a line of build/networks.jsonl; seeds that are there are not run again.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tests.scenes.networks import outcome, wrong

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "networks.jsonl"


def kept(path: Path) -> dict[int, dict[str, Any]]:
    """Return the outcomes so far by seed."""
    if not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return {row["seed"]: row for row in rows}


def one(seed: int, largest: float) -> dict[str, Any]:
    """Return the outcome of a seed; an error that is none of clast's own is one, too."""
    try:
        found = asdict(outcome(seed, largest))
    except Exception:
        found = {"seed": seed, "ended": "crashed", "said": traceback.format_exc(), "blocks": 0}
    return {**found, "largest": largest}


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Return how many rock masses ended how, and what went wrong."""
    ended = Counter(row["ended"] for row in rows)
    ran = [row for row in rows if row["ended"] == "ran"]
    blocks = sorted(row["blocks"] for row in ran) or [0]
    lines = [
        f"{len(rows)} rock masses: " + ", ".join(f"{n} {name}" for name, n in ended.items()),
        f"blocks {blocks[0]} to {blocks[-1]}, median {blocks[len(blocks) // 2]}; "
        f"steps {sum(row['steps'] for row in ran)}, {sum(row['cut_steps'] for row in ran)} cut; "
        f"overlaps warned of {sum(row['warned'] for row in ran)}",
    ]
    lines += [f"seed {row['seed']}: {text}" for row in rows for text in wrong(row)]
    return "\n".join(lines)


def say(text: str) -> None:
    """Write a line to the terminal."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


def main() -> None:
    """Run the seeds that are missing and say what went wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("first", type=int, nargs="?", default=0, help="first seed")
    parser.add_argument("end", type=int, nargs="?", default=1000, help="seed after the last")
    parser.add_argument("--largest", type=float, default=5000.0, help="blocks at most, about")
    parser.add_argument("--table", action="store_true", help="run nothing")
    parser.add_argument("--kept", type=Path, default=KEPT, help="file of the outcomes")
    arguments = parser.parse_args()
    rows = kept(arguments.kept)
    arguments.kept.parent.mkdir(exist_ok=True)
    for seed in () if arguments.table else range(arguments.first, arguments.end):
        if seed in rows:
            continue
        rows[seed] = one(seed, arguments.largest)
        with arguments.kept.open("a", encoding="utf-8") as file:
            file.write(json.dumps(rows[seed]) + "\n")
        for text in wrong(rows[seed]):
            say(f"seed {seed}: {text}")
    say(table([rows[seed] for seed in sorted(rows)]))


if __name__ == "__main__":
    main()
