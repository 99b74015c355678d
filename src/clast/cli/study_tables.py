"""Results of clast study: tables and reports that are written, and terminal output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from clast.cli.terminal import MISSED, print_json, print_table, say, table_of, tell
from clast.errors import CaseError

if TYPE_CHECKING:
    from clast.study.collapsing.collapse import Collapse
    from clast.study.collapsing.trial import Trial
    from clast.study.fitting.fitting import Fit
    from clast.study.folder import StudyFolder
    from clast.study.statistics import SensitivityIndex, StudyResults

NAMED = 3
"""Blocks that a line of a trial names."""


def print_trial(number: int, trial: Trial) -> None:
    """Print a line for a trial."""
    more = len(trial.blocks) - NAMED
    named = ", ".join(trial.blocks[:NAMED]) + (f" and {more} more" if more > 0 else "")
    tell(
        f"{number:4d}  {trial.factor:<10.6g} {trial.verdict:<10s} {trial.displacement:>9.3g} m  "
        f"{trial.steps:5d} steps  {named}"
    )


def print_fit(found: Fit, report: Path, as_json: bool, quiet: bool) -> None:
    """Print the result of a back-analysis, and where its report is."""
    if as_json:
        print_json({**found.as_dict(), "folder": str(report.parent)})
        return
    if quiet:
        return
    columns = zip(found.parameter, found.value, found.low, found.high, strict=True)
    rows = [(name, *(f"{one:.5g}" for one in numbers)) for name, *numbers in columns]
    title = f"{len(found.observed)} observations, {found.runs} runs"
    print_table(table_of(title, ("parameter", "value", "95 %: from", "to"), rows))
    misfit = found.predicted - found.observed
    tell(f"largest difference of computed and measured: {abs(misfit).max():.3g} m")
    for k, first in enumerate(found.parameter):
        for n, second in enumerate(found.parameter[:k]):
            tell(f"correlation of {second} and {first}: {found.correlation[k, n]:.2f}")
    if found.remark:
        tell(found.remark)
    tell(f"report: {report}")


def print_sensitivities(measure: str, found: Sequence[SensitivityIndex]) -> None:
    """Print the indices of sensitivity of a measure."""
    if not found:
        return
    rows = [(one.parameter, *(f"{value:.3g}" for value in one.index.values())) for one in found]
    print_table(table_of(f"sensitivity of {measure}", ("parameter", *found[0].index), rows))


def print_results(columns: StudyResults, rows: int) -> None:
    """Print the result of a sweep or a Monte Carlo study."""
    from clast.study import statistics
    from clast.study.description import SWEEP

    is_sweep = columns.study.kind == SWEEP
    table, words = (_ranges(columns), (0, 1)) if is_sweep else (_spreads(columns), (0,))
    print_table(table_of(f"{rows} of {columns.study.n} runs", *table, words=words))
    probability = statistics.probability(columns)
    if probability is not None:
        tell(f"probability of failure {probability}")
    elif len(columns.fails):
        tell(f"{int(columns.fails.sum())} of {len(columns.fails)} runs fail")
    for sentence in columns.gaps:
        tell(sentence)
    for reason, count in columns.reasons.items():
        tell(f"{count} without a result: {reason}")


def _spreads(columns: StudyResults) -> tuple[Sequence[str], list[Sequence[str]]]:
    """Return headings and rows of how the measures of a Monte Carlo study are spread."""
    from clast.study import statistics

    rows: list[Sequence[str]] = []
    for name, values in columns.measures.items():
        one = statistics.spread(columns, values)
        if one is not None:
            numbers = (one.mean, one.sd, one.least, *one.quantiles, one.largest)
            rows.append((name, *(f"{number:.5g}" for number in numbers)))
    return ("measure", "mean", "sd", "least", "5 %", "median", "95 %", "largest"), rows


def _ranges(columns: StudyResults) -> tuple[Sequence[str], list[Sequence[str]]]:
    """Return headings and rows of the extremes of the measures of a sweep, and where they are."""
    from clast.study import statistics

    rows: list[Sequence[str]] = []
    for name, values in columns.measures.items():
        extremes = statistics.extremes(columns, values)
        for word, one in vars(extremes).items() if extremes is not None else ():
            where = map(_short, one.parameters.values())
            rows.append((name, word, f"{one.value:.5g}", str(one.run), *where))
    parameters = [one.name for one in columns.study.vary]
    return ("measure", "extreme", "value", "in run", *parameters), rows


def _short(value: Any) -> str:
    """Return a value of a parameter."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def print_collected(there: StudyFolder, parquet: bool, as_json: bool, quiet: bool) -> None:
    """Write table and report; print the results."""
    from clast.study import statistics, trial_table
    from clast.study.study_report import write_report
    from clast.study.work import keep_worst

    there.tidy()
    rows = trial_table.write_csv(there, there.path / trial_table.CSV)
    if parquet:
        trial_table.write_parquet(there, there.path / trial_table.PARQUET)
    columns = statistics.columns_of(there)
    keep_worst(there, columns)
    report = write_report(there)
    indices = _sensitivities(columns)
    if as_json:
        print_json(
            {
                "folder": str(there.path),
                "done": rows,
                **_as_dict(columns),
                "sensitivity": {
                    name: {one.parameter: one.index for one in listed}
                    for name, listed in indices.items()
                },
            }
        )
    elif not quiet:
        print_results(columns, rows)
        for name, listed in indices.items():
            print_sensitivities(name, listed)
        tell(f"table: {there.path / trial_table.CSV}\nreport: {report}")
    if rows and columns.lost == rows:
        say("warning: no run has a result")
        raise typer.Exit(MISSED)


def _as_dict(columns: StudyResults) -> dict[str, Any]:
    """Return the results of a sweep or a Monte Carlo study for JSON."""
    from clast.study import statistics
    from clast.study.description import SWEEP

    summary = statistics.extremes if columns.study.kind == SWEEP else statistics.spread
    chance = statistics.probability(columns)
    summaries = {name: summary(columns, values) for name, values in columns.measures.items()}
    return {
        "runs": columns.study.n,
        "no_result": columns.lost,
        "reasons": {**columns.reasons, **columns.remarks},
        "failed": int(columns.fails.sum()) if len(columns.fails) else None,
        "probability_of_failure": None if chance is None else vars(chance),
        "measures": {
            name: None if found is None else asdict(found) for name, found in summaries.items()
        },
        "blocks": dict(columns.blocks),
        "joints": dict(columns.joints),
    }


def _sensitivities(columns: StudyResults) -> dict[str, list[SensitivityIndex]]:
    """Return the indices of sensitivity of each measure; say why where there are none."""
    from clast.study.statistics import sensitivities

    try:
        return {name: sensitivities(columns, one) for name, one in columns.measures.items()}
    except CaseError as error:
        say(f"warning: {error.what}: {error.remedy}")
        return {}


def print_collapse(found: Collapse, as_json: bool, quiet: bool) -> None:
    """Write the report of a study of collapse; print its result."""
    from clast.study.collapsing.collapse_report import write_collapse
    from clast.study.folder import StudyFolder

    there = StudyFolder.opened(found.folder or Path())
    report = write_collapse(there, found)
    if as_json:
        print_json(found.as_dict())
    elif not quiet:
        tell(found.sentence)
        tell(f"report: {report}")
    for text in found.warnings:
        say(f"warning: {text}")
    if not found.is_settled:
        say(f"warning: {found.sentence}")
        raise typer.Exit(MISSED)
