"""Resume a run from its checkpoint, or run a stage of it again: rebuild, and verify that all fits.

run = clast.resume("wall.checkpoint.h5")
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clast import spelling
from clast.case.case_file import Case
from clast.errors import CaseError, shortened
from clast.inputs.method import OutputTable
from clast.model.model import Model
from clast.results import Run
from clast.results.checkpoints import reopen
from clast.results.checkpoints.checkpoint import (
    OBJECTS,
    SETTINGS,
    TEXT,
    Checkpoint,
    Source,
    belongs,
)
from clast.results.checkpoints.checkpoint_files import checkpoint_path, damaged, read_checkpoint
from clast.results.checkpoints.encode import classes_near
from clast.results.checkpoints.fingerprints import (
    SHAPE,
    digest,
    fingerprints,
    print_of_named,
    print_of_text_in,
)
from clast.results.checkpoints.reopen import is_file_name, taken_over

if TYPE_CHECKING:
    from clast.run.schedule import Progress, Schedule
    from clast.step.method import Method


LATER = frozenset({"time.end", "output.checkpoint_every"})
"""Keys that change nothing before a checkpoint."""
LISTED_MAX = 6


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """A run that is ready to go on."""

    model: Model
    method: Method
    source: Source
    """Where it comes from, with its changed settings."""
    output: OutputTable | None
    """Its output settings; None where a script gave no keys."""
    warnings: tuple[str, ...]
    """Warnings known before the first step."""


def resume(
    path: str | Path,
    settings: Sequence[str] = (),
    *,
    stage: str = "",
    output: str | Path | None = None,
    model: Model | None = None,
    method: Method | None = None,
    progress: bool | Callable[[Progress], None] = False,
    warn: Callable[[str], None] | None = None,
) -> Run:
    """Return the run that a checkpoint is of, from there to its end.

    It appends to its result file, which is first cut back to the checkpoint: the file in the end is
    that of a run that was never interrupted, to the bit.  ``output`` is another file to go on in: a
    copy, or, if the old file is missing, a file of the steps after the checkpoint.  ``settings``
    may be ``["time.end=2"]``, which lets the run go on for longer.  With ``stage``, the name of
    one, the run goes on from the end of the stage before it, with any settings that leave the
    blocks and the stages before as they are.  A script gives its ``model`` again, and its
    ``method`` where that holds objects of its own.  ``progress`` and ``warn`` are those of
    ``Case.run``.

    Raises CaseError for a file that is not a checkpoint, for a model that has changed, and for a
    result file that does not fit; RunStopped where the run cannot go on.
    """
    path = Path(path)
    known = {} if model is None else classes_near(model.actions)
    checkpoint = read_checkpoint(path, known)
    source = checkpoint.source
    _check_source(source, path)
    if stage:
        path, checkpoint = stage_before(checkpoint, path, stage, known)
        now = _prepared_again(source, checkpoint, path, settings)
    else:
        now = _prepared(checkpoint, path, settings, model, method)
    _check_content(checkpoint, path, now)

    from clast.run.launch import Launch, Target, launch

    def target(say: Callable[[str], None]) -> Target:
        file, recorded = taken_over(path, now.model, checkpoint.recorded, output, say)
        return Target(output=file, recorded=recorded)

    return launch(
        Launch(
            model=now.model,
            method=now.method,
            schedule=now.source.schedule,
            remarks=tuple(_remarks(checkpoint)),
            foreseen=lambda: now.warnings,
            source=lambda: now.source,
            target=target,
            case_text=now.source.text,
            contacts=now.output.contacts if now.output else True,
            checkpoint_every=now.output.checkpoint_every if now.output else None,
            begin=checkpoint.run,
        ),
        progress,
        warn,
    )


def result_file(path: str | Path, output: str | Path | None = None) -> Path:
    """Return the result file in which a checkpoint goes on: ``output``, or that of its run."""
    if output is not None:
        return Path(output)
    return Path(path).resolve().parent / read_checkpoint(Path(path), {}).recorded.file


def _prepared(
    checkpoint: Checkpoint,
    path: Path,
    settings: Sequence[str],
    model: Model | None,
    method: Method | None,
) -> Prepared:
    """Rebuild model and method; raises CaseError unless they are unchanged."""
    source = checkpoint.source
    for key, equals in ((one.partition("=")[0].strip(), "=" in one) for one in settings):
        if key and equals and key not in LATER:
            raise CaseError(
                f"'{shortened(key)}' would change the run before its checkpoint",
                where="--set",
                remedy="a resumed run may change time.end and output.checkpoint_every; with "
                "--stage NAME a stage is run again with other numbers; else run the case again",
            )
    needed = {TEXT: (), SETTINGS: ("model",), OBJECTS: ("model", "method")}[source.gives]
    given = {"model": model, "method": method}
    missing = ", ".join(f"{name}=..." for name in needed if given[name] is None)
    if missing:
        what = "comes from a script: the objects that a file cannot hold must be given again"
        remedy = f"in the script: clast.resume('{path.name}', {missing})"
        raise CaseError(what, where=str(path), remedy=remedy)
    case = None if source.gives == OBJECTS else _case(source, path, settings)
    schedule = dataclasses.replace(source.schedule, end=_end(case, settings, checkpoint))
    model = model or _known(case).model()
    method = method or _known(case).method(model)
    _check_same(path, checkpoint, fingerprints(model=model, method=method))
    if case is None or source.gives != TEXT:
        from clast.run.preflight import examine

        warnings = examine(model, method, schedule).warnings
    else:
        warnings = case.foreseen(model, method)
    return Prepared(
        model=model,
        method=method,
        source=dataclasses.replace(
            source,
            text=case.text if case else source.text,
            file=case.file if case else source.file,
            schedule=schedule,
        ),
        output=case.output if case else None,
        warnings=warnings,
    )


def _prepared_again(
    source: Source, checkpoint: Checkpoint, path: Path, settings: Sequence[str]
) -> Prepared:
    """Return the parts for running a stage again; raises CaseError where they do not fit.

    The checkpoint is that of the end of the stage before, ``source`` where the run came from whose
    stage it is.
    """
    if source.gives != TEXT:
        what = "comes from a script, where a stage cannot be run again by itself"
        remedy = "write the model as a case file (builder.to_toml), or run the script again"
        raise CaseError(what, where=str(path), remedy=remedy)
    _as_it_was(source, path)
    case = Case.from_text(
        source.text, str(_folder(source, path) / Path(source.file).name), settings
    )
    model, schedule = case.model(), case.schedule()
    method = case.method(model)
    check_fits(checkpoint, path, model, schedule, case.method(model).fixed_point_stiffness)
    now = fingerprints(model=model, method=method)
    return Prepared(
        model=model,
        method=method,
        source=dataclasses.replace(
            source, text=case.text, file=case.file, schedule=schedule, fingerprints=now
        ),
        output=case.output,
        warnings=(*case.foreseen(model, method), *not_as_before(checkpoint, now)),
    )


def _known(case: Case | None) -> Case:
    """Return a case that is there."""
    if case is None:
        raise RuntimeError("pass the parts that come from a script again")
    return case


def _remarks(checkpoint: Checkpoint) -> Iterator[str]:
    """Warn where the version or the case file has changed since the run began."""
    from clast.results.run_report import version_of

    here, source = version_of("clast"), checkpoint.source
    if checkpoint.version != here:
        yield (
            f"the checkpoint is of clast {checkpoint.version}, this is {here}: results may differ "
            "in their last digits from those of an uninterrupted run"
        )
    now = print_of_text_in(Path(source.file))
    if now and source.file_text and now != source.file_text:
        yield (
            f"{source.file} has changed since the run began: the run continues with the case in "
            "its checkpoint. To use the changed file, run it again: clast run"
        )


def _check_content(checkpoint: Checkpoint, path: Path, now: Prepared) -> None:
    """Raise CaseError where a checkpoint does not fit this model and its stages."""
    from clast.run.run_state import RunState
    from clast.run.stages import checkpoint_checks

    run, recorded = checkpoint.run, checkpoint.recorded
    if not isinstance(run, RunState):
        raise damaged(path, "it carries no run")
    wrong = next(reopen.faults(recorded, now.model, checkpoint.time), "") or next(
        checkpoint_checks.faults(run, now.model, now.method, now.source.schedule), ""
    )
    if not wrong and not run.state.time == checkpoint.time:
        wrong = "its times differ"
    steps = int(recorded.frame["steps"][0]) + len(recorded.since["steps"]) if not wrong else 0
    if not wrong and run.tally.steps != steps:
        wrong = "its steps are not those that were recorded"
    if wrong:
        raise damaged(path, wrong)


def _check_source(source: Source, path: Path) -> None:
    """Raise CaseError where a checkpoint does not say where its run came from."""
    from clast.run.schedule import Schedule

    schedule, most = source.schedule, sys.float_info.max
    wrong = source.gives not in (TEXT, SETTINGS, OBJECTS) or not isinstance(schedule, Schedule)
    if not wrong:
        lengths = (schedule.step, schedule.end, schedule.every, schedule.smallest_step or 1.0)
        wrong = not all(0.0 < length <= most for length in lengths)
    if wrong:
        raise damaged(path, "it does not say when to simulate")


def _as_it_was(source: Source, path: Path) -> Case:
    """Return the case of a checkpoint's text; no file is looked at that it does not name."""
    case = Case.from_text(source.text, source.file)
    if source.gives == TEXT and (
        set(case.named_files()) != set(source.files)
        or digest(case.schedule()) != digest(source.schedule)
    ):
        raise damaged(path, "its case is another than its run's")
    return case


def _case(source: Source, path: Path, settings: Sequence[str]) -> Case:
    """Return the case of a text with settings; frames stay where they were to be."""
    case = _as_it_was(source, path)
    folder = _folder(source, path)
    file = str(folder / Path(source.file).name) if source.gives == TEXT else source.file
    if not settings:
        return case if file == source.file else Case.from_text(source.text, file)
    kept = () if case.output.every else (f"output.every={source.schedule.every!r}",)
    return Case.from_text(source.text, file, (*settings, *kept))


def _folder(source: Source, path: Path) -> Path:
    """Return the folder with the files that a case names, as they were."""
    folders = Path(source.file).parent, path.resolve().parent
    changed: list[str] = []
    for folder in folders:
        wrong = [name for name, was in source.files.items() if print_of_named(folder / name) != was]
        if not wrong:
            return folder
        changed = changed or wrong
    raise CaseError(
        f"the case names {shortened(changed[0], 100)}, which is missing or has changed since the "
        "checkpoint was written",
        where=str(folders[0] / changed[0]),
        remedy=f"put it back as it was, there or in {folders[1]}",
    )


def _end(case: Case | None, settings: Sequence[str], checkpoint: Checkpoint) -> float:
    """Return the end of the run, s: as before, or from the settings."""
    end: float = checkpoint.source.schedule.end
    if not any(setting.partition("=")[0].strip() == "time.end" for setting in settings):
        return end
    end = _known(case).time.end
    if end < checkpoint.time:
        what = f"{end:g} s is over: the checkpoint is of t = {checkpoint.time:.6g} s"
        remedy = "set a later end, or run the case again"
        raise CaseError(what, where="--set time.end", remedy=remedy)
    return end


def _check_same(path: Path, checkpoint: Checkpoint, now: Mapping[str, str]) -> None:
    """Raise CaseError where model or method have changed, and name the differences."""
    before = checkpoint.source.fingerprints
    names = sorted(set(before) | set(now))
    other = [name for name in names if before.get(name) != now.get(name)]
    if other:
        listed = ", ".join(other[:LISTED_MAX])
        more = f" and {len(other) - LISTED_MAX} more" if len(other) > LISTED_MAX else ""
        what = f"is the checkpoint of another run; changed parts: {listed}{more}"
        remedy = (
            f"give the model and the method of that run (clast {checkpoint.version}), or run the "
            "case again"
        )
        raise CaseError(what, where=str(path), remedy=remedy)


KEPT = (*SHAPE, "measured_points")
"""Parts of a model that must be unchanged."""


def stage_before(
    checkpoint: Checkpoint, path: Path, stage: str, known: Mapping[str, type]
) -> tuple[Path, Checkpoint]:
    """Return the checkpoint of the end of the stage before ``stage``, beside another of the run."""
    names = [one.name for one in checkpoint.source.schedule.stages]
    if stage not in names:
        what = f"the run has no stage '{shortened(stage)}'"
        remedy = spelling.advice(stage, names, kind="stage") if names else "leave it out"
        raise CaseError(what, where="--stage", remedy=remedy)
    at = names.index(stage)
    if at == 0:
        what = f"'{stage}' is the first stage: there is none before it"
        remedy = "run the case again: clast run CASE --set ..."
        raise CaseError(what, where="--stage", remedy=remedy)
    if checkpoint.stage == names[at - 1]:
        return path, _at_its_end(checkpoint, path, names[:at])
    if not is_file_name(checkpoint.recorded.file):
        raise damaged(path, "it names a result file that does not lie beside it")
    before = checkpoint_path(path.resolve().parent / checkpoint.recorded.file, names[at - 1])
    if not before.exists():
        what = f"there is no checkpoint of the end of stage '{shortened(names[at - 1])}'"
        remedy = "put it beside the named one, or run the case again"
        raise CaseError(what, where=str(before), remedy=remedy)
    ended = _at_its_end(read_checkpoint(before, known), before, names[:at])
    runs = [(one.recorded.lineage, one.recorded.frames) for one in (ended, checkpoint)]
    (first, frames), (second, later) = runs
    if not belongs(first, frames, second) and not belongs(second, later, first):
        what = f"belongs to another run than {path.name}"
        remedy = (
            "name a checkpoint of the run that wrote the result file last, or run the case again"
        )
        raise CaseError(what, where=str(before), remedy=remedy)
    return before, ended


def _at_its_end(checkpoint: Checkpoint, path: Path, names: Sequence[str]) -> Checkpoint:
    """Return a checkpoint if it is of the end of the last of these stages; else raise CaseError."""
    position: Any = getattr(checkpoint.run, "position", None)
    at_end = checkpoint.stage == names[-1] and position is not None and position.over
    if not at_end or len(position.starts) != len(names):
        what = f"is not a checkpoint of the end of stage '{shortened(names[-1])}'"
        raise CaseError(what, where=str(path), remedy="run the case again")
    return checkpoint


def check_fits(
    checkpoint: Checkpoint, path: Path, model: Model, schedule: Schedule, stiffness: float
) -> None:
    """Raise CaseError where a model and its stages do not fit a checkpoint.

    ``stiffness`` is that of the supports, N/m per m.
    """
    source, state = checkpoint.source, checkpoint.run.state
    remedy = "change numbers of this stage and later ones only, or run the case again"
    before = source.fingerprints
    other = [name for name in KEPT if before.get(f"model.{name}") != digest(getattr(model, name))]
    if other:
        what = f"has other blocks or points than the case with these settings: {', '.join(other)}"
        raise CaseError(what, where=str(path), remedy=remedy)
    for was, now in zip(source.schedule.stages, schedule.stages, strict=False):
        if digest(was) != digest(now):
            what = f"the settings change stage '{was.name}', which has already finished"
            raise CaseError(what, where="--set", remedy=remedy)
        if was.name == checkpoint.stage:
            break
    from clast.actions.active import actions_of
    from clast.actions.damping import Undamped

    acting = actions_of(model, stiffness, Undamped())
    same = len(state.actions) in (0, len(acting))
    if not same or state.points.shape != model.material_points.at.shape:
        what = "the settings add or remove loads, supports or other actions"
        raise CaseError(what, where="--set", remedy=remedy)


def not_as_before(checkpoint: Checkpoint, now: Mapping[str, str]) -> Iterator[str]:
    """Say which parts of model and method have fingerprints other than in the stages before."""
    before = checkpoint.source.fingerprints
    other = [name for name in now if before.get(name) != now[name]]
    if other:
        yield (
            f"the stages until '{checkpoint.stage}' were run with other numbers of "
            f"{', '.join(other)}: run the case again if they should change there too"
        )
