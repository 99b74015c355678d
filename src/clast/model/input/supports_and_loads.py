"""Supports, loads and measured points of a script, or of a case file, before they are checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from clast.errors import shortened
from clast.model.factors import Factor, checked_factor
from clast.model.input.blocks import Vector
from clast.model.input.points import Place
from clast.model.input.pressures import LinePressure
from clast.model.input.water import WaterEntry
from clast.model.model import Floats

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from clast.model.input.water import WaterKeys


@dataclass(kw_only=True)
class SupportsAndLoads:
    """What holds blocks, acts on them and is measured of them: a part of ``ModelBuilder``."""

    _fixed_points: list[Place] = field(default_factory=list, init=False)
    _point_loads: list[Place] = field(default_factory=list, init=False)
    _line_loads: list[Place] = field(default_factory=list, init=False)
    _pressures: list[LinePressure] = field(default_factory=list, init=False)
    _waters: list[WaterEntry] = field(default_factory=list, init=False)
    _factors: list[Factor] = field(default_factory=list, init=False)
    _measured_points: list[Place] = field(default_factory=list, init=False)
    _measured_names: list[str] = field(default_factory=list, init=False)

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
        self, at: Vector, force: Vector, block: str | None = None, factor: str | None = None
    ) -> None:
        """Apply a force (x, y), N per metre of thickness, at a point, m, of a block.

        ``factor`` names a table by whose value at the end of each step the force is multiplied.
        """
        label = f"point load {len(self._point_loads) + 1}"
        self._point_loads.append(Place(label, at, block, load=force, factor=factor))

    def line_load(
        self,
        start: Vector,
        end: Vector,
        traction: Vector,
        block: str | None = None,
        factor: str | None = None,
    ) -> None:
        """Apply a traction (x, y), N/m per metre of thickness, along a line of a block.

        ``start`` and ``end`` (x, y) in m; ``factor`` as for point loads.
        """
        label = f"line load {len(self._line_loads) + 1}"
        self._line_loads.append(Place(label, start, block, end=end, load=traction, factor=factor))

    def pressure(
        self,
        start: Vector,
        end: Vector,
        value: float | Vector,
        block: str | None = None,
        factor: str | None = None,
    ) -> None:
        """Press on the edges along a straight line, normal to them as they turn with their blocks.

        ``value`` is one pressure, Pa, or that at ``start`` and at ``end`` (x, y), m, positive into
        the blocks.  ``block`` is needed where edges of two blocks meet; ``factor`` as above.
        """
        label = f"pressure {len(self._pressures) + 1}"
        self._pressures.append(
            LinePressure(label=label, start=start, end=end, value=value, block=block, factor=factor)
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
