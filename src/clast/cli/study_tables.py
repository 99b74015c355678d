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
    from clast.study.collapsing.search import Trial
    from clast.study.collapsing.support_forces import SupportForce
    from clast.study.fitting.fitting import Fit
    from clast.study.folder import StudyFolder
    from clast.study.statistics import Sensitivities, StudyResults
    from clast.study.targeting.target import Target, TargetRun


SUPPORTS_MAX = 20
"""Rows of the table of supports, at most."""


def print_trial(number: int, trial: Trial) -> None:
    """Print a line for a trial."""
    from clast.study.collapsing.collapse import listed

    tell(
        f"{number:4d}  {trial.factor:<10.6g} {trial.verdict:<10s} {trial.displacement:>9.3g} m  "
        f"{trial.steps:5d} steps  {listed(trial.blocks, 3)}"
    )


def print_fit(result: Fit, report: Path, as_json: bool, quiet: bool) -> None:
    """Print the result of a back-analysis, and where its report is."""
    if as_json:
        print_json({**result.as_dict(), "folder": str(report.parent)})
    if as_json or quiet:
        return
    columns = zip(result.parameter, result.value, result.low, result.high, strict=True)
    rows = [(name, *(f"{one:.5g}" for one in numbers)) for name, *numbers in columns]
    title = f"{len(result.observed)} observations, {result.runs} runs"
    print_table(table_of(title, ("parameter", "value", "95 %: from", "to"), rows))
    misfit = result.predicted - result.observed
    tell(f"largest difference of computed and measured: {abs(misfit).max():.3g} m")
    for k, first in enumerate(result.parameter):
        for n, second in enumerate(result.parameter[:k]):
            tell(f"correlation of {second} and {first}: {result.correlation[k, n]:.2f}")
    if result.remark:
        tell(result.remark)
    tell(f"report: {report}")


def print_target_run(run: TargetRun) -> None:
    """Print a line for a run of a search for a target."""
    from clast.study.distributions import value_text

    word = {True: "reached", False: "not reached", None: "undecided"}[run.reached]
    numbers = "".join(f"  {name} = {value_text(one)}" for name, one in run.measures.items())
    tell(
        f"{run.number:4d}  {value_text(run.value):<12s} {word:<12s}{numbers}  {run.reason}".rstrip()
    )


def print_target(there: StudyFolder, result: Target, as_json: bool, quiet: bool) -> None:
    """Write the report of a search for a target; print its result."""
    from clast.study.targeting.target_report import write_target

    report = write_target(there, result)
    if as_json:
        print_json(result.as_dict())
    elif not quiet:
        tell(result.sentence)
        if result.supported:
            title = f"supports in run {result.supported.number}"
            _print_supports(there, title, result.supported.supports)
        tell(f"report: {report}")
    if not result.is_settled:
        say(f"warning: {result.sentence}")
        raise typer.Exit(MISSED)


def _print_supports(there: StudyFolder, title: str, supports: Sequence[SupportForce]) -> None:
    """Print the first of the forces of anchors, linings and links."""
    from clast.study.collapsing.support_forces import HEADS

    rows = [one.row for one in supports[:SUPPORTS_MAX]]
    print_table(table_of(title, HEADS, rows, words=(0, 1, 2, 6)))
    if len(supports) > SUPPORTS_MAX:
        tell(f"all {len(supports)} are in {there.path / 'supports.csv'}")


def _print_results(columns: StudyResults, rows: int) -> None:
    """Print the result of a sweep or a Monte Carlo study."""
    from clast.study import statistics
    from clast.study.description import SWEEP
    from clast.study.distributions import value_text

    lines: list[Sequence[str]] = []
    if columns.study.kind == SWEEP:
        heads = ["measure", "extreme", "value", "in run", *(one.name for one in columns.study.vary)]
        for name, values in columns.measures.items():
            for word, one in (statistics.extremes(columns, values) or {}).items():
                where = [value_text(value) for value in one.parameters.values()]
                lines.append((name, word, f"{one.value:.5g}", str(one.run), *where))
    else:
        heads = ["measure", *statistics.Spread.HEADS]
        for name, values in columns.measures.items():
            spread = statistics.spread(columns, values)
            if spread is not None:
                lines.append((name, *(f"{number:.5g}" for number in spread.row)))
    words = (0, 1) if columns.study.kind == SWEEP else (0,)
    print_table(table_of(f"{rows} of {columns.study.n} runs", heads, lines, words=words))
    probability = statistics.probability(columns)
    if probability is not None:
        tell(f"probability of failure {probability}")
    elif len(columns.fails):
        tell(f"{int(columns.fails.sum())} of {len(columns.fails)} runs fail")
    for sentence in columns.gaps:
        tell(sentence)
    for reason, count in columns.reasons.items():
        tell(f"{count} without a result: {reason}")


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
    indices: dict[str, Sensitivities] = {}
    try:
        for name, values in columns.measures.items():
            indices[name] = statistics.sensitivities(columns, values)
    except CaseError as error:
        say(f"warning: {error.what}: {error.remedy}")
    if as_json:
        content = {"folder": str(there.path), "done": rows, **_as_dict(columns)}
        print_json({**content, "sensitivity": indices})
    elif not quiet:
        _print_results(columns, rows)
        for name, index in indices.items():
            lines = [
                (one, *(f"{value:.3g}" for value in numbers.values()))
                for one, numbers in index.items()
            ]
            if lines:
                heads = ("parameter", *next(iter(index.values())))
                print_table(table_of(f"sensitivity of {name}", heads, lines))
        tell(f"table: {there.path / trial_table.CSV}\nreport: {report}")
    if rows and columns.lost == rows:
        say("warning: no run has a result")
        raise typer.Exit(MISSED)


def print_rockfall(there: StudyFolder, parquet: bool, as_json: bool, quiet: bool) -> None:
    """Write tables and report of rockfall; print where rocks ended and the hits of barriers."""
    from collections import Counter

    from clast.study.rockfall.page import write_page
    from clast.study.rockfall.report import write_report
    from clast.study.rockfall.results import BARRIER_HEADS, RockfallResults, told

    there.tidy()
    results = RockfallResults.of(there)
    files = results.write() + (results.write_parquet() if parquet else [])
    report, page = write_report(there, results), write_page(results)
    ends, barriers = Counter(results.paths["end"]), results.barriers()
    if as_json:
        content = {"folder": str(there.path), "paths": len(results), "ends": ends}
        print_json({**content, "barriers": barriers, "page": str(page), "report": str(report)})
    elif not quiet:
        rows = [(name, str(count)) for name, count in sorted(ends.items())]
        print_table(table_of(f"{len(results)} paths", ("end", "paths"), rows))
        if barriers:
            lines = [
                (name, *("-" if one is None else f"{one:.4g}" for one in numbers))
                for name, *numbers in told(barriers, BARRIER_HEADS)
            ]
            print_table(table_of("barriers", tuple(BARRIER_HEADS.values()), lines))
        if remark := results.remark_on_blocks:
            say(f"warning: {remark}")
        tables = (f"table: {file}" for file in files)
        tell("\n".join([*tables, f"page: {page}", f"report: {report}"]))


def _as_dict(columns: StudyResults) -> dict[str, Any]:
    """Return the results of a sweep or a Monte Carlo study for JSON."""
    from clast.study import statistics
    from clast.study.description import SWEEP

    def summary(values: Any) -> Any:
        if columns.study.kind == SWEEP:
            ends = statistics.extremes(columns, values)
            return ends and {word: asdict(one) for word, one in ends.items()}
        spread = statistics.spread(columns, values)
        return spread and asdict(spread)

    chance = statistics.probability(columns)
    return {
        "runs": columns.study.n,
        "no_result": columns.lost,
        "reasons": {**columns.reasons, **columns.remarks},
        "failed": int(columns.fails.sum()) if len(columns.fails) else None,
        "probability_of_failure": None if chance is None else vars(chance),
        "measures": {name: summary(values) for name, values in columns.measures.items()},
        "blocks": dict(columns.blocks),
        "joints": dict(columns.joints),
    }


def print_collapse(result: Collapse, as_json: bool, quiet: bool) -> None:
    """Write the report of a study of collapse; print its result."""
    from clast.study.collapsing.collapse_report import write_collapse
    from clast.study.folder import StudyFolder

    there = StudyFolder.opened(result.folder or Path())
    report = write_collapse(there, result)
    if as_json:
        print_json(result.as_dict())
    elif not quiet:
        tell(result.sentence)
        if result.supports:
            title = f"supports with {result.by.SYMBOL} = {result.low:.6g}, which stands"
            _print_supports(there, title, result.supports)
        tell(f"report: {report}")
    for text in result.warnings:
        say(f"warning: {text}")
    if not result.is_settled:
        say(f"warning: {result.sentence}")
        raise typer.Exit(MISSED)
