"""The report of a sweep or a Monte Carlo study: numbers, figures, tables, its worst run to play."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from clast.errors import CaseError
from clast.model.model import Floats, Model
from clast.pictures.study import figures
from clast.pictures.study.figures import FailurePlaces
from clast.pictures.study.sweep_figures import (
    MOST_PANELS,
    SweepAxis,
    SweepGrid,
    draw_sweep,
    panels_in,
)
from clast.results import read_results
from clast.study import statistics, trial_table
from clast.study.description import MONTECARLO, SWEEP, Description
from clast.study.folder import DONE, RUN_FILE, StudyFolder
from clast.study.parameters import ParameterPlaces, changed, content_of, units_of, with_units
from clast.study.report_page import Page, file_stem
from clast.study.statistics import MEANING, StudyResults, columns_of, sensitivities
from clast.study.work import rerun

TABLE_ROWS_MAX = 20
"""Rows of a table of blocks or reasons, at most."""
SWEEP_ROWS_MAX = 200
"""Rows of the table of runs, at most."""
FAILURE = "1: the run fails, 0: it stands"
"""Label of failure where nothing is measured."""
Units = Mapping[str, str]
"""Parameter -> unit."""


def write_report(folder: StudyFolder) -> Path:
    """Write the report of a sweep or a Monte Carlo study; return its path.

    Its worst run is made again for its page, the same as it was.
    """
    study, columns = folder.study, columns_of(folder)
    units = parameter_units(folder)
    page = Page.of(folder, "sweep" if study.kind == SWEEP else "Monte Carlo")
    _answer(page, columns)
    share = columns.fails
    if len(share) and 0.0 < share.mean() < 1.0 and statistics.influences(columns, share):
        page.head("How failure depends on the parameters")
        path = page.pictures / "failure-tornado.png"
        label = "share of the runs that fail"
        page.figures(partial(_tornado, columns, units, share, label, path))
        _influence(page, columns, units, share)
    if study.kind == SWEEP:
        _write_sweep(page, folder, columns, units)
    else:
        _write_montecarlo(page, columns, units)
    if len(columns.fails):
        page.head("Which blocks fail")
        _blocks(page, folder, columns)
    page.head("Parameters")
    page.parameters(study, units, "is")
    if study.correlate:
        pairs = [(f"{a}, {b}", value) for a, b, value in study.correlate]
        page.table(["correlated", "of normal scores"], pairs)
    if study.kind == MONTECARLO:
        numbers = ", ".join(f"{key} {value}" for key, value in vars(study.sampling).items())
        page.say(f"{study.n} runs, {type(study.sampling).WORD}, {numbers}.")
    if study.fail:
        page.say(f"A run fails where {study.fail}.")
    for number in statistics.worst(columns):
        page.head(f"Worst run: {number}")
        names = with_units((one.name for one in study.vary), units)
        page.table(["parameter", "value"], [*zip(names, folder.values(number), strict=True)])
        kept = folder.place(number) / RUN_FILE
        run: Any = read_results(kept) if kept.exists() else rerun(folder, number)
        if run is None:
            page.remark("It could not be made again.")
        else:
            page.run(run, "the worst run")
            page.remark(f"clast run {folder.place(number) / 'case.toml'}")
    return page.write()


def parameter_units(folder: StudyFolder) -> dict[str, str]:
    """Return the units of the parameters of a study by name; "" where there is none."""
    return units_of(ParameterPlaces.of(content_of(folder.base), folder.study.vary))


def _answer(page: Page, columns: StudyResults) -> None:
    """Write the answer of the study."""
    probability = statistics.probability(columns)
    if probability is not None:
        page.say(f"Probability of failure {probability}", "answer")
    elif len(columns.fails):
        page.say(f"{int(columns.fails.sum())} of {len(columns.fails)} runs fail", "answer")
    done = len(columns.run) + columns.lost
    if done < columns.study.n:
        page.say(f"{done} of {columns.study.n} runs are done.")
    for sentence in columns.gaps:
        page.say(f"{sentence}.")
    if columns.lost:
        count = "1 run has" if columns.lost == 1 else f"{columns.lost} runs have"
        page.say(f"{count} no result:")
        page.table(["why", "runs"], list(columns.reasons.items())[:TABLE_ROWS_MAX])


# Sweeps ------------------------------------------------------------------------------------------
# A mean over a grid would say how the grid was chosen, so there is none.


def _write_sweep(page: Page, folder: StudyFolder, columns: StudyResults, units: Units) -> None:
    """Write how the measures of a sweep go with its parameters, and its runs."""
    study = folder.study
    for name in study.measure or [""]:
        write_curves(page, columns, units, name)
    for name, values in columns.measures.items():
        if statistics.influences(columns, values):
            page.head(f"Influence of the parameters on {name}")
            label = f"mean of {_labelled(study, name)}"
            path = page.pictures / f"{file_stem(name)}-tornado.png"
            page.figures(partial(_tornado, columns, units, values, label, path))
            _influence(page, columns, units, values)
    write_runs(page, folder, columns, units)


def grids_of(columns: StudyResults, units: Units, name: str) -> list[SweepGrid]:
    """Return the grids of a measure, "" for failure: one of all lists, one of each in step.

    Lists of one value are no dimension; where there are no others there is no grid.
    """
    study, at = columns.study, columns.run.astype(int) - 1
    fails, lost, values = np.zeros(study.n, bool), np.zeros(study.n, bool), np.full(study.n, np.nan)
    if len(columns.fails):
        fails[at] = columns.fails == 1.0
    values[at] = columns.measures[name] if name else 1.0 * fails[at]
    values[~np.isfinite(values)] = np.nan
    lost[np.array(columns.without, int) - 1] = True
    lost[at] = np.isnan(values[at])
    axes = [
        SweepAxis(label=one.name, unit=units[one.name], values=listed)
        for one, listed in zip(study.vary, study.lists, strict=True)
        if len(listed) > 1
    ]
    shown = [(one,) for one in axes] if study.together else [tuple(axes)] if axes else []
    return [
        SweepGrid(
            axes=dimensions,
            label=_labelled(study, name) if name else FAILURE,
            values=values.reshape(shape),
            fails=fails.reshape(shape),
            lost=lost.reshape(shape),
        )
        for dimensions in shown
        for shape in [tuple(len(one.values) for one in dimensions)]
    ]


def write_curves(page: Page, columns: StudyResults, units: Units, name: str) -> None:
    """Write a measure of a sweep, "" for failure: its least and largest value, its figures."""
    study = columns.study
    unit = study.units[name] if name else ""
    head = f"{name} = {study.measure[name]}" if name else f"Failure: {study.fail}"
    page.head(f"{head}, {unit}" if unit else head)
    if name:
        ends = statistics.extremes(columns, columns.measures[name])
        texts = [
            f"{word} {one.value:.5g}{f' {unit}' if unit else ''} in run {one.run}{_where(one)}"
            for word, one in (ends or {}).items()
        ]
        text = f"{', '.join(texts)}." if texts else "no run has a value of it."
        page.say(text[0].upper() + text[1:])
    for k, grid in enumerate(grids_of(columns, units, name), 1):
        path = page.pictures / f"{file_stem(name or 'failure')}-sweep-{k}.png"
        caption = f"{grid.label} against {', '.join(one.label for one in grid.axes)}"
        kind = "figures wide" if len(grid.axes) > 2 else "figures"
        page.figures(partial(_sweep, grid, path, caption), kind)
        count = panels_in(grid)
        if count > MOST_PANELS:
            shown = f"The first {MOST_PANELS} of {count} matrices"
            page.remark(f"{shown}; all runs are in {trial_table.CSV}.")


def _where(extreme: statistics.Extreme) -> str:
    """Return the parameters of an extreme in brackets."""
    values = extreme.parameters.items()
    return f" ({', '.join(f'{name} = {value}' for name, value in values)})" if values else ""


def _sweep(grid: SweepGrid, path: Path, caption: str) -> list[tuple[Path, str]]:
    return [(draw_sweep(grid, path), caption)]


def write_runs(page: Page, folder: StudyFolder, columns: StudyResults, units: Units) -> None:
    """Write the table of the runs of a sweep, and the name of the file with all of them."""
    study = folder.study
    page.head("Runs")
    heads = trial_table.columns(study)
    measures = heads[2 + len(study.vary) :][: len(study.measure)]
    known = {**units, **dict(zip(measures, study.units.values(), strict=True))}
    rows = [trial_table.row(study, one) for one in islice(folder.results(), SWEEP_ROWS_MAX)]
    if rows:
        page.table(with_units(heads, known), rows)
    count = len(columns.run) + len(columns.without)
    first = f"The first {SWEEP_ROWS_MAX} of {count} runs; all"
    page.remark(f"{first if count > SWEEP_ROWS_MAX else 'All digits'} are in {trial_table.CSV}.")


# Monte Carlo studies -----------------------------------------------------------------------------


def _write_montecarlo(page: Page, columns: StudyResults, units: Units) -> None:
    """Write how measures of a Monte Carlo study are spread, and on which numbers they depend."""
    study = columns.study
    for name, values in columns.measures.items():
        unit = study.units[name]
        page.head(f"{name} = {study.measure[name]}{f', {unit}' if unit else ''}")
        spread = statistics.spread(columns, values)
        if spread is None:
            page.say("No run has a value of it.")
        else:
            page.table(spread.HEADS, [spread.row])
        page.figures(partial(_figures, page, columns, units, name))
        _influence(page, columns, units, values)
        try:
            indices = sensitivities(columns, values)
        except CaseError as error:
            page.remark(f"{error.what}. {error.remedy}")
            continue
        if indices:
            rows = [[one, *index.values()] for one, index in indices.items()]
            page.table(["parameter", *next(iter(indices.values()))], rows)
            page.remark(MEANING[type(study.sampling).WORD])


def _labelled(study: Description, name: str) -> str:
    """Return a measure and its unit, as axes have them."""
    unit = study.units[name]
    return f"{name} ({unit})" if unit else name


def _figures(page: Page, columns: StudyResults, units: Units, name: str) -> list[tuple[Path, str]]:
    """Return the figures of a measure, and their captions."""
    values, label = columns.measures[name], _labelled(columns.study, name)
    x, share, half = statistics.cumulative(columns.study, values)
    if not len(x):
        return []
    histogram, cumulative, tornado = (
        page.pictures / f"{file_stem(name)}-{kind}.png"
        for kind in ("histogram", "cumulative", "tornado")
    )
    band = (x, share, half, statistics.CONFIDENCE)
    return [
        (figures.draw_histogram(values, columns.fails, label, histogram), "histogram"),
        (figures.draw_cumulative(*band, label, cumulative), "cumulative"),
        *_tornado(columns, units, values, f"mean of {label}", tornado),
    ]


def _tornado(
    columns: StudyResults, units: Units, values: Floats, label: str, path: Path
) -> list[tuple[Path, str]]:
    """Return the tornado of a measure, and its caption; nothing where no parameter orders runs."""
    bars = [
        figures.Bar(
            label=one.parameter,
            low=one.low,
            high=one.high,
            ends=one.ends,
            unit=units[one.parameter],
        )
        for one in statistics.influences(columns, values)[:12]
    ]
    if not bars:
        return []
    middle = float(values[np.isfinite(values)].mean())
    return [(figures.draw_tornado(bars, middle, label, path), "tornado")]


def _influence(page: Page, columns: StudyResults, units: Units, values: Floats) -> None:
    """Say how a measure goes with each parameter."""
    influences = statistics.influences(columns, values)
    if not influences:
        return
    names = with_units((one.parameter for one in influences), units)
    rows = [
        [name, one.ends[0], one.low, one.ends[1], one.high, one.rank]
        for name, one in zip(names, influences, strict=True)
    ]
    heads = ["parameter", "least", "mean there", "largest", "mean there", "rank correlation"]
    page.table(heads, rows)
    page.remark(
        "Least and largest: mean of the parameter in the fifth of the runs with such values of it."
    )


# Blocks that fail --------------------------------------------------------------------------------


def _blocks(page: Page, folder: StudyFolder, columns: StudyResults) -> None:
    """Say and draw how often which block fails, or which place where runs have other blocks."""
    if not columns.blocks:
        page.say("None.")
        return
    if columns.joints:
        write_counts(page, columns, "joint along which they slide", columns.joints)
    path = page.pictures / "failing-blocks.png"
    varied = ParameterPlaces.of(content_of(folder.base), folder.study.vary).places
    shaping = {"domain", "joint_set", "trace", "opening", "block", "geometry", "block_pattern"}
    if any(keys[0] in shaping for places in varied for keys in places):
        places = share_of_places(folder)
        label = "share of the runs in which the rock at a place fails"
        if places is not None:
            page.figures(lambda: [(figures.draw_places(places, label, path), label)])
        page.remark("Blocks differ from run to run, so that places are counted.")
        return
    write_counts(page, columns, "block", columns.blocks)
    model = folder.base.model()
    runs = max(1, len(columns.run))
    share = np.array([columns.blocks.get(name, 0) / runs for name in model.block_name])
    blocks = np.split(model.vertices + model.origin, model.block_start[1:-1])
    label = "share of the runs in which a block fails"
    page.figures(lambda: [(figures.draw_frequency(blocks, share, label, path), label)])


def write_counts(page: Page, columns: StudyResults, head: str, counts: Mapping[str, int]) -> None:
    """Write in how many runs each block or joint fails, and the interval of its probability."""
    runs = max(1, len(columns.run))
    rows: list[list[Any]] = []
    for name, count in list(counts.items())[:TABLE_ROWS_MAX]:
        interval = statistics.interval_of_count(columns, count) or ()
        rows.append([name, count, count / runs, *interval])
    ends = [f"{100 * statistics.CONFIDENCE:g} %: from", "to"]
    page.table([head, "runs", "share of the runs", *ends][: len(rows[0])], rows)
    if len(counts) > TABLE_ROWS_MAX:
        page.remark(f"{len(counts) - TABLE_ROWS_MAX} more are in the results of the runs.")


CELLS = 240
"""Cells along the longer side of the section."""
CUT_RUNS_MAX = 500
"""Runs that are cut again, at most; of more that fail the first are taken as a sample."""


def share_of_places(folder: StudyFolder) -> FailurePlaces | None:
    """Return in which share of the runs each place fails; None where no run has blocks that fail.

    Runs that fail are cut again, as they were: their blocks follow from the study and their number.
    """
    base, study = folder.base, folder.study
    settings = ParameterPlaces.of(content_of(base), study.vary)
    outline = _outline(base.model())
    x, y = _grid(outline)
    count, runs, failed = np.zeros((len(y), len(x))), 0, 0
    for result in folder.results():
        if result["status"] != DONE:
            continue
        runs += 1
        if not result.get("blocks"):
            continue
        failed += 1
        if failed <= CUT_RUNS_MAX:
            model = changed(base, settings.case(folder.values(result["run"]))).model()
            fails = np.isin(model.block_name, result["blocks"])
            count += _inside(_outline(model, fails), x, y)
    if not failed:
        return None
    share = count / runs * (failed / min(failed, CUT_RUNS_MAX))
    share[~_inside(outline, x, y)] = np.nan
    rings = [shapely.get_coordinates(one) for one in shapely.get_parts(outline.boundary)]
    return FailurePlaces(x=x, y=y, share=share, outline=rings)


def _outline(model: Model, chosen: np.ndarray | None = None) -> shapely.Geometry:
    """Return the union of blocks, all or those that are chosen (n,), in coordinates of the file."""
    vertices = model.vertices + model.origin
    pairs = list(pairwise(model.block_start))
    kept = range(len(pairs)) if chosen is None else np.flatnonzero(chosen)
    return shapely.union_all([shapely.Polygon(vertices[slice(*pairs[k])]) for k in kept])


def _grid(outline: shapely.Geometry) -> tuple[Floats, Floats]:
    """Return the centres of the cells along x and y, m, shapes (nx,) and (ny,)."""
    left, low, right, high = outline.bounds
    cell = max(right - left, high - low) / CELLS
    nx, ny = (max(1, round(length / cell)) for length in (right - left, high - low))
    return (
        left + (np.arange(nx) + 0.5) * (right - left) / nx,
        low + (np.arange(ny) + 0.5) * (high - low) / ny,
    )


def _inside(outline: shapely.Geometry, x: Floats, y: Floats) -> np.ndarray:
    """Return which cells have their centre in an outline, shape (ny, nx)."""
    shapely.prepare(outline)
    inside: np.ndarray = shapely.contains_xy(outline, *np.meshgrid(x, y))
    return inside
