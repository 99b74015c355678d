"""Compiled kernels: kept in a folder that belongs to their text, loaded without scipy."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from clast.block import polygon
from clast.compute import jit as compiled

CODE = "from clast.block.polygon import travel; travel.open(); print(travel.stats.cache_path)"


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


def test_the_folder_is_named_after_the_text_of_the_kernels_used(tmp_path, monkeypatch):
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    texts = {
        "one": "from clast import two as kernel\n",
        "two": "from clast.three import (\n    name,\n)\n",
        "three": "",
        "other": "from clast import plain\n",
        "plain": "",
    }

    def kept() -> dict[str, str]:
        compiled.text_of.cache_clear()
        compiled.used_by.cache_clear()
        compiled.has_kernels.cache_clear()
        compiled.folder.cache_clear()
        return {name: compiled.folder(tmp_path / f"{name}.py", tmp_path) for name in texts}

    for name, text in texts.items():
        says = "" if name == "plain" else "from clast.compute.jit import kernel\n"
        (tmp_path / f"{name}.py").write_text(says + text)
    before = kept()
    assert {Path(one).parent for one in before.values()} == {tmp_path / "__pycache__"}
    assert len(set(before.values())) == len(texts)
    assert kept() == before
    (tmp_path / "plain.py").write_text("# changed\n")
    assert {name for name in kept() if kept()[name] != before[name]} == {"plain"}
    loops = "from clast.compute.parallel import BLOCKS, shared\n"
    (tmp_path / "three.py").write_text(loops)
    after = kept()
    assert {name for name in texts if after[name] != before[name]} == {
        "one",
        "two",
        "three",
        "plain",
    }


def test_kernels_are_kept_there_and_numbas_own_setting_is_left_alone():
    kept = compiled.folder(Path(polygon.__file__))
    polygon.travel.open()
    assert polygon.travel.stats.cache_path.startswith(kept or "/")
    assert numba.config.CACHE_DIR == os.environ.get("NUMBA_CACHE_DIR", "")


@pytest.mark.slow
def test_the_users_folder_comes_first(tmp_path):
    assert cache_path(NUMBA_CACHE_DIR=str(tmp_path)).startswith(str(tmp_path))
