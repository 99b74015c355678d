"""The same case through several processes and contact laws.

comparison = clast.studies.compare(clast.load("case.toml"), ["modified", "convex"])
comparison.rows[0].deviations
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from clast import spelling
from clast.case import CONTACT_LAWS, PROCESSES, Case
from clast.casefile.choices import Chosen
from clast.errors import CaseError, RunStopped
from clast.model import Bools, Floats, Ints
from clast.results import Report, Run
from clast.studies.references import Deviation, Vector, deviations

if TYPE_CHECKING:
    from clast.simulate import Progress

Watch = Callable[["Combination", "Progress"], None]
"""Called after every step of every run."""

SHARED = ("normal_stiffness", "shear_stiffness")
"""Numbers of a contact law that say what the joint is like; they hold for every law compared."""


@dataclass(frozen=True)
class Combination:
    """A process and a contact law, by their names in case files."""

    process: str
    """Process of a step."""
    law: str
    """Contact law."""

    def __str__(self) -> str:
        return f"{self.process}, {self.law}"

    def applied_to(self, case: Case) -> Case:
        """Return the case with this process and law.

        The numbers that the case gives for them are kept; a law that the case does not name takes
        the stiffnesses of the one that it names.
        """
        process, law = case.method_.chosen("process"), case.method_.chosen("contact_law")
        numbers = _numbers(law)
        if law.name != self.law:
            numbers = {key: value for key, value in numbers.items() if key in SHARED}
        own = _numbers(process) if process.name == self.process else {}
        return case.with_method(
            process={"name": self.process, **own}, contact_law={"name": self.law, **numbers}
        )


@dataclass(frozen=True, kw_only=True)
class Row:
    """What one combination made of the case; n blocks, nv vertices."""

    combination: Combination
    """Process and law."""
    report: Report
    """How the run went."""
    time: float
    """When the run ended, s."""
    displacement: dict[str, Vector]
    """Displacement (u, v) of every measured point at the end, m."""
    deviations: tuple[Deviation, ...]
    """Errors against the references of the case."""
    vertices: Floats
    """Vertices at the end, m, shape (nv, 2)."""
    penetration: float
    """Largest penetration at the end, m."""
    normal_force: float
    """Sum of the normal contact forces of the last step, N/m."""
    stiffness: float
    """Normal stiffness p that was used, N/m per m."""

    @property
    def passes_per_step(self) -> float:
        """Assemblies and solves per accepted step."""
        return self.report.passes / max(1, self.report.steps)

    @property
    def solves_per_step(self) -> float:
        """Solves per accepted step; more than passes where multipliers are renewed."""
        solves = self.report.counts.get("solves", self.report.passes)
        return solves / max(1, self.report.steps)

    @property
    def outcome(self) -> str:
        """How the run ended, in few words."""
        return "reached its end" if self.report.finished else f"stopped at t = {self.time:.4g} s"

    @property
    def error(self) -> Deviation | None:
        """The largest of the deviations, or one that was not reached."""
        missing = [one for one in self.deviations if one.distance is None]
        largest = max(self.deviations, key=lambda one: one.distance or 0.0, default=None)
        return missing[0] if missing else largest

    def as_dict(self) -> dict[str, Any]:
        """Return the row as plain numbers and texts, ready for JSON; vertices are left out."""
        return {
            "process": self.combination.process,
            "law": self.combination.law,
            "normal_stiffness": self.stiffness,
            "time": self.time,
            "displacement": {name: list(way) for name, way in self.displacement.items()},
            "deviations": [one.as_dict() for one in self.deviations],
            "largest_penetration": self.report.largest_penetration,
            "penetration": self.penetration,
            "normal_force": self.normal_force,
            "steps": self.report.steps,
            "passes_per_step": self.passes_per_step,
            "solves_per_step": self.solves_per_step,
            "cut_steps": self.report.cut_steps,
            "wall_seconds": self.report.wall_seconds,
            "finished": self.report.finished,
            "outcome": self.report.outcome,
            "warnings": list(self.report.warnings),
            "notes": list(self.report.notes),
            "counts": dict(self.report.counts),
        }


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """The same case through several combinations; n blocks, nv vertices."""

    name: str
    """Name of the case: its file without the ending."""
    title: str
    """Title of the case."""
    end: float
    """Time at which a run reaches its end, s."""
    rows: tuple[Row, ...]
    """What each combination made of it."""
    start: Floats
    """Vertices at the start, m, shape (nv, 2)."""
    block_start: Ints
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    fixed: Bools
    """True where a block cannot move at all, shape (n,)."""

    def as_dict(self) -> dict[str, Any]:
        """Return the comparison as plain numbers and texts, ready for JSON."""
        rows = [row.as_dict() for row in self.rows]
        return {"name": self.name, "title": self.title, "end": self.end, "rows": rows}


def combinations(processes: Sequence[str], laws: Sequence[str]) -> list[Combination]:
    """Return every process with every law; raises CaseError for names that nobody knows."""
    _check_names("process", processes, PROCESSES)
    _check_names("contact law", laws, CONTACT_LAWS)
    return [Combination(process, law) for process in processes for law in laws]


def compare(
    case: Case,
    processes: Sequence[str] = tuple(PROCESSES),
    laws: Sequence[str] = tuple(CONTACT_LAWS),
    *,
    watch: Watch | None = None,
) -> Comparison:
    """Run a case through every process with every law; a run that stops is a row like the others.

    Raises CaseError for unknown names and for a case that cannot be used.
    """
    wanted = combinations(processes, laws)
    model = case.model()
    return Comparison(
        name=case.name,
        title=case.title or case.name,
        end=case.time.end,
        rows=tuple(row_of(case, combination, watch) for combination in wanted),
        start=model.vertices + model.origin,
        block_start=model.block_start,
        fixed=model.fixed,
    )


def row_of(case: Case, combination: Combination, watch: Watch | None = None) -> Row:
    """Run a case with one combination; interrupting it interrupts the comparison."""
    applied = combination.applied_to(case)

    def told(progress: Progress) -> None:
        if watch:
            watch(combination, progress)

    try:
        run = applied.run(progress=told)
    except RunStopped as stopped:
        run = stopped.run  # type: ignore[assignment]
    else:
        if not run.report.finished:
            raise KeyboardInterrupt
    return _row(applied, combination, run)


def _row(case: Case, combination: Combination, run: Run) -> Row:
    names = run.model.measured_points.name
    ends = {name: run.history(name).displacement[-1] for name in names}
    return Row(
        combination=combination,
        report=replace(run.report, seconds=dict(run.report.seconds)),
        time=run.state.time,
        displacement={name: (float(u), float(v)) for name, (u, v) in ends.items()},
        deviations=deviations(case, run),
        vertices=run.final.vertices,
        penetration=max(0.0, -float(run.state.memory.gap.min(initial=0.0))),
        normal_force=float(run.state.memory.normal_force.sum()),
        stiffness=float(case.method(run.model).contact_law.normal_stiffness),
    )


def _numbers(chosen: Chosen) -> dict[str, Any]:
    """Return the numbers that a case gives for a choice, as the file writes them."""
    written = chosen.as_written()
    if isinstance(written, str):
        return {}
    return {key: value for key, value in written.items() if key != "name"}


def _check_names(kind: str, names: Sequence[str], known: dict[str, str]) -> None:
    if not names:
        raise CaseError(
            f"there is no {kind} to compare", remedy=f"name some of: {', '.join(known)}"
        )
    for name in names:
        if name not in known:
            raise CaseError(
                f"there is no {kind} '{name}'", remedy=spelling.advice(name, known, kind=kind)
            )
    if len(set(names)) < len(names):
        raise CaseError(f"a {kind} is named twice: {', '.join(names)}", remedy="name each once")
