"""Commands that run many models: verify, bench, warmup."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from clast.cli.exit_codes import MISSED
from clast.cli.options import AsJson, Threads, make_folder, words
from clast.cli.terminal import compiling, json_text, print_json, print_table, status
from clast.cli.terminal_tables import print_benchmark, verification_table
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
    Path | None,
    typer.Option(metavar="FOLDER", help="Write a page with figures into this folder too."),
]


def verify(
    problems: Problems = None,
    quick: Quick = False,
    process: ProcessNames = "",
    law: LawNames = "",
    report: ReportFolder = None,
    as_json: AsJson = False,
) -> None:
    """Run the verification problems and compare with their closed-form answers."""
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
    rows = [row for found in findings for row in found.rows]
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
            own = [row for row in rows if row.problem == problem.name]
            if own:
                print_table(verification_table(problem.title, own))
        for known in verification.fixed_failures(findings):
            typer.echo(f"no longer fails: {known.quantity}, {known.variant.name}: {known.reason}")
        typer.echo(f"{len(rows)} quantities compared, {len(missed)} missed")
    if missed:
        raise typer.Exit(MISSED)


Scenes = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="SCENE",
        help="wall, stack, heap, slope; all of these if none is named; "
        "whole: scenes from beginning to end, or one of them, rest, collapse, dominoes, slide; "
        "cut: networks of joints that are only cut, or one of them, persistent or baecher.",
    ),
]
Sizes = Annotated[
    str | None,
    typer.Option(
        metavar="N,...",
        help="Numbers of blocks, separated by commas; 100,1000 if absent, whole: 100, cut: 100000.",
    ),
]
Step = Annotated[float, typer.Option(metavar="H", help="Length of a step, s.")]
Steps = Annotated[int | None, typer.Option(metavar="K", help="Steps; 50 if absent.")]
End = Annotated[
    float | None, typer.Option(metavar="T", help="Simulated time, s, instead of --steps.")
]
Settle = Annotated[int, typer.Option(metavar="K", help="Steps run beforehand and not counted.")]
Stiffness = Annotated[
    float, typer.Option(metavar="SHARE", help="Normal stiffness p as a share of E.")
]
SolverName = Annotated[str, typer.Option(metavar="NAME", help="Solver, as in case files.")]
JsonFile = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="FILE", help="Also write JSON to this file."),
]
StatesFolder = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER", help="Keep the first and last state of every run in this folder."
    ),
]


def bench(
    scenes: Scenes = None,
    size: Sizes = None,
    step: Step = 1e-3,
    steps: Steps = None,
    end: End = None,
    settle: Settle = 0,
    stiffness: Stiffness = 1.0,
    solver: SolverName = "auto",
    output: JsonFile = None,
    results: StatesFolder = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Benchmark scenes of any size: time by stage, iterations, accuracy, memory.

    Of scenes from beginning to end: processor time by stage, share of impacts, steps,
    iterations, overlap, unaccounted energy; they have their own step and stiffness.
    Of networks that are only cut: time by stage, memory, and the error of the total area.
    """
    from clast.studies.bench import SCENES, BenchSettings, benchmark, sizes_in

    wanted = BenchSettings(
        scenes=tuple(dict.fromkeys(scenes or SCENES)),
        sizes=None if size is None else sizes_in(size),
        step=step,
        steps=steps,
        end=end,
        settle=settle,
        share=stiffness,
        solver=solver,
        results=results,
    )
    if output is not None and not output.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(output), remedy="create it first")
    with status() as say:
        measured = benchmark(wanted, say)
    if output is not None:
        output.write_text(json_text(measured.as_dict()) + "\n", encoding="utf-8")
    if as_json:
        print_json(measured.as_dict())
    else:
        print_benchmark(measured)


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
    """Compile the kernels ahead of the first run, for the given number of threads."""
    from time import perf_counter

    from clast.studies.warmup import warm_up

    start = perf_counter()
    with compiling() as watch:
        warm_up(watch, workers=workers, of=("first",) if first else ("first", "others"))
    typer.echo(f"kernels are ready after {perf_counter() - start:.1f} s")
