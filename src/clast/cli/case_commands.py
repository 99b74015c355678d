"""Commands on case files: new, check, schema, run, resume, compare."""

from __future__ import annotations

import dataclasses
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from clast.cli.options import (
    HERE,
    AsJson,
    CaseFile,
    Live,
    LiveAt,
    Quiet,
    Settings,
    Threads,
    Verbose,
    address_of,
    make_folder,
    words,
)
from clast.cli.terminal import (
    SIGNALLED,
    print_json,
    print_line,
    print_table,
    say,
    status,
    tell,
    warn,
)
from clast.cli.terminal_tables import print_comparison, print_run, sanity_table
from clast.errors import CaseError, RunStopped, shortened
from clast.run.interrupts import heard
from clast.spelling import require_known, visible

if TYPE_CHECKING:
    from clast.pictures.live.leader import LivePage
    from clast.results import Run
    from clast.run.schedule import Progress
    from clast.studies import Deviation


@contextmanager
def followed(
    output: Path, wanted: bool, at: str, progress: bool
) -> Iterator[bool | Callable[[Progress], None]]:
    """Yield the watcher of a run: the page of ``output``, if it is wanted, or stdin and stdout.

    The page stays, when the run is over, as long as somebody looks at it.
    """
    if not wanted:
        yield progress
        return
    from clast.pictures.live.leader import Led, LivePage

    if at == "-":
        led = Led(sys.stdout.fileno(), open(0, "rb", buffering=0, closefd=False), "end")
        try:
            yield led
        finally:
            led.over()
        return
    page = LivePage(output, address_of(at or HERE, "--live-at"), wants_line=progress)
    say(f"live: {page.address}")
    try:
        try:
            yield page
        except (RunStopped, typer.Exit) as end:
            if isinstance(end, RunStopped) or page.has_ended:
                _stay(page)
            raise
        _stay(page)
    finally:
        page.close()


def _stay(page: LivePage) -> None:
    """Leave the page to those who look at it."""
    page.over()
    if page.is_watched():
        page.wait()


def run(
    case: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Result file; the case's name with .vtkhdf if absent."),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    live: Live = False,
    live_at: LiveAt = "",
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Simulate a case and write its result file."""
    from clast.case.case_file import Case
    from clast.studies import deviations

    target = output or Path(f"{case.stem}.vtkhdf")
    show = partial(print_run, as_json=as_json, quiet=quiet, verbose=verbose)
    with heard(), followed(target, live or bool(live_at), live_at, not quiet) as progress:
        loaded = Case.from_toml(case, settings or ())
        _simulate(
            lambda warn: loaded.run(progress=progress, output=target, warn=warn),
            lambda done: show(done, deviations(loaded, done)),
        )


def _simulate(
    simulate: Callable[[Callable[[str], None]], Run], show: Callable[[Run], None]
) -> None:
    """Simulate, with a function to call once for every warning; show how it went."""
    try:
        done = simulate(lambda warning: warn([warning]))
    except RunStopped as stopped:
        partial_run: Any = stopped.run
        show(partial_run)
        say(f"the results until then are in {partial_run.output}{_continuation(partial_run)}")
        raise
    show(done)
    if not done.report.finished:
        ending = f"the results until then are in {done.output}{_continuation(done)}"
        say(f"{done.report.outcome}; {ending}")
        raise typer.Exit(SIGNALLED + done.ended_by)


def _continuation(run: Run) -> str:
    """Return how a run that has ended before its time goes on."""
    return f"; clast resume {run.checkpoint} continues it" if run.checkpoint else ""


def resume(
    checkpoint: Annotated[
        Path, typer.Argument(metavar="FILE", help="Checkpoint of a run (.checkpoint.h5).")
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="Continue in another file; in the run's own by default."
        ),
    ] = None,
    stage: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="Run this stage again, from the end of the one before it."
        ),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    live: Live = False,
    live_at: LiveAt = "",
    as_json: AsJson = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:
    """Continue a run from its checkpoint."""
    from clast.case.resume import result_file
    from clast.case.resume import resume as go_on

    if stage is not None and not stage.strip():
        raise CaseError(
            "is not the name of a stage",
            where="--stage",
            remedy="name the stage that is to be run again, or leave it out",
        )
    is_live = live or bool(live_at)
    show = partial(print_run, as_json=as_json, quiet=quiet, verbose=verbose)
    target = result_file(checkpoint, output) if is_live else Path()
    with heard(), followed(target, is_live, live_at, not quiet) as progress:
        _simulate(
            lambda warn: go_on(
                checkpoint,
                settings or (),
                stage=stage or "",
                output=output,
                progress=progress,
                warn=warn,
            ),
            lambda done: show(done, _compared(done)),
        )


def _compared(run: Run) -> Sequence[Deviation]:
    """Return how far a run is from the references of the case in its result file."""
    from clast.case.case_file import Case
    from clast.results import read_results
    from clast.studies import deviations

    if run.output is None:
        return ()
    return deviations(Case.from_text(read_results(run.output).case_text, "case"), run)


def check(
    case: CaseFile,
    settings: Settings = None,
    watch: Annotated[
        bool, typer.Option("--watch", help="Check again at each change, until Ctrl+C.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Check a case without running it. Prints counts, masses, supports, stability."""
    from clast.case.case_file import Case

    if watch:
        _watch(case, settings or (), print_line if as_json else _tell_checked)
        return
    loaded = Case.from_toml(case, settings or ())
    if loaded.rockfall is not None:
        rocks = loaded.campaign()
        tell(f"{rocks.count} rocks over {len(rocks.profile) - 1} segments of a profile")
        if "time" not in loaded.model_fields_set:
            return
    with status():
        sanity = loaded.examine()
    if as_json:
        print_json(dataclasses.asdict(sanity))
        return
    print_table(sanity_table(sanity))
    warn(sanity.warnings)
    if not sanity.warnings:
        typer.echo("nothing to object to")


def _watch(case: Path, settings: Iterable[str], show: Callable[[dict[str, Any]], None]) -> None:
    """Show what is found in a case at each change of it, until the key is pressed."""
    from clast.case.checking import checks
    from clast.run.progress import compilation_told

    with suppress(KeyboardInterrupt), compilation_told(say):
        for checked in checks(case, settings):
            if checked is not None:
                show(checked.as_dict())


def _tell_checked(found: dict[str, Any]) -> None:
    """Print what is found in a case, with the lines of the file."""
    clock = time.strftime("%H:%M:%S")
    for kind, key in (("error", "faults"), ("warning", "warnings")):
        for one in found[key]:
            line = f":{one['line']}" if one["line"] else ""
            remedy = f"\n  {one['remedy']}" if one["remedy"] else ""
            where = f"{one['where']}: " if one["where"] and kind == "error" else ""
            say(f"{clock} {found['file']}{line}: {kind}: {where}{one['what']}{remedy}")
    if not found["faults"]:
        many = "rocks that fall" if found["blocks"] is None else f"{found['blocks']} blocks"
        doubts = len(found["warnings"])
        said = f"{doubts} warning{'s' * (doubts != 1)}" if doubts else "nothing to object to"
        tell(f"{clock} {many}: {said}")


def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the case; .toml is added.")],
    template: Annotated[
        str | None,
        typer.Option(
            help="incline, slope, dam, tunnel, lined-tunnel, key-block, wall, shaken-wall, "
            "settling-wall, arch, spreading-arch, arch-bridge, column, dominoes, shear-box, heap "
            "or rockfall; if absent the one called as the case, else incline."
        ),
    ] = None,
) -> None:
    """Write a case file from a template."""
    from clast.case.templates import TEMPLATES

    if template is None:
        own = Path(name).name.removesuffix(".toml")
        template = own if own in TEMPLATES else "incline"
    require_known(template, TEMPLATES, kind="template", where="--template")
    path = Path(name) if name.endswith(".toml") else Path(f"{name}.toml")
    _check_new(name, path)
    path.write_text(TEMPLATES[template], encoding="utf-8")
    command = "rockfall" if "[rockfall]" in TEMPLATES[template] else "run"
    tell(f"wrote {path} from the template {template}; next: clast {command} {path}")


def _check_new(name: str, path: Path) -> None:
    """Refuse names under which no new case file can be written."""
    where = shortened(name, 100) or "the name"
    last = name.replace(os.sep, "/").rpartition("/")[2].removesuffix(".toml")
    if not last.strip(" .") or visible(name) != name or "\n" in name:
        raise CaseError("is not a valid case name", where=where, remedy="e.g. clast new mywall")
    if not path.parent.is_dir():
        raise CaseError(
            f"the folder {shortened(str(path.parent), 100)} does not exist",
            where=where,
            remedy="create it first, or choose a name without a folder",
        )
    if len(os.fsencode(path.name)) > 255:  # bytes, of most file systems
        raise CaseError("is too long a name", where=where, remedy="choose a shorter one")
    if path.exists() or path.is_symlink():
        raise CaseError("already exists", where=where, remedy="choose another name")


def schema() -> None:
    """Print the JSON Schema of case files, for editors."""
    from clast.case.case_file import json_schema

    print_json(json_schema())


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
    """Compare methods on one case. Runs processes and contact laws; writes a page."""
    from clast import studies
    from clast.case.case_file import Case

    loaded = Case.from_toml(case, settings or ())
    processes, laws = words(process), words(law)
    studies.combinations(processes, laws)
    folder = output or Path("build") / f"compare-{loaded.name}"
    make_folder(folder)
    with status() as say:
        comparison = studies.compare(
            loaded, processes, laws, watch=lambda one, at: say(f"{one}: {at.time:.4g} s")
        )
    written = studies.write_comparison(comparison, folder)
    if as_json:
        print_json({**comparison.as_dict(), "files": [str(path) for path in written]})
    elif not quiet:
        print_comparison(comparison)
        tell(f"page: {written[0]}")
