"""Repairs to blocks as they were drawn, so that they touch."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Repair:
    """Something that was done to blocks as they were drawn, so that they touch."""

    what: str
    """The repair, in words."""
    count: int
    """How often."""
    places: tuple[tuple[float, float], ...]
    """The first places, m."""

    def __str__(self) -> str:
        places = ", ".join(f"({x:.9g}, {y:.9g})" for x, y in self.places)
        more = ", ..." if self.count > len(self.places) else ""
        return f"{self.count} {self.what}: {places}{more}"
