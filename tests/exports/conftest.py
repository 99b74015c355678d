"""Fixtures of the tests of exports."""

from __future__ import annotations

import pytest

from clast.results import Results, read_results
from scenes.recorded_run import record, three_blocks


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """A result file of three blocks with five frames."""
    path = tmp_path_factory.mktemp("written") / "three.vtkhdf"
    record(three_blocks(), path)
    return read_results(path)
