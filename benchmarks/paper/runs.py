"""Jobs of the studies, a run each, and their results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from clast.case.case_file import Case
from clast.run.preflight import examine
from clast.studies.comparing import Combination, ComparedRun, run_combination

WORKERS = 2
"""Runs at a time."""
PROCESSES = ("modified", "open-close", "convex")
"""Processes compared: the paper's, Shi's, clast's own."""
LAWS = {"penalty": "penalty", "augmented-lagrangian": "ALM"}
"""Contact laws compared, and their names in tables and legends."""
EVERY_COMBINATION = tuple(Combination(process, law) for law in LAWS for process in PROCESSES)
"""All three processes with both laws."""


@dataclass(frozen=True, kw_only=True)
class PaperRun:
    """One run of a study."""

    study: str
    """Which study it belongs to."""
    file: Path
    """Case file."""
    combination: Combination
    """Process and law."""
    settings: tuple[str, ...] = ()
    """Keys that differ from the file."""
    value: float
    """The variable of the study: an angle, degrees, a stiffness, N/m per m, or a number of
    solves."""
    variant: str = ""
    """The name that distinguishes jobs of the same process and law."""

    @property
    def label(self) -> str:
        """Process, variant and law, as tables and legends have it."""
        return f"{self.combination.process}{self.variant}, {LAWS[self.combination.law]}"


@dataclass(frozen=True, kw_only=True)
class PaperResult:
    """The result of a job."""

    job: PaperRun
    """The job."""
    row: ComparedRun
    """Its row of the comparison."""
    stability: float
    """p h2/m at the start, m being the mass per contact."""
    drift: float
    """Largest horizontal displacement of a vertex, m."""

    @property
    def finished(self) -> bool:
        """True where the run reached its end."""
        return self.row.report.finished

    @property
    def depth(self) -> float:
        """Largest penetration of the run, m; nan where it stopped."""
        return self.row.report.largest_penetration if self.finished else float("nan")

    def text_if_finished(self, text: str) -> str:
        """Return the text where the run reached its end, else when it stopped."""
        return text if self.finished else self.row.outcome


@dataclass(frozen=True)
class PaperResults:
    """All results, by study."""

    by_study: Mapping[str, Sequence[PaperResult]] = field(default_factory=dict)
    """Name of a study -> its results, in the order of its jobs."""

    def series(self, study: str) -> dict[str, list[PaperResult]]:
        """Return the results of a study by label, in the order of their values."""
        series: dict[str, list[PaperResult]] = {}
        for result in self.by_study[study]:
            series.setdefault(result.job.label, []).append(result)
        return {label: sorted(s, key=lambda one: one.job.value) for label, s in series.items()}


def run_job(job: PaperRun) -> PaperResult:
    """Run a job."""
    case = Case.from_toml(job.file, job.settings)
    applied = job.combination.applied_to(case)
    model = applied.model()
    row = run_combination(case, job.combination)
    return PaperResult(
        job=job,
        row=row,
        stability=examine(model, applied.method(model), applied.schedule()).stability_number,
        drift=float(np.abs(row.vertices - model.vertices - model.origin)[:, 0].max()),
    )


def run_all(jobs: Sequence[PaperRun], workers: int = WORKERS) -> PaperResults:
    """Run all jobs, some at a time; the results do not depend on how many."""
    by_study: dict[str, list[PaperResult]] = {}
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for result in pool.map(run_job, jobs, chunksize=1):
            by_study.setdefault(result.job.study, []).append(result)
    return PaperResults(by_study)
