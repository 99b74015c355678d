"""The paper's studies: formulas, verdicts, and the page made of invented results."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.paper import rest, stiffness_study, table_1
from benchmarks.paper.__main__ import STUDIES
from benchmarks.paper.page import Claim, put_into_page
from benchmarks.paper.runs import PaperResult, PaperResults, PaperRun, run_job
from clast.case.case_file import Case
from clast.errors import CaseError
from clast.model.state import Ledger
from clast.results import Report
from clast.studies.comparing import ComparedRun

ROOT = Path(__file__).parents[2]
CASES, PAGE = ROOT / "cases" / "paper", ROOT / "docs" / "paper.md"


def all_jobs() -> list[PaperRun]:
    return [job for study in STUDIES for job in study.jobs(CASES)]


def test_formulas():
    assert table_1.exact_distance(20.0) == pytest.approx(1.558273, abs=1e-6)
    assert table_1.exact_distance(45.0) == pytest.approx(0.0, abs=1e-12)
    assert table_1.lag(35.0) == pytest.approx(0.0047, abs=5e-5)
    assert rest.share(1e3, 4) == pytest.approx(0.25, rel=1e-5)
    assert rest.share(1e8, 1) == pytest.approx(1.0)


def test_verdicts():
    assert Claim("c", "f", {"a": True, "b": True}).verdict == "holds"
    assert Claim("c", "f", {"a": False}).verdict == "does not hold"
    assert Claim("c", "f", {"a": True, "b": False}).verdict == "holds for a. Does not for b"


def test_range_of_sound_stiffness():
    nan = float("nan")
    assert stiffness_study.sound_range([1.0, 5.0, 9.0], [0.001, 0.002, nan]) == (5.0, 9.0)
    assert stiffness_study.sound_range([1.0, 5.0], [0.5, 0.002]) == (0.0, 1.0)
    assert stiffness_study.sound_range([1.0, 5.0], [0.0, 0.0]) == (5.0, float("inf"))


def test_every_job_is_a_case():
    jobs = all_jobs()
    # the same settings are shared by all combinations
    for file, settings in {(job.file, job.settings) for job in jobs}:
        Case.from_toml(file, settings)
    assert {str(job.combination) for job in jobs} == {
        f"{process}, {law}"
        for process in ("modified", "open-close", "convex")
        for law in ("penalty", "augmented-lagrangian")
    }


def test_a_job_is_run():
    job = next(job for job in rest.jobs(CASES) if job.study == "rest")
    result = run_job(replace(job, settings=(*job.settings, "time.end=0.3")))
    assert result.finished
    assert result.row.penetration == pytest.approx(rest.WEIGHT / (2 * job.value), rel=1e-3)
    assert result.row.normal_force == pytest.approx(rest.WEIGHT, rel=1e-3)
    assert result.stability == pytest.approx(2 * rest.beta(job.value))


def invented(job: PaperRun) -> PaperResult:
    """A result as it might be: stiff runs of the modified process stop."""
    case = Case.from_toml(job.file, job.settings)
    finished = not (job.combination.process == "modified" and job.value > 1e10)
    report = Report(
        finished=finished,
        outcome="",
        steps=10,
        passes=10,
        cut_steps=0,
        largest_contacts=1,
        largest_penetration=1e-4,
        ledger=Ledger(),
        wall_seconds=1.0,
    )
    model = case.model()
    row = ComparedRun(
        combination=job.combination,
        report=report,
        time=0.1,
        displacement={"A": (1.56, -1.56)},
        deviations=(),
        vertices=model.vertices + model.origin,
        absent=model.absent,
        penetration=1e-4 if job.combination.law == "penalty" else 0.25e-4,
        normal_force=rest.WEIGHT,
        stiffness=job.value,
    )
    return PaperResult(job=job, row=row, stability=1e-10 * job.value, drift=1e-5)


def test_page(tmp_path):
    by_study: dict[str, list[PaperResult]] = {}
    for job in all_jobs():
        by_study.setdefault(job.study, []).append(invented(job))
    (tmp_path / "images").mkdir()
    sections = [study.section(PaperResults(by_study), tmp_path / "images") for study in STUDIES]
    file = tmp_path / "paper.md"
    file.write_text(PAGE.read_text(encoding="utf-8"), encoding="utf-8")
    put_into_page(sections, file)
    page = file.read_text(encoding="utf-8")
    pictures = re.findall(r"\]\((images/[^)]*)\)", page)
    assert len(pictures) == len(STUDIES)
    assert all((tmp_path / name).stat().st_size > 1000 for name in pictures)
    assert page.count("(the paper)") >= 4
    assert "stopped at t = 0.1 s" in page
    assert "nan" not in page


def test_a_missing_folder(tmp_path):
    with pytest.raises(CaseError, match="no such file"):
        run_job(next(iter(table_1.jobs(tmp_path))))
