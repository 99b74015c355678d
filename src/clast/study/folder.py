"""The folder of a study, which holds all that is known of it and survives whatever ends a run.

    out/study.toml                      what the study consists of
    out/base/HASH/case.toml             the case, with the files that it names
    out/runs/0012/00123456/case.toml    the case of a run, for clast run
    out/runs/0012/00123456/result.json  what came of it; it names the study
    out/results.csv                     all results, in the order of their numbers
    out/asked.jsonl                     of a back-analysis: the parameters of its runs

A run is made in a folder of its own beside its place, which takes its name when all is written: a
run is there as a whole or not at all, and a run that is made twice does no harm.  Runs lie by ten
thousand in a folder, which is listed as one: a study of a million is read without holding
more than that.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

from clast.case.case_file import Case
from clast.errors import CaseError
from clast.inputs.declaring import text as case_text
from clast.results import locks
from clast.results.checkpoints.checkpoint_files import checkpoint_path
from clast.study.description import COLLAPSE, FIT, Description, described
from clast.study.trial_cases import content_of
from clast.study.variables.distributions import Value

STUDY, BASE, RUNS, RESULT, CASE = "study.toml", "base", "runs", "result.json", "case.toml"
RUN_FILE = "run.vtkhdf"
"""Result file of a run that is kept, or that writes checkpoints."""
ASKED = "asked.jsonl"
SHARD = 10_000
"""Runs in a folder."""
DONE, NO_RESULT = "done", "no result"
"""Outcomes of a run: no result is one that could not go on, or had wrong numbers."""
NAMES_FILE = "file"
"""Key of all tables of a case that names a file beside it."""


@dataclass(frozen=True)
class StudyFolder:
    """A folder in which a study is kept."""

    path: Path
    """The folder."""
    study: Description
    """The study."""

    @classmethod
    def made(cls, path: Path, case: Case, study: Description) -> StudyFolder:
        """Return the folder of a study, made or found again.

        Another study of which no run has been begun is replaced.  Raises CaseError where another
        one, or anything else, is there.
        """
        content = content_of(case)
        named = {name: _bytes_of(case, name) for name in _files_in(content)}
        places = {name: f"files/{k}-{Path(name).name}" for k, name in enumerate(named, 1)}
        text = case_text.to_toml(_with_files(content, places))
        parts = [text.encode("utf-8"), *named.values()]
        hashed = _hash_of(parts)
        study = replace(study, case=f"{BASE}/{hashed}/{CASE}").checked()
        make_folder(path)
        there = path / STUDY
        if there.exists():
            found = cls.opened(path)
            if found.study.text == study.text:
                return found
            if (path / RUNS).exists():
                raise CaseError(
                    "holds another study",
                    where=str(path),
                    remedy=f"choose another folder, or continue it: clast study resume {path}",
                )
            with found.driven():  # it has no run: nothing is lost with it
                shutil.rmtree(path / BASE, ignore_errors=True)
        elif any(path.iterdir()):
            raise CaseError(
                "is not empty, and does not contain a study",
                where=str(path),
                remedy="choose another folder; it is made if it does not exist",
            )
        base = path / BASE / hashed
        (base / "files").mkdir(parents=True, exist_ok=True)
        for name, place in places.items():
            (base / place).write_bytes(named[name])
        (base / CASE).write_text(text, encoding="utf-8")
        write_whole(there, study.text.encode("utf-8"))
        return cls(path, study)

    @classmethod
    def opened(cls, path: Path) -> StudyFolder:
        """Return the folder of a study that is there; raises CaseError where there is none."""
        file = path / STUDY
        if not file.is_file():
            raise CaseError(
                "is not a folder of a study",
                where=str(path),
                remedy="name one that clast study has made: it holds study.toml",
            )
        return cls(path, described(case_text.read_text(file), str(file)))

    @cached_property
    def base(self) -> Case:
        """The case; raises CaseError where it, or a file of it, is not as the study was made."""
        file = self.path / self.study.case
        text = case_text.read_text(file, MOVED)
        found = (file.parent / "files").glob("[0-9]*-*")
        files = sorted(found, key=lambda one: int(one.name.partition("-")[0]))
        parts = [text.encode("utf-8"), *(one.read_bytes() for one in files)]
        if _hash_of(parts) != file.parent.name:
            raise CaseError(
                "has changed since the study was begun, or a file beside it has",
                where=str(file),
                remedy="restore it; for another case choose another folder",
            )
        return Case.from_text(text, str(file.absolute()))

    @cached_property
    def writes_files(self) -> bool:
        """Whether runs write result files, and with them checkpoints; trials begin anew."""
        if self.study.kind == COLLAPSE:
            return False
        return self.study.keep in ("failed", "all") or self.base.output.checkpoint_every is not None

    @contextmanager
    def driven(self) -> Iterator[None]:
        """Keep other drivers out in the block.

        Raises CaseError where one is at work, and where the folder cannot be written.
        """
        try:
            opened = (self.path / STUDY).open("r+b")
        except OSError as error:
            raise CaseError(
                f"cannot be written: {error.strerror}",
                where=str(self.path),
                remedy="change its permissions, or continue a copy of it",
            ) from None
        with opened as file:
            if not locks.claim(file):
                raise CaseError(
                    "is in use by another clast study",
                    where=str(self.path),
                    remedy="wait for it, or stop it; finished runs are kept",
                )
            self._tidy()
            yield

    # Runs ----------------------------------------------------------------------------------------

    def place(self, run: int) -> Path:
        """Return the folder of a run."""
        return self.path / RUNS / f"{run // SHARD:04d}" / f"{run:08d}"

    def values(self, run: int) -> tuple[Value, ...]:
        """Return the parameters of a run, from 1; of a back-analysis as its search asks for it."""
        return self.asked()[run - 1] if self.study.kind == FIT else self.study.values(run)

    @property
    def asked_file(self) -> Path:
        """The file with the parameters of the runs of a back-analysis, a line for each."""
        return self.path / ASKED

    def asked(self) -> list[tuple[float, ...]]:
        """Return the parameters of the runs that a back-analysis has asked for, from run 1 on."""
        if not self.asked_file.exists():
            return []
        text = case_text.read_text(self.asked_file)
        return [tuple(map(float, json.loads(line))) for line in text.splitlines()]

    def result(self, run: int) -> dict[str, Any] | None:
        """Return the result of a run; None where it is not done, damaged, or of another study."""
        try:
            found = json.loads((self.place(run) / RESULT).read_bytes())
        except (OSError, ValueError):
            return None
        return found if _is_whole(found, run, self.study) else None

    @contextmanager
    def making(self, run: int) -> Iterator[Path]:
        """Give a folder that becomes that of a run when the block ends well.

        It has the files of whoever was killed at the run on this machine, where a checkpoint is
        among them; such a folder is left where the block ends by an error.
        """
        place = self.place(run)
        place.parent.mkdir(parents=True, exist_ok=True)
        part = place.with_name(f".{place.name}.{socket.gethostname()}.{os.getpid()}")
        if not self._goes_on(part):
            shutil.rmtree(part, ignore_errors=True)
            self._take_over(run, part)
        part.mkdir(exist_ok=True)
        try:
            yield part
            if place.exists() and self.result(run) is None:
                shutil.rmtree(place)
            with suppress(OSError):  # somebody else has done it meanwhile: the same
                os.rename(part, place)
            shutil.rmtree(part, ignore_errors=True)
        finally:
            if not self._goes_on(part):
                shutil.rmtree(part, ignore_errors=True)

    def write_result(self, part: Path, result: Mapping[str, Any]) -> None:
        """Write the result of a run into its folder, last of all."""
        text = json.dumps({"study": self.study.hash, **result}, ensure_ascii=False, indent=1)
        write_whole(part / RESULT, (text + "\n").encode("utf-8"))

    def results(self) -> Iterator[dict[str, Any]]:
        """Give all results in the order of their numbers."""
        for numbers in self._shards():
            there = self._there(numbers)
            for run in (one for one in numbers if one in there):
                found = self.result(run)
                if found is not None:
                    yield found

    def missing(self, wanted: Callable[[int], bool], *, retry: bool = False) -> Iterator[int]:
        """Give the runs that are to be made; with ``retry`` those that failed to run as well."""
        for numbers in self._shards():
            there = self._there(numbers)
            for run in numbers:
                if not wanted(run):
                    continue
                if run not in there:
                    yield run
                    continue
                found = self.result(run)
                if found is None or (retry and found["status"] != DONE):
                    yield run

    def count(self) -> int:
        """Return how many runs have a result, of this study or another."""
        return sum(len(self._there(numbers)) for numbers in self._shards())

    def has_begun(self, run: int) -> bool:
        """Return whether somebody has begun a run and left it."""
        place = self.place(run)
        return any(place.parent.glob(f".{place.name}.*"))

    def forget(self, run: int) -> None:
        """Remove the result of a run."""
        shutil.rmtree(self.place(run), ignore_errors=True)

    def _shards(self) -> Iterator[range]:
        """Give the numbers of runs, as many at a time as lie in a folder."""
        for shard in range(self.study.n // SHARD + 1):
            first, past = max(1, shard * SHARD), min(self.study.n + 1, (shard + 1) * SHARD)
            yield range(first, past)

    def _there(self, numbers: range) -> set[int]:
        """Return which runs of a folder have a place in it."""
        if not numbers:
            return set()
        try:
            with os.scandir(self.place(numbers[0]).parent) as entries:
                return {int(entry.name) for entry in entries if entry.name.isdigit()}
        except FileNotFoundError:
            return set()

    def _take_over(self, run: int, part: Path) -> None:
        """Rename to ``part`` the folder of a run that was killed here and can go on."""
        if not self.writes_files:
            return
        for left in self.place(run).parent.glob(f".{self.place(run).name}.*"):
            if _is_abandoned(left.name) and self._goes_on(left):
                with suppress(OSError):  # somebody else has taken it
                    os.rename(left, part)
                    return

    def _goes_on(self, part: Path) -> bool:
        """Return whether the run that was left in a folder can go on."""
        return self.writes_files and checkpoint_path(part / RUN_FILE).exists()

    def _tidy(self) -> None:
        """Remove the files of runs that were killed on this machine, and cannot go on."""
        for shard in (self.path / RUNS).glob("*/"):
            with os.scandir(shard) as entries:
                parts = [entry.name for entry in entries if entry.name.startswith(".")]
            for name in filter(_is_abandoned, parts):
                number = name[1:].partition(".")[0]
                is_done = number.isdecimal() and self.result(int(number)) is not None
                if is_done or not self._goes_on(shard / name):
                    shutil.rmtree(shard / name, ignore_errors=True)


MOVED = "the folder of the study is not whole: it holds base/ with the case and its files"


def with_files(content: Mapping[str, Any], folder: str) -> dict[str, Any]:
    """Return a case whose files lie beside it, seen from another place: ``folder`` leads there."""
    return _with_files(content, {name: f"{folder}/{name}" for name in _files_in(content)})


def _files_in(value: Any, key: str = "") -> list[str]:
    """Return the files that a case names, each once."""
    if isinstance(value, Mapping):
        found = [one for name, inner in value.items() for one in _files_in(inner, str(name))]
    elif isinstance(value, list):
        found = [one for inner in value for one in _files_in(inner, key)]
    else:
        found = [value] if isinstance(value, str) and key == NAMES_FILE else []
    return list(dict.fromkeys(found))


def _with_files(value: Any, places: Mapping[str, str], key: str = "") -> Any:
    """Return a case that names its files by their new places."""
    if isinstance(value, Mapping):
        return {name: _with_files(inner, places, str(name)) for name, inner in value.items()}
    if isinstance(value, list):
        return [_with_files(inner, places, key) for inner in value]
    return places.get(value, value) if isinstance(value, str) and key == NAMES_FILE else value


def _bytes_of(case: Case, name: str) -> bytes:
    return case_text.read_bytes(Path(case.file).parent / name, f"it is named by {case.file}")


def make_folder(path: Path) -> None:
    """Make the folder; raises CaseError where something else is in its place."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CaseError(
            f"cannot be made: {error.strerror}",
            where=str(path),
            remedy="name a folder for the study; it is made if it does not exist",
        ) from None


def write_whole(path: Path, content: bytes) -> None:
    """Write a file that is there as a whole or not at all."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    with part.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(part, path)


def _hash_of(parts: Iterable[bytes]) -> str:
    """Return the name of a case and its files."""
    return sha256(b"".join(sha256(part).digest() for part in parts)).hexdigest()[:16]


def _is_whole(found: Any, run: int, study: Description) -> bool:
    """Return whether what a file has is the result of a run of a study, with all of its values."""
    if not isinstance(found, dict) or found.get("study") != study.hash:
        return False
    if study.kind == COLLAPSE:
        return True
    given, measures = found.get("parameters"), found.get("measures")
    names = {one.name for one in study.vary}
    if found.get("run") != run or not isinstance(given, dict) or set(given) != names:
        return False
    if found.get("status") != DONE:
        return found.get("status") == NO_RESULT
    if not isinstance(measures, dict) or set(measures) != set(study.measure):
        return False
    numbers = all(isinstance(value, int | float) for value in measures.values())
    return numbers and (not study.fail or isinstance(found.get("fails"), bool))


def _is_abandoned(name: str) -> bool:
    """Return whether a folder is of a process of this machine that has ended."""
    _, _, rest = name[1:].partition(".")
    host, _, process = rest.rpartition(".")
    is_here = host == socket.gethostname() and process.isdecimal()
    return is_here and not _lives(int(process))


def _lives(process: int) -> bool:
    """Return whether a process of this machine goes on."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return process > 0
