"""Report of a sweep: a measure against its parameters, and the table of its runs.

A mean over a grid would say how the grid was chosen, so there is none.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast.model.model import Floats
from clast.pictures.study.sweep_figures import (
    MOST_PANELS,
    Flags,
    SweepAxis,
    SweepGrid,
    draw_sweep,
    panels_in,
)
from clast.study import trial_table
from clast.study.description import Description
from clast.study.folder import DONE, StudyFolder
from clast.study.parameters import with_units
from clast.study.report_page import Page, add_figures, file_stem

MOST_RUNS = 200
"""Most rows of the table of runs."""
SHARE = "1: the run fails, 0: it stands"
"""Label of failure where nothing is measured."""


@dataclass(frozen=True, kw_only=True)
class SweepRuns:
    """Values of the runs of a sweep, in the order of their numbers; n runs."""

    values: Mapping[str, Floats]
    """Measure -> values, shape (n,); NaN where a run has none, or is not done."""
    fails: Flags
    """Whether a run fails, shape (n,)."""
    done: Flags
    """Whether a run has a result, shape (n,)."""
    made: Flags
    """Whether a run was made, with a result or without, shape (n,)."""
    rows: list[list[Any]]
    """The first rows of the table."""


def runs_of(folder: StudyFolder) -> SweepRuns:
    """Return the values of the runs of a sweep."""
    study = folder.study
    values = {name: np.full(study.n, np.nan) for name in study.measure}
    fails, done, made = (np.zeros(study.n, bool) for _ in range(3))
    rows: list[list[Any]] = []
    for result in folder.results():
        k = result["run"] - 1
        made[k] = True
        if len(rows) < MOST_RUNS:
            rows.append(trial_table.row(study, result))
        if result["status"] == DONE:
            done[k] = True
            fails[k] = bool(result.get("fails"))
            for name, value in result["measures"].items():
                values[name][k] = float(value) if np.isfinite(float(value)) else np.nan
    return SweepRuns(values=values, fails=fails, done=done, made=made, rows=rows)


def grids_of(
    study: Description, units: Mapping[str, str], runs: SweepRuns, name: str
) -> list[SweepGrid]:
    """Return the grids of a measure, "" for failure: one of all lists, one of each in step.

    Lists of one value are no dimension; where there are no others there is no grid.
    """
    values = runs.values[name] if name else np.where(runs.done, 1.0 * runs.fails, np.nan)
    lost = runs.made & ~np.isfinite(values)
    unit = study.units[name] if name else ""
    label = (f"{name} ({unit})" if unit else name) or SHARE
    axes = [
        SweepAxis(label=one.name, unit=units[one.name], values=listed)
        for one, listed in zip(study.vary, study.lists, strict=True)
        if len(listed) > 1
    ]
    shown = [(one,) for one in axes] if study.together else [tuple(axes)] if axes else []
    return [
        SweepGrid(
            axes=own,
            label=label,
            values=values.reshape(shape),
            fails=runs.fails.reshape(shape),
            lost=lost.reshape(shape),
        )
        for own in shown
        for shape in [tuple(len(one.values) for one in own)]
    ]


def write_curves(
    page: Page, study: Description, units: Mapping[str, str], runs: SweepRuns, folder: Path
) -> None:
    """Write each measure of a sweep: its least and largest value, and its figures."""
    for name in study.measure or [""]:
        unit = study.units[name] if name else ""
        expression = study.measure[name] if name else study.fail
        head = f"{name} = {expression}" if name else f"Failure: {expression}"
        page.head(f"{head}, {unit}" if unit else head)
        if name:
            _extremes(page, runs.values[name], unit)
        stem = file_stem(name or "failure")
        for k, grid in enumerate(grids_of(study, units, runs, name), 1):
            _figure(page, grid, folder / f"{stem}-sweep-{k}.png")


def _figure(page: Page, grid: SweepGrid, path: Path) -> None:
    """Draw a grid, and say where it is not drawn as a whole."""
    caption = f"{grid.label} against {', '.join(one.label for one in grid.axes)}"
    kind = "figures wide" if len(grid.axes) > 2 else "figures"
    add_figures(page, lambda: [(draw_sweep(grid, path), caption)], kind)
    count = panels_in(grid)
    if count > MOST_PANELS:
        page.say(
            f"The first {MOST_PANELS} of {count} matrices; all runs are in {trial_table.CSV}.",
            "remark",
        )


def _extremes(page: Page, values: Floats, unit: str) -> None:
    """Say which runs have the least and the largest value of a measure."""
    if not np.isfinite(values).any():
        page.say("No run has a value of it.")
        return
    least, largest = int(np.nanargmin(values)), int(np.nanargmax(values))
    unit = f" {unit}" if unit else ""
    page.say(
        f"Least {values[least]:.5g}{unit} in run {least + 1}, "
        f"largest {values[largest]:.5g}{unit} in run {largest + 1}."
    )


def write_runs(page: Page, study: Description, units: Mapping[str, str], runs: SweepRuns) -> None:
    """Write the table of the runs of a sweep, and the name of the file with all of them."""
    page.head("Runs")
    measures = trial_table.columns(study)[2 + len(study.vary) :][: len(study.measure)]
    known = {**units, **dict(zip(measures, study.units.values(), strict=True))}
    if runs.rows:
        page.table(with_units(trial_table.columns(study), known), runs.rows)
    count = int(runs.made.sum())
    shown = f"The first {MOST_RUNS} of {count} runs; all" if count > MOST_RUNS else "All digits"
    page.say(f"{shown} are in {trial_table.CSV}.", "remark")
