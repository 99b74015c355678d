"""Sweeps and Monte Carlo studies: against integration, killed and resumed, with runs that fail."""

from __future__ import annotations

import csv
import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.study import executors, statistics
from clast.study.folder import StudyFolder
from clast.study.study_api import HowMade, resume
from clast.study.study_report import write_report
from clast.study.work import Bench

VARY = {
    "joint.plane.friction_angle": "normal(34, 4, low=5, high=70)",
    "joint.plane.cohesion": "lognormal(15e3, 6e3)",
}
PAIR = ("joint.plane.cohesion", "joint.plane.friction_angle", -0.4)
HERE = HowMade(array=(1, 1))


def study(slab, **changes):
    given = {"vary": VARY, "correlate": [PAIR], "measure": {"u": "displacement(A)"}}
    return clast.Study(slab.file, **{**given, "fail": "fails()", **changes})


def rows(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def test_every_run_fails_where_its_formula_says_so(slab, tmp_path):
    table = study(slab).run(tmp_path / "out", n=60, seed=5, how=HERE)
    angle, cohesion = (np.array(table[name]) for name in VARY)
    factor = slab.factor(cohesion, angle)
    assert set(table["status"]) == {"done"}
    clear = np.abs(factor - 1.0) > 0.002
    assert np.array_equal(np.array(table["fails"])[clear], (factor < 1.0)[clear])
    assert 0 < sum(table["fails"]) < 30
    found = statistics.probability(statistics.columns_of(StudyFolder.opened(tmp_path / "out")))
    assert found.low < slab.fails((15e3, 6e3), (34.0, 4.0), -0.4) < found.high


def test_all_ways_of_making_runs_give_the_same_table(slab, tmp_path):
    tables = []
    for name, hows in {
        "one": [HERE],
        "array": [HowMade(array=(k, 3)) for k in (2, 1, 3)],
        "threads": [HowMade(executor=ThreadPoolExecutor(1), workers=1)],
    }.items():
        made = study(slab)
        for how in hows:
            made.run(tmp_path / name, n=8, how=how)
        folder = StudyFolder.opened(tmp_path / name)
        clast.study.trial_table.write_csv(folder, tmp_path / f"{name}.csv")
        tables.append((tmp_path / f"{name}.csv").read_bytes())
    assert tables[0] == tables[1] == tables[2]


RESUME = [sys.executable, "-m", "clast", "study", "resume", "part", "-q"]


def workers_of(driver: subprocess.Popen[bytes]) -> list[int]:
    """Return the processes that a driver has started and that make runs."""
    listed = ["ps", "-o", "pid=,args=", "--ppid", str(driver.pid)]
    lines = subprocess.run(listed, capture_output=True, text=True, check=False).stdout.splitlines()
    return [int(line.split()[0]) for line in lines if "spawn_main" in line]


def killed(driver: subprocess.Popen[bytes], victim: str) -> None:
    """Kill a driver, all of its processes with it, or one of its workers."""
    if victim == "all":
        os.killpg(driver.pid, signal.SIGKILL)
    elif victim == "driver":
        os.kill(driver.pid, signal.SIGKILL)
    else:
        for one in workers_of(driver)[:1]:
            os.kill(one, signal.SIGKILL)
        assert driver.poll() is None
        time.sleep(2.0)  # it goes on with another one
        os.killpg(driver.pid, signal.SIGKILL)
    driver.wait()


@pytest.mark.slow
def test_a_study_that_is_killed_again_and_again_ends_with_the_same_table(slab, tmp_path):
    """Five times while it makes its 500 runs, in an order and at moments that are drawn."""
    study(slab).run(tmp_path / "whole", n=500, seed=5, how=HERE)
    resume(tmp_path / "whole", HowMade(workers=1))
    study(slab).run(tmp_path / "part", n=500, seed=5, how=HowMade(array=(500, 500)))
    part, order, before = StudyFolder.opened(tmp_path / "part"), random.Random(3), []
    victims = ["driver", "worker", "all", "worker", "driver"]
    for victim in order.sample(victims, k=5):
        driver = subprocess.Popen([*RESUME, "--workers", "2"], cwd=tmp_path, start_new_session=True)
        goal = part.count() + order.randint(10, 60)
        while part.count() < goal and driver.poll() is None:
            time.sleep(0.05)
        assert driver.poll() is None, "it had ended before it was killed"
        before.append(part.count())
        killed(driver, victim)
    assert before == sorted(set(before)) and before[-1] < 500
    time.sleep(1.0)
    subprocess.run([*RESUME, "--workers", "1"], cwd=tmp_path, check=True)
    table = (tmp_path / "part/results.csv").read_bytes()
    assert table == (tmp_path / "whole/results.csv").read_bytes()
    found = statistics.probability(statistics.columns_of(part))
    assert (found.runs, found.lost) == (500, 0)
    assert found.low < slab.fails((15e3, 6e3), (34.0, 4.0), -0.4) < found.high


def interrupted(case: clast.Case, **given) -> clast.Run:
    """Run a case as one is that hears the interrupt key after 60 steps: it leaves a checkpoint."""

    def press(at) -> None:
        if at.steps == 60:
            signal.raise_signal(signal.SIGINT)

    return RUN(case, progress=press, **given)


def refused(case: clast.Case, **given) -> clast.Run:
    raise AssertionError("the run begins anew")


RUN = clast.Case.run


@pytest.mark.parametrize("of", ["another process", "this process", "other parameters"])
def test_a_run_that_was_killed_goes_on_from_its_checkpoint(
    slab_in_steps, tmp_path, monkeypatch, of
):
    """Its result is that of a run that was not, and nothing of its files is left."""
    made = study(slab_in_steps, measure={"u": "largest(speed(A))", "n": "steps()"}, fail="")
    described = made.described(1)
    whole = Bench.of(StudyFolder.made(tmp_path / "whole", made.case, described)).make(1)
    bench = Bench.of(StudyFolder.made(tmp_path / "part", made.case, described))
    monkeypatch.setattr(clast.Case, "run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        bench.make(1)
    (left,) = bench.folder.place(1).parent.iterdir()
    assert (left / "run.checkpoint.h5").exists() and bench.folder.result(1) is None
    if of == "another process":
        ended = subprocess.Popen([sys.executable, "-c", ""])
        ended.wait()
        left = left.rename(left.with_name(left.name.replace(str(os.getpid()), str(ended.pid))))
        with bench.folder.driven():  # what can go on is no litter
            assert left.exists()
    monkeypatch.setattr(clast.Case, "run", refused)
    if of == "other parameters":
        text = (left / "case.toml").read_text()
        (left / "case.toml").write_text(text.replace("cohesion", "cohesion ", 1))
        monkeypatch.setattr(clast.Case, "run", RUN)
    assert bench.make(1) == whole
    assert sorted(file.name for file in bench.folder.place(1).iterdir()) == [
        "case.toml",
        "result.json",
    ]
    assert [one.name for one in bench.folder.place(1).parent.iterdir()] == ["00000001"]


def test_a_run_with_wrong_numbers_has_no_result_and_the_others_go_on(slab, tmp_path):
    one = clast.Study(
        slab.file,
        vary={"joint.plane.friction_angle": [30.0, 95.0, 35.0]},
        measure={"u": "displacement(A)"},
    )
    table = one.run(tmp_path / "out", how=HERE)
    assert table["status"] == ["done", "no result", "done"]
    # the same wherever the study lies
    assert table["reason"][1] == (
        "case.toml: [joint.plane] friction_angle: must be below 90, not 95.0; "
        "Coulomb friction angle, degrees."
    )
    assert table["u"][1] is None


def test_the_report_of_a_sweep_has_its_curve_and_its_runs(slab, tmp_path):
    pytest.importorskip("matplotlib")
    vary = {"joint.plane.friction_angle": [30.0, 95.0, 20.0]}
    study(slab, vary=vary, correlate=[]).run(tmp_path / "out", how=HERE)
    text = write_report(StudyFolder.opened(tmp_path / "out")).read_text(encoding="utf-8")
    assert "1 run has no result" in text and "<h2>Runs</h2>" in text
    for head in ("joint.plane.friction_angle, °", "u, m"):
        assert f">{head}</th>" in text
    assert "standard deviation" not in text and "histogram" not in text
    assert 'alt="u (m) against joint.plane.friction_angle"' in text
    assert (tmp_path / "out/figures/u-sweep-1.png").stat().st_size > 5000


class Dying(Executor):
    """An executor whose workers die, in the middle of a run or before they begin one."""

    def __init__(self, folder: Path, run: int) -> None:
        self.folder, self.run = folder, run

    def submit(self, call, folder, runs, *more):
        future = Future()
        if self.run == 0:
            future.set_exception(BrokenExecutor("they are not there"))
        elif self.run in runs:
            before = [run for run in runs if run < self.run]
            call(folder, before)
            place = StudyFolder.opened(self.folder).place(self.run)
            place.with_name(f".{place.name}.here.1").mkdir(parents=True, exist_ok=True)
            future.set_exception(BrokenExecutor("out of memory"))
        else:
            future.set_result(call(folder, runs))
        return future


def test_a_run_that_kills_its_worker_has_no_result_after_three_tries(slab, tmp_path):
    how = HowMade(executor=Dying(tmp_path / "out", 4), workers=1)
    table = study(slab).run(tmp_path / "out", n=7, how=how)
    assert table["status"] == ["done"] * 3 + ["no result"] + ["done"] * 3
    assert "ended 3 times" in table["reason"][3] and "out of memory" in table["reason"][3]
    again = resume(tmp_path / "out", HowMade(array=(1, 1), retry=True))
    assert again["status"] == ["done"] * 7


def test_workers_that_never_begin_are_no_fault_of_the_runs(slab, tmp_path):
    how = HowMade(executor=Dying(tmp_path / "out", 0), workers=1)
    with pytest.raises(CaseError, match="no worker starts"):
        study(slab).run(tmp_path / "out", n=7, how=how)
    assert StudyFolder.opened(tmp_path / "out").count() == 0


class Plain(Executor):
    """An executor that says nothing of itself, and runs what it is given at once."""

    def submit(self, call, /, *given):
        future = Future()
        future.set_result(call(*given))
        return future


def test_an_executor_need_not_say_how_many_workers_it_has(slab, tmp_path):
    table = study(slab).run(tmp_path / "out", n=5, executor=Plain())
    assert table["status"] == ["done"] * 5


def test_an_executor_that_was_shut_down_is_said(slab, tmp_path):
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    with pytest.raises(CaseError, match="takes no more runs"):
        study(slab).run(tmp_path / "out", n=2, executor=pool)


@pytest.mark.parametrize(
    ("how", "what"),
    [
        ({"executor": "processes"}, "a str is not an executor"),
        ({"workers": 0}, "0 is not a valid number of workers"),
        ({"workers": 1.5}, "not a valid number of workers"),
        ({"workers": True}, "not a valid number of workers"),
        ({"array": (0, 3)}, "is not part of an array"),
        ({"array": (4, 3)}, "is not part of an array"),
        ({"array": "1/3"}, "is not part of an array"),
        ({"array": (1, 2), "executor": Plain()}, "array and executor exclude each other"),
        ({"array": (1, 2), "scheduler": "tcp://h:1"}, "array and scheduler exclude each other"),
    ],
)
def test_who_could_not_make_runs_is_refused(how, what):
    with pytest.raises(CaseError, match=what) as refused:
        HowMade(**how)
    assert refused.value.remedy


def test_a_worker_that_dies_while_it_has_nothing_to_do_is_replaced(monkeypatch):
    class Pool:
        made: ClassVar[list[Pool]] = []

        def __init__(self, *_, **__):
            self.made.append(self)

        def submit(self, *_):
            if self is self.made[0]:
                raise BrokenExecutor("it was killed")
            return "a future"

        def shutdown(self, **_):
            pass

    monkeypatch.setattr(executors, "ProcessPoolExecutor", Pool)
    assert executors.Processes(1).submit(0, "out", [1]) == "a future"
    assert len(Pool.made) == 2


def test_a_folder_is_of_one_study(slab, tmp_path):
    study(slab).run(tmp_path / "out", n=1, how=HERE)
    with pytest.raises(CaseError, match="another study"):
        study(slab).run(tmp_path / "out", n=2, how=HERE)
    with pytest.raises(CaseError, match="not empty"):
        study(slab).run(tmp_path, n=2, how=HERE)
    with pytest.raises(CaseError, match="not a folder of a study"):
        resume(tmp_path)
    there = StudyFolder.opened(tmp_path / "out")
    with there.driven(), pytest.raises(CaseError, match="in use by another"):
        resume(tmp_path / "out")


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"measure": {"u": "displacement(B)"}}, "no point or block 'B'"),
        ({"measure": {"u": "displacement()"}}, "is of 1 name"),
        ({"measure": {"u": "bolt_force(A)"}}, "no bolt 'A'"),
        ({"measure": {"u": "sliding(plan)"}}, "no joint 'plan'"),
        ({"measure": {"u": "energy(heat)"}}, "no entry 'heat'"),
    ],
)
def test_studies_that_ask_for_what_is_not_there_are_refused(slab, tmp_path, changes, what):
    with pytest.raises(CaseError, match=what):
        study(slab, **changes).run(tmp_path / "out", n=2, how=HERE)


def test_a_million_runs_are_listed_without_being_held(slab, tmp_path):
    import tracemalloc

    made = study(slab)
    folder = StudyFolder.made(tmp_path / "out", made.case, made.described(1_000_000))
    tracemalloc.start()
    count = sum(1 for _ in folder.missing(lambda run: True))
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert count == 1_000_000
    assert most < 5e6


def test_the_worst_runs_are_kept_and_joints_are_counted(slab, tmp_path):
    one = study(slab, keep="worst 3", measure={"u": "farthest()"})
    one.run(tmp_path / "out", n=12, seed=5, how=HERE)
    table = resume(tmp_path / "out", HowMade(workers=1))
    kept = sorted(file.parent.name for file in (tmp_path / "out/runs").rglob("run.vtkhdf"))
    u = [-1.0 if one is None else one for one in table["u"]]
    order = sorted(range(12), key=lambda k: (not table["fails"][k], -u[k]))
    assert kept == sorted(f"{k + 1:08d}" for k in order[:3])
    for name in kept:
        run = clast.read_results(tmp_path / f"out/runs/0000/{name}/run.vtkhdf")
        assert bool(run.report.finished)
    found = statistics.columns_of(StudyFolder.opened(tmp_path / "out"))
    failed = int(sum(table["fails"]))
    assert failed > 0 and found.joints == {"plane": failed} and found.blocks == {"slab": failed}


def test_progress_of_a_part_of_an_array_is_that_of_the_part(slab, tmp_path):
    seen = []
    one = study(slab)
    one.run(tmp_path / "out", n=7, array=(1, 7))
    one.run(tmp_path / "out", n=7, array=(1, 2), watch=seen.append)
    assert [(at.done, at.total) for at in seen] == [(2, 4), (3, 4), (4, 4)]
    assert seen[-1].left == 0.0
