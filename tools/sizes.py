"""Reports sizes of the package: lines and files by folder, and what is longer than usual.

    python tools/sizes.py

A file of more than 500 lines or a folder of more than 16 files often has two subjects; it is not an
error, and splitting one that has a single subject makes it harder to read.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "src" / "clast"
USUAL_LINES = 500
USUAL_FILES = 16
"""Files of a folder, __init__.py not counted."""


def lines_of_files(package: Path = PACKAGE) -> dict[str, int]:
    """Return the number of lines of each file of the package."""
    return {
        path.relative_to(package).as_posix(): len(path.read_text("utf-8").splitlines())
        for path in sorted(package.rglob("*.py"))
    }


def report(lines: dict[str, int]) -> str:
    """Return lines and files by chapter, long files, full folders, and names that stand twice."""
    chapters: dict[str, list[int]] = defaultdict(list)
    folders: dict[str, list[str]] = defaultdict(list)
    homes: dict[str, list[str]] = defaultdict(list)
    for file, count in lines.items():
        chapters[file.split("/")[0] if "/" in file else "."].append(count)
        folder, _, name = file.rpartition("/")
        if name != "__init__.py":
            folders[folder or "."].append(name)
            homes[name].append(folder or ".")
    rows = [
        f"{name:14} {sum(found):6} lines {len(found):4} files" for name, found in chapters.items()
    ]
    rows.append(f"{'all':14} {sum(lines.values()):6} lines {len(lines):4} files")
    rows += [f"long file: {file}, {n} lines" for file, n in lines.items() if n > USUAL_LINES]
    rows += [
        f"full folder: {folder}, {len(names)} files"
        for folder, names in folders.items()
        if len(names) > USUAL_FILES
    ]
    rows += [
        f"one name, {len(found)} folders: {name} in {', '.join(found)}"
        for name, found in sorted(homes.items())
        if len(found) > 1
    ]
    return "\n".join(rows)


if __name__ == "__main__":
    print(report(lines_of_files()))  # noqa: T201
