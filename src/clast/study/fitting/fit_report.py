"""The report of a back-analysis: parameters with their intervals, and how well the case fits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from clast.pictures.page.document import write_html
from clast.pictures.study import figures
from clast.study.fitting.fitting import Fit
from clast.study.fitting.observations import ENSEMBLE, FitSettings
from clast.study.folder import StudyFolder, make_folder
from clast.study.report_page import FIGURES, REPORT, Page, add_figures
from clast.study.statistics import CONFIDENCE
from clast.study.study_report import parameter_units

MOST_ROWS = 200
"""Most observations of the table."""


def write_fit(folder: StudyFolder, found: Fit) -> Path:
    """Write the report of a back-analysis; return its path."""
    page = Page(f"{folder.base.title or 'Study'}: back-analysis")
    _parameters(page, folder, found)
    pictures = folder.path / FIGURES
    make_folder(pictures)
    page.head("Computed and measured")
    add_figures(page, lambda: _figures(folder, found, pictures))
    _differences(page, folder, found)
    if len(found.parameter) > 1:
        page.head("Correlation of the errors of the parameters")
        rows = [
            [name, *row]
            for name, row in zip(found.parameter, found.correlation.tolist(), strict=True)
        ]
        page.table(["", *found.parameter], rows)
        page.say(
            "Near 1 or -1 the observations give the two together better than each alone.", "remark"
        )
    _observations(page, folder, found)
    return write_html(page.text(), folder.path / REPORT)


def _parameters(page: Page, folder: StudyFolder, found: Fit) -> None:
    """Write the answer: each parameter with its interval, and the reservations."""
    study, how = folder.study, folder.study.fit or FitSettings()
    units = parameter_units(folder)
    numbers = zip(found.parameter, found.value, found.low, found.high, strict=True)
    for name, value, low, high in numbers:
        answer = f"{name} = {value:.5g}{figures.behind_number(units[name])}"
        page.say(f"{answer} ({100 * CONFIDENCE:g} %: {low:.5g} to {high:.5g})", "answer")
    if found.remark:
        page.say(found.remark[0].upper() + found.remark[1:])
    rows = [
        [one.name, ", ".join(one.paths), str(one.distribution), units[one.name]]
        for one in study.vary
    ]
    page.table(["parameter", "keys", "sought in", "unit"], rows)
    made = f"{how.method}, {found.runs} runs"
    if how.method == ENSEMBLE:
        made += f", {how.members} members, {how.rounds} rounds, seed {how.seed}"
    page.say(f"{made}. The case with these parameters: clast run {folder.path}/best.toml", "remark")


def _deviations(folder: StudyFolder) -> np.ndarray | None:
    """Return the standard deviations of the observations, m, shape (k,); None where not known."""
    sd = [one.sd for one in folder.study.observe]
    return None if None in sd else np.array(sd, np.float64)


def _figures(folder: StudyFolder, found: Fit, pictures: Path) -> list[tuple[Path, str]]:
    """Return the figures, and their captions."""
    study, sd = folder.study, _deviations(folder)
    match = figures.Match(
        label=[f"{one.point} {'xy'[one.part]}" for one in study.observe],
        time=np.array([np.nan if one.time is None else one.time for one in study.observe]),
        observed=found.observed,
        predicted=found.predicted,
        deviation=sd,
    )
    drawn = [
        (figures.draw_match(match, pictures / "match.png"), "computed against measured"),
        (figures.draw_differences(match, pictures / "differences.png"), "differences"),
    ]
    if len(found.parameter) > 1:
        path = pictures / "correlation.png"
        figures.draw_correlation(found.parameter, found.correlation, path)
        drawn.append((path, "correlation of the errors of the parameters"))
    return drawn


def _differences(page: Page, folder: StudyFolder, found: Fit) -> None:
    """Say how large the differences are that are left."""
    left, sd = found.predicted - found.observed, _deviations(folder)
    mean = float(np.sqrt(np.mean(left**2)))
    largest = float(np.abs(left).max())
    rows: list[list[Any]] = [["root mean square, m", mean], ["largest, m", largest]]
    if sd is not None:
        rows.append(["root mean square, over sd", float(np.sqrt(np.mean((left / sd) ** 2)))])
    page.table(["differences that are left", ""], rows)
    if sd is not None:
        page.say("Over sd it should be about 1, without a trend in time.", "remark")


def _observations(page: Page, folder: StudyFolder, found: Fit) -> None:
    """Write measured and computed values side by side."""
    sd = _deviations(folder)
    page.head("Observations")
    heads = ["point", "part", "time, s", "measured, m", "computed, m", "difference, m"]
    rows: list[list[Any]] = []
    for k, one in enumerate(folder.study.observe[:MOST_ROWS]):
        time = "end" if one.time is None else one.time
        own = [found.observed[k].item(), found.predicted[k].item()]
        rows.append([one.point, "xy"[one.part], time, *own, own[1] - own[0]])
        if sd is not None:
            rows[-1].append((own[1] - own[0]) / sd[k].item())
    page.table([*heads, "over sd"] if sd is not None else heads, rows)
    if len(folder.study.observe) > MOST_ROWS:
        page.say(f"{len(folder.study.observe) - MOST_ROWS} more are in fit.json.", "remark")
