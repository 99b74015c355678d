"""The interrupt key waits for the end of a step; pressed twice it does not."""

import signal
import subprocess
import sys
import threading

import pytest

from clast.results import read_results
from clast.run.interrupts import heard, held_back
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from scenes.systems import box, by_convex, system


@pytest.fixture(autouse=True)
def usual_handler():
    """Give the key its usual handler: tests in the background inherit that it is ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def press():
    signal.raise_signal(signal.SIGINT)


def test_the_key_is_held_back_until_it_is_let_go():
    done = []
    with pytest.raises(KeyboardInterrupt), held_back() as let_go:
        let_go()
        press()
        done.append("step")
        let_go()
        done.append("never")
    assert done == ["step"]
    with pytest.raises(KeyboardInterrupt):
        press()


def test_a_second_press_is_not_held_back():
    with pytest.raises(KeyboardInterrupt), held_back():
        press()
        press()
        pytest.fail("the second press was held back")


def test_a_handler_of_somebody_else_stays():
    seen = []
    usual = signal.signal(signal.SIGINT, lambda *_: seen.append(1))
    try:
        with held_back() as let_go:
            press()
            let_go()
    finally:
        signal.signal(signal.SIGINT, usual)
    assert seen == [1]


def test_outside_the_main_thread_nothing_changes():
    ended = []

    def work():
        with held_back() as let_go:
            let_go()
            ended.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert ended == [signal.default_int_handler]


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="needs POSIX signals")
def test_what_is_ignored_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with heard(), held_back() as let_go:
            signal.raise_signal(signal.SIGHUP)
            let_go()
    finally:
        signal.signal(signal.SIGHUP, before)


ENDED = """
import os, signal, sys
import clast
from clast.case.templates import INCLINE

def watch(progress):
    if progress.steps == 3:
        os.kill(os.getpid(), getattr(signal, sys.argv[2]))

clast.Case.from_toml(INCLINE).run(progress=watch, output=sys.argv[1])
print("goes on")
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="needs POSIX signals")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_script_that_is_asked_to_end_keeps_its_results(tmp_path, name):
    path = tmp_path / "out.vtkhdf"
    done = subprocess.run(
        [sys.executable, "-c", ENDED, str(path), name], capture_output=True, text=True, check=False
    )
    assert done.returncode == -getattr(signal, name), done.stderr
    assert done.stdout == ""
    results = read_results(path)
    assert results.times[-1] == pytest.approx(0.003)
    assert f"interrupted by {name}" in results.report.outcome


def test_a_run_ends_after_the_step_in_which_the_key_is_pressed():
    model = system([box(0.0, 0.0)])
    steps = []

    def watch(progress):
        steps.append(progress.time)
        if len(steps) == 3:
            press()

    run = simulate(model, by_convex(5e9), Schedule(step=1e-3, end=1.0, every=1e-3), watch=watch)
    assert run.report.outcome == "interrupted at t = 0.003 s"
    assert run.report.steps == 3
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
