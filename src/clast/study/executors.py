"""Who makes the runs: processes of this machine, or any ``concurrent.futures.Executor``.

Runs are handed out in portions, which become smaller towards the end.  A worker that dies costs its
own run a try; after three it is written down as one without a result.  Everything is written by the
workers themselves, so that nothing is lost with a driver or a scheduler, and whoever goes on with
the study finds all finished runs.
"""

from __future__ import annotations

import ast
import logging
import os
import sys
import time
import tokenize
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from multiprocessing import get_context
from typing import Any, ClassVar, Protocol

from clast.errors import CaseError, ResultsLost
from clast.study.description import ROCKFALL
from clast.study.folder import NO_RESULT, StudyFolder
from clast.study.work import Bench, make_runs
from clast.study.worker_start import start_worker

TRIES = 3
"""How often a run is tried whose worker dies."""
RUNS_PER_WORKER_MAX = 50
"""Runs that a worker makes before it is renewed, at most."""
SCHEDULER_TIMEOUT, WORKER_TIMEOUT = 10, 60
"""How long a scheduler is waited for, and its first worker, s."""


@dataclass(frozen=True, kw_only=True)
class StudyProgress:
    """How far a study is."""

    done: int
    total: int
    lost: int
    """Runs that have no result because of a failure."""
    seconds: float
    """Time since the driver began, s."""
    made: int

    @property
    def left(self) -> float | None:
        """Time left, s, as the last runs took it; None as long as none is done."""
        return (self.total - self.done) * self.seconds / self.made if self.made else None


Watch = Callable[[StudyProgress], None]


class Workers(Protocol):
    """Those who make runs, by places."""

    portion: ClassVar[int]
    """Runs that they are given at a time, at most."""

    @property
    def places(self) -> int:
        """Portions that are made at a time."""

    def submit(self, place: int, folder: str, runs: list[int]) -> Future[int]:
        """Have a portion of runs made by a worker."""

    def renew(self, place: int) -> None:
        """Have a new worker at a place: the old one has died, or is to be renewed."""


@dataclass(frozen=True)
class ThisProcess:
    """One run after the other in this process."""

    bench: Bench
    portion: ClassVar[int] = 1
    places: ClassVar[int] = 1

    def submit(self, place: int, folder: str, runs: list[int]) -> Future[int]:
        """Make the runs that are not done, now; their errors are raised here."""
        made: Future[int] = Future()
        made.set_result(self.bench.make_missing(runs))
        return made

    def renew(self, place: int) -> None:
        """Do nothing: it is the only one."""


@dataclass
class Processes:
    """Processes of this machine, one at each place."""

    portion: ClassVar[int] = RUNS_PER_WORKER_MAX
    places: int
    here: Bench | None = None
    """Makes the runs of the first place by a thread of this process.

    For runs that are short, keep no memory and end no process: nobody waits for one, and workers
    are not renewed.
    """
    _thread: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1))
    _is_over: bool = False
    _pools: dict[int, ProcessPoolExecutor] = field(default_factory=dict)
    _made: dict[int, int] = field(default_factory=dict)

    def submit(self, place: int, folder: str, runs: list[int]) -> Future[int]:
        """Have a portion of runs made by a worker."""
        if self.here and place == 0:
            return self._thread.submit(self.here.make_missing, runs, lambda: not self._is_over)
        self._made[place] = self._made.get(place, 0) + len(runs)
        if not self.here and place in self._pools and self._made[place] > RUNS_PER_WORKER_MAX:
            self.renew(place)
            self._made[place] = len(runs)
        if place not in self._pools:
            context = get_context("spawn")
            pool = ProcessPoolExecutor(1, mp_context=context, initializer=start_worker)
            self._pools[place] = pool
        try:
            return self._pools[place].submit(make_runs, folder, runs, os.getpid())
        except BrokenExecutor:  # it died while it had nothing to do
            self.renew(place)
            return self.submit(place, folder, runs)

    def renew(self, place: int) -> None:
        """Have a new worker at a place."""
        pool = self._pools.pop(place, None)
        if pool is not None:
            pool.shutdown(wait=False, cancel_futures=True)

    def close(self, *, now: bool) -> None:
        """End all workers, ``now`` without waiting for their runs."""
        self._is_over = now
        self._thread.shutdown(cancel_futures=True)
        for pool in self._pools.values():
            # a process of the pool ends between two runs where its driver has ended
            for process in list((getattr(pool, "_processes", None) or {}).values()):
                if now:
                    process.terminate()
            pool.shutdown(wait=not now, cancel_futures=True)
        self._pools.clear()


@dataclass
class Foreign:
    """An executor of somebody else: Dask, Parsl, mpi4py.futures; it renews workers itself."""

    portion: ClassVar[int] = RUNS_PER_WORKER_MAX
    executor: Executor
    workers: Callable[[], int]
    """How many workers it has; they may come and go."""

    @property
    def places(self) -> int:
        """Portions that are made at a time: two a worker, so that none waits."""
        return 2 * max(1, self.workers())

    def submit(self, place: int, folder: str, runs: list[int]) -> Future[int]:
        """Have a portion of runs made by a worker; raises CaseError where it takes none."""
        try:
            return self.executor.submit(make_runs, folder, runs)
        except (RuntimeError, OSError) as error:  # it was shut down, or has broken
            what = f"takes no more runs: {_line(error)}"
            remedy = "finished runs are kept; give another executor to continue"
            raise CaseError(what, where="executor", remedy=remedy) from None

    def renew(self, place: int) -> None:
        """Leave it to the executor."""


@dataclass
class Driver:
    """Has the runs of a study made by workers."""

    folder: StudyFolder
    workers: Workers
    watch: Watch | None = None
    tries: dict[int, int] = field(default_factory=dict)
    """Run -> how often its worker has died."""
    idle: int = 0
    """Portions in a row of which no run was begun."""

    def make(self, runs: Iterator[int], left: int, total: int) -> None:
        """Make runs, of which so many are ``left`` of a ``total``.

        Raises the executor's error where it has ended, and ResultsLost where files of the study
        cannot be written.
        """
        self._left, self._total, self._began = left, total, time.monotonic()
        self._handed = 0
        going: dict[Future[int], tuple[int, list[int]]] = {}
        again: list[list[int]] = []
        while True:
            taken = {place for place, _ in going.values()}
            for place in (one for one in range(self.workers.places) if one not in taken):
                portion = again.pop() if again else self._portion(runs)
                if not portion:
                    break
                future = self.workers.submit(place, str(self.folder.path.absolute()), portion)
                going[future] = (place, portion)
            if not going:
                break
            done, _ = wait(going, 0.5, FIRST_COMPLETED)
            for future in done:
                place, portion = going.pop(future)
                again += self._ended(future, place, portion)
            self._tell(going)

    def _portion(self, runs: Iterator[int]) -> list[int]:
        """Return the next runs to hand out: fewer towards the end."""
        left = self._left - self._handed
        size = min(self.workers.portion, max(1, left // (3 * self.workers.places)))
        portion = list(islice(runs, size))
        self._handed += len(portion)
        return portion

    def _ended(self, future: Future[int], place: int, portion: list[int]) -> list[list[int]]:
        """Return the runs to repeat of a portion that has come to an end."""
        try:
            error = future.exception()
        except CancelledError:
            raise CaseError(
                "the program that made the runs has stopped",
                where=str(self.folder.path),
                remedy="finished runs are kept; continue with clast study resume "
                f"{self.folder.path}",
            ) from None
        left = [run for run in portion if self.folder.result(run) is None]
        if error is None and not left:
            self.idle = 0
            return []
        if isinstance(error, KeyboardInterrupt | ResultsLost):
            raise error
        if error is not None and not left:
            self.workers.renew(place)
            return []
        # runs are made in their order: the first without a result is what its worker was at
        self.workers.renew(place)
        first, others = left[0], left[1:]
        began = self.folder.has_begun(first) or len(left) < len(portion)
        self.idle = 0 if began else self.idle + 1
        if self.idle >= TRIES * self.workers.places:
            raise CaseError(
                f"no worker starts a run: {_line(error) if error else 'they end at once'}",
                where=str(self.folder.path),
                remedy='a script with workers needs if __name__ == "__main__":; on other '
                "machines clast and the folder must be there by the same name",
            )
        self.tries[first] = self.tries.get(first, 0) + 1
        if began and self.tries[first] >= TRIES:
            self._give_up(first, error)
            del self.tries[first]
            return [others] if others else []
        return [part for part in ([first], others) if part]

    def _give_up(self, run: int, error: BaseException | None) -> None:
        """Write down that a run has no result."""
        names = [one.name for one in self.folder.study.vary]
        why = f"{type(error).__name__}: {_line(error)}" if error else "it ended without a result"
        result = {
            "run": run,
            "parameters": dict(zip(names, self.folder.values(run), strict=True)),
            "status": NO_RESULT,
            "reason": f"its worker ended {TRIES} times: {why}",
        }
        with self.folder.making(run) as part:
            self.folder.write_result(part, result)

    def _tell(self, going: dict[Future[int], tuple[int, list[int]]]) -> None:
        """Tell how far the study is."""
        if self.watch is None:
            return
        at_work = sum(
            not self.folder.place(run).exists() for _, portion in going.values() for run in portion
        )
        made = self._handed - at_work
        self.watch(
            StudyProgress(
                done=self._total - self._left + made,
                total=self._total,
                lost=len(self.tries),
                seconds=time.monotonic() - self._began,
                made=made,
            )
        )


def _line(error: BaseException) -> str:
    """Return the message of an error in one line."""
    return " ".join(str(error).split())[:300]


@contextmanager
def workers_of(
    folder: StudyFolder, executor: Any, count: int | None, scheduler: str
) -> Iterator[Workers]:
    """Give who makes the runs of a study: processes where no executor and no scheduler is given.

    They end with the block, at once where it is left by an error.  One alone is this process.
    """
    if scheduler:
        with _dask(scheduler) as client:
            # Dask would make tasks again whose results it has lost; ours are on the disk
            pool = client.get_executor(pure=False, retries=0)
            yield Foreign(pool, lambda: count or _threads_of(client))
    elif executor is not None:
        client = getattr(executor, "_client", None)  # of Dask
        known = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
        yield Foreign(executor, lambda: count or (_threads_of(client) if client else int(known)))
    elif (count or os.cpu_count() or 1) == 1:
        yield ThisProcess(Bench.of(folder))
    else:
        check_guard()
        here = Bench.of(folder) if folder.study.kind == ROCKFALL else None
        processes, now = Processes(count or os.cpu_count() or 1, here), True
        try:
            yield processes
            now = False
        finally:
            processes.close(now=now)


def check_guard() -> None:
    """Raise CaseError where new processes would run the script again that asks for them.

    Each of them begins with the main script, under another name than ``__main__``.
    """
    main, frame = sys.modules["__main__"], sys._getframe()
    while frame.f_back and not (
        frame.f_globals is vars(main) and frame.f_code.co_name == "<module>"
    ):
        frame = frame.f_back
    file = getattr(main, "__file__", None)
    name = getattr(getattr(main, "__spec__", None), "name", "")
    if frame.f_globals is not vars(main) or file is None or name.endswith("__main__"):
        return
    try:
        with tokenize.open(file) as source:
            tree = ast.parse(source.read())
    except (OSError, SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and node.lineno <= frame.f_lineno <= (node.end_lineno or 0):
            if any(getattr(one, "id", "") == "__name__" for one in ast.walk(node.test)):
                return
    raise CaseError(
        "asks for workers, which are new processes, each of which would run this script again",
        where=f"{file}, line {frame.f_lineno}",
        remedy='put it under if __name__ == "__main__":, or give workers=1, which is this process',
    )


def _threads_of(client: Any) -> int:
    """Return how many threads the workers of a Dask cluster have; none where it has ended."""
    try:
        return int(sum(client.nthreads().values()))
    except (OSError, TimeoutError):
        return 0


@contextmanager
def _dask(scheduler: str) -> Iterator[Any]:
    """Give the client of a Dask cluster that is there, and has a worker."""
    try:
        from distributed import Client
    except ImportError:
        remedy = "install it: pip install 'clast[distributed]'"
        raise CaseError("Dask is not installed", where="scheduler", remedy=remedy) from None
    remedy = "start it: dask scheduler; dask worker tcp://host:port --nthreads 1"
    # it logs a traceback for each task when its scheduler goes, which is said in one message here
    logger = logging.getLogger("distributed")
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        client = Client(scheduler, timeout=SCHEDULER_TIMEOUT)
    except (OSError, TimeoutError, ValueError) as error:
        what = f"does not answer: {_line(error)}"
        raise CaseError(what, where=scheduler, remedy=remedy) from None
    try:
        client.wait_for_workers(1, timeout=WORKER_TIMEOUT)
        yield client
    except TimeoutError:
        what = f"has no worker after {WORKER_TIMEOUT} s"
        raise CaseError(what, where=scheduler, remedy=remedy) from None
    finally:
        client.close()
        logger.setLevel(before)
