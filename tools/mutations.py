"""Whether the core tests see a wrong sign: changes a formula at a time, and runs them.

    python tools/mutations.py                     all of them: half an hour to an hour
    python tools/mutations.py --every 5 --from 2  some of them
    python tools/mutations.py --only coulomb laws those of some files

A copy of the tree gets one changed sign or factor after the other; its core tests are run until one
fails.  First come the test files that import the changed module, those of its own chapter before
those of the chapters above, then the rest of its chapter, then the chapters above.  What no core
test finds is listed in the end: each needs a test.  Kernels are compiled anew for every change,
which takes most of the time.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COPIED = ("src", "tests", "tools", "benchmarks", "cases", "docs", "pyproject.toml", "README.md")
ABOVE = ("contact", "linear", "minimise", "actions", "step", "run", "case")
"""Chapters whose core tests are run after those of the changed one, in this order."""
LONGEST = 900.0
"""Wall time after which the tests of a change are given up, s."""


@dataclass(frozen=True)
class Mutation:
    """A wrong formula."""

    file: str
    """Below src/clast."""
    right: str
    """What stands there, once."""
    wrong: str
    """What is put in its place."""


MUTATIONS = (
    # water in joints: apertures, conductance, columns
    Mutation(
        "model/flow/apertures.py", "last**2 / (first + last)", "last**2 / (first + 2.0 * last)"
    ),
    Mutation("model/flow/apertures.py", "yy * z * z + 2.0 * xy", "yy * z * z - 2.0 * xy"),
    Mutation("model/flow/apertures.py", "rough.stiffness * rough.closure + s", "rough.closure + s"),
    Mutation("model/joints.py", "1e6 * aperture**2 / hydraulics", "1e6 * aperture / hydraulics"),
    Mutation("model/flow/pieces.py", "lacking > pressure[", "lacking > 0.5 * pressure["),
    Mutation("model/flow/pieces.py", "opened * problem.saturation", "opened * saturation"),
    Mutation("model/flow/path.py", "column[at] = 1.0, -1.0", "column[at] = 1.0, -0.5"),
    Mutation("actions/flow.py", "flow.weight * rise - down", "flow.weight * rise + down"),
    # block: displacement function, rotation, integrals, stress
    Mutation("block/displacement.py", "u0 - y * r0 + x * ex", "u0 + y * r0 + x * ex"),
    Mutation("block/displacement.py", "x * fy - y * fx, x * fx", "x * fy + y * fx, x * fx"),
    Mutation("block/displacement.py", "0.5 * y, u), 0.5 * x, v)", "0.5 * y, u), -0.5 * x, v)"),
    Mutation("block/displacement.py", "rr, ss = ayy - 2.0 * bxy", "rr, ss = ayy + 2.0 * bxy"),
    Mutation("block/displacement.py", "0.5 * (byy + cxy)", "0.5 * (byy - cxy)"),
    Mutation("block/rotation.py", "* exy - sine * ey", "* exy + sine * ey"),
    Mutation("block/rotation.py", "less + ex, exy - s", "less + ex, exy + s"),
    Mutation("block/equations.py", "sine**2 * yy - both", "sine**2 * yy + both"),
    Mutation("block/equations.py", "cosine * sine * (xx - yy)", "cosine * sine * (yy - xx)"),
    Mutation("block/polygon.py", "(2.0 * x1 * y1 + x1 * y2", "(x1 * y1 + x1 * y2"),
    Mutation("block/polygon.py", "triangle * (x1 + x2) / 3.0", "triangle * (x1 + x2) / 2.0"),
    Mutation("block/equations.py", "-= area[b] * stress[b, i]", "+= area[b] * stress[b, i]"),
    # contact: Coulomb's law, springs, rows, lengths, gaps
    Mutation("contact/coulomb.py", "normal * friction + cohesion", "normal * friction - cohesion"),
    Mutation("contact/coulomb.py", "shear_force - k * slip", "shear_force + k * slip"),
    Mutation("contact/coulomb.py", "bound * (size - bound) / k", "bound * (size + bound) / k"),
    Mutation("contact/coulomb.py", "        0.5 * t * t / k,", "        t * t / k,"),
    Mutation("contact/laws.py", "multiplier - p * gap[c]", "multiplier + p * gap[c]"),
    Mutation("contact/laws.py", "rest_force + multiplier", "rest_force - multiplier"),
    Mutation(
        "contact/laws.py", "n = trial if carries else -tension", "n = trial if carries else tension"
    ),
    Mutation("contact/clipped_spring.py", "(straight - 0.5 * force)", "(straight + 0.5 * force)"),
    Mutation(
        "contact/jacobian.py",
        "nx * u + ny * v, nx * v - ny * u",
        "nx * u + ny * v, nx * v + ny * u",
    ),
    Mutation("contact/jacobian.py", "(kn[c] - ks[c]) * nx * ny", "(kn[c] + ks[c]) * nx * ny"),
    Mutation("contact/joints/along_joint.py", "return 0.5 * (high - low)", "return high - low"),
    Mutation(
        "contact/joints/asperities.py",
        "flank = normal - kappa * along",
        "flank = normal + kappa * along",
    ),
    Mutation("contact/narrow_phase.py", "gap = rx * ty - ry * tx", "gap = ry * tx - rx * ty"),
    # linear: assembly, factor, what is out of balance
    Mutation(
        "linear/assembly.py",
        "s = plus_scaled(row(load, i), -1.0, times(base, i, d, i))",
        "s = plus_scaled(row(load, i), 1.0, times(base, i, d, i))",
    ),
    Mutation("linear/ldlt.py", "minus_column(blocks, q, a)", "minus_column(blocks, f, a)"),
    Mutation("linear/coarse_space.py", "u = -dy * turn + dx", "u = dy * turn + dx"),
    # minimise: energy, slope along a line, interior point
    Mutation("minimise/potential.py", "np.vdot(0.5 * bent - self", "np.vdot(bent - self"),
    Mutation(
        "minimise/line_search.py",
        "works[c] = n * opening + t * sliding",
        "works[c] = n * opening - t * sliding",
    ),
    Mutation("minimise/line_search.py", "start = -sums(products", "start = sums(products"),
    Mutation(
        "minimise/interior_point.py",
        "give = 1.0 / k[c] + (under / a",
        "give = 1.0 / k[c] - (under / a",
    ),
    # actions: bolts, pressures, dashpots, stress, supports
    Mutation(
        "actions/bolts.py",
        "(length - rest - state.plastic)",
        "(length - rest + state.plastic)",
    ),
    Mutation("actions/loads.py", "x * up - y * across", "x * up + y * across"),
    Mutation("actions/viscous_edges.py", "wave = 2.0 * below", "wave = below"),
    Mutation(
        "actions/in_situ.py", "xx * nx + xy * ny, xy * nx + yy", "xx * nx - xy * ny, xy * nx + yy"
    ),
    Mutation("actions/supports.py", "pull = -k * drift", "pull = k * drift"),
    # step: time scheme, energy balance
    Mutation(
        "step/integration.py", "return (1.0 - 1.0 / self.theta)", "return (1.0 / self.theta - 1.0)"
    ),
    Mutation("step/energy_balance.py", "s[5] -= area[b] * acting", "s[5] += area[b] * acting"),
    Mutation(
        "step/modified.py",
        "entered.normal_force - entered.normal_stiffness",
        "entered.normal_force + entered.normal_stiffness",
    ),
)


def mutated(text: str, mutation: Mutation) -> str:
    """Return the text of a file with the wrong formula; raises ValueError if it is not there."""
    if text.count(mutation.right) != 1:
        raise ValueError(f"{mutation.file}: {mutation.right!r} stands there not once")
    return text.replace(mutation.right, mutation.wrong)


def order_of_tests(mutation: Mutation, tests: Path) -> list[list[str]]:
    """Return what is run, group after group: files that import the module, chapter, those above."""
    chapter, stem = Path(mutation.file).parts[0], Path(mutation.file).stem
    dotted = ".".join(Path(mutation.file).with_suffix("").parts)
    package = ".".join(Path(mutation.file).parts[:-1])
    named = re.compile(rf"clast\.{dotted}\b|from clast\.{package} import .*\b{stem}\b")
    above = ABOVE[ABOVE.index(chapter) + 1 :] if chapter in ABOVE else ABOVE
    order = (chapter, *above)

    def rank(path: Path) -> tuple[int, Path]:
        of = path.relative_to(tests).parts[0]
        return order.index(of) if of in order else len(order), path

    near = [
        path
        for path in sorted(tests.rglob("test_*.py"), key=rank)
        if path.relative_to(tests).parts[0] not in ("system", "long")
        and named.search(path.read_text("utf-8"))
    ]
    groups = [[str(path) for path in near], [str(tests / chapter)]]
    groups += [[str(tests / one)] for one in above]
    return [group for group in groups if group]


def finder(mutation: Mutation, tree: Path) -> str:
    """Return the core test of a changed tree that fails first, "" where none does."""
    environment = {**os.environ, "PYTHONPATH": str(tree / "src"), "TESTS_DRAWN_BY": "mutations"}
    options = ["-x", "-q", "-m", "core", "--no-core-limit", "-p", "no:cacheprovider", "--tb=no"]
    until = time.monotonic() + LONGEST
    for paths in order_of_tests(mutation, tree / "tests"):
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *options, *paths],
            cwd=tree,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=max(1.0, until - time.monotonic()),
        )
        failed = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
        if failed:
            return failed[1]
        if done.returncode not in (0, 5):
            return "pytest itself"
    return ""


def copied(to: Path) -> Path:
    """Return a copy of the tree, with the times of its files, so that compiled kernels count."""
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "images")
            shutil.copytree(source, to / name, ignore=ignored)
        else:
            shutil.copy2(source, to / name)
    take_kernels(ROOT / "src", to / "src")
    return to


def take_kernels(source: Path, to: Path) -> None:
    """Copy the compiled kernels of a tree, which numba keeps by the place of their files."""
    for folder in source.rglob("__pycache__"):
        own, other = (
            hashlib.sha1(os.path.abspath(root).encode(), usedforsecurity=False).hexdigest()
            for root in (folder.parent, to / folder.parent.relative_to(source))
        )
        for kept in folder.glob(f"*/*_{own}"):
            name = kept.name.replace(own, other)
            shutil.copytree(kept, to / kept.parent.relative_to(source) / name, dirs_exist_ok=True)


def found_by(mutations: Sequence[Mutation], tree: Path) -> Iterator[tuple[Mutation, str, float]]:
    """Yield each change with the test that finds it, "" for none, and the wall time, s."""
    for mutation in mutations:
        path = tree / "src" / "clast" / mutation.file
        text, start = path.read_text("utf-8"), time.monotonic()
        written = path.stat()
        path.write_text(mutated(text, mutation), "utf-8")
        try:
            test = finder(mutation, tree)
        except subprocess.TimeoutExpired:
            test = ""
        finally:
            path.write_text(text, "utf-8")
            # numba compiles a file of another age anew
            os.utime(path, ns=(written.st_atime_ns, written.st_mtime_ns))
        yield mutation, test, time.monotonic() - start


def main() -> int:
    """Run the tool; return 1 where more than one change in twenty is not found."""
    parser = argparse.ArgumentParser(description="Whether the core tests see a wrong sign.")
    parser.add_argument("--every", type=int, default=1, help="one change in so many")
    parser.add_argument("--from", type=int, default=0, dest="first", help="the first, from 0")
    parser.add_argument("--only", nargs="*", default=[], help="parts of names of files")
    given = parser.parse_args()
    chosen = [
        one
        for one in MUTATIONS[given.first :: given.every]
        if not given.only or any(part in one.file for part in given.only)
    ]
    missed = []
    with tempfile.TemporaryDirectory() as folder:
        for mutation, test, seconds in found_by(chosen, copied(Path(folder))):
            told = test or "NOT FOUND"
            sys.stdout.write(
                f"{seconds:6.0f} s  {mutation.file}: {mutation.wrong}\n          {told}\n"
            )
            sys.stdout.flush()
            missed += [] if test else [mutation]
    sys.stdout.write(f"found: {len(chosen) - len(missed)} of {len(chosen)}\n")
    return int(20 * len(missed) > len(chosen))


if __name__ == "__main__":
    sys.exit(main())
