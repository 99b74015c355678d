"""Supports, loads and measured points of a script, or of a case file, before they are checked."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from clast.errors import shortened
from clast.inputs.declaring.table import Inputs
from clast.inputs.placing.blocks import Vector
from clast.inputs.placing.openings import OpeningEntry
from clast.inputs.placing.points import Place
from clast.inputs.placing.pressures import LinePressure
from clast.inputs.placing.water import WaterEntry
from clast.model.factors import Factor, checked_factor
from clast.model.model import Floats

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from clast.inputs.placing.water import WaterKeys
from clast.model.value_checks import check_name, check_text


@dataclass(kw_only=True)
class SupportsAndLoads(Inputs):
    """What holds blocks, acts on them and is measured of them: a part of ``ModelBuilder``."""

    _fixed_points: list[Place] = field(default_factory=list, init=False)
    _point_loads: list[Place] = field(default_factory=list, init=False)
    _line_loads: list[Place] = field(default_factory=list, init=False)
    _pressures: list[LinePressure] = field(default_factory=list, init=False)
    _waters: list[WaterEntry] = field(default_factory=list, init=False)
    _factors: list[Factor] = field(default_factory=list, init=False)
    _measured_points: list[Place] = field(default_factory=list, init=False)
    _measured_names: list[str] = field(default_factory=list, init=False)
    opening_outlines: dict[str, Floats] = field(default_factory=dict, init=False)
    """Outlines of openings by name, counter-clockwise, m, (c, 2) each: for patterns of bolts."""
    _openings: list[OpeningEntry] = field(default_factory=list, init=False)

    def fixed_point(self, at: Vector, block: str | None = None) -> None:
        """Hold a point (x, y), m, of a block in place with a stiff spring."""
        label = f"fixed point {len(self._fixed_points) + 1}"
        self._fixed_points.append(Place(label, at, block))

    def add_table(self, name: str, time: Any, value: Any) -> str:
        """Add a factor of loads over time and return its name: instants, s, values, - (k,) each.

        It is linear between the instants and constant before and after them.
        """
        self._factors.append(checked_factor(name, time, value))
        return name

    def point_load(
        self,
        at: Vector,
        force: Vector,
        block: str | None = None,
        factor: str | None = None,
        name: str | None = None,
    ) -> None:
        """Apply a force (x, y), N per metre of thickness, at a point, m, of a block.

        ``factor`` names a table by whose value at the end of each step the force is multiplied;
        ``name`` is that by which stages refer to it, and to others of the same name.
        """
        label = f"point load {len(self._point_loads) + 1}"
        self._point_loads.append(
            Place(label, at, block, load=force, factor=factor, name=_name_of(name, label))
        )

    def line_load(
        self,
        start: Vector,
        end: Vector,
        traction: Vector,
        block: str | None = None,
        factor: str | None = None,
        name: str | None = None,
    ) -> None:
        """Apply a traction (x, y), N/m per metre of thickness, along a line of a block.

        ``start`` and ``end`` (x, y) in m; ``factor`` and ``name`` as for point loads.
        """
        label = f"line load {len(self._line_loads) + 1}"
        named = _name_of(name, label)
        self._line_loads.append(
            Place(label, start, block, end=end, load=traction, factor=factor, name=named)
        )

    def pressure(
        self,
        start: Vector,
        end: Vector,
        value: float | Vector,
        block: str | None = None,
        factor: str | None = None,
        name: str | None = None,
    ) -> None:
        """Press on the edges along a straight line, normal to them as they turn with their blocks.

        ``value`` is one pressure, Pa, or that at ``start`` and at ``end`` (x, y), m, positive into
        the blocks.  ``block`` is needed where edges of two blocks meet; ``factor`` and
        ``name`` as above.
        """
        label = f"pressure {len(self._pressures) + 1}"
        self._pressures.append(
            LinePressure(
                label=label,
                start=start,
                end=end,
                value=value,
                block=block,
                factor=factor,
                name=_name_of(name, label),
            )
        )

    def water(
        self,
        level: float | None = None,
        *,
        line: Sequence[Vector] | Floats | None = None,
        acts_on: str = "both",
        name: str | None = None,
        **keys: Unpack[WaterKeys],
    ) -> None:
        """Let water press on what lies below a level y, m, or a phreatic line of points (x, y), m.

        ``acts_on`` is "faces": edges that no other block covers; "joints": both faces of where
        blocks lie along each other; or "both".  The pressure is rho g times the depth, times
        ``factor``: a share of the full head, 0 to 1, or the name of a table of such shares.
        ``density`` in kg/m3 (1000); ``joints`` names those that it gets into (all); at points
        ``drained_at`` of joints there is no pressure, and along the joints it falls towards them;
        ``wetted`` is "open-and-closed", or "closed": joints that open lose their water.
        """
        label = f"water {len(self._waters) + 1}"
        self._waters.append(
            WaterEntry(label=label, name=name, level=level, line=line, acts_on=acts_on, keys=keys)
        )

    def measured_point(self, name: str, at: Vector, block: str | None = None) -> None:
        """Record displacement, velocity and rotation of a point (x, y), m, of a block, every step.

        ``block`` names the block of a point; it may be left out where only one is there.
        """
        self._measured_names.append(name)
        self._measured_points.append(Place(f"measured point '{shortened(str(name))}'", at, block))

    def opening(self, name: str, blocks: Iterable[str], weld: str | None = None) -> str:
        """Let stages excavate ``blocks`` (their names) together under a name; return this.

        ``weld`` names a joint (``add_weld``): the edges that have it hold together what is inside
        and outside until the opening is excavated, and then have no joint of their own any more.
        """
        names = (blocks,) if isinstance(blocks, str) else tuple(map(str, blocks))
        self._openings.append(OpeningEntry(str(name), names, weld))
        return str(name)


def _name_of(name: str | None, label: str) -> str:
    """Return the name of a load, "" where it has none; refuse names that are none."""
    if name is not None:
        check_text(check_name(name, label.rsplit(" ", 1)[0], label), label)
    return name or ""
