"""The report of a back-analysis: parameters with their intervals, and how well the case fits."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from clast.pictures.study import figures
from clast.study.fitting.fitting import Fit
from clast.study.fitting.observations import ENSEMBLE, FitSettings, Observation
from clast.study.folder import StudyFolder
from clast.study.report_page import Page
from clast.study.statistics import CONFIDENCE
from clast.study.study_report import parameter_units

ROWS_MAX = 200
"""Most observations of the table."""


def write_fit(folder: StudyFolder, result: Fit) -> Path:
    """Write the report of a back-analysis; return its path."""
    page = Page.of(folder, "back-analysis")
    _parameters(page, folder, result)
    page.head("Computed and measured")
    page.figures(lambda: _figures(page, folder.study.observe, result))
    sd = _deviations(folder.study.observe)
    difference = result.predicted - result.observed
    rows: list[list[Any]] = [
        ["root mean square, m", float(np.sqrt(np.mean(difference**2)))],
        ["largest, m", float(np.abs(difference).max())],
    ]
    if sd is not None:
        rows.append(["root mean square, over sd", float(np.sqrt(np.mean((difference / sd) ** 2)))])
    page.table(["differences that are left", ""], rows)
    if sd is not None:
        page.remark("Over sd it should be about 1, without a trend in time.")
    if len(result.parameter) > 1:
        page.head("Correlation of the errors of the parameters")
        correlations = zip(result.parameter, result.correlation.tolist(), strict=True)
        page.table(["", *result.parameter], [[name, *row] for name, row in correlations])
        page.remark("Near 1 or -1 the observations give the two together better than each alone.")
    _observations(page, folder.study.observe, result)
    return page.write()


def _parameters(page: Page, folder: StudyFolder, result: Fit) -> None:
    """Write the answer: each parameter with its interval, and the reservations."""
    how, units = folder.study.fit or FitSettings(), parameter_units(folder)
    numbers = zip(result.parameter, result.value, result.low, result.high, strict=True)
    for name, value, low, high in numbers:
        answer = f"{name} = {value:.5g}{figures.behind_number(units[name])}"
        page.say(f"{answer} ({100 * CONFIDENCE:g} %: {low:.5g} to {high:.5g})", "answer")
    if result.remark:
        page.say(result.remark[0].upper() + result.remark[1:])
    page.parameters(folder.study, units, "sought in")
    made = f"{how.method}, {result.runs} runs"
    if how.method == ENSEMBLE:
        made += f", {how.members} members, {how.rounds} rounds, seed {how.seed}"
    page.remark(f"{made}. The case with these parameters: clast run {folder.path}/best.toml")


def _deviations(observations: Sequence[Observation]) -> np.ndarray | None:
    """Return their standard deviations, m, shape (k,); None where not known."""
    sd = [one.sd for one in observations]
    return None if None in sd else np.array(sd, np.float64)


def _figures(
    page: Page, observations: Sequence[Observation], result: Fit
) -> list[tuple[Path, str]]:
    """Return the figures, and their captions."""
    match = figures.Match(
        label=[f"{one.point} {'xy'[one.part]}" for one in observations],
        time=np.array([np.nan if one.time is None else one.time for one in observations]),
        observed=result.observed,
        predicted=result.predicted,
        deviation=_deviations(observations),
    )
    pictures = page.pictures
    drawn = [
        (figures.draw_match(match, pictures / "match.png"), "computed against measured"),
        (figures.draw_differences(match, pictures / "differences.png"), "differences"),
    ]
    if len(result.parameter) > 1:
        path = pictures / "correlation.png"
        figures.draw_correlation(result.parameter, result.correlation, path)
        drawn.append((path, "correlation of the errors of the parameters"))
    return drawn


def _observations(page: Page, observations: Sequence[Observation], result: Fit) -> None:
    """Write measured and computed values side by side."""
    page.head("Observations")
    heads = ["point", "part", "time, s", "measured, m", "computed, m", "difference, m", "over sd"]
    rows: list[list[Any]] = []
    values = zip(observations, result.observed.tolist(), result.predicted.tolist(), strict=True)
    for one, observed, predicted in list(values)[:ROWS_MAX]:
        time, difference = "end" if one.time is None else one.time, predicted - observed
        rows.append([one.point, "xy"[one.part], time, observed, predicted, difference])
        rows[-1] += [] if one.sd is None else [difference / one.sd]
    page.table(heads[: len(rows[0])], rows)
    if len(observations) > ROWS_MAX:
        page.say(f"{len(observations) - ROWS_MAX} more are in fit.json.", "remark")
