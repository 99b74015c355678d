"""Scripts with studies, started as files: workers are new processes, which run the script."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

MODEL = """
print("the script begins")
import clast
b = clast.ModelBuilder(title="x")
b.add_rock("s", young=5e9, poisson=0.2, density=2500.0)
b.add_joint(friction_angle=30)
b.block(name="f", vertices=[(-1, -1), (3, -1), (3, 0), (-1, 0)], fixed=True)
b.block(name="k", vertices=[(0, 0), (1, 0), (1, 0.5), (0, 0.5)], velocity=(1, 0, 0))
b.measured_point("A", at=(0.5, 0.5), block="k")
vary = {"joint.default.friction_angle": clast.Normal(30, 3)}
study = clast.Study(b.case(end=0.01), vary=vary, measure={"u": "displacement(A)"})
"""
BARE = "print(study.run('s', n=2, workers=WORKERS)['status'])\n"
GUARDED = f"if __name__ == '__main__':\n    {BARE}"
IN_A_FUNCTION = f"def go():\n    {BARE}\ngo()\n"
TRIED = f"try:\n    if '__main__' == __name__ and True:\n        {BARE}\nfinally:\n    pass\n"


def started(folder: Path, text: str, workers: str) -> subprocess.CompletedProcess[str]:
    (folder / "script.py").write_text(MODEL + text.replace("WORKERS", workers))
    return subprocess.run(
        [sys.executable, "script.py"], cwd=folder, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    "text", [BARE, IN_A_FUNCTION, GUARDED], ids=["bare", "function", "guarded"]
)
def test_one_worker_is_this_process(tmp_path, text):
    ended = started(tmp_path, text, "1")
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.splitlines() == ["the script begins", "['done', 'done']"]


@pytest.mark.parametrize("text", [BARE, IN_A_FUNCTION], ids=["bare", "function"])
def test_a_script_without_its_guard_says_so_before_anything_runs_twice(tmp_path, text):
    ended = started(tmp_path, text, "2")
    assert ended.returncode == 1 and ended.stdout.splitlines() == ["the script begins"]
    assert 'if __name__ == "__main__":' in ended.stderr and "script.py, line" in ended.stderr
    assert ended.stderr.count("Traceback") == 1


@pytest.mark.parametrize("text", [GUARDED, TRIED], ids=["guarded", "within try"])
def test_a_guarded_script_has_its_workers(tmp_path, text):
    ended = started(tmp_path, text, "2")
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.splitlines()[-1] == "['done', 'done']"
