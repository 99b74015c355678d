"""Where a run comes from, as its checkpoints say: case file or script, and files that they name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clast.errors import CaseError
from clast.model.model import Model
from clast.results.checkpoints.checkpoint import OBJECTS, SETTINGS, TEXT, Source
from clast.results.checkpoints.fingerprints import fingerprints, print_of, print_of_text

if TYPE_CHECKING:
    from clast.case.case_file import Case
    from clast.run.schedule import Schedule
    from clast.step.method import Method

NAMING = "file"
"""Key of all tables of a case that names a file beside it."""
LARGEST_NAMED = 500_000_000
"""Files above this size are not read, bytes."""


def case_source(case: Case, model: Model, method: Method, schedule: Schedule) -> Source:
    """Return where the run of a case comes from."""
    return Source(
        text=case.text,
        gives=TEXT if is_whole(case) else OBJECTS,
        file=str(Path(case.file).absolute()),
        file_text="" if case.origin is None else print_of_text(case.origin),
        files={name: named_print(Path(case.file).parent / name) for name in named_files(case)},
        schedule=schedule,
        fingerprints=fingerprints(model=model, method=method),
    )


def script_source(
    settings: Case | None, model: Model, method: Method, schedule: Schedule
) -> Source:
    """Return where the run of a script comes from: its keys, None where it gave objects."""
    whole = settings is not None and is_whole(settings)
    return Source(
        text=settings.text if settings else "",
        gives=SETTINGS if whole else OBJECTS,
        schedule=schedule,
        fingerprints=fingerprints(model=model, method=method),
    )


def is_whole(case: Case) -> bool:
    """Return whether a text can hold all of a case."""
    try:
        case.to_toml()
    except CaseError:
        return False
    return True


def named_files(case: Case) -> list[str]:
    """Return the files that a case names, each once."""

    def named(value: Any, key: str) -> Iterator[str]:
        if isinstance(value, dict):
            for name, inner in value.items():
                yield from named(inner, str(name))
        elif isinstance(value, list | tuple):
            for inner in value:
                yield from named(inner, key)
        elif isinstance(value, str) and key == NAMING:
            yield value

    return list(dict.fromkeys(named(case.model_dump(by_alias=True), "")))


def named_print(path: Path) -> str:
    """Return the fingerprint of a file that a case names, empty where there is none."""
    return print_of(path, LARGEST_NAMED)
