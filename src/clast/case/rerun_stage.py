"""A stage that is run again, with other numbers, from the end of the stage before it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clast import spelling
from clast.errors import CaseError, shortened
from clast.model.model import Model
from clast.model.state import State
from clast.results.checkpoints.checkpoint import Checkpoint, belongs
from clast.results.checkpoints.checkpoint_files import checkpoint_path, damaged, read_checkpoint
from clast.results.checkpoints.fingerprints import SHAPE, digest
from clast.results.checkpoints.reopen import is_file_name

if TYPE_CHECKING:
    from clast.run.schedule import Schedule

KEPT = (*SHAPE, "measured_points")
"""Parts of a model that must be unchanged."""


def stage_before(
    checkpoint: Checkpoint, path: Path, stage: str, known: Mapping[str, type]
) -> tuple[Path, Checkpoint]:
    """Return the checkpoint of the end of the stage before ``stage``, beside another of the run.

    Raises CaseError where there is no such stage, or none before it, and where that checkpoint is
    of another run or of another moment.  ``known`` are classes of scripts.
    """
    names = [one.name for one in _stages(checkpoint.source.schedule)]
    if stage not in names:
        raise CaseError(
            f"the run has no stage '{shortened(stage)}'",
            where="--stage",
            remedy=spelling.advice(stage, names, kind="stage") if names else "leave it out",
        )
    at = names.index(stage)
    if at == 0:
        raise CaseError(
            f"'{stage}' is the first stage: there is none before it",
            where="--stage",
            remedy="run the case again: clast run CASE --set ...",
        )
    if checkpoint.stage == names[at - 1]:
        return path, _at_its_end(checkpoint, path, names[:at])
    if not is_file_name(checkpoint.recorded.file):
        raise damaged(path, "it names a result file that does not lie beside it")
    before = checkpoint_path(path.resolve().parent / checkpoint.recorded.file, names[at - 1])
    if not before.exists():
        raise CaseError(
            f"there is no checkpoint of the end of stage '{shortened(names[at - 1])}'",
            where=str(before),
            remedy="put it beside the named one, or run the case again",
        )
    found = _at_its_end(read_checkpoint(before, known), before, names[:at])
    runs = [(one.recorded.lineage, one.recorded.frames) for one in (found, checkpoint)]
    (first, frames), (second, later) = runs
    if not belongs(first, frames, second) and not belongs(second, later, first):
        raise CaseError(
            f"belongs to another run than {path.name}",
            where=str(before),
            remedy="name a checkpoint of the run that wrote the result file last, or run the case "
            "again",
        )
    return before, found


def _at_its_end(checkpoint: Checkpoint, path: Path, names: Sequence[str]) -> Checkpoint:
    """Return a checkpoint if it is of the end of the last of these stages; else raise CaseError."""
    position: Any = getattr(checkpoint.run, "position", None)
    at_end = checkpoint.stage == names[-1] and position is not None and position.over
    if not at_end or len(position.starts) != len(names):
        raise CaseError(
            f"is not a checkpoint of the end of stage '{shortened(names[-1])}'",
            where=str(path),
            remedy="run the case again",
        )
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
        raise CaseError(
            f"has other blocks or points than the case with these settings: {', '.join(other)}",
            where=str(path),
            remedy=remedy,
        )
    for was, now in zip(_stages(source.schedule), _stages(schedule), strict=False):
        if digest(was) != digest(now):
            raise CaseError(
                f"the settings change stage '{was.name}', which has already finished",
                where="--set",
                remedy=remedy,
            )
        if was.name == checkpoint.stage:
            break
    if not _same_things(state, model, stiffness):
        raise CaseError(
            "the settings add or remove loads, supports or other actions",
            where="--set",
            remedy=remedy,
        )


def not_as_before(checkpoint: Checkpoint, now: Mapping[str, str]) -> Iterator[str]:
    """Say which parts of model and method have fingerprints other than in the stages before."""
    before = checkpoint.source.fingerprints
    other = [name for name in now if before.get(name) != now[name]]
    if other:
        yield (
            f"the stages until '{checkpoint.stage}' were run with other numbers of "
            f"{', '.join(other)}: run the case again if they should change there too"
        )


def _same_things(state: State, model: Model, stiffness: float) -> bool:
    """Return whether the same things act on blocks as when a state was kept."""
    from clast.actions.active import actions_of
    from clast.actions.damping import Undamped

    acting = actions_of(model, stiffness, Undamped())
    same = len(state.actions) in (0, len(acting))
    return same and state.points.shape == model.material_points.at.shape


def _stages(schedule: Any) -> tuple[Any, ...]:
    """Return the stages of a schedule."""
    return tuple(schedule.stages)
