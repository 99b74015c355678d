"""What a finished run hands back: histories, energies, a report and the last state."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clast.errors import CaseError
from clast.model.model import Bools, Floats, Ints, Model
from clast.model.stages.records import Event, StageRecord, events_from, records_from
from clast.model.state import Ledger, Overlap, State
from clast.model.water.water import Water
from clast.results.frames import (
    VERTICES,
    Frame,
    FrameStore,
    block_of,
    bolts_of,
    contacts_of,
    field_of,
    frame_of,
    unknown_name,
)
from clast.results.tables import (
    BlockHistory,
    BoltHistory,
    Columns,
    FrameBolts,
    FrameContacts,
    PointHistory,
    rows_of_bolt,
    rows_of_point,
)

if TYPE_CHECKING:
    from clast.results.frames_in_memory import FramesInMemory


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
    """Warnings given before the run, and by what was measured in it."""
    overlaps: tuple[Overlap, ...] = ()
    """Blocks that overlapped in a frame deeper than their contacts knew, each pair's worst."""
    notes: tuple[str, ...] = ()
    """What was chosen automatically, and why."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Sums over the accepted steps of what the process counts: passes, line searches, ..."""
    stages: tuple[StageRecord, ...] = ()
    """How each stage went; none where the run has no stages."""
    events: tuple[Event, ...] = ()
    """What happened in the run."""

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


@dataclass(frozen=True, kw_only=True, repr=False)
class Run:
    """What a run computed; histories, fields and contacts read as those of a result file do.

    Frames are in memory where the run wrote no file, else they are read from it when asked for.
    """

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
    bolt_rows: NDArray[Any]
    """Bolts, a row per instant: time, force, elongation, state by bolt; none without bolts."""
    energy_rows: NDArray[Any]
    """Energy ledger, a row per instant: time and every entry of the ledger."""
    step_rows: NDArray[Any]
    """Accepted steps, a row each: time at its end, size, passes, contacts, penetration, travel."""
    times: Floats
    """Time of each frame, s, shape (frames,)."""
    kept: FramesInMemory | None = None
    """Frames in memory; None where they are in the file."""
    begins: Mapping[str, str] = field(default_factory=dict)
    """Stage with which each load, water or table that stages name begins."""
    ended_by: int = 0
    """Number of the signal that ended the run early, 0 where none did."""
    checkpoint: Path | None = None
    """The last checkpoint of the run, which ``clast resume`` goes on from; None without any."""

    @property
    def final(self) -> State:
        """State at the end in user coordinates: the model's origin is added."""
        origin = self.model.origin
        return dataclasses.replace(
            self.state, vertices=self.state.vertices + origin, points=self.state.points + origin
        )

    def history(self, name: str) -> PointHistory:
        """Return the history of the measured point ``name``, a row per instant, as a table.

        Raises CaseError for a point that does not exist.
        """
        names = self.model.measured_points.name
        if name not in names:
            raise unknown_name("measured point", name, names)
        return PointHistory(rows_of_point(self.point_rows, names.index(name)))

    @property
    def bolt_name(self) -> tuple[str, ...]:
        """Name of each bolt."""
        return self.model.bolts.name

    def bolt_history(self, name: str) -> BoltHistory:
        """Return what the bolt ``name`` bore, a row per instant, as a table.

        Raises CaseError for a bolt that does not exist.
        """
        if name not in self.bolt_name:
            raise unknown_name("bolt", name, self.bolt_name)
        return BoltHistory(rows_of_bolt(self.bolt_rows, self.bolt_name.index(name)))

    def bolts(self, frame: int = -1) -> FrameBolts:
        """Return the bolts of a frame: where they are, their forces and states."""
        return bolts_of(self._frames, frame, self.bolt_name, self.model.bolts.bolt, self.bolt_rows)

    @property
    def energy(self) -> Columns:
        """Energy ledger over time: ``time``, s, and every entry, J per m, each of shape (t,)."""
        return Columns(self.energy_rows)

    @property
    def steps(self) -> Columns:
        """Accepted steps: time, step, passes, contacts, penetration, travel, each of shape (t,)."""
        return Columns(self.step_rows)

    @property
    def step_sizes(self) -> Floats:
        """Size of every accepted step, s, shape (steps,)."""
        sizes: Floats = self.step_rows["step"]
        return sizes

    @property
    def stages(self) -> tuple[StageRecord, ...]:
        """How each stage went; none where the run has no stages."""
        return self.report.stages

    @property
    def events(self) -> tuple[Event, ...]:
        """What happened in the run."""
        return self.report.events

    @property
    def frame_stages(self) -> tuple[str, ...]:
        """Name of the stage of each frame; empty where the run has no stages."""
        return self._frames.frame_stages

    @property
    def title(self) -> str:
        """Title of the case."""
        return self.model.title

    @property
    def name(self) -> str:
        """Name of the result file, "run" where there is none."""
        return self.output.name if self.output else "run"

    @property
    def block_name(self) -> tuple[str, ...]:
        """Name of each block."""
        return self.model.block_name

    @property
    def block_start(self) -> Ints:
        """Index of each block's first vertex; the last entry is the vertex count, (n + 1,)."""
        return self.model.block_start

    @property
    def fixed(self) -> Bools:
        """True where a block cannot move at all, shape (n,)."""
        return self.model.fixed

    @property
    def rock_name(self) -> tuple[str, ...]:
        """Name of each rock."""
        return tuple(rock.name for rock in self.model.rocks)

    @property
    def joint_name(self) -> tuple[str, ...]:
        """Name of each joint."""
        return tuple(joint.name for joint in self.model.joint_table.joints)

    @property
    def edge_joint(self) -> Ints:
        """Joint index of the edge from each vertex to the next, shape (nv,).

        -1: none of its own; its contacts take that of their blocks or rocks, or the default.
        """
        return self.model.edge_joint

    @property
    def origin(self) -> Floats:
        """Point that coordinates of the model are relative to, m, shape (2,)."""
        return self.model.origin

    @property
    def water(self) -> tuple[Water, ...]:
        """Water on outer faces and in joints."""
        return self.model.water

    @property
    def point_name(self) -> tuple[str, ...]:
        """Name of each measured point."""
        return self.model.measured_points.name

    @property
    def point_start(self) -> Floats:
        """Where each measured point was at the start, m, shape (k, 2)."""
        start: Floats = self.model.measured_points.at + self.model.origin
        return start

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields of the blocks."""
        return self._frames.field_names

    def field(self, name: str, frame: int | None = None) -> NDArray[Any]:
        """Return a field of the blocks, of all frames or of one.

        Shape (frames, n), (frames, n, 2) or (frames, n, 3), without the first of them for one
        frame.  ``field_names`` says which there are; parts of them are called sigma_yy,
        displacement_x and so on; "vertices" is (frames, nv, 2), m.  Raises CaseError for a field or
        a frame that does not exist.
        """
        return field_of(self._frames, name, frame)

    def vertices(self, frame: int = -1) -> Floats:
        """Return the vertices of a frame, m, shape (nv, 2); frame -1 is the last."""
        return field_of(self._frames, VERTICES, frame)

    def contacts(self, frame: int = -1) -> FrameContacts:
        """Return the contacts of a frame that carry a force, as a table."""
        return contacts_of(self._frames, frame)

    def frame(
        self, number: int = -1, *, at: float | None = None, stage: str | None = None
    ) -> Frame:
        """Return a frame by its number, the one nearest to the time ``at``, s, or of a stage.

        That is the last one of the stage.  Raises CaseError for a number or a time that lies
        outside of the run, and for a stage that does not exist.
        """
        return frame_of(self._frames, number, at, stage)

    def block(self, name: str) -> BlockHistory:
        """Return how the block ``name`` moved, a row per frame, as a table.

        Raises CaseError for a block that does not exist.
        """
        return block_of(self._frames, name, self.model.block_name)

    @cached_property
    def _frames(self) -> FrameStore:
        if self.kept is not None:
            return self.kept
        from clast.results.reading import read_results

        path = self.output or Path()
        results = read_results(path)
        if results.title != self.title or not np.array_equal(results.times, self.times):
            raise CaseError(
                "holds another run now", where=str(path), remedy="keep the results of each run"
            )
        return results

    def __repr__(self) -> str:
        end = "finished" if self.report.finished else "not finished"
        where = f"{len(self.times)} frames in {self.output or 'memory'}"
        points = ", ".join(self.model.measured_points.name[:4])
        return (
            f"Run('{self.title}', {self.model.block_count} blocks, {end} at t = "
            f"{self.state.time:.6g} s after {self.report.steps} steps\n"
            f"    {where}; measured points: {points or 'none'})"
        )
