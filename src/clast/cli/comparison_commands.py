"""Commands about the program itself: verify, warmup."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clast.cli.options import AsJson, Threads, make_folder, words
from clast.cli.terminal import MISSED, print_json, print_table, progress_bar, say, status
from clast.cli.terminal_tables import verification_table
from clast.errors import CaseError

Problems = Annotated[
    list[str] | None,
    typer.Argument(metavar="PROBLEM", help="Names of problems or groups; all if none is named."),
]
Quick = Annotated[bool, typer.Option("--quick", help="Run fewer variants of each.")]
ProcessNames = Annotated[
    str, typer.Option(metavar="NAME,...", help="Only these processes, separated by commas.")
]
LawNames = Annotated[str, typer.Option(metavar="NAME,...", help="Only these contact laws.")]
ReportFolder = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Write a page with figures into this folder too.")
]


def verify(
    problems: Problems = None,
    quick: Quick = False,
    process: ProcessNames = "",
    law: LawNames = "",
    report: ReportFolder = None,
    as_json: AsJson = False,
) -> None:
    """Run verification problems. Compares them with their closed-form answers."""
    from clast import verification

    choose = verification.narrowed(
        verification.quick if quick else verification.every, words(process), words(law)
    )
    if report:
        make_folder(report)
    with status() as say:
        findings = verification.examine(
            problems or (),
            choose=choose,
            watch=lambda problem, variant: say(f"{problem.title}: {variant.name}"),
        )
    rows = [row for one in findings for row in one.rows]
    if not rows:
        raise CaseError(
            "this selection contains no runs", remedy="leave out --quick, --process or --law"
        )
    missed = verification.misses(rows)
    if report:
        verification.write_report(findings, report)
    if as_json:
        print_json({"passed": not missed, "rows": [row.as_dict() for row in rows]})
    else:
        for problem in verification.problems(problems or ()):
            compared = [row for row in rows if row.problem == problem.name]
            if compared:
                print_table(verification_table(problem.title, compared))
        for known in verification.fixed_failures(findings):
            typer.echo(f"no longer fails: {known.quantity}, {known.variant.name}: {known.reason}")
        typer.echo(f"{len(rows)} quantities compared, {len(missed)} missed")
    if missed:
        raise typer.Exit(MISSED)


def warmup(
    threads: Threads = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Number of compiling processes; one per core by default."),
    ] = None,
    first: Annotated[
        bool, typer.Option("--first", help="Compile only the kernels of the incline.")
    ] = False,
) -> None:
    """Compile the kernels ahead of the first run."""
    from time import perf_counter

    from clast.studies.warmup import warm_up

    start = perf_counter()
    say("compiling, once after installation, by all cores: a minute or two")
    parts = ("first",) if first else ("first", "others")
    with progress_bar("last") as show:
        warm_up(lambda what, done, of: show(done, of, what), workers=workers, of=parts)
    typer.echo(f"kernels are ready after {perf_counter() - start:.1f} s")
