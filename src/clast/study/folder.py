"""The folder of a study, which holds all that is known of it and survives whatever ends a run.

    out/study.toml                      definition of the study
    out/base/HASH/case.toml             the case, with the files that it names
    out/runs/0012/00123456/case.toml    the case of a run, for clast run
    out/runs/0012/00123456/result.json  its outcome; it names the study
    out/results.csv                     all results, in the order of their numbers
    out/asked.jsonl                     of a back-analysis: the parameters of its runs; of a
                                        target: their shares of the range

A run is made in a folder of its own beside its place, which takes its name when all is written: a
run is there as a whole or not at all, and a run that is made twice does no harm.  Runs lie by ten
thousand in a folder, which is listed as one: a study of a million is read without holding
more than that.

A result counts where its file is one that was written here and was not changed since, with the
parameters that its run has in the study; otherwise there is none, and the run is made again.
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import socket
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

from clast.case.case_file import Case
from clast.errors import CaseError, ClastError, ResultsLost
from clast.inputs.declaring import text as case_text
from clast.model.distributions import Value
from clast.results import locks
from clast.results.checkpoints.checkpoint_files import checkpoint_path
from clast.results.checkpoints.fingerprints import content_of as content_of_file
from clast.results.output import fresh
from clast.study.description import COLLAPSE, FIT, ROCKFALL, TARGET, Description, described
from clast.study.parameters import content_of

STUDY, BASE, RUNS, RESULT, CASE = "study.toml", "base", "runs", "result.json", "case.toml"
RUN_FILE = "run.vtkhdf"
"""Result file of a run that is kept, or that writes checkpoints."""
ASKED = "asked.jsonl"
ARRAYS = "paths.npz"
"""Arrays of a portion of paths."""
BLOWS = "blows.csv"
"""Blows of a portion of paths: rows of the table of all."""
RUNS_PER_FOLDER = 10_000
DONE, NO_RESULT = "done", "no result"
"""Outcomes of a run: no result is one that could not go on, or had wrong numbers."""
PART = re.compile(rf"\.{re.escape(STUDY)}\.[0-9]+")
"""Files, with the case, of a study that was ended before its first run."""
RESULT_BYTES_MAX = 100_000_000
"""Results above this size are not read, bytes."""
STALE_AFTER = 86_400.0
"""Time after which nobody is at the files of a run that another machine has left, s."""


@dataclass(frozen=True)
class StudyFolder:
    """A folder in which a study is kept."""

    path: Path
    study: Description

    @classmethod
    def made(cls, path: Path, case: Case, study: Description) -> StudyFolder:
        """Return the folder of a study, made or found again.

        Another study of which no run has been begun is replaced.  Raises CaseError where another
        one, or anything else, is there.
        """
        tables = content_of(case)
        places: dict[str, str] = {}
        named: list[bytes] = []

        def numbered(name: str) -> str:
            if name not in places:
                source = Path(case.file).parent / name
                named.append(case_text.read_bytes(source, f"it is named by {case.file}"))
                places[name] = f"files/{len(named)}-{Path(name).name}"
            return places[name]

        text = case_text.to_toml(_with_files(tables, numbered))
        parts = [text.encode("utf-8"), *named]
        hashed = _hash_of(parts)
        study = replace(study, case=f"{BASE}/{hashed}/{CASE}").checked()
        make_folder(path)
        there, base = path / STUDY, path / BASE / hashed
        if there.exists():
            other = cls.opened(path)
            if other.study.text == study.text:
                return other
            if (path / RUNS).exists():
                raise CaseError(
                    "holds another study",
                    where=str(path),
                    remedy=f"choose another folder, or continue it: clast study resume {path}",
                )
            with other.driven():  # it has no run: nothing is lost with it
                _remove(path / BASE)
        elif any(not (one.name == BASE or PART.fullmatch(one.name)) for one in path.iterdir()):
            raise CaseError(
                "is not empty, and does not contain a study",
                where=str(path),
                remedy="choose another folder; it is made if it does not exist",
            )
        with writing(path):
            (base / "files").mkdir(parents=True, exist_ok=True)
            for place, content in zip(places.values(), named, strict=True):
                write_whole(base / place, content)
            write_whole(base / CASE, parts[0])
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
        names = (file.parent / "files").glob("[0-9]*-*")
        files = sorted(names, key=lambda one: (len(one.name.partition("-")[0]), one.name))
        parts = [text.encode("utf-8"), *(case_text.read_bytes(one, MOVED) for one in files)]
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

    def case_text(self, content: Mapping[str, Any], back: str = "../../../") -> bytes:
        """Return the case file of a run, with the files beside the case; ``back`` leads to here."""
        base = back + Path(self.study.case).parent.as_posix()
        return case_text.to_toml(_with_files(content, lambda name: f"{base}/{name}")).encode()

    @contextmanager
    def driven(self) -> Iterator[None]:
        """Keep other drivers out in the block.

        Raises CaseError where one is at work, and where a file of the study cannot be written.
        """
        with writing(self.path), (self.path / STUDY).open("r+b") as file:
            if not locks.claim(file):
                raise CaseError(
                    "is in use by another clast study",
                    where=str(self.path),
                    remedy="wait for it, or stop it; finished runs are kept",
                )
            self.tidy()
            yield

    # Runs ----------------------------------------------------------------------------------------

    def place(self, run: int) -> Path:
        """Return the folder of a run."""
        return self.path / RUNS / f"{run // RUNS_PER_FOLDER:04d}" / f"{run:08d}"

    def values(self, run: int) -> tuple[Value, ...]:
        """Return the parameters of a run, from 1; of a search as it asks for it."""
        if self.study.kind == TARGET:
            return tuple(one.drawn.quantile(self.asked()[run - 1][0]) for one in self.study.vary)
        return self.asked()[run - 1] if self.study.kind == FIT else self.study.values(run)

    @property
    def asked_file(self) -> Path:
        """The file of the parameters that a search has asked for, a line for each run."""
        return self.path / ASKED

    def asked(self) -> list[tuple[float, ...]]:
        """Return the parameters, or shares of a range, that a search has asked for, from run 1 on.

        Those behind a damaged line are not among them: the search asks for them again.
        """
        asked: list[tuple[float, ...]] = []
        with suppress(OSError, ValueError, TypeError, OverflowError, RecursionError, CaseError):
            for line in content_of_file(self.asked_file, RESULT_BYTES_MAX).splitlines():
                asked.append(tuple(map(float, json.loads(line))))
        return asked

    def result(self, run: int) -> dict[str, Any] | None:
        """Return the result of a run; None where it is not done, damaged, or of another study."""
        with suppress(OSError, ValueError, OverflowError, RecursionError, IndexError, CaseError):
            result = json.loads(content_of_file(self.place(run) / RESULT, RESULT_BYTES_MAX))
            return result if self._is_result(result, run) else None
        return None

    @contextmanager
    def making(self, run: int) -> Iterator[Path]:
        """Give a folder that becomes that of a run when the block ends well.

        It has the files of whoever was killed at the run on this machine, where a checkpoint is
        among them; such a folder is left where the block ends by an error.  Raises ResultsLost
        where a file of the run cannot be written.
        """
        place = self.place(run)
        part = place.with_name(f".{place.name}.{socket.gethostname()}.{os.getpid()}")
        with writing(self.path):
            place.parent.mkdir(parents=True, exist_ok=True)
            if not self._goes_on(part):
                _remove(part)
                self._take_over(run, part)
            part.mkdir(exist_ok=True)
            try:
                yield part
                if self.result(run) is None:
                    _remove(place)
                    os.rename(part, place)
                _remove(part)  # where somebody else has done it meanwhile: the same
            finally:
                if not self._goes_on(part):
                    shutil.rmtree(part, ignore_errors=True)

    def write_result(self, part: Path, result: Mapping[str, Any]) -> None:
        """Write the result of a run into its folder, last of all."""
        whole = {"study": self.study.hash, **result}
        whole["checksum"] = _checksum(whole)
        text = json.dumps(whole, ensure_ascii=False, indent=1)
        write_whole(part / RESULT, (text + "\n").encode("utf-8"))

    def results(self) -> Iterator[dict[str, Any]]:
        """Give all results in the order of their numbers."""
        for numbers in self._shards():
            there = self._there(numbers)
            for run in (one for one in numbers if one in there):
                result = self.result(run)
                if result is not None:
                    yield result

    def missing(self, wanted: Callable[[int], bool], *, retry: bool = False) -> Iterator[int]:
        """Give the runs that are to be made; with ``retry`` those that failed to run as well."""
        for numbers in self._shards():
            there = self._there(numbers)
            for run in numbers:
                if not wanted(run):
                    continue
                result = self.result(run) if run in there else None
                if result is None or (retry and result["status"] != DONE):
                    yield run

    def count(self) -> int:
        """Return how many runs have a result, of this study or another."""
        return sum(len(self._there(numbers)) for numbers in self._shards())

    def has_begun(self, run: int) -> bool:
        """Return whether somebody has begun a run and left it."""
        place = self.place(run)
        return any(place.parent.glob(f".{place.name}.*"))

    def forget(self, run: int) -> None:
        """Remove the result of a run, or whatever else is in its place."""
        _remove(self.place(run))

    def _shards(self) -> Iterator[range]:
        """Give the numbers of runs, as many at a time as lie in a folder."""
        for shard in range(self.study.n // RUNS_PER_FOLDER + 1):
            first, past = (
                max(1, shard * RUNS_PER_FOLDER),
                min(self.study.n + 1, (shard + 1) * RUNS_PER_FOLDER),
            )
            yield range(first, past)

    def _there(self, numbers: range) -> set[int]:
        """Return which runs of a folder have a place in it."""
        if not numbers:
            return set()
        try:
            with os.scandir(self.place(numbers[0]).parent) as entries:
                return {int(entry.name) for entry in entries if entry.name.isdecimal()}
        except FileNotFoundError:
            return set()
        except OSError as error:
            remedy = "runs of a study lie there: make it a folder that can be read, or remove it"
            what = f"cannot be read: {error.strerror}"
            raise CaseError(what, where=str(error.filename), remedy=remedy) from None

    def _take_over(self, run: int, part: Path) -> None:
        """Rename to ``part`` the folder of a run that was killed here and can go on."""
        if not self.writes_files:
            return
        for left in self.place(run).parent.glob(f".{self.place(run).name}.*"):
            if _is_abandoned(left) and self._goes_on(left):
                with suppress(OSError):  # somebody else has taken it
                    os.rename(left, part)
                    return

    def _goes_on(self, part: Path) -> bool:
        """Return whether the run that was left in a folder can go on: none that has links in it."""
        if not self.writes_files or part.is_symlink():
            return False
        there = checkpoint_path(part / RUN_FILE).exists()
        return there and not any(file.is_symlink() for file in part.iterdir())

    def tidy(self) -> None:
        """Remove files of runs that were killed, and that nobody goes on with."""
        for part in (self.path / RUNS).glob("*/.*"):
            number = part.name[1:].partition(".")[0]
            is_done = number.isdecimal() and self.result(int(number)) is not None
            is_litter = is_done and _is_stale(part)
            if _is_abandoned(part):
                is_litter = is_done or not self._goes_on(part)
            if is_litter:
                with suppress(OSError):
                    _remove(part)

    def _is_result(self, result: Any, run: int) -> bool:
        """Return whether a file holds the result of a run, with all of its values."""
        study = self.study
        if not isinstance(result, dict) or result.get("study") != study.hash:
            return False
        checksum = _checksum(result)
        if result.get("run") != run or result.get("checksum", checksum) != checksum:
            return False
        if study.kind == COLLAPSE:
            return "trial" in result
        if study.kind == ROCKFALL:
            return result.get("status") == NO_RESULT or self._has_files(result, run)
        given, measures = result.get("parameters"), result.get("measures")
        planned = dict(zip((one.name for one in study.vary), self.values(run), strict=True))
        if not isinstance(given, dict) or set(given) != set(planned):
            return False
        texts = [result.get("reason", "")]
        for key in ("blocks", "joints"):
            names = result.get(key, [])
            texts += names if isinstance(names, list) else [None]
        if not all(isinstance(one, str) for one in texts):
            return False
        if not all(_is_same(value, planned[name]) for name, value in given.items()):
            return False
        if result.get("status") != DONE:
            return result.get("status") == NO_RESULT
        if not isinstance(measures, dict) or set(measures) != set(study.measure):
            return False
        numbers = [float(one) for one in measures.values() if isinstance(one, int | float)]
        is_whole = len(numbers) == len(measures)
        return is_whole and (not study.fail or isinstance(result.get("fails"), bool))

    def _has_files(self, result: dict[str, Any], run: int) -> bool:
        """Return whether the files of a portion of paths are those of its result."""
        hashes = {
            name: sha256(content_of_file(self.place(run) / name, RESULT_BYTES_MAX)).hexdigest()
            for name in (ARRAYS, BLOWS)
        }
        return "rows" in result and result.get("files") == hashes


MOVED = "the folder of the study is not whole: it holds base/ with the case and its files"


def _with_files(value: Any, place: Callable[[str], str], key: str = "") -> Any:
    """Return a case that names its files by their places: all that a key ``file`` names."""
    if isinstance(value, Mapping):
        return {name: _with_files(inner, place, str(name)) for name, inner in value.items()}
    if isinstance(value, list):
        return [_with_files(inner, place, key) for inner in value]
    return place(value) if isinstance(value, str) and key == "file" else value


def make_folder(path: Path) -> None:
    """Make the folder; raises CaseError where something else is in its place."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise CaseError(
            f"cannot be made: {error.strerror}",
            where=str(path),
            remedy="something else is in its place, or its folder is full or cannot be written",
        ) from None


@contextmanager
def writing(folder: Path) -> Iterator[None]:
    """Raise ResultsLost, which names the file, where one of a study cannot be written in the block.

    That is no fault of the run that is being made: it ends the study, and not the run alone.
    """
    try:
        yield
    except (ConnectionError, TimeoutError):  # of no file
        raise
    except (OSError, ClastError) as error:
        cause = error.__cause__ if isinstance(error, ClastError) else error
        if isinstance(error, ResultsLost) or not isinstance(cause, OSError | ResultsLost):
            raise
        if isinstance(cause, ResultsLost):
            raise cause from None
        where = getattr(error, "where", "") or str(cause.filename or folder)
        raise ResultsLost(
            f"cannot be written: {cause.strerror or cause}",
            where=where,
            remedy="make room, or check its permissions and whether it is a file or a folder as it "
            f"should be; finished runs are kept: continue with clast study resume {folder}",
        ) from error


def write_whole(path: Path, content: bytes) -> None:
    """Write a file that is there as a whole or not at all; a link in its place is replaced."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with fresh(part) as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from None


def is_in(path: Path, content: bytes) -> bool:
    """Return whether a file that is no link has this content."""
    with suppress(OSError, CaseError):
        return not path.is_symlink() and content_of_file(path, len(content) + 1) == content
    return False


def _remove(path: Path) -> None:
    """Remove a folder with all that is in it, a file or a link, if there is one."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _hash_of(parts: Iterable[bytes]) -> str:
    """Return the name of a case and its files."""
    return sha256(b"".join(sha256(part).digest() for part in parts)).hexdigest()[:16]


def _checksum(result: Mapping[str, Any]) -> str:
    """Return the hash of a result but for its own."""
    rest = {key: value for key, value in result.items() if key != "checksum"}
    return sha256(json.dumps(rest, ensure_ascii=False, sort_keys=True).encode()).hexdigest()[:16]


def _is_same(value: Any, planned: Value) -> bool:
    """Return whether a parameter in a file is that of the study."""
    if isinstance(value, float) and isinstance(planned, float):
        return math.isclose(value, planned, rel_tol=1e-9)  # machines may round otherwise
    if isinstance(planned, tuple):
        same = isinstance(value, list) and len(value) == len(planned)
        return same and all(map(_is_same, value, planned))
    return type(value) is type(planned) and value == planned


def _is_abandoned(part: Path) -> bool:
    """Return whether a folder is of a process of this machine that has ended."""
    _, _, rest = part.name[1:].partition(".")
    host, _, process = rest.rpartition(".")
    if host != socket.gethostname() or not process.isdecimal():
        return False
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return True
    except (OSError, OverflowError):
        return False
    return int(process) == 0


def _is_stale(part: Path) -> bool:
    """Return whether nothing was written into a folder for long."""
    with suppress(OSError):
        files = [part, *part.iterdir()] if part.is_dir() else [part]
        return time.time() - max(file.lstat().st_mtime for file in files) > STALE_AFTER
    return False
