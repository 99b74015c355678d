"""What the tests of the commands begin with."""

from __future__ import annotations

from pathlib import Path

import pytest

from clast.case.templates import INCLINE


@pytest.fixture
def incline(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The case of the incline, in a folder of its own that is the current one."""
    monkeypatch.chdir(tmp_path)
    case = tmp_path / "incline.toml"
    case.write_text(INCLINE, encoding="utf-8")
    return case
