"""Cases whose lateral collapse factor is known: ``clast study fos cases/push/NAME.toml --by pga``.

    python tools/push_cases.py            write the cases anew
    python tools/push_cases.py --table    find the factor of each, and print the table of the page

The arches, walls and columns are those of ``clast verify arch-push``, ``wall-push`` and
``tilt-table``; exact factors are those of limit analysis and of the tilt table there.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import clast
from clast.case.api import ModelBuilder
from clast.verification.problems.friction import tilt_table
from clast.verification.problems.masonry import arch_push, wall_push

FOLDER = Path(__file__).resolve().parents[1] / "cases" / "push"
TOLERANCE = 0.005
"""Width of the brackets of the table, as a share of their upper ends."""


@dataclass(frozen=True, kw_only=True)
class PushCase:
    """A case and the push over its weight at which it fails."""

    name: str
    """Name of its file, without ending."""
    words: str
    """What it is."""
    exact: float
    """Push over weight at collapse."""
    text: str
    """Its case file."""

    @property
    def file(self) -> Path:
        """Its case file."""
        return FOLDER / f"{self.name}.toml"


def cases() -> Iterator[PushCase]:
    """Give all cases."""
    arches = [*arch_push.ARCHES, *(replace(arch_push.OPPENHEIM, voussoirs=n) for n in (31, 63))]
    yield from map(_arch, arches)
    yield from map(_wall, wall_push.WALLS)
    yield from map(_column, tilt_table.WIDTHS)


def _arch(arch: arch_push.Arch) -> PushCase:
    share = f"{100 * arch.share:.0f}"
    name = f"arch-{arch.embrace:g}-t{share}-n{arch.voussoirs}-phi{arch.friction_angle:g}"
    words = (
        f"arch of {arch.embrace:g}°, t/R {arch.share:g}, {arch.voussoirs} voussoirs, "
        f"φ {arch.friction_angle:g}°"
    )
    builder = ModelBuilder(title=f"Push on an {words}", gravity=(0.0, -arch_push.GRAVITY))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=arch_push.DENSITY)
    builder.add_joint("default", friction_angle=arch.friction_angle)
    arch_push.add_arch(builder, arch)
    return _case(name.replace(".", "p"), words, arch_push.exact_factor(arch), builder)


def _wall(wall: wall_push.Wall) -> PushCase:
    words = f"wall of {wall.bricks} bricks × {wall.courses} courses, φ 40°, smooth head joints"
    builder = ModelBuilder(title=f"Push on a {words}", gravity=(0.0, -wall_push.GRAVITY))
    wall_push.add_wall(builder, wall)
    return _case(f"wall-{wall.bricks}x{wall.courses}", words, wall_push.exact_push(wall), builder)


def _column(width: float) -> PushCase:
    exact = math.tan(math.radians(tilt_table.exact_angle(width)))
    words = f"column of {width:g} m × 1 m, φ 25°"
    builder = ModelBuilder(title=f"Push on a {words}", gravity=(0.0, -tilt_table.GRAVITY))
    tilt_table.add_block(builder, width)
    return _case(f"column-{width:g}".replace(".", "p"), words, exact, builder)


def _case(name: str, words: str, exact: float, builder: ModelBuilder) -> PushCase:
    head = f"# {words[0].upper()}{words[1:]}; written by tools/push_cases.py.\n"
    head += f"# clast study fos cases/push/{name}.toml --by pga: {exact:.4f}\n\n"
    text = head + builder.to_toml(step=0.02, end=6.0)
    return PushCase(name=name, words=words, exact=exact, text=text)


def table() -> Iterator[str]:
    """Give the lines of the table: what is pushed, its file, both ends of the bracket, error."""
    yield "| pushed | case | exact | stands with | fails with | error |"
    yield "| --- | --- | --: | --: | --: | --: |"
    for one in cases():
        found = clast.collapse_load(one.file, "pga", tolerance=TOLERANCE)
        error = 100.0 * (found.value / one.exact - 1.0)
        numbers = f"{one.exact:.4f} | {found.low:.4f} | {found.high:.4f} | {error:+.2f} %"
        yield f"| {one.words} | `{one.name}` | {numbers} |"


def main() -> None:
    """Write the cases, or print the table."""
    if "--table" in sys.argv[1:]:
        for line in table():
            sys.stdout.write(f"{line}\n")
        return
    FOLDER.mkdir(exist_ok=True)
    for one in cases():
        one.file.write_text(one.text, encoding="utf-8")


if __name__ == "__main__":
    main()
