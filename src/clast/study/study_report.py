"""The report of a sweep or a Monte Carlo study: numbers, figures, tables, its worst run to play.

Everything is in the one file, which asks no network.  Figures need matplotlib; without it the page
says so and has the tables alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from clast.errors import CaseError
from clast.model.model import Floats, Model
from clast.pictures.page.document import write_html
from clast.pictures.study import figures
from clast.pictures.study.figures import FailurePlaces
from clast.results import read_results
from clast.study import statistics, sweep_report
from clast.study.description import MONTECARLO, SWEEP, Description
from clast.study.folder import DONE, RUN_FILE, StudyFolder, make_folder
from clast.study.parameters import ParameterPlaces, changed, content_of, units_of, with_units
from clast.study.report_page import FIGURES, REPORT, Page, add_figures, file_stem
from clast.study.statistics import MEANING, StudyResults, columns_of, sensitivities
from clast.study.work import made_again

KIND_TITLES = {SWEEP: "sweep", MONTECARLO: "Monte Carlo"}
"""Kind of study -> its title."""
MOST_BARS = 12
"""Most parameters of a tornado."""
MOST_ROWS = 20
"""Most rows of a table of blocks or reasons."""


def write_report(folder: StudyFolder) -> Path:
    """Write the report of a sweep or a Monte Carlo study; return its path.

    Its worst run is made again for its page, the same as it was.
    """
    study, columns = folder.study, columns_of(folder)
    units = parameter_units(folder)
    page = Page(f"{folder.base.title or 'Study'}: {KIND_TITLES[study.kind]}")
    _answer(page, columns)
    pictures = folder.path / FIGURES
    make_folder(pictures)
    _failure(page, columns, units, pictures)
    PARTS[study.kind](page, folder, columns, units)
    if len(columns.fails):
        page.head("Which blocks fail")
        _blocks(page, folder, columns, pictures)
    _what_varies(page, folder, units)
    for number in statistics.worst(columns):
        page.head(f"Worst run: {number}")
        names = with_units((one.name for one in study.vary), units)
        page.table(["parameter", "value"], [*zip(names, folder.values(number), strict=True)])
        _worst(page, folder, number)
    return write_html(page.text(), folder.path / REPORT)


def _swept(
    page: Page, folder: StudyFolder, columns: StudyResults, units: Mapping[str, str]
) -> None:
    """Write how the measures of a sweep go with its parameters, and its runs."""
    study, runs, pictures = folder.study, sweep_report.runs_of(folder), folder.path / FIGURES
    sweep_report.write_curves(page, study, units, runs, pictures)
    for name, values in columns.measures.items():
        label, path = (
            f"mean of {_labelled(study, name)}",
            pictures / f"{file_stem(name)}-tornado.png",
        )
        if statistics.influences(columns, values):
            page.head(f"Influence of the parameters on {name}")
            add_figures(page, lambda v=values, a=label, p=path: _tornado(columns, units, v, a, p))
            _influence(page, columns, units, values)
    sweep_report.write_runs(page, study, units, runs)


def _drawn(
    page: Page, folder: StudyFolder, columns: StudyResults, units: Mapping[str, str]
) -> None:
    """Write how the measures of a Monte Carlo study are spread, and on what they depend."""
    study, pictures = folder.study, folder.path / FIGURES
    for name, values in columns.measures.items():
        unit = study.units[name]
        page.head(f"{name} = {study.measure[name]}{f', {unit}' if unit else ''}")
        _spread(page, columns, values)
        add_figures(
            page, lambda name=name, values=values: _figures(columns, units, name, values, pictures)
        )
        _influence(page, columns, units, values)
        _sensitivity(page, columns, values)


PARTS = {SWEEP: _swept, MONTECARLO: _drawn}
"""Kind of study -> what writes its measures."""


def _labelled(study: Description, name: str) -> str:
    """Return a measure and its unit, as axes have them."""
    unit = study.units[name]
    return f"{name} ({unit})" if unit else name


def _answer(page: Page, columns: StudyResults) -> None:
    """Write the answer of the study."""
    found = statistics.probability(columns)
    if found is not None:
        page.say(f"Probability of failure {found}", "answer")
    elif len(columns.fails):
        failed = int(columns.fails.sum())
        page.say(f"{failed} of {len(columns.fails)} runs fail", "answer")
    done = len(columns.run) + columns.lost
    if done < columns.study.n:
        page.say(f"{done} of {columns.study.n} runs are done.")
    for sentence in columns.gaps:
        page.say(f"{sentence}.")
    if columns.lost:
        count = "1 run has" if columns.lost == 1 else f"{columns.lost} runs have"
        page.say(f"{count} no result:")
        page.table(["why", "runs"], list(columns.reasons.items())[:MOST_ROWS])


def _spread(page: Page, columns: StudyResults, values: Any) -> None:
    """Say how a measure is spread."""
    found = statistics.spread(columns, values)
    if found is None:
        page.say("No run has a value of it.")
        return
    heads = ["mean", "standard deviation", "least", "5 %", "median", "95 %", "largest"]
    page.table(heads, [[found.mean, found.sd, found.least, *found.quantiles, found.largest]])


def _figures(
    columns: StudyResults, units: Mapping[str, str], name: str, values: Any, folder: Path
) -> list[tuple[Path, str]]:
    """Return the figures of a measure, and their captions."""
    safe = file_stem(name)
    x, share, half = statistics.cumulative(columns.study, values)
    if not len(x):
        return []
    label = _labelled(columns.study, name)
    confidence = statistics.CONFIDENCE
    paths = [folder / f"{safe}-{kind}.png" for kind in ("histogram", "cumulative", "tornado")]
    drawn = [
        (figures.draw_histogram(values, columns.fails, label, paths[0]), "histogram"),
        (
            figures.draw_cumulative(x, share, half, confidence, label, paths[1]),
            "cumulative",
        ),
    ]
    return [*drawn, *_tornado(columns, units, values, f"mean of {label}", paths[2])]


def _tornado(
    columns: StudyResults, units: Mapping[str, str], values: Any, label: str, path: Path
) -> list[tuple[Path, str]]:
    """Return the tornado of a measure, and its caption; nothing where no parameter orders runs."""
    found = statistics.influences(columns, values)
    if not found:
        return []
    bars = [
        figures.Bar(
            label=one.parameter,
            low=one.low,
            high=one.high,
            ends=one.ends,
            unit=units[one.parameter],
        )
        for one in found[:MOST_BARS]
    ]
    middle = float(values[np.isfinite(values)].mean())
    return [(figures.draw_tornado(bars, middle, label, path), "tornado")]


def _failure(page: Page, columns: StudyResults, units: Mapping[str, str], pictures: Path) -> None:
    """Say and draw how the share of runs that fail goes with each parameter."""
    share = columns.fails
    if not len(share) or not 0.0 < share.mean() < 1.0:
        return
    if not statistics.influences(columns, share):
        return
    page.head("How failure depends on the parameters")
    label, path = "share of the runs that fail", pictures / "failure-tornado.png"
    add_figures(page, lambda: _tornado(columns, units, share, label, path))
    _influence(page, columns, units, share)


def _influence(page: Page, columns: StudyResults, units: Mapping[str, str], values: Any) -> None:
    """Say how a measure goes with each parameter."""
    found = statistics.influences(columns, values)
    names = with_units((one.parameter for one in found), units)
    rows = [
        [name, one.ends[0], one.low, one.ends[1], one.high, one.rank]
        for name, one in zip(names, found, strict=True)
    ]
    if rows:
        heads = ["parameter", "least", "mean there", "largest", "mean there", "rank correlation"]
        page.table(heads, rows)
        page.say(
            "Least and largest: mean of the parameter in the fifth of the runs with such values "
            "of it.",
            "remark",
        )


def _sensitivity(page: Page, columns: StudyResults, values: Any) -> None:
    """Write the indices of sensitivity where runs were drawn for them."""
    try:
        found = sensitivities(columns, values)
    except CaseError as error:
        page.say(f"{error.what}. {error.remedy}", "remark")
        return
    if found:
        page.table(
            ["parameter", *found[0].index],
            [[one.parameter, *one.index.values()] for one in found],
        )
        page.say(MEANING[type(columns.study.sampling).WORD], "remark")


def _blocks(page: Page, folder: StudyFolder, columns: StudyResults, pictures: Path) -> None:
    """Say and draw how often which block fails, or which place where runs have other blocks."""
    if not columns.blocks:
        page.say("None.")
        return
    if columns.joints:
        _counts(page, columns, "joint along which they slide", columns.joints)
    path = pictures / "failing-blocks.png"
    if not _same_blocks(folder):
        places = share_of_places(folder)
        label = "share of the runs in which the rock at a place fails"
        if places is not None:
            add_figures(page, lambda: [(figures.draw_places(places, label, path), label)])
        page.say("Blocks differ from run to run, so that places are counted.", "remark")
        return
    _counts(page, columns, "block", columns.blocks)
    model = folder.base.model()
    runs = max(1, len(columns.run))
    share = np.array([columns.blocks.get(name, 0) / runs for name in model.block_name])
    blocks = np.split(model.vertices + model.origin, model.block_start[1:-1])
    label = "share of the runs in which a block fails"
    add_figures(page, lambda: [(figures.draw_frequency(blocks, share, label, path), label)])


def _counts(page: Page, columns: StudyResults, head: str, counts: Mapping[str, int]) -> None:
    """Write in how many runs each block or joint fails, and the interval of its probability."""
    runs = max(1, len(columns.run))
    rows: list[list[Any]] = []
    for name, count in list(counts.items())[:MOST_ROWS]:
        interval = statistics.interval_of_count(columns, count) or ()
        rows.append([name, count, count / runs, *interval])
    ends = [f"{100 * statistics.CONFIDENCE:g} %: from", "to"]
    page.table([head, "runs", "share of the runs", *ends][: len(rows[0])], rows)
    if len(counts) > MOST_ROWS:
        page.say(f"{len(counts) - MOST_ROWS} more are in the results of the runs.", "remark")


def _same_blocks(folder: StudyFolder) -> bool:
    """Return whether nothing that varies changes the blocks."""
    places = ParameterPlaces.of(content_of(folder.base), folder.study.vary).places
    shaping = {"domain", "joint_set", "trace", "opening", "block", "geometry", "block_pattern"}
    return not any(keys[0] in shaping for own in places for keys in own)


def parameter_units(folder: StudyFolder) -> dict[str, str]:
    """Return the units of the parameters of a study by name; "" where there is none."""
    return units_of(ParameterPlaces.of(content_of(folder.base), folder.study.vary))


def _what_varies(page: Page, folder: StudyFolder, units: Mapping[str, str]) -> None:
    """Write the parameters, and how runs were drawn."""
    study = folder.study
    page.head("Parameters")
    rows = [
        [one.name, ", ".join(one.paths), str(one.distribution), units[one.name]]
        for one in study.vary
    ]
    page.table(["parameter", "keys", "is", "unit"], rows)
    if study.correlate:
        pairs = [(f"{a}, {b}", value) for a, b, value in study.correlate]
        page.table(["correlated", "of normal scores"], pairs)
    if study.kind == MONTECARLO:
        numbers = ", ".join(f"{key} {value}" for key, value in vars(study.sampling).items())
        page.say(f"{study.n} runs, {type(study.sampling).WORD}, {numbers}.")
    if study.fail:
        page.say(f"A run fails where {study.fail}.")


def _worst(page: Page, folder: StudyFolder, number: int) -> None:
    """Put the page of the worst run into the report."""
    kept = folder.place(number) / RUN_FILE
    run: Any = read_results(kept) if kept.exists() else made_again(folder, number)
    if run is None:
        page.say("It could not be made again.", "remark")
        return
    page.run(run, "the worst run")
    page.say(f"clast run {folder.place(number) / 'case.toml'}", "remark")


CELLS = 240
"""Cells along the longer side of the section."""
MOST_RUNS = 500
"""Most runs that are cut again; of more that fail the first are taken as a sample."""


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
        if failed <= MOST_RUNS:
            model = changed(base, settings.case(folder.values(result["run"]))).model()
            fails = np.isin(model.block_name, result["blocks"])
            count += _inside(_outline(model, fails), x, y)
    if not failed:
        return None
    share = count / runs * (failed / min(failed, MOST_RUNS))
    share[~_inside(outline, x, y)] = np.nan
    return FailurePlaces(x=x, y=y, share=share, outline=_rings(outline))


def _outline(model: Model, chosen: np.ndarray | None = None) -> shapely.Geometry:
    """Return the union of blocks, all or those that are chosen (n,), in coordinates of the file."""
    vertices = model.vertices + model.origin
    pairs = list(pairwise(model.block_start))
    kept = range(len(pairs)) if chosen is None else np.flatnonzero(chosen)
    return shapely.union_all([shapely.Polygon(vertices[slice(*pairs[k])]) for k in kept])


def _rings(outline: shapely.Geometry) -> list[Floats]:
    """Return the rings of an outline, m, each of shape (k, 2)."""
    return [shapely.get_coordinates(one) for one in shapely.get_parts(outline.boundary)]


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
