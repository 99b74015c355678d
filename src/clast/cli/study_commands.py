"""The commands of clast study: fos, target, sweep, montecarlo, fit, resume, collect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clast.cli.options import AsJson, CaseFile, Quiet, Settings, words
from clast.cli.study_tables import (
    print_collapse,
    print_collected,
    print_fit,
    print_rockfall,
    print_target,
    print_target_run,
    print_trial,
)
from clast.cli.terminal import status, tell, warn
from clast.errors import CaseError, shortened
from clast.run.interrupts import heard

if TYPE_CHECKING:
    from clast.study.executors import StudyProgress
    from clast.study.folder import StudyFolder
    from clast.study.study_api import HowMade

app = typer.Typer(
    help="Run studies. Factors of safety, sweeps, probability of failure, back-analysis.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

Out = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="DIR", help="Folder; build/study-CASE if absent."),
]
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a study.")]
FactorOf = Annotated[
    str, typer.Option(help="Of factor_of_safety(): the quantity it multiplies or divides.")
]
Joints = Annotated[
    str, typer.Option(metavar="NAME,...", help="Joints whose strength is reduced; all if absent.")
]
Tolerance = Annotated[
    float, typer.Option(metavar="SHARE", help="Relative width of the final bracket.")
]
Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="PATH=VALUE",
        help='Parameters, e.g. "joint.bedding.friction_angle=normal(35, 5)" or "...=[20, 30]".',
    ),
]
Measure = Annotated[
    list[str] | None,
    typer.Option("--measure", metavar="NAME=EXPRESSION", help='E.g. "crest=displacement(A)".'),
]
Fail = Annotated[
    str, typer.Option(metavar="EXPRESSION", help='Criterion of failure, e.g. "crest > 0.05".')
]
Keep = Annotated[str, typer.Option(help='Result files to keep: none, failed, "worst N" or all.')]
Workers = Annotated[
    int | None,
    typer.Option(
        min=1, max=10_000, metavar="N", help="Simultaneous runs; one per processor by default."
    ),
]
Scheduler = Annotated[
    str,
    typer.Option(metavar="ADDRESS", help="Address of a running Dask scheduler, tcp://host:port."),
]
Array = Annotated[
    str, typer.Option(metavar="I/N", help="Make only every N-th run, from the I-th on, here.")
]
Retry = Annotated[bool, typer.Option("--retry-failed", help="Repeat runs that have no result.")]


@app.command()
def fos(
    case: CaseFile,
    by: Annotated[
        str, typer.Option(help='strength, gravity, "load NAME", pga or "pga left".')
    ] = "strength",
    joints: Joints = "",
    tolerance: Tolerance = 0.01,
    start: Annotated[
        float | None,
        typer.Option(
            help="First factor; 1, of pga 0.1, if absent. The bracket grows from it, up or down."
        ),
    ] = None,
    growth: Annotated[float | None, typer.Option(help="Growth of factors until one fails.")] = None,
    refine: Annotated[
        int,
        typer.Option(min=0, max=500, help="Further trials near the bracket, to refine the curve."),
    ] = 0,
    settings: Settings = None,
    output: Out = None,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Find the factor of safety, or the factor of gravity, a load or a push, at collapse."""
    from clast.case.case_file import Case
    from clast.study.collapsing.collapse import collapse
    from clast.study.collapsing.search import FactorSettings

    loaded = Case.from_toml(case, settings or ())
    how = FactorSettings(
        by=by,
        joints=tuple(words(joints)),
        start=start,
        growth=growth,
        tolerance=tolerance,
        refine=refine,
    )
    folder = output or Path("build") / f"study-{loaded.name}"
    warn(loaded.examine().warnings)
    with heard(), status() as show:

        def watch(number: int, trial: Any) -> None:
            show(f"trial {number}: {trial.factor:.6g} {trial.verdict}")
            if not quiet and not as_json:
                print_trial(number, trial)

        result = collapse(loaded, how, folder, watch)
    print_collapse(result, as_json, quiet)


@app.command()
def target(
    case: CaseFile,
    reach: Annotated[
        str, typer.Option(metavar="CONDITION", help='Target, e.g. "factor_of_safety() >= 1.3".')
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option(metavar="PATH=between(A, B)", help="The parameter, and its range."),
    ] = None,
    measure: Measure = None,
    tolerance: Annotated[
        float, typer.Option(metavar="SHARE", help="Width of the final bracket, of the range.")
    ] = 0.002,
    settings: Settings = None,
    output: Out = None,
    by: FactorOf = "strength",
    joints: Joints = "",
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Find the value of a parameter with which a factor of safety or a measure meets a target."""
    from clast.case.case_file import Case
    from clast.study.collapsing.search import FactorSettings
    from clast.study.folder import StudyFolder
    from clast.study.targeting.goal import TargetSettings
    from clast.study.targeting.target import described

    loaded = Case.from_toml(case, settings or ())
    study = described(
        loaded,
        dict(_pairs("--vary", vary, "bolt_kind.anchor.pretension=between(0, 500e3)")),
        TargetSettings(reach=reach, tolerance=tolerance),
        dict(_pairs("--measure", measure, "crest=displacement(A)")),
        FactorSettings(by=by, joints=tuple(words(joints))),
    )
    warn(loaded.examine().warnings)
    _go_on_to_target(StudyFolder.made(_folder(case, output), loaded, study), as_json, quiet)


@app.command()
def sweep(
    case: CaseFile,
    vary: Vary = None,
    measure: Measure = None,
    fail: Fail = "",
    together: Annotated[
        bool, typer.Option("--together", help="Take the lists in step, not all combinations.")
    ] = False,
    keep: Keep = "none",
    settings: Settings = None,
    output: Out = None,
    by: FactorOf = "strength",
    joints: Joints = "",
    tolerance: Tolerance = 0.01,
    workers: Workers = None,
    scheduler: Scheduler = "",
    array: Array = "",
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Run a case over lists of values, or all combinations of them."""
    given = _given(case, settings, vary, measure, by, joints, tolerance)
    given |= {"fail": fail, "keep": keep, "together": together}
    how = _how(workers, scheduler, array)
    _run(given, {"kind": "sweep"}, _folder(case, output), how, as_json, quiet)


@app.command()
def montecarlo(
    case: CaseFile,
    vary: Vary = None,
    correlate: Annotated[
        list[str] | None,
        typer.Option("--correlate", metavar="A,B,R", help="Correlation of two parameters."),
    ] = None,
    measure: Measure = None,
    fail: Fail = "",
    n: Annotated[int, typer.Option("-n", "--runs", help="Number of runs.")] = 100,
    sampling: Annotated[
        str,
        typer.Option(
            help="random, latin-hypercube, sobol, point-estimate; saltelli, morris: sensitivities."
        ),
    ] = "random",
    seed: Annotated[int | None, typer.Option(help="Seed; 1 if absent.")] = None,
    replicates: Annotated[
        int | None, typer.Option(help="Latin hypercubes that the runs are divided among.")
    ] = None,
    keep: Keep = "none",
    settings: Settings = None,
    output: Out = None,
    by: FactorOf = "strength",
    joints: Joints = "",
    tolerance: Tolerance = 0.01,
    workers: Workers = None,
    scheduler: Scheduler = "",
    array: Array = "",
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Estimate the probability of failure and the scatter of measures by random sampling."""
    given = _given(case, settings, vary, measure, by, joints, tolerance)
    given |= {"fail": fail, "keep": keep, "correlate": [_correlation(c) for c in correlate or ()]}
    drawn: dict[str, Any] = {"kind": "montecarlo", "n": n, "sampling": sampling}
    drawn |= {} if seed is None else {"seed": seed}
    drawn |= {} if replicates is None else {"replicates": replicates}
    how = _how(workers, scheduler, array)
    _run(given, drawn, _folder(case, output), how, as_json, quiet)


@app.command()
def fit(
    case: CaseFile,
    observe: Annotated[
        Path, typer.Option(metavar="FILE", help="Table (CSV) with point, time, x, y, sd.")
    ],
    vary: Vary = None,
    settings: Settings = None,
    method: Annotated[
        str, typer.Option(help="least-squares, or es-mda: an ensemble, for many parameters.")
    ] = "least-squares",
    members: Annotated[int, typer.Option(help="Members of the ensemble.")] = 100,
    rounds: Annotated[int, typer.Option(help="Rounds of the ensemble.")] = 4,
    seed: Annotated[int, typer.Option(help="Seed of the ensemble.")] = 1,
    output: Out = None,
    workers: Workers = None,
    scheduler: Scheduler = "",
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Find the parameters that reproduce measured movements (back-analysis)."""
    from clast.case.case_file import Case
    from clast.study.fitting.fit import described
    from clast.study.fitting.observations import FitSettings
    from clast.study.folder import StudyFolder
    from clast.study.work import check_study

    how = FitSettings(method=method, members=members, rounds=rounds, seed=seed)
    loaded = Case.from_toml(case, settings or ())
    ranges = dict(_pairs("--vary", vary, "joint.bedding.shear_stiffness=uniform(1e8, 1e10)"))
    study, made = described(loaded, observe, ranges, how), _how(workers, scheduler, "")
    check_study(loaded, study)
    warn(loaded.examine().warnings)
    there = StudyFolder.made(_folder(case, output), loaded, study)
    _go_on_fitting(there, made, as_json, quiet)


def rockfall(
    case: CaseFile,
    settings: Settings = None,
    output: Out = None,
    workers: Workers = None,
    scheduler: Scheduler = "",
    array: Array = "",
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Follow rocks that fall on a profile: paths, heights, speeds, and the barriers that hold them.

    The case has [rockfall], [surface.NAME] and [[source]]; blocks that it has stand still.
    """
    from clast.case.case_file import Case
    from clast.study.folder import StudyFolder
    from clast.study.rockfall.portions import study_of

    loaded = Case.from_toml(case, settings or ())
    study = study_of(loaded.campaign())
    there = StudyFolder.made(_folder(case, output), loaded, study)
    _go_on(there, _how(workers, scheduler, array), as_json, quiet)


@app.command()
def hand_over(
    folder: Folder,
    path: Annotated[int, typer.Argument(metavar="PATH", help="Number of the path.")],
) -> None:
    """Write the run of the blocks that a path of rockfall strikes, from that blow on."""
    from clast.study.rockfall.hand_over import hand_over as written

    tell(f"case: {written(folder, path)}")


@app.command()
def resume(
    folder: Folder,
    workers: Workers = None,
    scheduler: Scheduler = "",
    array: Array = "",
    retry: Retry = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Continue a study: make the runs that are still missing."""
    from clast.study.collapsing import collapse
    from clast.study.description import COLLAPSE, FIT, TARGET
    from clast.study.folder import StudyFolder

    there = StudyFolder.opened(folder)
    how = _how(workers, scheduler, array, retry)
    if there.study.kind == COLLAPSE:
        with heard(), status():
            result = collapse.go_on(there, None if quiet or as_json else print_trial)
        print_collapse(result, as_json, quiet)
    elif there.study.kind == FIT:
        _go_on_fitting(there, how, as_json, quiet)
    elif there.study.kind == TARGET:
        _go_on_to_target(there, as_json, quiet)
    else:
        _go_on(there, how, as_json, quiet)


@app.command()
def collect(
    folder: Folder,
    parquet: Annotated[bool, typer.Option("--parquet", help="Write Parquet as well.")] = False,
    as_json: AsJson = False,
    quiet: Quiet = False,
) -> None:
    """Write table and report of the finished runs of a study."""
    from clast.study.description import ROCKFALL, SEARCHES
    from clast.study.folder import StudyFolder

    there = StudyFolder.opened(folder)
    if there.study.kind in SEARCHES:
        raise CaseError(
            "is a search, in which each run depends on the one before: there is no report until "
            "it has finished",
            where=str(folder),
            remedy=f"clast study resume {folder}: it uses the finished runs and writes the report",
        )
    printed = print_rockfall if there.study.kind == ROCKFALL else print_collected
    printed(there, parquet, as_json, quiet)


# What they have in common ------------------------------------------------------------------------


def _given(
    case: Path,
    settings: Sequence[str] | None,
    vary: Sequence[str] | None,
    measure: Sequence[str] | None,
    by: str,
    joints: str,
    tolerance: float,
) -> dict[str, Any]:
    """Return the arguments of a study that sweeps and samplings have in common."""
    from clast.case.case_file import Case
    from clast.study.collapsing.search import FactorSettings

    factor = FactorSettings(by=by, joints=tuple(words(joints)), tolerance=tolerance)
    return {
        "case": Case.from_toml(case, settings or ()),
        "vary": dict(_pairs("--vary", vary, "joint.bedding.friction_angle=normal(35, 5)")),
        "measure": dict(_pairs("--measure", measure, "crest=displacement(A)")),
        "factor": None if factor == FactorSettings() else factor,
    }


def _pairs(option: str, given: Sequence[str] | None, example: str) -> Iterator[tuple[str, str]]:
    """Give name and value of options of the kind NAME=VALUE, each name once."""
    seen = set()
    for one in given or ():
        name, equals, value = one.partition("=")
        name = name.strip()
        if not equals or not name or not value.strip():
            what = f"'{shortened(one)}' is not understood"
            raise CaseError(what, where=option, remedy=f'e.g. "{example}"')
        if name in seen:
            remedy = "give each name once"
            raise CaseError(f"'{shortened(name)}' is given twice", where=option, remedy=remedy)
        seen.add(name)
        yield name, value.strip()


def _correlation(text: str) -> tuple[str, str, float]:
    parts = [part.strip() for part in text.split(",")]
    try:
        first, second, value = parts
        return first, second, float(value)
    except ValueError:
        raise CaseError(
            f"'{shortened(text)}' is not a valid correlation of two parameters",
            where="--correlate",
            remedy='write "joint.a.cohesion,joint.a.friction_angle,-0.4"',
        ) from None


def _folder(case: Path, output: Path | None) -> Path:
    return output or Path("build") / f"study-{case.stem}"


def _how(workers: int | None, scheduler: str, array: str, retry: bool = False) -> HowMade:
    """Return how runs are made."""
    from clast.study.study_api import HowMade

    part = None
    if array:
        first, slash, count = array.partition("/")
        whole = slash and first.strip().isdecimal() and count.strip().isdecimal()
        if not whole or not 1 <= int(first) <= int(count):
            raise CaseError(
                f"'{shortened(array)}' is not part of an array",
                where="--array",
                remedy="write e.g. 3/10: every tenth run, from the third on",
            )
        part = (int(first), int(count))
    return HowMade(workers=workers, array=part, retry=retry, scheduler=scheduler)


def _run(
    given: dict[str, Any],
    drawn: dict[str, Any],
    folder: Path,
    how: HowMade,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run a study in a folder; print its results."""
    from clast.study.folder import StudyFolder
    from clast.study.study_api import Study
    from clast.study.work import check_study

    study = Study(**given)
    described = study.described(**drawn)
    check_study(study.case, described)
    warn(study.case.examine().warnings)
    _go_on(StudyFolder.made(folder, study.case, described), how, as_json, quiet)


def _go_on_fitting(there: StudyFolder, how: HowMade, as_json: bool, quiet: bool) -> None:
    """Make the remaining runs of a back-analysis; print its result."""
    from clast.study.fitting.fit import go_on
    from clast.study.fitting.fit_report import write_fit

    with heard(), status() as show:
        result = go_on(there, how, lambda runs, error: show(f"{runs} runs, mean error {error:.4g}"))
    print_fit(result, write_fit(there, result), as_json, quiet)


def _go_on_to_target(there: StudyFolder, as_json: bool, quiet: bool) -> None:
    """Make the remaining runs of a search for a target; print its result."""
    from clast.study.targeting.target import go_on

    with heard(), status():
        result = go_on(there, None if quiet or as_json else print_target_run)
    print_target(there, result, as_json, quiet)


def _go_on(there: StudyFolder, how: HowMade, as_json: bool, quiet: bool) -> None:
    """Run the remaining runs; print the results."""
    from dataclasses import replace

    from clast.study import study_api
    from clast.study.description import ROCKFALL

    with heard(), status() as show:

        def watch(at: StudyProgress) -> None:
            left = "" if at.left is None else f", {_duration(at.left)} left"
            show(f"{at.done} of {at.total} runs{left}")

        study_api.make(there, how if quiet or as_json else replace(how, watch=watch))
    if how.array is None and there.study.kind == ROCKFALL:
        print_rockfall(there, False, as_json, quiet)
    elif how.array is None:
        print_collected(there, False, as_json, quiet)
    elif not quiet:
        tell(f"done; when all parts are: clast study collect {there.path}")


def _duration(seconds: float) -> str:
    """Return a time in words."""
    for size, name in ((86400.0, "d"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.0f} {name}"
    return f"{seconds:.0f} s"
