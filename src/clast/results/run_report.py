"""How a run went: counts, ledger, warnings, and how it ended."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from clast.model.stage_records import Event, StageRecord, events_from, records_from
from clast.model.state import Ledger, Overlap


@dataclass(frozen=True, kw_only=True, repr=False)
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
    """Time that the run took, s of wall clock, without the time in which kernels were compiled."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall clock per stage of the step, s; and "compilation", where kernels were compiled."""
    warnings: tuple[str, ...] = ()
    """Warnings given before the run, and those based on its results."""
    overlaps: tuple[Overlap, ...] = ()
    """Blocks that overlapped in a frame deeper than their contacts knew, each pair's worst."""
    notes: tuple[str, ...] = ()
    """Automatic choices, with their reasons."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Sums over the accepted steps of the counts of the process: passes, line searches, ..."""
    stages: tuple[StageRecord, ...] = ()
    """How each stage went; none where the run has no stages."""
    events: tuple[Event, ...] = ()
    """Events of the run."""

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain numbers and texts, ready for JSON."""
        plain = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        plain["ledger"] = dataclasses.asdict(self.ledger)
        plain["seconds"] = dict(self.seconds)
        plain["counts"] = dict(self.counts)
        plain["warnings"] = list(self.warnings)
        plain["overlaps"] = [dataclasses.asdict(one) for one in self.overlaps]
        plain["notes"] = list(self.notes)
        plain["stages"] = [dataclasses.asdict(one) for one in self.stages]
        plain["events"] = [dataclasses.asdict(one) for one in self.events]
        return plain

    def __repr__(self) -> str:
        lines = [
            f"Report: {self.outcome.partition(':')[0]}",
            f"  {self.steps} steps ({self.cut_steps} cut), {self.passes} passes, at most "
            f"{self.largest_contacts} contacts, {self.wall_seconds:.3g} s of wall time",
            f"  penetration at most {self.largest_penetration:.3g} m; kinetic "
            f"{self.ledger.kinetic:.4g}, friction {self.ledger.friction:.4g}, impacts "
            f"{self.ledger.impacts:.4g}, numerical {self.ledger.numerical:.4g}, "
            f"unaccounted {self.ledger.unaccounted:.2g} J/m",
        ]
        lines += [f"  {stage}" for stage in self.stages]
        if self.warnings:
            lines.append(f"  {len(self.warnings)} warnings: .warnings")
        return "\n".join(lines)


def report_from_dict(plain: Mapping[str, Any]) -> Report:
    """Return the report that ``Report.as_dict`` gave."""
    known = {f.name for f in dataclasses.fields(Report)}
    entries = {name: value for name, value in plain.items() if name in known}
    ledger = {f.name for f in dataclasses.fields(Ledger)}
    entries["ledger"] = Ledger(**{k: v for k, v in plain["ledger"].items() if k in ledger})
    entries["warnings"] = tuple(plain["warnings"])
    entries["notes"] = tuple(plain.get("notes", ()))
    entries["overlaps"] = tuple(
        Overlap(**{**one, "blocks": tuple(one["blocks"])}) for one in plain.get("overlaps", ())
    )
    entries["stages"] = records_from(plain.get("stages", ()))
    entries["events"] = events_from(plain.get("events", ()))
    return Report(**entries)
