"""The same case through several processes and contact laws.

comparison = clast.studies.compare(clast.load("case.toml"), ["modified", MyProcess()])
comparison.rows[0].deviations
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from clast.case.case_file import Case
from clast.errors import CaseError, RunStopped
from clast.inputs.declaring.alternatives import Chosen, GivenObject
from clast.inputs.method import CONTACT_LAWS, PROCESSES
from clast.model.model import Bools, Floats, Ints
from clast.results import Report, Run
from clast.results.frames import absent_in_frame
from clast.spelling import require_known

if TYPE_CHECKING:
    from clast.run.schedule import Progress

Watch = Callable[["Combination", "Progress"], None]

SHARED = ("normal_stiffness", "shear_stiffness")
"""Numbers of a contact law that describe the joint; they hold for every law compared."""


Vector = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """How far a measured point is from where a reference has it."""

    point: str
    time: float
    """Time of the reference, s."""
    reference: Vector
    """Displacement (u, v) of the reference, m."""
    computed: Vector | None
    """Displacement (u, v) of the run at that time, m; None where the run ended before."""
    source: str

    @property
    def distance(self) -> float | None:
        """Distance between computed and reference, m."""
        if self.computed is None:
            return None
        return float(np.hypot(*np.subtract(self.computed, self.reference)))

    @property
    def relative(self) -> float | None:
        """Distance over the length of the reference, -; None for a reference of zero."""
        length = float(np.hypot(*self.reference))
        if self.distance is None or length == 0.0:
            return None
        return self.distance / length

    def as_text(self) -> str:
        """Return the error in words: in % of the reference, or in m where that is zero."""
        if self.distance is None:
            return "not reached"
        if self.relative is None:
            return f"{self.distance:.3g} m"
        return f"{100.0 * self.relative:.3g} %"

    def as_dict(self) -> dict[str, Any]:
        """Return the deviation as plain numbers and texts, ready for JSON."""
        computed = None if self.computed is None else list(self.computed)
        return {
            "point": self.point,
            "time": self.time,
            "reference": list(self.reference),
            "computed": computed,
            "distance": self.distance,
            "relative": self.relative,
            "source": self.source,
        }


def deviations(case: Case, run: Run) -> tuple[Deviation, ...]:
    """Return how far a run of a case is from each of its references, linear between steps."""
    listed = []
    for one in case.reference:
        time, history = one.time or case.time.end, run.history(one.point)
        computed = None
        if history.time[-1] >= time * (1.0 - 1e-9):
            u, v = (float(np.interp(time, history.time, each)) for each in history.displacement.T)
            computed = u, v
        listed.append(
            Deviation(
                point=one.point,
                time=time,
                reference=one.displacement,
                computed=computed,
                source=one.source,
            )
        )
    return tuple(listed)


@dataclass(frozen=True)
class Combination:
    """A process and a contact law, by their names in case files or as objects of a script."""

    process: str
    law: str
    process_object: Any = None
    """The process itself, where it is an object; ``process`` is its name in tables."""
    law_object: Any = None
    """The contact law itself, where it is an object; ``law`` is its name in tables."""

    def __str__(self) -> str:
        return f"{self.process}, {self.law}"

    def applied_to(self, case: Case) -> Case:
        """Return the case with this process and law.

        The numbers that the case gives for them are kept; a law that the case does not name takes
        the stiffnesses of the one that it names.  Objects have theirs.
        """
        process, law = case.method_.chosen("process"), case.method_.chosen("contact_law")
        numbers = _numbers(law)
        if law.name != self.law:
            numbers = {key: value for key, value in numbers.items() if key in SHARED}
        kept = _numbers(process) if process.name == self.process else {}
        named_process, named_law = {"name": self.process, **kept}, {"name": self.law, **numbers}
        return case.with_method(
            process=named_process if self.process_object is None else self.process_object,
            contact_law=named_law if self.law_object is None else self.law_object,
        )


@dataclass(frozen=True, kw_only=True)
class ComparedRun:
    """The result of one combination; n blocks, nv vertices."""

    combination: Combination
    report: Report
    time: float
    displacement: dict[str, Vector]
    """Displacement (u, v) of every measured point at the end, m."""
    deviations: tuple[Deviation, ...]
    vertices: Floats = field(repr=False)
    """Vertices at the end, m, shape (nv, 2)."""
    absent: Bools = field(repr=False)
    """True where a block has been excavated, shape (n,)."""
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
            "displacement": {name: list(moved) for name, moved in self.displacement.items()},
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
class ComparedMethods:
    """The same case through several combinations; n blocks, nv vertices."""

    name: str
    """Name of the case: its file without the ending."""
    title: str
    end: float
    """Time at which a run reaches its end, s."""
    rows: tuple[ComparedRun, ...]
    start: Floats = field(repr=False)
    """Vertices at the start, m, shape (nv, 2)."""
    block_start: Ints = field(repr=False)
    """Index of each block's first vertex; the last entry is the vertex count, shape (n + 1,)."""
    fixed: Bools = field(repr=False)
    """True where a block cannot move at all, shape (n,)."""

    def as_dict(self) -> dict[str, Any]:
        """Return the comparison as plain numbers and texts, ready for JSON."""
        rows = [row.as_dict() for row in self.rows]
        return {"name": self.name, "title": self.title, "end": self.end, "rows": rows}


def combinations(processes: Sequence[Any], laws: Sequence[Any]) -> list[Combination]:
    """Return every process with every law, each a name or an object.

    An object is called by the name of its class, or by all that it prints where several are of one
    class.  Raises CaseError for unknown names.
    """
    process_names = _names_of("process", processes, PROCESSES)
    law_names = _names_of("contact law", laws, CONTACT_LAWS)
    return [
        Combination(
            process,
            law,
            None if isinstance(process_object, str) else process_object,
            None if isinstance(law_object, str) else law_object,
        )
        for process, process_object in zip(process_names, processes, strict=True)
        for law, law_object in zip(law_names, laws, strict=True)
    ]


def compare(
    case: Case,
    processes: Sequence[Any] = tuple(PROCESSES),
    laws: Sequence[Any] = tuple(CONTACT_LAWS),
    *,
    watch: Watch | None = None,
) -> ComparedMethods:
    """Run a case through every process with every law; a run that stops is a row like the others.

    Processes and laws are names as in case files, or objects: ``laws=["penalty", MyLaw()]``.
    Raises CaseError for unknown names, for objects that are none of the kind, and for a case that
    cannot be used.
    """
    wanted = combinations(processes, laws)
    for combination in wanted:
        combination.applied_to(case)  # what is not a process or law is refused before the first run
    model = case.model()
    return ComparedMethods(
        name=case.name,
        title=case.title or case.name,
        end=case.time.end,
        rows=tuple(run_combination(case, combination, watch) for combination in wanted),
        start=model.vertices + model.origin,
        block_start=model.block_start,
        fixed=model.fixed,
    )


def run_combination(
    case: Case, combination: Combination, watch: Watch | None = None
) -> ComparedRun:
    """Run a case with one combination; interrupting it interrupts the comparison."""
    applied = combination.applied_to(case)

    def report(progress: Progress) -> None:
        if watch:
            watch(combination, progress)

    try:
        run = applied.run(progress=report)
    except RunStopped as stopped:
        run = stopped.run  # type: ignore[assignment]
    else:
        if not run.report.finished:
            raise KeyboardInterrupt
    names = run.model.measured_points.name
    ends = {name: run.history(name).displacement[-1] for name in names}
    return ComparedRun(
        combination=combination,
        report=replace(run.report, seconds=dict(run.report.seconds)),
        time=run.state.time,
        displacement={name: (float(u), float(v)) for name, (u, v) in ends.items()},
        deviations=deviations(applied, run),
        vertices=run.final.vertices,
        absent=absent_in_frame(run, len(run.times) - 1),
        penetration=max(0.0, -float(run.state.memory.gap.min(initial=0.0))),
        normal_force=float(run.state.memory.normal_force.sum()),
        stiffness=float(applied.method(run.model).contact_law.normal_stiffness),
    )


def _numbers(chosen: Chosen | GivenObject) -> dict[str, Any]:
    """Return the numbers that a case gives for a choice, as the file writes them."""
    written = chosen.as_written()
    if not isinstance(written, dict):
        return {}
    return {key: value for key, value in written.items() if key != "name"}


def _names_of(kind: str, given: Sequence[Any], known: dict[str, str]) -> list[str]:
    """Return the names of processes or laws in tables; raise CaseError for invalid ones."""
    if not given:
        raise CaseError(
            f"there is no {kind} to compare", remedy=f"name some of: {', '.join(known)}"
        )
    if isinstance(given, str):
        raise CaseError(f"'{given}' is not a list", remedy=f'give one: ["{given}"]')
    for name in given:
        if isinstance(name, str):
            require_known(name, known, kind=kind)
    classes = [one if isinstance(one, str) else type(one).__name__ for one in given]
    alike = {name for name in classes if classes.count(name) > 1}
    called = [
        repr(one) if name in alike and not isinstance(one, str) else name
        for name, one in zip(classes, given, strict=True)
    ]
    if len(set(called)) < len(called):
        raise CaseError(f"a {kind} is listed twice: {', '.join(called)}", remedy="list each once")
    return called
