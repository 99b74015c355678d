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
from functools import cached_property
from pathlib import Path
from typing import Any

from clast.case.case_file import Case
from clast.case.resume import resume
from clast.errors import CaseError, ClastError, ResultsLost, shortened
from clast.model.distributions import Value
from clast.results import Run
from clast.results.checkpoints.checkpoint_files import checkpoint_path
from clast.results.checkpoints.fingerprints import content_of as content_of_file
from clast.study import statistics
from clast.study.collapsing.reduction import Reduction, reduction
from clast.study.collapsing.search import (
    STANDS,
    UNDECIDED,
    FactorBracket,
    FactorSettings,
    Trial,
    bracket_of,
    search_factor,
)
from clast.study.collapsing.support_forces import SupportForce, support_forces
from clast.study.collapsing.trial import (
    Settled,
    largest_of,
    over_weight,
    run_trial,
    settle_standing,
)
from clast.study.description import ROCKFALL, TARGET, WORST, Description
from clast.study.folder import (
    CASE,
    DONE,
    NO_RESULT,
    RESULT_BYTES_MAX,
    RUN_FILE,
    StudyFolder,
    is_in,
    write_whole,
    writing,
)
from clast.study.measures import FOS, MEASURES, STANDS_WITH, RunResults, check, known_names
from clast.study.parameters import ParameterPlaces, changed, content_of
from clast.study.rockfall.portions import paths_of
from clast.study.statistics import StudyResults
from clast.trajectory.campaign import Campaign


def make_runs(folder: str, runs: Sequence[int], driver: int = 0) -> int:
    """Make runs of the study in a folder, those that are done left out; return how many were made.

    Where the process ``driver`` that asked for them has ended, this one does too, between runs.
    """

    def is_wanted() -> bool:
        return not driver or os.getppid() == driver

    with writing(Path(folder)):
        made = Bench.of(StudyFolder.opened(Path(folder))).make_missing(runs, is_wanted)
    if not is_wanted():
        os._exit(0)  # nobody reads the answer, and nobody asks again
    return made


def check_study(case: Case, study: Description) -> None:
    """Raise CaseError where the first run of a study has wrong numbers or nothing to measure.

    Before its folder is made: a refused study leaves nothing behind.
    """
    check_run(case, study, study.values(1), "the first run")


def check_run(case: Case, study: Description, values: Sequence[Value], run: str) -> None:
    """Raise CaseError where a run of a study, which ``run`` names, cannot be made or measured."""
    settings = ParameterPlaces.of(content_of(case), study.vary)
    try:
        first = changed(case, settings.case(values))
        known = known_names(first.model())
    except CaseError as error:
        raise CaseError(
            f"{run} cannot be made: {error.what}",
            where=error.where,
            remedy=error.remedy or "check the values that vary",
        ) from None
    # of stages it is not known how long they last
    end = math.inf if first.stage else first.time.end
    for expression in study.expressions:
        check(expression, known, end)
    if any(name in (FOS, STANDS_WITH) for one in study.expressions for name, _ in one.calls()):
        how = study.how_of_factor
        by = reduction(how.by, how.joints)
        by.check(content_of(first))
        how.of(by)


@dataclass(frozen=True, kw_only=True)
class Bench:
    """All that the runs of a study have in common."""

    folder: StudyFolder
    settings: ParameterPlaces

    @classmethod
    def of(cls, folder: StudyFolder) -> Bench:
        """Return the bench of a study; raises CaseError where its parameters lead nowhere."""
        content = content_of(folder.base)
        return cls(folder=folder, settings=ParameterPlaces.of(content, folder.study.vary))

    @cached_property
    def campaign(self) -> Campaign:
        """The rocks of a study of rockfall."""
        return self.folder.base.campaign()

    def make_missing(self, runs: Sequence[int], goes_on: Callable[[], bool] = lambda: True) -> int:
        """Make the runs that are not done, as long as it goes on; return how many were made."""
        made = 0
        for run in runs:
            if not goes_on():
                break
            if self.folder.result(run) is None:
                self.make(run)
                made += 1
        return made

    def make(self, run: int) -> dict[str, Any]:
        """Make a run; return its result, which is written down."""
        study, folder = self.folder.study, self.folder
        if study.kind == ROCKFALL:
            with folder.making(run) as part:
                paths = {"run": run, **paths_of(self.campaign, run, part)}
                folder.write_result(part, paths)
            return paths
        values = folder.values(run)
        content = self.settings.case(values)
        result: dict[str, Any] = {
            "run": run,
            "parameters": {one.name: value for one, value in zip(study.vary, values, strict=True)},
        }
        with folder.making(run) as part:
            text, file = folder.case_text(content), part / CASE
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
                how = self.folder.study.how_of_factor
                return self._measured(One(changed(self.folder.base, content), output, how))
        except ResultsLost:
            raise
        except ClastError as error:
            reason = str(error)
        except Exception as error:  # the fault of one run is not that of the others
            reason = f"{type(error).__name__}: {error}"
        # without folders: no table depends on where a study lies, and by whom it is made
        for named in (Path(self.folder.base.file), output):
            if named is not None:
                reason = reason.replace(f"{named.parent}{os.sep}", "")
        lines = filter(None, map(str.strip, reason.split("\n")))
        return {"status": NO_RESULT, "reason": shortened("; ".join(lines), 500)}

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
            result["reason"] = one.factor.describe(one.by.TITLE)
            if fails is not also:
                raise CaseError(result["reason"])
        result["measures"] = values
        if self.folder.study.kind == TARGET:
            result["supports"] = [dict(vars(support)) for support in one.supports]
        if fails is not None:
            result["fails"] = fails
        if fails and "measured" in vars(one):
            result["blocks"] = list(one.measured.blocks)
            result["joints"] = list(one.measured.joints)
        return result

    def _evaluated(self, one: One, end: str) -> tuple[dict[str, Any], bool | None]:
        """Return the measures of a run, and whether it fails, with an end of its factor."""
        study = self.folder.study

        def function(name: str) -> Callable[..., Any]:
            if name == FOS:
                return lambda: getattr(one.factor, end)
            if name == STANDS_WITH:
                return lambda factor: one.stands(float(factor))
            return lambda *given: MEASURES[name].value(one.measured, *given)

        functions = {name: function(name) for name in MEASURES}
        values: dict[str, Any] = {}
        for name, expression in study.measures.items():
            values[name] = expression.value(values, functions)
        if study.condition is None:
            return values, None
        return values, bool(study.condition.value(values, functions))


@dataclass
class One:
    """A run that is made when something is asked of it."""

    case: Case
    output: Path | None
    how: FactorSettings
    """How its factor of safety is looked for."""
    trials: list[Trial] = field(default_factory=list)
    """Trials that were made."""

    @property
    def supports(self) -> tuple[SupportForce, ...]:
        """Forces of supports in the trial with the largest factor that stands, else in the run."""
        standing = [trial for trial in self.trials if trial.verdict == STANDS]
        if standing:
            return max(standing, key=lambda trial: trial.factor).supports
        return support_forces(self.measured.run) if "measured" in vars(self) else ()

    @property
    def by(self) -> Reduction:
        """The quantity of its factor of safety."""
        return reduction(self.how.by, self.how.joints)

    @cached_property
    def factor(self) -> FactorBracket:
        """The bracket of its factor of safety.

        Raises CaseError where every trial is undecided: nothing is known of it.
        """
        by = self.by
        most = largest_of(over_weight(self.case, by))
        trials = search_factor(self.how.of(by), lambda _, factor: self.trial(factor), most)
        bracket = bracket_of(trials)
        if bracket.low == 0.0 and math.isinf(bracket.high):
            raise CaseError(
                f"all {len(trials)} trials of the factor are undecided",
                where=FOS,
                remedy="run clast study fos on the case of this run for the curves",
            )
        return bracket

    @cached_property
    def start(self) -> Settled:
        """The state from which the trials of its factor begin."""
        self.by.check(content_of(self.case))
        return settle_standing(self.case, self.by)

    def trial(self, factor: float, output: Path | None = None) -> Trial:
        """Return the trial with a factor."""
        self.trials.append(run_trial(self.start, self.by, factor, output))
        return self.trials[-1]

    def stands(self, factor: float) -> bool:
        """Return whether the blocks stand with a factor; raises CaseError where it is undecided."""
        trial = self.trial(factor)
        if trial.verdict == UNDECIDED:
            what = f"the trial with {self.by.SYMBOL} = {factor:g} is undecided: {trial.reason}"
            raise CaseError(what, where=STANDS_WITH)
        return trial.verdict == STANDS

    @property
    def is_open(self) -> bool:
        """Whether its factor of safety was asked for, and has an open end."""
        return "factor" in vars(self) and not self.factor.is_closed

    @cached_property
    def measured(self) -> RunResults:
        """Its results."""
        run = self._run()
        if not run.report.finished:
            raise KeyboardInterrupt
        return RunResults(run)

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


def _forget(part: Path) -> None:
    """Remove result file and checkpoints of a run."""
    for file in part.glob("run*"):
        file.unlink()


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
            if rerun(folder, number, part) is not None:
                os.replace(part, file)
    file, before = folder.path / "worst.txt", b""
    with suppress(OSError, CaseError):
        before = content_of_file(file, RESULT_BYTES_MAX)
    kept = {str(number).encode() for number in wanted}
    for number in map(
        int, filter(re.compile(rb"[0-9]{1,9}").fullmatch, set(before.split()) - kept)
    ):
        (folder.place(number) / RUN_FILE).unlink(missing_ok=True)
    write_whole(file, "".join(f"{number}\n" for number in wanted).encode())
    return wanted


def rerun(folder: StudyFolder, number: int, output: Path | None = None) -> Run | None:
    """Make a run again; None where it cannot go on."""
    settings = ParameterPlaces.of(content_of(folder.base), folder.study.vary)
    case = changed(folder.base, settings.case(folder.values(number)))
    try:
        return case.run(output=output, warn=lambda _text: None)
    except ResultsLost:
        raise
    except CaseError:
        return None
