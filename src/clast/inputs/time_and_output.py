"""[time] and [output]: times to simulate and results to keep."""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, StrictBool, model_validator

from clast.inputs.declaring.alternatives import Number
from clast.inputs.declaring.table import Interval, Length, Positive, Table
from clast.inputs.declaring.validation_messages import Fault, refusal
from clast.model import ranges
from clast.model.model import Model

SECONDS_OF_A_STEP = 1e-5
"""Wall time of a step that none falls below, s."""
TRAVEL_SHARE = 0.05
"""Default max_displacement, as a share of the size (square root of area) of the smallest block."""
FRAMES = 100
"""Frames of a run that does not say how many it wants."""


class TimeTable(Table):
    """Duration and time step."""

    step: Interval
    """Length of a step, s; shorter steps are used where max_displacement requires them."""
    end: Positive
    """End of the run, s; with [[stage]] the time limit of stages that give none."""
    max_displacement: Length | None = None
    """Largest movement of a vertex in a step against blocks that it might touch, m; 5 % of the size
    (square root of the area) of the smallest block if absent."""
    dynamic_ratio: Annotated[Number, Field(ge=0.0, le=1.0)] = 1.0
    """Share of velocity carried to the next step: 0 static, 1 dynamic."""
    smallest_step: Interval | None = None
    """The run stops where it would need a smaller step than this, s."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        steps = min(self.end / self.step, 1e300)
        if steps > ranges.MOST_STEPS:
            raise refusal(
                Fault(
                    place=("end",),
                    what=f"{self.end:g} s are {steps:.3g} steps of {self.step:g} s: more than "
                    f"{steps * SECONDS_OF_A_STEP / 3600.0:.2g} hours",
                    remedy="lower end, or raise step",
                )
            )
        if self.step > self.end:
            raise refusal(
                Fault(
                    place=("step",),
                    what=f"{self.step:g} s is longer than the whole run of {self.end:g} s",
                    remedy="lower step, or raise end",
                )
            )
        if self.smallest_step is not None and self.smallest_step > self.step:
            raise refusal(
                Fault(
                    place=("smallest_step",),
                    what=f"{self.smallest_step:g} s is longer than step, {self.step:g} s",
                    remedy="lower it below step, or leave it out",
                )
            )
        return self

    def largest_movement(self, model: Model) -> float:
        """Return max_displacement, m, or its default for the blocks of a model."""
        return self.max_displacement or TRAVEL_SHARE * float(np.sqrt(model.smallest))


class OutputTable(Table):
    """Output of the run."""

    every: Interval | None = None
    """Time between frames, s; a hundredth of the run, or a step, if absent."""
    contacts: StrictBool = True
    """True: contact forces are kept in every frame."""
    checkpoint_every: Interval | None = None
    """Wall time between checkpoints, s, from which ``clast resume`` continues; if absent, one is
    written when a run ends early."""

    def interval(self, step: float, end: float) -> float:
        """Return the time between frames, s, of a run to ``end``, s, in steps of ``step``, s."""
        return self.every or max(step, end / FRAMES)
