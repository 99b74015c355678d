"""The command line: the only place that prints.

Exit codes: 0 done, 1 a verification failed, 2 bad input, 3 a run that could not go on (its
partial results are kept), 130 interrupted, 143 and 129 ended by SIGTERM and SIGHUP.
"""

from __future__ import annotations

import atexit
import dataclasses
import gc
import json
import math
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from clast.errors import CaseError, ClastError, RunStopped, shortened
from clast.run.interrupts import heard
from clast.spelling import visible, without_long_words

if TYPE_CHECKING:
    from rich.table import Table

    from clast.results import Report, Run
    from clast.run.preflight import Sanity
    from clast.studies import Comparison, Deviation
    from clast.studies.bench import Benchmark
    from clast.verification import Row

MISSED = 1
BAD_INPUT = 2
STOPPED = 3
USAGE_ERROR: Any = typer.BadParameter.__base__
"""What the parser of the command line raises."""
SIGNALLED = 128
"""What systems add to the number of the signal that ended a program: 130 for the interrupt key."""

PIPE_WIDTH = 160
"""Width of tables where there is no terminal, characters."""
LONGEST_USAGE = 200
"""Most characters that are said of a command line that cannot be read."""
LONGEST_FILE_NAME = 255
"""Bytes of the longest name of a file."""


class Commands(TyperGroup):
    """Commands whose errors end as one message on stderr and an exit code."""

    def invoke(self, ctx: Any) -> Any:
        """Run a command; say its errors."""
        try:
            return super().invoke(ctx)
        except RunStopped as stopped:
            _say(f"stopped: {stopped}")
            raise typer.Exit(STOPPED) from None
        except ClastError as error:
            _say(f"error: {error}")
            raise typer.Exit(BAD_INPUT) from None
        except USAGE_ERROR as error:
            error.message = visible(shortened(error.message, LONGEST_USAGE))
            raise
        except BrokenPipeError:
            raise
        except OSError as error:
            _say(f"error: {shortened(str(error.filename or 'a file'), 200)}: {error.strerror}")
            raise typer.Exit(BAD_INPUT) from None
        except (KeyboardInterrupt, SystemError) as error:
            # Python makes a SystemError of the key where numba is loading a kernel
            if isinstance(error, SystemError) and not isinstance(
                error.__cause__, KeyboardInterrupt
            ):
                raise
            _say("interrupted")
            raise typer.Exit(_interrupted_by(error)) from None


app = typer.Typer(
    cls=Commands,
    help="Discontinuous deformation analysis of rock and masonry blocks in two dimensions.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich is loaded by commands that print tables, not by --help
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120},
)

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).")]
ResultFile = Annotated[Path, typer.Argument(metavar="FILE", help="Result file of a run.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Replace a value of the case, e.g. time.end=2."
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON for a program to read.")]


Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]


def _share(threads: int | None) -> None:
    """Have kernels share their work among ``threads``; they are not loaded yet."""
    if threads is not None:
        os.environ["NUMBA_NUM_THREADS"] = str(threads)


Threads = Annotated[
    int | None,
    typer.Option(
        "--threads",
        metavar="N",
        min=1,
        max=os.cpu_count(),
        callback=_share,
        help="Threads that share the work, 1 if absent; the results are the same. More than one "
        "pay from some thousand blocks on, where the machine has nothing else to do.",
    ),
]


def _print_version(wanted: bool) -> None:
    if wanted:
        import clast

        typer.echo(f"clast {clast.__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Discontinuous deformation analysis of rock and masonry blocks in two dimensions."""


@app.command()
def run(
    case: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Result file; the case's name with .vtkhdf if absent."),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Simulate a case and write its result file."""
    with heard():
        _run(case, output or Path(f"{case.stem}.vtkhdf"), settings or (), as_json, quiet)


def _run(case: Path, target: Path, settings: Sequence[str], as_json: bool, quiet: bool) -> None:
    """Simulate a case; print how it went."""
    from clast.case.case_file import Case
    from clast.studies import deviations

    loaded = Case.from_toml(case, settings)
    foreseen: list[str] = []

    def foresee(warning: str) -> None:
        foreseen.append(warning)
        _print_warnings([warning])

    try:
        done = loaded.run(progress=not quiet, output=target, warn=foresee)
    except RunStopped as stopped:
        partial: Any = stopped.run
        _print_warnings(text for text in partial.report.warnings if text not in foreseen)
        _print_run(partial, deviations(loaded, partial), as_json=as_json, quiet=quiet)
        _say(f"the results until then are in {target}")
        raise
    _print_warnings(text for text in done.report.warnings if text not in foreseen)
    _print_run(done, deviations(loaded, done), as_json=as_json, quiet=quiet)
    if not done.report.finished:
        _say(f"{done.report.outcome}; the results until then are in {target}")
        raise typer.Exit(SIGNALLED + done.ended_by)


@app.command()
def check(case: CaseFile, settings: Settings = None, as_json: AsJson = False) -> None:
    """Look at a case before its first step: counts, masses, supports, stability, units."""
    from clast.case.case_file import Case

    loaded = Case.from_toml(case, settings or ())
    sanity = loaded.examine()
    if as_json:
        _print_json(dataclasses.asdict(sanity))
        return
    _print_table(_sanity_table(sanity))
    _print_warnings(sanity.warnings)
    if not sanity.warnings:
        typer.echo("nothing to object to")


@app.command()
def info(file: ResultFile, as_json: AsJson = False) -> None:
    """Say what a result file contains."""
    from clast.results import read_results, summary
    from clast.results.about import texts

    results = read_results(file, whole=sys.maxsize)
    content = summary(results)
    if as_json:
        _print_json(content)
        return
    first, last = content["time"]
    warnings = results.report.warnings if results.report else ()
    rows = {
        "outcome": content["outcome"],
        "frames": f"{content['frames']}, from {first:.6g} to {last:.6g} s",
        "blocks": f"{content['blocks']} ({content['fixed_blocks']} fixed)",
        "vertices": f"{content['vertices']}",
        "rocks": ", ".join(content["rocks"]),
        **texts(results.about),
        "largest displacement": f"{content['largest_displacement']:.6g} m",
        "contacts at the end": f"{content['contacts']}",
        "fields": ", ".join(content["fields"]),
        "size": f"{content['size_bytes'] / 1e6:.3g} MB",
        **({"warnings": "\n".join(warnings)} if warnings else {}),
        "version": content["version"],
        "made with": ", ".join(f"{k} {v}" for k, v in content["versions"].items() if k != "clast"),
    }
    _print_table(_two_columns(content["title"], rows))
    _print_points(content["measured_points"])


@app.command()
def plot(
    file: ResultFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Picture; the file's name with .png if absent."),
    ] = None,
    frame: Annotated[int, typer.Option(help="Number of the frame, from 0; -1 is the last.")] = -1,
    field: Annotated[str, typer.Option(help="What colours the blocks.")] = "displacement",
    contacts: Annotated[bool, typer.Option(help="Draw contact forces as arrows.")] = True,
    limits: Annotated[
        str,
        typer.Option(metavar="LOW,HIGH", help="Ends of the colours, in m, m/s, degrees or Pa."),
    ] = "",
    zoom: Annotated[str, typer.Option(metavar="X0,Y0,X1,Y1", help="Draw this part alone, m.")] = "",
    size: Annotated[
        str, typer.Option(metavar="W[,H]", help="Width and height of the picture, cm.")
    ] = "",
    dpi: Annotated[int | None, typer.Option(metavar="N", help="Dots per inch.")] = None,
) -> None:
    """Draw a frame of a result file."""
    from clast.pictures.plot import Look, plot_results
    from clast.results import read_results

    look = Look(
        limits=_numbers("--limits", limits, 2),
        zoom=_numbers("--zoom", zoom, 4),
        size=_numbers("--size", size, 1, 2),
        dpi=dpi,
    )
    target = output or file.with_suffix(".png")
    results = read_results(file)
    plot_results(results, target, frame=frame, field=field, contacts=contacts, look=look)
    _tell(f"picture: {target}")


@app.command()
def new(
    name: Annotated[str, typer.Argument(help="Name of the case; .toml is added.")],
    template: Annotated[str, typer.Option(help="incline, wall or heap.")] = "incline",
) -> None:
    """Write a case file to begin with."""
    from clast import spelling
    from clast.case.templates import TEMPLATES

    if template not in TEMPLATES:
        raise CaseError(
            f"there is no template '{shortened(template)}'",
            where="--template",
            remedy=spelling.advice(template, TEMPLATES, kind="template"),
        )
    path = Path(name) if name.endswith(".toml") else Path(f"{name}.toml")
    _check_new(name, path)
    path.write_text(TEMPLATES[template](), encoding="utf-8")
    _tell(f"wrote {path}; next: clast run {path}")


def _check_new(name: str, path: Path) -> None:
    """Refuse names under which no new case file can be written."""
    where = shortened(name, 100) or "the name"
    last = name.replace(os.sep, "/").rpartition("/")[2].removesuffix(".toml")
    if not last.strip(" .") or visible(name) != name or "\n" in name:
        raise CaseError("is no name of a case", where=where, remedy="e.g. clast new mywall")
    if not path.parent.is_dir():
        raise CaseError(
            f"the folder {shortened(str(path.parent), 100)} does not exist",
            where=where,
            remedy="make it first, or choose a name without a folder",
        )
    if len(os.fsencode(path.name)) > LONGEST_FILE_NAME:
        raise CaseError("is too long a name", where=where, remedy="choose a shorter one")
    if path.exists() or path.is_symlink():
        raise CaseError("exists already", where=where, remedy="choose another name")


@app.command()
def schema() -> None:
    """Print the JSON Schema of the case file, for editors and programs."""
    from clast.case.case_file import json_schema

    _print_json(json_schema())


@app.command()
def verify(
    problems: Annotated[
        list[str] | None,
        typer.Argument(metavar="PROBLEM", help="Names of problems; all if none is named."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Run fewer variants of each.")] = False,
    process: Annotated[
        str, typer.Option(metavar="NAME,...", help="Only these processes, separated by commas.")
    ] = "",
    law: Annotated[str, typer.Option(metavar="NAME,...", help="Only these contact laws.")] = "",
    report: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write a page with figures into this folder too."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Run problems with closed-form answers and compare."""
    from clast import verification

    choose = verification.narrowed(
        verification.quick if quick else verification.every, _words(process), _words(law)
    )
    if report:
        _make_folder(report)
    with _status() as say:
        findings = verification.examine(
            problems or (),
            choose=choose,
            watch=lambda problem, variant: say(f"{problem.title}: {variant.name}"),
        )
    rows = [row for found in findings for row in found.rows]
    if not rows:
        raise CaseError(
            "nothing is run with this choice", remedy="leave out --quick, --process or --law"
        )
    missed = verification.misses(rows)
    if report:
        verification.write_report(findings, report)
    if as_json:
        _print_json({"passed": not missed, "rows": [row.as_dict() for row in rows]})
    else:
        for problem in verification.problems(problems or ()):
            own = [row for row in rows if row.problem == problem.name]
            if own:
                _print_table(_verification_table(problem.title, own))
        for known in verification.outlived(findings):
            typer.echo(f"fails no longer: {known.quantity}, {known.variant.name}: {known.reason}")
        typer.echo(f"{len(rows)} quantities compared, {len(missed)} missed")
    if missed:
        raise typer.Exit(MISSED)


@app.command()
def compare(
    case: CaseFile,
    process: Annotated[
        str, typer.Option(metavar="NAME,...", help="Processes of a step, separated by commas.")
    ] = "modified,open-close,convex",
    law: Annotated[
        str, typer.Option(metavar="NAME,...", help="Contact laws, separated by commas.")
    ] = "penalty,augmented-lagrangian",
    settings: Settings = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder; build/compare-CASE if absent."),
    ] = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Run a case through several processes and contact laws; write a page with a picture."""
    from clast import studies
    from clast.case.case_file import Case

    loaded = Case.from_toml(case, settings or ())
    processes, laws = _words(process), _words(law)
    studies.combinations(processes, laws)
    folder = output or Path("build") / f"compare-{loaded.name}"
    _make_folder(folder)
    with _status() as say:
        comparison = studies.compare(
            loaded, processes, laws, watch=lambda one, at: say(f"{one}: {at.time:.4g} s")
        )
    written = studies.write_comparison(comparison, folder)
    if as_json:
        _print_json({**comparison.as_dict(), "files": [str(path) for path in written]})
    elif not quiet:
        _print_table(_comparison_table(comparison))
        _tell(f"page: {written[0]}")


@app.command()
def bench(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENE", help="wall, stack, heap, slope; all if none is named."),
    ] = None,
    size: Annotated[
        str, typer.Option(metavar="N,...", help="Numbers of blocks, separated by commas.")
    ] = "100,1000",
    step: Annotated[float, typer.Option(metavar="H", help="Length of a step, s.")] = 1e-3,
    steps: Annotated[int | None, typer.Option(metavar="K", help="Steps; 50 if absent.")] = None,
    end: Annotated[
        float | None, typer.Option(metavar="T", help="Simulated time, s, instead of --steps.")
    ] = None,
    settle: Annotated[
        int, typer.Option(metavar="K", help="Steps before these that are not counted.")
    ] = 0,
    stiffness: Annotated[
        float, typer.Option(metavar="SHARE", help="Normal stiffness p as a share of E.")
    ] = 1.0,
    solver: Annotated[str, typer.Option(metavar="NAME", help="Solver, as in case files.")] = "auto",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Write JSON there too.")
    ] = None,
    results: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Keep first and last state of every run there."),
    ] = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Measure what scenes of any size cost: time by stage, iterations, accuracy, memory."""
    from clast.studies.bench import SCENES, Wishes, benchmark, sizes_in

    wanted = Wishes(
        scenes=tuple(dict.fromkeys(scenes or SCENES)),
        sizes=sizes_in(size),
        step=step,
        steps=steps,
        end=end,
        settle=settle,
        share=stiffness,
        solver=solver,
        results=results,
    )
    if output is not None and not output.absolute().parent.is_dir():
        raise CaseError("its folder does not exist", where=str(output), remedy="make it first")
    with _status() as say:
        measured = benchmark(wanted, say)
    if output is not None:
        output.write_text(_json(measured.as_dict()) + "\n", encoding="utf-8")
    if as_json:
        _print_json(measured.as_dict())
    else:
        _print_benchmark(measured)


@app.command()
def warmup() -> None:
    """Compile all kernels ahead of the first run."""
    from dataclasses import replace
    from time import perf_counter

    from clast.case.case_file import Case
    from clast.case.templates import INCLINE
    from clast.linear.solvers import PCG
    from clast.run.simulate import simulate
    from clast.studies.bench.scenes import SCENES
    from clast.studies.bench.wishes import Wishes, method_for, schedule_of

    start = perf_counter()
    for settings in WARMUPS:
        Case.from_toml(INCLINE, ["time.end=0.003", *settings]).run()
    for scene, size, step, share, plain in WARMUP_SCENES:
        model, wishes = SCENES[scene].build(size), Wishes(step=step, steps=1, share=share)
        method = replace(method_for(model, wishes), solver=PCG(plain=plain))
        simulate(model, method, schedule_of(wishes))
    typer.echo(f"kernels are ready after {perf_counter() - start:.1f} s")


WARMUPS = (
    ["method.process=modified"],
    ["method.process={name='modified', friction='implicit'}", "method.rotation=exact"],
    [
        "method.process={name='modified', passes=2}",
        "method.integrator=backward-euler",
        "method.rotation=linear",
    ],
    ["method.process=convex"],
    ["method.process=convex", "method.solver=pcg", "method.corner_rule=shi"],
    ["method.process=open-close", "method.contact_law.name=augmented-lagrangian"],
)
WARMUP_SCENES = (
    ("wall", 60, 1e-3, 1.0, 100),
    ("wall", 60, 1e-3, 1.0, 0),
    ("wall", 60, 1.0, 1.0, 0),
    ("slope", 60, 1e-2, 1e3, 100),
    ("wall", 1600, 1e-3, 1.0, 100),
)
"""Scene, blocks, step, s, p/E and iterations without a coarse system, which need, one after the
other: no such system, one in single and one in double precision, the interior point method, and
blocks that go first because they are the worst of many.  With WARMUPS they reach the kernels of all
processes and solvers."""


def _interrupted_by(error: BaseException) -> int:
    """Return the exit code of a program that a signal, SIGINT if no other, has ended."""
    key = error.__cause__ if isinstance(error, SystemError) else error
    return SIGNALLED + int(getattr(key, "number", signal.SIGINT))


def _print_run(run: Run, deviations: Sequence[Deviation], *, as_json: bool, quiet: bool) -> None:
    """Print the summary of a run and how far it is from its references, as tables or JSON."""
    points = {name: _last_of(run, name) for name in run.model.measured_points.name}
    if as_json:
        content = {"title": run.model.title, "output": str(run.output), "time": run.state.time}
        known = {"measured_points": points, "references": [one.as_dict() for one in deviations]}
        _print_json({**content, **run.report.as_dict(), **known})
    elif not quiet:
        _print_table(_report_table(run))
        _print_points(points)
        for one in deviations:
            source = f" ({one.source})" if one.source else ""
            _tell(f"error of {one.point} at t = {one.time:g} s: {one.as_text()}{source}")
        _tell(f"results: {run.output}")


def _last_of(run: Run, name: str) -> dict[str, Any]:
    """Return where a measured point is at the end of a run."""
    history = run.history(name)
    return {
        "displacement": history.displacement[-1].tolist(),
        "velocity": history.velocity[-1].tolist(),
        "rotation": float(history.rotation[-1]),
    }


def _report_table(run: Run) -> Table:
    """Return how a run went, as a table."""
    report, ledger = run.report, run.report.ledger
    sizes = run.step_sizes
    stages = sorted(report.seconds.items(), key=lambda item: -item[1])
    speed = run.state.time / report.wall_seconds if report.wall_seconds > 0.0 else 0.0
    rows = {
        "outcome": report.outcome,
        "simulated time": f"{run.state.time:.6g} s, {speed:.3g} s per s of wall time",
        "steps": f"{report.steps}, {report.cut_steps} cut; {_counts_text(report)}",
        "step size": f"{sizes.min():.3g} to {sizes.max():.3g} s" if len(sizes) else "",
        "contacts": f"at most {report.largest_contacts}",
        "penetration": f"at most {report.largest_penetration:.3g} m",
        "energy": f"kinetic {ledger.kinetic:.4g}, elastic {ledger.elastic:.4g}, "
        f"gravity {ledger.gravity:.4g} J/m",
        "dissipated": f"friction {ledger.friction:.4g}, impacts {ledger.impacts:.4g}, "
        f"numerical {ledger.numerical:.4g}, unaccounted {ledger.unaccounted:.2g} J/m",
        "wall time": f"{report.wall_seconds:.3g} s: "
        + ", ".join(f"{name} {seconds:.2g}" for name, seconds in stages),
        **_notes_rows(report.notes),
    }
    return _two_columns(run.model.title, rows)


def _counts_text(report: Report) -> str:
    """Return what the process counted, with the number per step where it is no whole one."""
    steps = max(1, report.steps)
    texts = []
    for name, number in {"passes": report.passes, **report.counts}.items():
        share = f" ({number / steps:.3g} a step)" if number % steps else ""
        texts.append(f"{number} {COUNTED.get(name, name)}{share}")
    return ", ".join(texts)


COUNTED = {
    "line_search": "steps of the line search",
    "interior": "minimisations by the interior point method",
    "local": "iterations of few blocks by themselves",
}
"""What a count of the report is called."""


def _notes_rows(notes: Sequence[str]) -> dict[str, str]:
    """Return what clast chose by itself as a row of a table, or none."""
    return {"chosen by clast": "\n".join(notes)} if notes else {}


def _print_points(points: dict[str, dict[str, Any]]) -> None:
    """Print where the measured points are at the end, if there are any."""
    if not points:
        return
    from rich.table import Table
    from rich.text import Text

    table = Table(title="measured points at the end", title_justify="left")
    table.add_column("point", overflow="fold")
    for head in ("u, m", "v, m", "u', m/s", "v', m/s", "rotation, rad"):
        table.add_column(head, justify="right", no_wrap=True)
    for name, last in points.items():
        numbers = (*last["displacement"], *last["velocity"], last["rotation"])
        table.add_row(Text(name), *(f"{number:.5g}" for number in numbers))
    _print_table(table)


def _sanity_table(sanity: Sanity) -> Table:
    """Return what a case consists of and what clast chose by itself, as a table."""
    left, low, right, high = sanity.box
    names = ", ".join(sanity.unsupported[:5]) + (", ..." if len(sanity.unsupported) > 5 else "")
    rows = {
        "blocks": f"{sanity.blocks} ({sanity.fixed_blocks} fixed)",
        "vertices": f"{sanity.vertices}",
        "rocks": ", ".join(sanity.rocks),
        "joints": ", ".join(sanity.joints),
        "fixed points": f"{sanity.fixed_points}",
        "loads": f"{sanity.loads}",
        "measured points": f"{sanity.measured_points}",
        "mass": f"{sanity.mass:.6g} kg/m",
        "bounding box": f"({left:.6g}, {low:.6g}) to ({right:.6g}, {high:.6g}) m",
        "smallest block": f"{sanity.smallest[0]}, {sanity.smallest[1]:.4g} m2",
        "largest block": f"{sanity.largest[0]}, {sanity.largest[1]:.4g} m2",
        "contacts at the start": f"{sanity.contacts} in {sanity.touching_pairs} pairs",
        "unsupported blocks": f"{len(sanity.unsupported)} {f'({names})' if names else ''}".strip(),
        "steps": f"{sanity.steps}",
        "max_displacement": f"{sanity.max_displacement:.4g} m",
        "critdis": f"{sanity.critdis:.4g} m",
        "p h2/m": f"{sanity.stability_number:.4g} "
        f"(without passes at most {sanity.stability_limit:g})",
        **_notes_rows(sanity.notes),
    }
    return _two_columns(sanity.title, rows)


def _verification_table(title: str, rows: Sequence[Row]) -> Table:
    """Return computed values beside exact ones, and below why some are known to fail."""
    from rich.table import Table
    from rich.text import Text

    from clast.verification import HEADINGS, cells

    reasons = dict.fromkeys(row.known_failure for row in rows if row.known_failure)
    table = Table(
        title=Text(title),
        title_justify="left",
        caption=Text("\n".join(f"known to fail: {reason}" for reason in reasons)),
        caption_justify="left",
    )
    # the title names the problem already
    for heading in HEADINGS[1:]:
        numeric = heading in ("computed", "exact", "error", "tolerance")
        table.add_column(heading, justify="right" if numeric else "left", no_wrap=numeric)
    for row in rows:
        table.add_row(*(Text(cell) for cell in cells(row)[1:]))
    return table


def _comparison_table(comparison: Comparison) -> Table:
    """Return what each process and law made of a case, and what is to be said of it below."""
    from rich.table import Table
    from rich.text import Text

    from clast.studies.comparison_table import cells, headings, remarks

    table = Table(
        title=Text(comparison.title),
        title_justify="left",
        caption=Text("\n".join(remarks(comparison))),
        caption_justify="left",
    )
    heads = headings(comparison)
    for heading in heads:
        words = heading in (*heads[:2], heads[-1])
        wraps = heading == heads[-1]
        table.add_column(heading, justify="left" if words else "right", no_wrap=not wraps)
    for row in comparison.rows:
        table.add_row(*(Text(cell) for cell in cells(comparison, row)))
    return table


def _print_benchmark(measured: Benchmark) -> None:
    """Print what scenes cost, by stage below, and what is to be said of it."""
    from clast.studies.bench import table

    rows = measured.rows
    _print_table(_plain_table(table.HEADINGS, [table.cells(row) for row in rows]))
    by_stage = [table.stage_cells(measured, row) for row in rows]
    _print_table(_plain_table(table.stage_headings(measured), by_stage, title="ms per step"))
    memory = [table.memory_cells(measured, row) for row in rows]
    _print_table(_plain_table(table.MEMORY_HEADINGS, memory, title="memory"))
    for remark in table.remarks(measured):
        _tell(remark)


def _plain_table(
    headings: Sequence[str], rows: Sequence[Sequence[str]], title: str | None = None
) -> Table:
    """Return texts as a table whose first column is words and the others numbers."""
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for number, heading in enumerate(headings):
        table.add_column(heading, justify="right" if number else "left", no_wrap=True)
    for row in rows:
        table.add_row(*row)
    return table


def _numbers(option: str, listed: str, *counts: int) -> Any:
    """Return the numbers of a list separated by commas, None for none; ``counts`` are allowed."""
    if not listed:
        return None
    try:
        numbers = tuple(float(word) for word in listed.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in counts:
        many = " or ".join(map(str, counts))
        raise CaseError(
            f"'{listed[:40]}' are not {many} numbers",
            where=option,
            remedy=f"write them with commas and without spaces, e.g. {option} "
            + ",".join(str(number) for number in range(counts[-1])),
        )
    return numbers


def _make_folder(folder: Path) -> None:
    """Make a folder to write pages into, or raise CaseError where something else is there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise CaseError(
            "is not a folder, or lies in something that is none",
            where=str(folder),
            remedy="name a folder for the pages; it is made if it does not exist",
        ) from None


def _words(listed: str) -> list[str]:
    """Return the words of a list separated by commas."""
    return [word.strip() for word in listed.split(",") if word.strip()]


def _two_columns(title: str, rows: dict[str, str]) -> Table:
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title), title_justify="left", show_header=False)
    for key, value in rows.items():
        table.add_row(key, Text(value))
    return table


def _print_table(table: Table) -> None:
    from rich.console import Console
    from rich.text import Text

    cells = (cell for column in table.columns for cell in column.cells)
    for text in (table.title, table.caption, *cells):
        if isinstance(text, Text):
            text.plain = visible(text.plain)
    # a pipe or a file has no width of its own
    width = None if sys.stdout.isatty() else PIPE_WIDTH
    Console(width=width).print(table)


@contextmanager
def _status() -> Iterator[Callable[[str], None]]:
    """Give a function that shows what is going on, where stderr is a terminal."""
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda _: None
        return
    with console.status("starting") as status:
        yield status.update


def _print_json(content: Any) -> None:
    """Print JSON; numbers that JSON does not know become null."""
    typer.echo(_json(content))


def _json(content: Any) -> str:
    return visible(json.dumps(_plain(content), indent=2, ensure_ascii=False))


def _plain(value: Any) -> Any:
    """Return a value made of what JSON knows."""
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _print_warnings(warnings: Iterable[str]) -> None:
    for warning in warnings:
        _say(f"warning: {warning}")


def _say(message: str) -> None:
    """Print a message for the user on stderr."""
    typer.echo(visible(without_long_words(message)), err=True)


def _tell(message: str) -> None:
    """Print what was asked for on stdout."""
    typer.echo(visible(message))


def main() -> None:
    """Run the command line."""
    _spare_the_collector()
    app(prog_name="clast")


def _spare_the_collector() -> None:
    """Let the garbage collector look seldom, and not at all at the end.

    It would go through all that has been loaded, which is no garbage, again and again: a tenth of
    the time until the first step, and as long as a fifth of it when all is done.  Steps leave no
    garbage.
    """
    gc.set_threshold(*COLLECT_AFTER)
    atexit.register(gc.freeze)


COLLECT_AFTER = 20_000, 50, 100
"""Objects more than before after which the collector looks, and how often it looks further."""
