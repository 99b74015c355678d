"""Compiled kernels: kept in a folder that belongs to the text of all, loaded without scipy."""

import os
import subprocess
import sys
from pathlib import Path

import numba

from clast.kernels import compiled, laws

CODE = "from clast.kernels import laws; print(laws.penalty.stats.cache_path)"


def cache_path(**environment: str) -> str:
    """Return where a new process keeps its kernels."""
    answer = subprocess.run(
        [sys.executable, "-c", CODE],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return answer.stdout.strip()


def test_the_folder_is_named_after_the_text_of_all_kernels(tmp_path, monkeypatch):
    for name in ("one.py", "two.py"):
        (tmp_path / name).write_text(f"# {name}\n")
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "one.py"))
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    before = compiled.folder()
    assert Path(before).parent == tmp_path / "__pycache__"
    assert compiled.folder() == before
    (tmp_path / "two.py").write_text("# changed\n")
    assert compiled.folder() != before


def test_kernels_are_kept_there_and_numbas_own_setting_is_left_alone():
    assert laws.penalty.stats.cache_path.startswith(compiled.FOLDER or "/")
    assert numba.config.CACHE_DIR == os.environ.get("NUMBA_CACHE_DIR", "")


def test_the_users_folder_comes_first(tmp_path):
    assert cache_path(NUMBA_CACHE_DIR=str(tmp_path)).startswith(str(tmp_path))


LOADED = """
import sys
import numba
import numpy as np
from clast.kernels import polygon

polygon.owners(np.array([0, 3, 7]))
assert "scipy.linalg" not in sys.modules, "numba has asked scipy for a BLAS"
product = numba.njit(lambda a, b: np.dot(a, b))(np.eye(2), np.array([[1.0, 2.0], [3.0, 4.0]]))
assert product.tolist() == [[1.0, 2.0], [3.0, 4.0]]
assert "scipy.linalg" in sys.modules
"""


def test_scipy_is_asked_for_a_blas_only_by_kernels_that_need_one():
    """It takes a quarter of a second to import; a plugin's np.dot must work all the same."""
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
