"""The report of a search for a target: the answer, its curve, its runs, the two ends to play."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from clast.pictures.study.sweep_figures import SweepAxis, SweepGrid, draw_sweep
from clast.results import read_results
from clast.study.collapsing.support_forces import HEADS
from clast.study.folder import RUN_FILE, StudyFolder
from clast.study.measures import STANDS_WITH
from clast.study.parameters import ParameterPlaces, changed, content_of
from clast.study.report_page import Page
from clast.study.study_report import parameter_units
from clast.study.targeting.goal import REACHED
from clast.study.targeting.target import Target, TargetRun
from clast.study.work import One, rerun

WORDS = {True: "reached", False: "not reached", None: "undecided"}


def write_target(folder: StudyFolder, result: Target) -> Path:
    """Write the report of a search for a target; return its path."""
    page = Page.of(folder, "target")
    page.say(f"{result.sentence[0].upper()}{result.sentence[1:]}.", "answer")
    page.parameters(folder.study, parameter_units(folder), "sought in")
    if result.ends:
        page.remark(f"The case with the answer: clast run {folder.path}/answer.toml")
    page.head("Runs")
    page.figures(lambda: _curves(page, result))
    unit = f", {result.unit}" if result.unit else ""
    names = list(dict.fromkeys(name for one in result.runs for name in one.measures))
    page.table(
        ["run", f"{result.parameter}{unit}", result.reach, *names, "remark"],
        [
            [one.number, one.value, WORDS[one.reached], *map(one.measures.get, names), one.reason]
            for one in result.runs
        ],
    )
    if result.supported:
        page.head(f"Anchors, linings and links in run {result.supported.number}")
        page.table(HEADS, [one.row for one in result.supported.supports])
        page.remark("All digits are in supports.csv, in N.")
    for one in result.ends or ():
        title = f"Run {one.number}, {WORDS[one.reached]}"
        run = _played(folder, one)
        page.head(title)
        if run is None:
            page.remark("It could not be made again.")
        else:
            page.run(run, title)
    return page.write()


def _curves(page: Page, result: Target) -> list[tuple[Path, str]]:
    """Return the figures of the measures over the parameter, and their captions."""
    runs = sorted(result.runs, key=lambda one: one.share)
    axis = SweepAxis(
        label=result.parameter, unit=result.unit, values=tuple(one.value for one in runs)
    )
    names = list(dict.fromkeys(name for one in runs for name in one.measures)) or [REACHED]
    drawn = []
    for k, name in enumerate(names):
        values = [one.measures.get(name, one.reached if name == REACHED else None) for one in runs]
        grid = SweepGrid(
            axes=(axis,),
            label=f"1: {result.reach}, 0: not" if name == REACHED else name,
            values=np.array([np.nan if one is None else one for one in values], np.float64),
            fails=np.array([one.reached is False for one in runs]),
            lost=np.array([one.reached is None for one in runs]),
            words=(WORDS[True], WORDS[False]),
        )
        caption = f"{name} against {result.parameter}"
        drawn.append((draw_sweep(grid, page.pictures / f"target-{k}.png"), caption))
    return drawn


def _played(folder: StudyFolder, run: TargetRun) -> Any:
    """Return a run as it is played: the trial that decides, else the run; None: not possible."""
    study, file = folder.study, folder.place(run.number) / RUN_FILE
    factors = [given for name, given in study.measures[REACHED].calls() if name == STANDS_WITH]
    if not factors:
        return read_results(file) if file.exists() else rerun(folder, run.number)
    if not file.exists():
        content = ParameterPlaces.of(content_of(folder.base), study.vary).case((run.value,))
        one = One(changed(folder.base, content), None, study.how_of_factor)
        one.trial(float(factors[0][0]), file)
    return read_results(file)
