"""``python -m benchmarks.paper FOLDER PAGE``: the runs of the cases in a folder go into a page."""

from __future__ import annotations

import sys
from pathlib import Path

from benchmarks.paper import rest, stiffness_study, table_1, walls
from benchmarks.paper.page import put_into_page
from benchmarks.paper.runs import run_all

STUDIES = (table_1, stiffness_study, rest, walls)
"""The studies, in the order of the page."""


def reproduce(folder: Path, page: Path) -> None:
    """Run all studies on the cases in a folder; put results into the page, figures beside it."""
    results = run_all([job for study in STUDIES for job in study.jobs(folder)])
    images = page.parent / "images"
    put_into_page([study.section(results, images) for study in STUDIES], page)


if __name__ == "__main__":
    reproduce(*(Path(argument) for argument in sys.argv[1:3]))
