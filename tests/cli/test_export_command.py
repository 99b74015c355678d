"""clast export and the frames of clast plot: what they write, and one message where they cannot."""

from __future__ import annotations

from pathlib import Path

import pytest

from clast.exports.csv_tables import TABLES
from clast.results import read_results
from scenes.command_line import clast_command, good
from scenes.recorded_run import record, three_blocks


@pytest.fixture
def result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A result file of five frames, 0.05 s apart, in the current folder."""
    monkeypatch.chdir(tmp_path)
    record(three_blocks(), tmp_path / "three.vtkhdf")
    return Path("three.vtkhdf")


def left() -> list[str]:
    """Return what has been written beside the result file."""
    return sorted(path.name for path in Path().iterdir() if path.name != "three.vtkhdf")


def test_each_form_has_its_frames_and_names(result: Path):
    assert good("export", result, "--to", "vtu") == "wrote three.pvd and 5 more\n"
    assert left() == [*(f"three-{k:04d}.vtu" for k in range(5)), "three.pvd"]
    assert good("export", result, "--to", "dxf") == "wrote three.dxf\n"
    assert good("export", result, "--to", "csv") == "wrote three-tables/blocks.csv and 6 more\n"
    lines = Path("three-tables/blocks.csv").read_text().splitlines()
    assert len(lines) == 1 + 5 * 3


def test_one_frame_by_number_or_time(result: Path):
    good("export", result, "--to", "vtu", "--frame", "2")
    good("export", result, "--to", "vtu", "--time", "0.101", "-o", "b.vtu")
    assert Path("three.vtu").read_bytes() == Path("b.vtu").read_bytes()
    assert f"\n{float(read_results(result).times[2])!r}\n" in Path("b.vtu").read_text()
    good("export", result, "--to", "dxf", "--all", "-o", "c.dxf")
    assert len(list(Path().glob("c-*.dxf"))) == 5


def test_some_tables(result: Path):
    good("export", result, "--to", "csv", "--tables", "steps, energy", "-o", "few")
    assert sorted(path.name for path in Path("few").iterdir()) == ["energy.csv", "steps.csv"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--to", "vtu", "--frame", "9"], ["there is no frame 9", "0 to 4"]),
        (["--to", "dxf", "--time", "7"], ["no frame at t = 7 s", "between 0 and 0.2 s"]),
        (["--to", "dxf", "--time", "nan"], ["no frame at t = nan s"]),
        (["--to", "dxf", "--time", "0", "--frame", "0"], ["--time", "leave one"]),
        (["--to", "dxf", "--all", "--frame", "0"], ["--all", "leave one"]),
        (["--to", "vtu", "--tables", "steps"], ["--tables", "--to csv"]),
        (["--to", "csv", "--tables", "step"], ["no table 'step'", "'steps'"]),
        (["--to", "csv", "-o", "taken.dxf"], ["taken.dxf", "folder"]),
        (["--to", "dxf", "-o", "taken.dxf"], ["taken.dxf", "already exists"]),
        (["--to", "dxf", "-o", "missing/a.dxf"], ["missing/a.dxf", "folder does not exist"]),
        (["--to", "vtu", "-o", "a.vtu"], ["a.vtu", "ending in .pvd"]),
    ],
)
def test_one_message_where_nothing_can_be_written(result: Path, arguments: list, said: list):
    Path("taken.dxf").write_text("mine")
    found = clast_command("export", result, *arguments)
    assert (found.exit_code, found.stdout) == (2, "")
    assert found.stderr.startswith("error: ")
    assert found.stderr.count("error: ") == 1
    for word in said:
        assert word in found.stderr
    assert left() == ["taken.dxf"]
    assert Path("taken.dxf").read_text() == "mine"


def test_no_contacts_are_said_where_they_are_asked_for(result: Path):
    record(three_blocks(), result, contacts=False)
    found = clast_command("export", result, "--to", "csv", "--tables", "contacts")
    assert found.exit_code == 2
    assert "no contacts are recorded" in found.stderr
    assert "left out, nothing is recorded of: contacts" in good("export", result, "--to", "csv")
    assert not Path("three-tables/contacts.csv").exists()


def test_a_picture_of_the_frame_at_a_time(result: Path):
    pytest.importorskip("matplotlib")
    good("plot", result, "--time", "0.101", "--field", "joint", "-o", "a.png")
    good("plot", result, "--frame", "2", "--field", "joint", "-o", "b.png")
    good("plot", result, "--field", "joint", "-o", "c.png", "--limits", "0,1", "--zoom", "0,0,5,5")
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()
    assert Path("c.png").read_bytes() != Path("b.png").read_bytes()
    found = clast_command("plot", result, "--time", "0", "--frame", "0")
    assert found.exit_code == 2
    assert "leave one of them out" in found.stderr


def test_help_names_every_table():
    said = " ".join(good("export", "--help").replace("│", " ").split())
    listed = said.split("Only these of ")[1].split(".")[0]
    assert listed.split(", ") == list(TABLES)
