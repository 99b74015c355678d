"""Fixtures of the tests of exports."""

from __future__ import annotations

from pathlib import Path

import pytest

from clast.results import Results, read_results
from scenes.first_version import crafted, of_the_first_version
from scenes.recorded_run import record, three_blocks


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """A result file of three blocks with five frames."""
    path = tmp_path_factory.mktemp("written") / "three.vtkhdf"
    record(three_blocks(), path)
    return read_results(path)


@pytest.fixture
def old(written: Results, tmp_path: Path) -> Results:
    """The same as the first version wrote it, without joints."""
    crafted(written.path, tmp_path / "old.vtkhdf", of_the_first_version)
    return read_results(tmp_path / "old.vtkhdf")
