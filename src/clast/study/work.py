"""A worker: make runs of a study, and write down the result of each.

All that a run is follows from the folder and its number.  Whatever goes wrong in a run is a result:
the study goes on with the next.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from clast.case.case_file import Case
from clast.case.resume import resume
from clast.errors import CaseError, ClastError, ResultsLost, shortened
from clast.inputs.declaring import text as case_text
from clast.results import Run
from clast.results.checkpoints.checkpoint_files import checkpoint_path
from clast.results.checkpoints.fingerprints import content_of as content_of_file
from clast.study import statistics
from clast.study.collapsing.reduction import Reduction, reduction
from clast.study.collapsing.trial import FactorBracket, FactorSearch, Trials, standing, tried
from clast.study.description import WORST, Description, FactorSettings
from clast.study.folder import (
    CASE,
    DONE,
    LARGEST_RESULT,
    NO_RESULT,
    RUN_FILE,
    StudyFolder,
    is_in,
    with_files,
    write_whole,
    writing,
)
from clast.study.measures import ARGUMENTS, FOS, RunResults, check, known_names
from clast.study.parameters import ParameterPlaces, changed, content_of
from clast.study.statistics import StudyResults

LONGEST_REASON = 500
"""Most characters of why there is no result."""


def make_runs(folder: str, runs: Sequence[int], driver: int = 0) -> int:
    """Make runs of the study in a folder, those that are done left out; return how many were made.

    It stops between runs where the process ``driver`` that asked for them has ended.
    """
    made = 0
    with writing(Path(folder)):
        bench = Bench.at(Path(folder))
        for run in runs:
            if driver and os.getppid() != driver:
                break
            if bench.folder.result(run) is None:
                bench.make(run)
                made += 1
    return made


def check_study(case: Case, study: Description) -> None:
    """Raise CaseError where the first run of a study has wrong numbers or nothing to measure.

    Before its folder is made: what is refused leaves nothing behind.
    """
    settings = ParameterPlaces.of(content_of(case), study.vary)
    try:
        first = changed(case, settings.case(study.values(1)))
        known = known_names(first.model())
    except CaseError as error:
        raise CaseError(
            f"the first run cannot be made: {error.what}",
            where=error.where,
            remedy=error.remedy or "check the values that vary",
        ) from None
    # of stages it is not known how long they last
    end = math.inf if first.stage else first.time.end
    for expression in study.expressions:
        check(expression, known, end)
    if any(name == FOS for one in study.expressions for name, _ in one.calls()):
        how = study.factor or FactorSettings()
        by = factor_of(how)
        by.check(content_of(first))
        search_of(how, by)


@dataclass(frozen=True, kw_only=True)
class Bench:
    """All that the runs of a study have in common."""

    folder: StudyFolder
    """Where the study is kept."""
    settings: ParameterPlaces
    """Where its parameters are set."""

    @classmethod
    def at(cls, path: Path) -> Bench:
        """Return the bench of a folder."""
        return cls.of(StudyFolder.opened(path))

    @classmethod
    def of(cls, folder: StudyFolder) -> Bench:
        """Return the bench of a study; raises CaseError where its parameters lead nowhere."""
        content = content_of(folder.base)
        return cls(folder=folder, settings=ParameterPlaces.of(content, folder.study.vary))

    def make(self, run: int) -> dict[str, Any]:
        """Make a run; return its result, which is written down."""
        study, folder = self.folder.study, self.folder
        values = folder.values(run)
        content = self.settings.case(values)
        result: dict[str, Any] = {
            "run": run,
            "parameters": {one.name: value for one, value in zip(study.vary, values, strict=True)},
        }
        with folder.making(run) as part:
            base = f"../../../{Path(study.case).parent.as_posix()}"
            text = case_text.to_toml(with_files(content, base)).encode("utf-8")
            file = part / CASE
            if not is_in(file, text):  # what is there is a checkpoint of other parameters
                _forget(part)
                write_whole(file, text)
            output = part / RUN_FILE if folder.writes_files else None
            result.update(self._result(content, output))
            is_failure = result["status"] != DONE or bool(result.get("fails"))
            if not (study.keep == "all" or (study.keep == "failed" and is_failure)):
                _forget(part)
            folder.write_result(part, result)
        return result

    def _result(self, content: dict[str, Any], output: Path | None) -> dict[str, Any]:
        """Return the result of a run; a failure is a result as well.

        Raises ResultsLost where a file cannot be written, which is no fault of the run.
        """
        try:
            with writing(self.folder.path):
                how = self.folder.study.factor or FactorSettings()
                return self._measured(One(changed(self.folder.base, content), output, how))
        except ResultsLost:
            raise
        except ClastError as error:
            return self._no_result(str(error), output)
        except Exception as error:  # the fault of one run is not that of the others
            return self._no_result(f"{type(error).__name__}: {error}", output)

    def _no_result(self, reason: str, output: Path | None) -> dict[str, Any]:
        """Return the result of a run that has none.

        Files of case and run are named without their folders: no table depends on where a study
        lies, and by whom it is made.
        """
        for file in (Path(self.folder.base.file), output):
            if file is not None:
                reason = reason.replace(f"{file.parent}{os.sep}", "")
        lines = filter(None, map(str.strip, reason.split("\n")))
        return {"status": NO_RESULT, "reason": shortened("; ".join(lines), LONGEST_REASON)}

    def _measured(self, one: One) -> dict[str, Any]:
        """Return the measures of a run.

        Where a factor of safety has an open end, measures that depend on where it ends have no
        value (nan), and the run fails or not where it does at both ends; raises CaseError if not.
        """
        values, fails = self._evaluated(one, "low")
        result: dict[str, Any] = {"status": DONE}
        if one.is_open:
            others, also = self._evaluated(one, "high")
            values = {
                name: value if value == others[name] else math.nan for name, value in values.items()
            }
            result["reason"] = one.factor.sentence(factor_of(one.how).TITLE)
            if fails is not also:
                raise CaseError(result["reason"])
        result["measures"] = values
        if fails is not None:
            result["fails"] = fails
        if fails and one.made:
            result["blocks"] = list(one.measured.blocks)
            result["joints"] = list(one.measured.joints)
        return result

    def _evaluated(self, one: One, end: str) -> tuple[dict[str, Any], bool | None]:
        """Return the measures of a run, and whether it fails, with an end of its factor."""
        study = self.folder.study

        def called(name: str, *given: str) -> Any:
            return getattr(one.measured, name)(*given)

        functions: dict[str, Callable[..., Any]] = {
            name: partial(called, name) for name in ARGUMENTS
        }
        functions[FOS] = lambda: getattr(one.factor, end)
        found: dict[str, Any] = {}
        for name, expression in study.measures.items():
            found[name] = expression.value(found, functions)
        if study.condition is None:
            return found, None
        return found, bool(study.condition.value(found, functions))


@dataclass
class One:
    """A run that is made when something is asked of it."""

    case: Case
    """Its case."""
    output: Path | None
    """Its result file."""
    how: FactorSettings
    """How its factor of safety is looked for."""
    made: list[RunResults] = field(default_factory=list)

    @cached_property
    def factor(self) -> FactorBracket:
        """The bracket of its factor of safety.

        Raises CaseError where every trial is undecided: nothing is known of it.
        """
        by = factor_of(self.how)
        by.check(content_of(self.case))
        start = standing(self.case, by)
        trials = Trials(
            search_of(self.how, by), lambda _number, factor: tried(start, by, factor)[0]
        )
        found = trials.all()
        if found.low == 0.0 and math.isinf(found.high):
            raise CaseError(
                f"all {len(trials.done)} trials of the factor are undecided",
                where=FOS,
                remedy="run clast study fos on the case of this run for the curves",
            )
        return found

    @property
    def is_open(self) -> bool:
        """Whether its factor of safety was asked for, and has an open end."""
        return "factor" in vars(self) and not self.factor.is_closed

    @property
    def measured(self) -> RunResults:
        """Its results."""
        if not self.made:
            run = self._run()
            if not run.report.finished:
                raise KeyboardInterrupt
            self.made.append(RunResults(run))
        return self.made[0]

    def _run(self) -> Run:
        """Return the run, gone on with from its checkpoint where it has one."""
        quiet: dict[str, Any] = {"warn": lambda _text: None}
        left = None if self.output is None else checkpoint_path(self.output)
        if left is not None and left.exists():
            try:
                return resume(left, **quiet)
            except CaseError as error:  # of another version, or damaged
                if isinstance(error, ResultsLost):
                    raise
                _forget(left.parent)
        return self.case.run(output=self.output, **quiet)


def factor_of(how: FactorSettings) -> Reduction:
    """Return the reduction of a factor."""
    return reduction(how.by, how.joints)


def search_of(how: FactorSettings, by: Reduction) -> FactorSearch:
    """Return where and how well a factor is looked for; raises CaseError for wrong numbers."""
    return FactorSearch(
        start=by.START if how.start is None else how.start,
        growth=by.GROWTH if how.growth is None else how.growth,
        tolerance=how.tolerance,
    )


def _forget(part: Path) -> None:
    """Remove result file and checkpoints of a run."""
    for file in part.glob("run*"):
        file.unlink()


KEPT = "worst.txt"
"""Numbers of the worst runs, the worst first."""
NUMBER = re.compile(rb"[0-9]{1,9}")
"""Number of a run in that file."""


def keep_worst(folder: StudyFolder, columns: StudyResults) -> list[int]:
    """Return the worst runs of a study that keeps some, with their result files in place."""
    if not WORST.fullmatch(folder.study.keep):
        return []
    wanted = statistics.worst(columns, int(folder.study.keep.split()[1]))
    for number in wanted:
        file = folder.place(number) / RUN_FILE
        if not file.exists():
            part = file.with_name(f"part{os.getpid()}.vtkhdf")
            part.unlink(missing_ok=True)
            if made_again(folder, number, part) is not None:
                os.replace(part, file)
    listed, before = folder.path / KEPT, b""
    with suppress(OSError, CaseError):
        before = content_of_file(listed, LARGEST_RESULT)
    kept = {str(number).encode() for number in wanted}
    for number in map(int, filter(NUMBER.fullmatch, set(before.split()) - kept)):
        (folder.place(number) / RUN_FILE).unlink(missing_ok=True)
    write_whole(listed, "".join(f"{number}\n" for number in wanted).encode())
    return wanted


def made_again(folder: StudyFolder, number: int, output: Path | None = None) -> Run | None:
    """Return a run, made again; None where it cannot go on."""
    settings = ParameterPlaces.of(content_of(folder.base), folder.study.vary)
    case = changed(folder.base, settings.case(folder.values(number)))
    try:
        return case.run(output=output, warn=lambda _text: None)
    except ResultsLost:
        raise
    except CaseError:
        return None
