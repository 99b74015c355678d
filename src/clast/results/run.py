"""What a finished run hands back: histories, energies, a report and the last state."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from clast import spelling
from clast.errors import CaseError
from clast.model import Floats, Model
from clast.state import Ledger, Overlap, State


@dataclass(frozen=True, kw_only=True)
class PointHistory:
    """How one measured point moved, at the start and after every step; t instants."""

    time: Floats
    """Time, s, shape (t,)."""
    displacement: Floats
    """Displacement (x, y) since the start, m, shape (t, 2)."""
    velocity: Floats
    """Velocity (x, y) of the point, m/s, shape (t, 2)."""
    rotation: Floats
    """Rotation of the point's block since the start, rad, counter-clockwise, shape (t,)."""


@dataclass(frozen=True, kw_only=True)
class Report:
    """How a run went."""

    finished: bool
    """True where the run reached its end."""
    outcome: str
    """How the run ended, in words, with advice where it could not go on."""
    steps: int
    """Accepted steps."""
    passes: int
    """Assemblies and solves in the accepted steps."""
    cut_steps: int
    """Steps that were tried again with a smaller step."""
    largest_contacts: int
    """Largest number of contacts in a step."""
    largest_penetration: float
    """Largest penetration at the end of a step, m."""
    ledger: Ledger
    """Energy ledger at the end."""
    wall_seconds: float
    """Time that the run took, s of wall clock."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall clock per stage of the step, s."""
    warnings: tuple[str, ...] = ()
    """Warnings given before the run, and by what was measured in it."""
    overlaps: tuple[Overlap, ...] = ()
    """Blocks that overlapped in a frame deeper than their contacts knew, each pair's worst."""
    notes: tuple[str, ...] = ()
    """What was chosen automatically, and why."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Sums over the accepted steps of what the process counts: passes, line searches, ..."""

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain numbers and texts, ready for JSON."""
        plain = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        plain["ledger"] = dataclasses.asdict(self.ledger)
        plain["seconds"] = dict(self.seconds)
        plain["counts"] = dict(self.counts)
        plain["warnings"] = list(self.warnings)
        plain["overlaps"] = [dataclasses.asdict(one) for one in self.overlaps]
        plain["notes"] = list(self.notes)
        return plain


def report_from_dict(plain: Mapping[str, Any]) -> Report:
    """Return the report that :meth:`Report.as_dict` gave."""
    known = {f.name for f in dataclasses.fields(Report)}
    entries = {name: value for name, value in plain.items() if name in known}
    ledger = {f.name for f in dataclasses.fields(Ledger)}
    entries["ledger"] = Ledger(**{k: v for k, v in plain["ledger"].items() if k in ledger})
    entries["warnings"] = tuple(plain["warnings"])
    entries["notes"] = tuple(plain.get("notes", ()))
    entries["overlaps"] = tuple(
        Overlap(**{**one, "blocks": tuple(one["blocks"])}) for one in plain.get("overlaps", ())
    )
    return Report(**entries)


@dataclass(frozen=True, kw_only=True)
class Run:
    """What a run computed."""

    model: Model
    """What was simulated."""
    state: State
    """State at the end, relative to the model's origin (see ``final``)."""
    report: Report
    """How the run went."""
    output: Path | None
    """Result file, or None where nothing was written."""
    point_rows: NDArray[Any]
    """Measured points, a row per instant: time, displacement, velocity, rotation by point."""
    energy_rows: NDArray[Any]
    """Energy ledger, a row per instant: time and every entry of the ledger."""
    step_rows: NDArray[Any]
    """Accepted steps, a row each: time at its end, size, passes, contacts, penetration, travel."""

    @property
    def final(self) -> State:
        """State at the end in user coordinates: the model's origin is added."""
        origin = self.model.origin
        return dataclasses.replace(
            self.state, vertices=self.state.vertices + origin, points=self.state.points + origin
        )

    def history(self, name: str) -> PointHistory:
        """Return the history of the measured point ``name``."""
        names = self.model.measured_points.name
        if name not in names:
            raise unknown_name("measured point", name, names)
        return point_history(self.point_rows, names.index(name))

    @property
    def energy(self) -> dict[str, Floats]:
        """Energy ledger over time: ``time``, s, and every entry, J per m, each of shape (t,)."""
        return columns(self.energy_rows)

    @property
    def step_sizes(self) -> Floats:
        """Size of every accepted step, s, shape (steps,)."""
        sizes: Floats = self.step_rows["step"]
        return sizes


def point_history(rows: NDArray[Any], point: int) -> PointHistory:
    """Return the history of one point from the rows of all points."""
    return PointHistory(
        time=rows["time"],
        displacement=rows["displacement"][:, point],
        velocity=rows["velocity"][:, point],
        rotation=rows["rotation"][:, point],
    )


def columns(rows: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Return the columns of a table by name."""
    return {name: rows[name] for name in rows.dtype.names or ()}


def unknown_name(kind: str, name: str, known: Sequence[str]) -> CaseError:
    """Return the error for a name that does not exist, with the nearest one that does."""
    return CaseError(f"there is no {kind} '{name}'", remedy=spelling.advice(name, known, kind=kind))
