"""When to simulate and when to record, and where a run is."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Schedule:
    """When to simulate and when to record."""

    step: float
    """Wanted length of a step, s; shorter ones are used where max_displacement asks for it."""
    end: float
    """End of the run, s."""
    every: float
    """Time between frames, s."""
    smallest_step: float | None = None
    """A run stops where it would need a smaller step than this, s."""


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Where a run is; handed to ``watch`` after every accepted step."""

    time: float
    """Simulated time, s."""
    end: float
    """End of the run, s."""
    step: float
    """Length of the last step, s."""
    steps: int
    """Accepted steps so far."""
    contacts: int
    """Contacts of the last step."""
    penetration: float
    """Largest penetration of the last step, m."""
