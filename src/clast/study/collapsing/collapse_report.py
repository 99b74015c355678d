"""The report of a study of collapse: bracket, trials, the blocks that fail, runs to play."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from clast.errors import CaseError
from clast.model.stages import Stage
from clast.pictures.page.document import write_html
from clast.pictures.study import figures
from clast.results import read_results
from clast.rockmass.drawings.blocks_out import write_blocks_dxf
from clast.run.stages.failure_verdict import Scales
from clast.study.collapsing.collapse import Collapse, ends, undecided
from clast.study.folder import RUN_FILE, StudyFolder, make_folder
from clast.study.report_page import FIGURES, REPORT, Page, add_figures


def write_collapse(folder: StudyFolder, found: Collapse) -> Path:
    """Write the report of a study of collapse; return its path."""
    page = Page(f"{folder.base.title or 'Study'}: {found.by.TITLE}")
    page.say(f"{found.sentence[0].upper()}{found.sentence[1:]}.", "answer")
    for text in found.warnings:
        page.say(f"Warning: {text}.")
    make_folder(folder.path / FIGURES)
    _bracket(page, folder, found)
    _trials(page, found)
    for k in undecided(found):
        _curves(page, folder, found, k)
    _failing(page, folder, found)
    for k in ends(found):
        file = folder.place(k) / RUN_FILE
        if file.exists():
            title = _titled(found, k)
            page.head(title)
            page.run(read_results(file), title)
    return write_html(page.text(), folder.path / REPORT)


def _bracket(page: Page, folder: StudyFolder, found: Collapse) -> None:
    """Draw displacement against factor."""
    factors = np.array([one.factor for one in found.trials])
    displacements = np.array([one.displacement for one in found.trials])
    verdicts = [one.verdict for one in found.trials]
    path, symbol = folder.path / FIGURES / "displacement.png", found.by.SYMBOL
    bracket, label = (found.low, found.high), "displacement against factor, with the bracket"

    def drawn() -> list[tuple[Path, str]]:
        trials = factors, displacements, verdicts
        return [(figures.draw_factors(*trials, bracket, symbol, path), label)]

    add_figures(page, drawn)


def _trials(page: Page, found: Collapse) -> None:
    """Write the table of the trials."""
    page.head("Trials")
    heads = ["trial", found.by.SYMBOL, "verdict", "displacement, m", "steps", "blocks that fail"]
    page.table(
        heads,
        [
            [k, f"{one.factor:.6g}", one.verdict, one.displacement, one.steps, _listed(one.blocks)]
            for k, one in enumerate(found.trials, 1)
        ],
    )


def _curves(page: Page, folder: StudyFolder, found: Collapse, number: int) -> None:
    """Say why a trial is undecided, and draw how its blocks went."""
    page.head(_titled(found, number))
    page.say(found.trials[number - 1].reason)
    file = folder.place(number) / RUN_FILE
    if not file.exists():
        return
    steps = read_results(file).steps
    limits = Scales.of(folder.base.model()).goes, Stage.force_ratio
    displacement, unbalanced = np.cumsum(steps["travel"]), steps["unbalanced"]
    path = folder.path / FIGURES / f"undecided-{number}.png"
    label = f"movement and unbalanced force of trial {number}, step by step"
    add_figures(
        page,
        lambda: [(figures.draw_course(displacement, unbalanced, limits, path), label)],
    )


def _titled(found: Collapse, number: int) -> str:
    """Return number, factor and verdict of a trial."""
    trial = found.trials[number - 1]
    return f"Trial {number}, {found.by.SYMBOL} = {trial.factor:.6g}: {trial.verdict}"


def _failing(page: Page, folder: StudyFolder, found: Collapse) -> None:
    """Draw the blocks that fail in each trial, as pictures and DXF in its folder."""
    model = folder.base.model()
    vertices, said = model.vertices + model.origin, ""
    blocks = np.split(vertices, model.block_start[1:-1])
    page.head("Blocks that fail")
    for k, trial in enumerate(found.trials, 1):
        if not trial.blocks:
            continue
        fails = np.isin(model.block_name, trial.blocks)
        place = folder.place(k)
        try:
            figures.draw_failing(blocks, fails, place / "failing.png")
            layers = np.where(fails, "FAILS", "STANDS").tolist()
            write_blocks_dxf(place / "failing.dxf", vertices, model.block_start, layers)
        except CaseError as error:
            said = f"{error.what}. {error.remedy}"
    if said:
        page.say(said, "remark")
    first = next((k for k in ends(found)[::-1] if found.trials[k - 1].blocks), None)
    drawn = None if first is None else folder.place(first) / "failing.png"
    if drawn is not None and drawn.exists():
        page.pictures([(drawn, "blocks that fail in the first trial that does")])
        page.say("Pictures and DXF of all trials are in their folders.", "remark")


def _listed(blocks: Sequence[str]) -> str:
    more = f" and {len(blocks) - 6} more" if len(blocks) > 6 else ""
    return ", ".join(blocks[:6]) + more
