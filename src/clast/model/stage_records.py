"""Records of stages: how each of them ended, and the events with their times."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

REACHED, MOVING, TIME_OVER, BROKEN_OFF = "equilibrium", "moving", "time over", "broken off"
"""How a stage ends: in equilibrium, at its limit while blocks move, after its time, or not."""
FAILS = "fails"
"""How a static stage ends that has no equilibrium."""
BLOCKS_NAMED_MAX = 5
"""Blocks of a mechanism that are named one by one."""


@dataclass(frozen=True, kw_only=True)
class Mover:
    """The block that moved most in a step, against the limit of equilibrium."""

    block: str = ""
    """Its name; "" where no block can move."""
    speed: float = 0.0
    """Largest speed of a point of it, m/s."""
    direction: float = 0.0
    """Direction in which it moved, degrees counter-clockwise from +x, -180 to 180."""

    def __str__(self) -> str:
        if self.speed == 0.0:
            return "no block"
        return f"block '{self.block}' at {self.speed:.3g} m/s, {towards(self.direction)}"


def towards(direction: float) -> str:
    """Return a direction, degrees from +x, in words: "57 degrees below +x", "downwards"."""
    if abs(abs(direction) - 90.0) < 0.5:
        return "upwards" if direction > 0.0 else "downwards"
    side = "-x" if abs(direction) > 90.0 else "+x"
    steep = 180.0 - abs(direction) if side == "-x" else abs(direction)
    if steep < 0.5:
        return f"towards {side}"
    return f"{steep:.0f} degrees {'above' if direction > 0.0 else 'below'} {side}"


@dataclass(frozen=True, kw_only=True)
class Mechanism:
    """How blocks move that have no equilibrium."""

    blocks: tuple[str, ...]
    """Names of the blocks that move, the one that moves most first; empty: none goes anywhere."""
    mover: Mover
    """The one that moves most, and in which direction."""
    moved: float
    """How far it has moved since the last balance, m."""
    steps: int
    """Steps since then."""
    hindrance: str
    """The condition of equilibrium that fails, with block and number."""
    load: float = 1.0
    """Share of weight, stress and loads that had come on."""
    advice: str = ""
    """The remedy where the verdict may be wrong; "" where it is not in doubt."""

    def __str__(self) -> str:
        return f"{self._how()}. {self.advice}" if self.advice else self._how()

    def _how(self) -> str:
        if not self.blocks:
            return f"no equilibrium{self._under()} in {self.steps} steps: {self.hindrance}"
        named = ", ".join(f"'{name}'" for name in self.blocks[:BLOCKS_NAMED_MAX])
        more = len(self.blocks) - BLOCKS_NAMED_MAX
        which = f"blocks {named}" if len(self.blocks) > 1 else f"block {named}"
        which += f" and {more} more" if more > 0 else ""
        many = len(self.blocks) > 1
        moves = f"move, most of all '{self.mover.block}'," if many else "moves"
        return (
            f"no equilibrium{self._under()}: {which} {moves} "
            f"{towards(self.mover.direction)} by {self.moved:.3g} m in {self.steps} steps"
        )

    def _under(self) -> str:
        """Return the share of the load without equilibrium, "" for all of it."""
        return "" if self.load == 1.0 else f" under {100.0 * self.load:.3g} % of the load"


@dataclass(frozen=True, kw_only=True)
class StageRecord:
    """How a stage went."""

    name: str
    """Its name."""
    start: float
    """Time at which it began, s."""
    end: float
    """Time at which it ended, s."""
    steps: int
    """Accepted steps in it."""
    outcome: str
    """"equilibrium", "fails", "moving", "time over" or "broken off"."""
    force_ratio: float
    """Largest unbalanced force on a block at its end, as a share of all forces on it."""
    mover: Mover
    """Block that moved most in its last step."""
    seconds: float
    """Wall time, s."""
    hindrance: str = ""
    """The condition of equilibrium that failed in its last step, with block and number; "" where
    none."""
    broken: int = 0
    """Bonds that broke in it."""
    mechanism: tuple[str, ...] = ()
    """Blocks that move where it fails, the one that moves most first."""
    reset: tuple[tuple[float, float], ...] = ()
    """New zero of the displacements of measured points, m, where the stage reset them."""
    branch: str = ""
    """That more than one path went on in a static stage, and which was followed; "" where not."""

    def __str__(self) -> str:
        branch = f"; {self.branch}" if self.branch else ""
        return (
            f"{self.name}: {self.outcome} at t = {self.end:.6g} s after {self.steps} steps, "
            f"unbalanced force {self.force_ratio:.2g}, {self.mover}{branch}"
        )


@dataclass(frozen=True, kw_only=True)
class Event:
    """Something that happened in a run."""

    time: float
    """When, s."""
    stage: str
    """In which stage; "" in a run without stages."""
    kind: str
    """The kind of the thing, e.g. "excavated"."""
    what: str
    """Name of the thing that it happened to."""
    text: str
    """The event, in words."""
    block: int = -1
    """Block that left the model; -1: none."""
    mass: float = 0.0
    """Its mass, kg/m."""

    def __str__(self) -> str:
        return f"{self.time:.6g} s: {self.text}"


DRAWN = "drawn"
"""Kind of the event of a block that leaves at a drawpoint."""


def counted_from(records: Sequence[StageRecord], point: int, time: float) -> tuple[float, float]:
    """Return how far a measured point had moved, m, where its displacements at a time count from.

    ``point`` is its number; nothing where no stage before the ``time``, s, has reset them.
    """
    resets = [one.reset for one in records if one.reset and one.end < time]
    return resets[-1][point] if resets else (0.0, 0.0)


def record_from(plain: Mapping[str, Any]) -> StageRecord:
    """Return the record of a stage that was written as plain data."""
    mover = Mover(**plain["mover"])
    reset = tuple((float(x), float(y)) for x, y in plain.get("reset", ()))
    mechanism = tuple(plain.get("mechanism", ()))
    return StageRecord(**{**plain, "mover": mover, "reset": reset, "mechanism": mechanism})


def records_from(plain: Iterable[Mapping[str, Any]]) -> tuple[StageRecord, ...]:
    """Return the records of stages that were written as plain data."""
    return tuple(record_from(one) for one in plain)


def events_from(plain: Iterable[Mapping[str, Any]]) -> tuple[Event, ...]:
    """Return the events that were written as plain data."""
    return tuple(Event(**one) for one in plain)
