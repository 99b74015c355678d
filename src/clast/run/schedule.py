"""When to simulate and when to record, and where a run is."""

from __future__ import annotations

import math
from dataclasses import dataclass

from clast.model.stages import Stage


@dataclass(frozen=True, kw_only=True)
class Schedule:
    """When to simulate and when to record."""

    step: float
    """Wanted length of a step, s; shorter ones are used where max_displacement asks for it."""
    end: float
    """End of the run, s; with stages the longest time of one that gives none."""
    every: float
    """Time between frames, s."""
    smallest_step: float | None = None
    """A run stops where it would need a smaller step than this, s."""
    stages: tuple[Stage, ...] = ()
    """Stages of the run; none: it goes to its end in one."""

    @property
    def latest(self) -> float:
        """Time at which the run is over at the latest, s."""
        if not self.stages:
            return self.end
        return sum(stage.time or self.end for stage in self.stages)

    @property
    def steps(self) -> int:
        """Steps that the run takes at most if none is cut."""
        if not self.stages:
            return math.ceil(self.end / self.step - 1e-9)
        parts = ((stage.time or self.end) / (stage.step or self.step) for stage in self.stages)
        return sum(math.ceil(part - 1e-9) for part in parts)

    @property
    def of_motion(self) -> tuple[float, float]:
        """Longest step and length of the run, or of its stages, in which the ground moves, s."""
        shaken = [stage for stage in self.stages if stage.ground_motion]
        if not shaken:
            return self.step, self.latest
        return (
            max(stage.step or self.step for stage in shaken),
            max(stage.time or self.end for stage in shaken),
        )


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Where a run is; handed to ``watch`` after every accepted step."""

    time: float
    """Simulated time, s."""
    end: float
    """End of the run, or of its stage at the latest, s."""
    step: float
    """Length of the last step, or before the first of that to come, s."""
    steps: int
    """Accepted steps so far."""
    contacts: int
    """Contacts of the last step."""
    penetration: float
    """Largest penetration of the last step, m."""
    stage: str = ""
    """Name of the stage, "" in a run without stages."""
    start: float = 0.0
    """Start of the run, or of its stage, s."""
    force_ratio: float | None = None
    """Largest unbalanced force on a block, as a share of all forces on it; None without stages."""
    speed: float | None = None
    """Largest speed of a block, m/s; None without stages."""
