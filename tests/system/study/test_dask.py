"""Studies on a Dask cluster: a scheduler and two workers, each a process of its own."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import clast
from clast.errors import CaseError
from clast.study import executors
from clast.study.study_api import HowMade, resume
from clast.study.trial_table import CSV

pytestmark = pytest.mark.slow
VARY = {
    "joint.plane.friction_angle": "normal(34, 4, low=5, high=70)",
    "joint.plane.cohesion": "lognormal(15e3, 6e3)",
}


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def started(*words: str, cwd: Path) -> subprocess.Popen[bytes]:
    quiet = subprocess.DEVNULL
    command = [sys.executable, "-m", *words]
    return subprocess.Popen(command, cwd=cwd, stdout=quiet, stderr=quiet)


def wait_for(port: int) -> None:
    """Wait until somebody answers at a port."""
    end = time.monotonic() + 100.0
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), 1.0).close()
            return
        except OSError:
            if time.monotonic() > end:
                raise
            time.sleep(0.2)


@contextmanager
def cluster(cwd: Path, workers: int = 2) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Give the address of a scheduler, and its process and those of two workers."""
    address = f"tcp://127.0.0.1:{(port := free_port())}"
    words = ["--host", "127.0.0.1", "--port", str(port), "--dashboard-address", ":0"]
    parts = [started("distributed.cli.dask_scheduler", *words, cwd=cwd)]
    worker = ["distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny"]
    parts += [started(*worker, "--no-dashboard", cwd=cwd) for _ in range(workers)]
    try:
        wait_for(port)
        yield address, parts
    finally:
        for one in parts:
            one.kill()
            one.wait()


def test_a_cluster_gives_the_table_of_one_process(slab, tmp_path):
    pytest.importorskip("distributed")
    study = clast.Study(slab.file, vary=VARY, measure={"u": "displacement(A)"}, fail="fails()")
    study.run(tmp_path / "whole", n=24, how=HowMade(array=(1, 1)))
    resume(tmp_path / "whole", HowMade(workers=1))
    made = study.described(24)
    assert made.n == 24
    with cluster(tmp_path) as (address, _):
        study.run(tmp_path / "part", n=24, how=HowMade(scheduler=address))
    tables = [(tmp_path / name / CSV).read_bytes() for name in ("whole", "part")]
    assert tables[0] == tables[1]


@pytest.mark.parametrize("victim", [0, 1], ids=["scheduler", "worker"])
def test_a_study_goes_on_when_its_cluster_is_gone(slab, tmp_path, victim):
    pytest.importorskip("distributed")
    study = clast.Study(slab.file, vary=VARY, measure={"u": "displacement(A)"}, fail="fails()")
    study.run(tmp_path / "whole", n=40, how=HowMade(array=(1, 1)))
    resume(tmp_path / "whole", HowMade(workers=1))
    with cluster(tmp_path) as (address, parts):
        killed = []

        def kill(at) -> None:
            if at.made >= 4 and not killed:
                killed.append(at.made)
                os.kill(parts[victim].pid, signal.SIGKILL)

        how = HowMade(scheduler=address, watch=kill)
        start = time.monotonic()
        if victim == 0:
            with pytest.raises(CaseError, match="has stopped"):
                study.run(tmp_path / "part", n=40, how=how)
        else:
            study.run(tmp_path / "part", n=40, how=how)
        assert killed and time.monotonic() - start < 120.0
    resume(tmp_path / "part", HowMade(array=(1, 1)))
    resume(tmp_path / "part", HowMade(workers=1))
    tables = [(tmp_path / name / CSV).read_bytes() for name in ("whole", "part")]
    assert tables[0] == tables[1]


def test_an_executor_of_a_local_cluster_gives_the_same_table(slab, tmp_path):
    distributed = pytest.importorskip("distributed")
    study = clast.Study(slab.file, vary=VARY, measure={"u": "displacement(A)"}, fail="fails()")
    study.run(tmp_path / "whole", n=12, how=HowMade(array=(1, 1)))
    resume(tmp_path / "whole", HowMade(workers=1))
    own = {"host": "127.0.0.1", "dashboard_address": None, "local_directory": str(tmp_path)}
    with (
        distributed.LocalCluster(2, threads_per_worker=1, **own) as local,
        distributed.Client(local) as client,
    ):
        study.run(tmp_path / "part", n=12, executor=client.get_executor(pure=False))
    tables = [(tmp_path / name / CSV).read_bytes() for name in ("whole", "part")]
    assert tables[0] == tables[1]


def test_a_scheduler_without_workers_is_said(slab, tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "WORKER_TIMEOUT", 1)
    study = clast.Study(slab.file, vary=VARY, measure={"u": "displacement(A)"})
    with cluster(tmp_path, workers=0) as (address, _), pytest.raises(CaseError, match="no worker"):
        study.run(tmp_path / "part", n=2, scheduler=address)


def test_a_scheduler_that_does_not_answer_is_said(slab, tmp_path):
    pytest.importorskip("distributed")
    study = clast.Study(slab.file, vary=VARY, measure={"u": "displacement(A)"})
    address = f"tcp://127.0.0.1:{free_port()}"
    with pytest.raises(CaseError, match="does not answer"):
        study.run(tmp_path / "part", n=2, how=HowMade(scheduler=address))
