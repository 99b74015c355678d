"""Holds the sizes of the package and of its tests against their budget, folder by folder.

    python tools/sizes.py

Whoever carries clast on has to read it, so a line is a cost.  `budget.toml` beside this file has
one number of lines a folder.  The numbers may only fall, except in a commit whose text names the
feature that was added and what left for it.  The exit status is 1 where a folder exceeds its
number.

A file of more than 500 lines or a folder of more than 16 files often has two subjects; it is not an
error, and splitting one that has a single subject makes it harder to read.
"""

from __future__ import annotations

import sys
import tomllib
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUDGET = Path(__file__).with_name("budget.toml")
USUAL_LINES = 500
USUAL_FILES = 16
"""Files of a folder, __init__.py not counted."""


def lines_of_files(folder: Path) -> dict[str, int]:
    """Return the number of lines of each Python file below a folder."""
    return {
        path.relative_to(folder).as_posix(): len(path.read_text("utf-8").splitlines())
        for path in sorted(folder.rglob("*.py"))
    }


def lines_of_folders(lines: dict[str, int]) -> tuple[Counter[str], Counter[str]]:
    """Return lines and files of each top folder, and of all; `root` has the files beside them."""
    sums, files = Counter[str](), Counter[str]()
    for file, count in lines.items():
        for name in (file.split("/")[0] if "/" in file else "root", "all"):
            sums[name] += count
            files[name] += 1
    return sums, files


def report(title: str, lines: dict[str, int], budget: dict[str, int]) -> tuple[list[str], bool]:
    """Return the table of one part, lines against budget, and whether a folder exceeds it."""
    sums, files = lines_of_folders(lines)
    named = set(budget) if set(budget) == {"all"} else set(budget) | set(sums)
    above = {name for name in named if sums[name] > budget.get(name, 0)}
    rows = [f"{title:14} {'lines':>7} {'budget':>7} {'files':>6}"]
    rows += [
        f"{name:14} {sums[name]:7} {budget.get(name, 0):7} {files[name]:6}"
        + "  above its budget" * (name in above)
        for name in sorted(named, key=lambda name: -sums[name])
    ]
    return rows, bool(above)


def unusual(lines: dict[str, int]) -> list[str]:
    """Return long files and full folders."""
    folders = Counter(
        file.rpartition("/")[0] or "root" for file in lines if not file.endswith("__init__.py")
    )
    return [
        *(
            f"long file: {file}, {count} lines"
            for file, count in lines.items()
            if count > USUAL_LINES
        ),
        *(f"full folder: {name}, {n} files" for name, n in folders.items() if n > USUAL_FILES),
    ]


def main() -> int:
    """Print the tables of package and tests; return 1 where one exceeds its budget."""
    budget = tomllib.loads(BUDGET.read_text("utf-8"))
    package = lines_of_files(ROOT / "src" / "clast")
    rows, above = report("src/clast", package, budget["package"])
    tests, tests_above = report("tests", lines_of_files(ROOT / "tests"), budget["tests"])
    print("\n".join([*rows, "", *tests, "", *unusual(package)]))  # noqa: T201
    return int(above or tests_above)


if __name__ == "__main__":
    sys.exit(main())
