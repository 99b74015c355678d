"""[ground_motion]: an earthquake or a shaking table."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import StrictStr, model_validator

from clast.case.choices import Number, within
from clast.case.faults import Fault, refusal
from clast.case.tables.record import read_record
from clast.case.tables.table import Acceleration, Instant, Table
from clast.errors import shortened
from clast.model import ranges
from clast.model.builder import ModelBuilder
from clast.model.ground_motion import Accelerogram, GroundMotion, InertialForce, MovingBase

GROUND_MOTIONS: dict[str, type[InertialForce] | type[MovingBase]] = {
    "body-force": InertialForce,
    "base": MovingBase,
}
OTHER_UNIT = 5.0
"""A scale that is off by more than this factor belongs to another unit."""


class GroundMotionTable(Table):
    """An accelerogram, linear between its instants, and how it reaches the blocks.

    The ground starts from rest.  After the last instant it has no acceleration, and keeps the
    velocity that it then has.
    """

    acts: Literal["body-force", "base"]
    """"body-force": minus the acceleration on the mass of every block, motion is relative to the
    ground; "base": the fixed points move with the ground.  Fixed blocks do not move: a base that
    moves is held by fixed points."""
    file: StrictStr | None = None
    """Text file beside the case file, with columns t, ax and, if wanted, ay; instead of lists."""
    time: list[Instant] | None = None
    """Instants, s, rising."""
    acceleration: list[Acceleration] | None = None
    """Horizontal acceleration of the ground at the instants, m/s2, to the right."""
    vertical: list[Acceleration] | None = None
    """Vertical acceleration of the ground at the instants, m/s2, upwards; none if absent."""
    scale: Annotated[Number, within(ranges.FACTOR)] = 1.0
    """Factor on all accelerations: 9.81 for a record in g."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        lists = {"time": self.time, "acceleration": self.acceleration, "vertical": self.vertical}
        given = {key: len(values) for key, values in lists.items() if values is not None}
        if self.file is not None and given:
            remedy = "name the file, or give the lists"
            raise refusal(Fault(place=("file",), what="there are lists as well", remedy=remedy))
        if self.file is None and not {"time", "acceleration"} <= set(given):
            remedy = 'give file = "record.csv", or time = [...] and acceleration = [...]'
            raise refusal(Fault(what="there is no accelerogram", remedy=remedy))
        if len(set(given.values())) > 1:
            counted = ", ".join(f"{key} {count}" for key, count in given.items())
            remedy = "give as many numbers in each list"
            raise refusal(Fault(what=f"the lists differ in length: {counted}", remedy=remedy))
        return self

    def motion(self, folder: Path) -> GroundMotion:
        """Return the ground motion; a file is looked for in ``folder``."""
        if self.file is not None:
            record = read_record(folder / self.file)
            time, acceleration = record.time, record.acceleration
        else:
            time = np.array(self.time, np.float64)
            horizontal = np.array(self.acceleration, np.float64)
            vertical = np.zeros(len(time)) if self.vertical is None else np.array(self.vertical)
            acceleration = np.stack([horizontal, vertical], axis=1)
        return GROUND_MOTIONS[self.acts](Accelerogram(time, self.scale * acceleration))

    def add_to(self, builder: ModelBuilder, key: str, folder: Path) -> None:
        """Let the ground move."""
        builder.ground_motion = self.motion(folder)

    def remarks(self, folder: Path) -> Iterator[str]:
        """Say where the unit that a record's heading names contradicts the scale."""
        unit = read_record(folder / self.file).unit if self.file is not None else None
        if unit is None:
            return
        name, size = unit
        if not size / OTHER_UNIT <= abs(self.scale) <= size * OTHER_UNIT:
            yield (
                f"[ground_motion] scale is {self.scale:g}, but the heading of "
                f"{shortened(str(self.file))} says that accelerations are in {name}: give scale = "
                f"{size:g} if they are"
            )
