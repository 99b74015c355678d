"""Fixtures of the tests of results."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenes.recorded_run import Recorded, record, three_blocks


@pytest.fixture
def recorded(tmp_path: Path) -> Recorded:
    """A run of three blocks recorded in a file."""
    return record(three_blocks(), tmp_path / "out.vtkhdf")
