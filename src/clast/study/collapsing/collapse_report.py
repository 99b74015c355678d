"""The report of a study of collapse: bracket, trials, the blocks that fail, runs to play."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.model.stages import Stage
from clast.pictures.study import figures
from clast.results import read_results
from clast.rockmass.drawings.blocks_out import write_blocks_dxf
from clast.run.stages.convergence import goes_from
from clast.study.collapsing.collapse import Collapse, ends, listed, undecided
from clast.study.collapsing.support_forces import HEADS
from clast.study.folder import RUN_FILE, StudyFolder
from clast.study.report_page import Page


def write_collapse(folder: StudyFolder, result: Collapse) -> Path:
    """Write the report of a study of collapse; return its path."""
    page = Page.of(folder, result.by.TITLE)
    page.say(f"{result.sentence[0].upper()}{result.sentence[1:]}.", "answer")
    for text in result.warnings:
        page.say(f"Warning: {text}.")
    symbol, bracket = result.by.SYMBOL, (result.low, result.high)
    columns = [(one.factor, one.displacement, one.verdict) for one in result.trials]
    factors, displacements, verdicts = zip(*columns, strict=True)
    trials = np.array(factors), np.array(displacements), list(verdicts)
    path, label = (
        page.pictures / "displacement.png",
        "displacement against factor, with the bracket",
    )
    page.figures(lambda: [(figures.draw_factors(*trials, bracket, symbol, path), label)])
    page.head("Trials")
    page.table(
        ["trial", symbol, "verdict", "displacement, m", "steps", "blocks that fail"],
        [
            [
                k,
                f"{one.factor:.6g}",
                one.verdict,
                one.displacement,
                one.steps,
                listed(one.blocks, 6),
            ]
            for k, one in enumerate(result.trials, 1)
        ],
    )
    if result.supports:
        page.head(f"Anchors, linings and links with {symbol} = {result.low:.6g}, which stands")
        page.table(HEADS, [one.row for one in result.supports])
        page.remark("All digits are in supports.csv, in N.")
    for k in undecided(result):
        _curves(page, folder, result, k)
    _failing(page, folder, result)
    for k in ends(result):
        file = folder.place(k) / RUN_FILE
        if file.exists():
            title = _titled(result, k)
            page.head(title)
            page.run(read_results(file), title)
    return page.write()


def _curves(page: Page, folder: StudyFolder, result: Collapse, number: int) -> None:
    """Say why a trial is undecided, and draw how its blocks went."""
    page.head(_titled(result, number))
    page.say(result.trials[number - 1].reason)
    file = folder.place(number) / RUN_FILE
    if not file.exists():
        return
    steps = read_results(file).steps
    limits = goes_from(folder.base.model()), Stage.force_ratio
    displacement, unbalanced = np.cumsum(steps["travel"]), steps["unbalanced"]
    path = page.pictures / f"undecided-{number}.png"
    label = f"movement and unbalanced force of trial {number}, step by step"
    page.figures(lambda: [(figures.draw_course(displacement, unbalanced, limits, path), label)])


def _titled(result: Collapse, number: int) -> str:
    """Return number, factor and verdict of a trial."""
    trial = result.trials[number - 1]
    return f"Trial {number}, {result.by.SYMBOL} = {trial.factor:.6g}: {trial.verdict}"


def _failing(page: Page, folder: StudyFolder, result: Collapse) -> None:
    """Draw the blocks that fail in each trial, as pictures and DXF in its folder."""
    model = folder.base.model()
    vertices, fault = model.vertices + model.origin, ""
    blocks = np.split(vertices, model.block_start[1:-1])
    page.head("Blocks that fail")
    for k, trial in enumerate(result.trials, 1):
        if not trial.blocks:
            continue
        fails = np.isin(model.block_name, trial.blocks)
        place = folder.place(k)
        try:
            figures.draw_failing(blocks, fails, place / "failing.png")
            layers = np.where(fails, "FAILS", "STANDS").tolist()
            write_blocks_dxf(place / "failing.dxf", vertices, model.block_start, layers)
        except CaseError as error:
            fault = f"{error.what}. {error.remedy}"
    if fault:
        page.remark(fault)
    first = next((k for k in ends(result)[::-1] if result.trials[k - 1].blocks), None)
    drawn = None if first is None else folder.place(first) / "failing.png"
    if drawn is not None and drawn.exists():
        page.figures(lambda: [(drawn, "blocks that fail in the first trial that does")])
        page.remark("Pictures and DXF of all trials are in their folders.")
