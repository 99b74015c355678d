"""Counts of a run, added up step by step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from clast.step.method import StepResult

Number = TypeVar("Number", int, float)


@dataclass(frozen=True, kw_only=True)
class Tally:
    """Counts of a run so far."""

    steps: int = 0
    """Accepted steps."""
    passes: int = 0
    """Assemblies and solves."""
    cut_steps: int = 0
    """Steps that were rejected and tried again with a shorter one."""
    contacts: int = 0
    """Largest number of contacts in a step."""
    penetration: float = 0.0
    """Largest penetration, m."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall time of each stage of the steps, s."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """What the process counted."""

    def with_step(self, result: StepResult, cuts: int = 0) -> Tally:
        """Return the counts with those of an accepted step, and of the ``cuts`` before it."""
        return Tally(
            steps=self.steps + 1,
            passes=self.passes + result.passes,
            cut_steps=self.cut_steps + cuts,
            contacts=max(self.contacts, len(result.contacts)),
            penetration=max(self.penetration, result.penetration),
            seconds=_added(self.seconds, result.seconds),
            counts=_added(self.counts, result.counts),
        )


def _added(before: Mapping[str, Number], new: Mapping[str, Number]) -> dict[str, Number]:
    """Return the sums of what has the same name."""
    sums = {**before}
    for name in new:
        sums[name] = sums[name] + new[name] if name in sums else new[name]
    return sums
