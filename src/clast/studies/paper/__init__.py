"""The paper's studies, run with every process and law: ``make paper`` writes docs/paper.md.

    python -m clast.studies.paper cases/paper docs/paper.md

A file here is a study: its jobs, a run each, and its section of the page.  Every number on the page
comes from the runs that write it.
"""

from __future__ import annotations

from pathlib import Path

from clast.studies.paper import iteration, rest, stiffness_study, table_1
from clast.studies.paper.jobs import JobResult, JobResults, PaperRun, run_all
from clast.studies.paper.paper_page import write_page

STUDIES = (table_1, stiffness_study, rest, iteration)
"""The studies, in the order of the page."""


def reproduce(folder: Path, page: Path) -> None:
    """Run all studies on the cases in a folder and write the page, its figures beside it."""
    findings = run_all([job for study in STUDIES for job in study.jobs(folder)])
    images = page.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    write_page([study.section(findings, images) for study in STUDIES], page)


__all__ = ["STUDIES", "JobResult", "JobResults", "PaperRun", "reproduce", "run_all", "write_page"]
