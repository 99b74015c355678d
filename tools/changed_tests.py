"""Runs the core tests of the chapters that changed, and of those above that use them.

    python tools/changed_tests.py             since the branch left main, with what is not committed
    python tools/changed_tests.py HEAD~3      since another commit
    python tools/changed_tests.py -- -x -q    arguments of pytest follow the two dashes
    python tools/changed_tests.py --list      says what it would run

A chapter is a folder of src/clast; those above it are the ones that may import it, by the layers in
pyproject.toml.  Test files that changed themselves are run whatever their tier.  What belongs to no
chapter (pyproject.toml, what tests share) makes all core tests run.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
EVERYTHING = {"pyproject.toml", "constraints.txt", "tests/conftest.py"}
"""Files on which all tests depend."""


@dataclass(frozen=True)
class Selection:
    """What is run."""

    core: tuple[str, ...]
    """Folders and files of which the core tests are run."""
    whole: tuple[str, ...]
    """Test files that changed, of which every test is run."""


def layers() -> list[set[str]]:
    """Return the chapters by layers, from the highest to the lowest."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    lines = next(one["layers"] for one in contracts if one["type"] == "layers")
    return [set(re.findall(r"\w+", line)) for line in lines]


def above(chapters: Iterable[str], order: Sequence[set[str]]) -> set[str]:
    """Return the chapters, and all in layers above them."""
    found = set(chapters)
    for number, layer in enumerate(order):
        if layer & found:
            found.update(*order[:number])
    return found


def changed_files(since: str) -> list[str]:
    """Return the files that differ from where this branch left ``since``, untracked ones too."""
    base = _git("merge-base", since, "HEAD")
    known = _git("diff", "--name-only", base[0] if base else since)
    return sorted({*known, *_git("ls-files", "--others", "--exclude-standard")})


def selection(files: Iterable[str], order: Sequence[set[str]]) -> Selection:
    """Return what is to be run after a change of these files."""
    chapters: set[str] = set()
    tests = set()
    for name in files:
        parts = Path(name).parts
        if name in EVERYTHING or name.startswith("tests/scenes/"):
            return Selection(core=("tests",), whole=())
        if parts[:2] == ("src", "clast"):
            chapters.add(Path(parts[2]).stem)
        if parts[0] == "tests" and parts[-1].startswith("test_") and (ROOT / name).exists():
            tests.add(name)
        if parts[0] in ("docs", "tools", "benchmarks"):
            chapters.add(parts[0])
    folders = {f"tests/{one}" for one in above(chapters, order) if (ROOT / "tests" / one).is_dir()}
    alone = {"tests/test_house.py"} if chapters else set()
    return Selection(core=tuple(sorted(folders | alone)), whole=tuple(sorted(tests)))


def _git(*arguments: str) -> list[str]:
    done = subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return done.stdout.split("\n")[:-1] if done.returncode == 0 else []


def main(arguments: Sequence[str]) -> int:
    """Run the tests; return the exit status of pytest, 0 where there is nothing to run."""
    cut = list(arguments).index("--") if "--" in arguments else len(arguments)
    own, given = list(arguments[:cut]), list(arguments[cut + 1 :])
    listed = "--list" in own
    since = next((one for one in own if one != "--list"), "main")
    chosen = selection(changed_files(since), layers())
    status = 0
    for paths, marker in ((chosen.core, ["-m", "core"]), (chosen.whole, [])):
        if not paths:
            continue
        sys.stdout.write(f"{'core tests of' if marker else 'changed'}: {' '.join(paths)}\n")
        sys.stdout.flush()
        if not listed:
            command = [sys.executable, "-m", "pytest", *marker, *given, *paths]
            code = subprocess.run(command, cwd=ROOT, check=False).returncode
            status = status or (0 if code == 5 else code)  # 5: no core test is there
    if not (chosen.core or chosen.whole):
        sys.stdout.write(f"nothing that tests look at has changed since {since}\n")
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
