"""Tables of results: every row and every digit, and what is left out."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.exports import TABLES, write_csv
from clast.inputs.builder import InputBuilder
from clast.model.state import initial_state
from clast.results import Results, Run, RunRecorder
from scenes.recorded_run import record, report, three_blocks


def rows_of(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def numbers(rows: list[dict[str, str]], *columns: str) -> np.ndarray:
    return np.array([[float(row[column]) for column in columns] for row in rows])


@pytest.fixture(scope="module")
def folder(written: Results, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All tables of all frames."""
    path = tmp_path_factory.mktemp("tables") / "three"
    # there are none
    none = ("bolts", "linings", "links", "measured_contacts", "convergences", "stages", "events")
    none += ("channels", "flow", "measured_flows")
    names = [name for name in TABLES if name not in none]
    assert write_csv(written, path) == [path / f"{name}.csv" for name in names]
    return path


def test_blocks_have_a_row_in_each_frame(written: Results, folder: Path):
    rows = rows_of(folder, "blocks")
    assert len(rows) == 5 * 3
    assert [row["name"] for row in rows[3:6]] == ["base", "wedge", "corner"]
    assert [row["rock"] for row in rows[3:6]] == ["granite", "granite", "marl"]
    assert [row["fixed"] for row in rows[3:6]] == ["1", "0", "0"]
    for frame in range(5):
        own = [row for row in rows if row["frame"] == str(frame)]
        assert [float(row["time"]) for row in own] == [written.times[frame]] * 3
        for field, parts in (
            ("displacement", ("x", "y")),
            ("velocity", ("x", "y")),
            ("stress", ("xx", "yy", "xy")),
        ):
            found = numbers(own, *(f"{field}_{part}" for part in parts))
            np.testing.assert_array_equal(found, written.field(field, frame))
        for field in ("rotation", "sigma_1", "sigma_3", "max_shear"):
            np.testing.assert_array_equal(numbers(own, field)[:, 0], written.field(field, frame))


def test_vertices_have_the_joint_of_the_edge_behind_them(written: Results, folder: Path):
    rows = rows_of(folder, "vertices")
    assert len(rows) == 5 * 13
    at = np.concatenate([written.vertices(frame) for frame in range(5)])
    np.testing.assert_array_equal(numbers(rows, "x", "y"), at)
    assert [row["block"] for row in rows[:13]] == [*"0000", *"111", *"222222"]
    assert {row["vertex"]: row["joint"] for row in rows if row["joint"]} == {
        "2": "bed",
        "7": "foot",
    }


def test_contacts_name_their_joints(written: Results, folder: Path):
    rows = rows_of(folder, "contacts")
    contacts = [written.contacts(frame) for frame in range(5)]
    assert len(rows) == sum(map(len, contacts)) == 8
    assert [row["joint"] for row in rows[:2]] == ["foot", "bed"]
    for column in set(contacts[1]) - {"joint"}:
        expected = np.concatenate([one[column] for one in contacts])
        np.testing.assert_array_equal(numbers(rows, column)[:, 0], expected)
    assert [row["frame"] for row in rows] == [*"11223344"]


def test_histories_energy_and_steps_are_complete(written: Results, folder: Path):
    histories = rows_of(folder, "histories")
    assert len(histories) == 2 * 21
    for name in ("tip", "left/right"):
        own = [row for row in histories if row["point"] == name]
        for column, values in written.history(name).items():
            np.testing.assert_array_equal(numbers(own, column)[:, 0], values)
    for name, table in {"energy": written.energy, "steps": written.steps}.items():
        rows = rows_of(folder, name)
        for column, values in table.items():
            np.testing.assert_array_equal(numbers(rows, column)[:, 0], values)


def test_some_tables_of_some_frames(written: Results, tmp_path: Path):
    paths = write_csv(written, tmp_path, [3, -1, 4], ["blocks", "contacts"])
    assert [path.name for path in paths] == ["blocks.csv", "contacts.csv"]
    assert [row["frame"] for row in rows_of(tmp_path, "blocks")] == [*"333444"]


def test_a_run_in_memory_gives_the_same_tables(folder: Path, tmp_path: Path):
    write_csv(record(three_blocks()).run, tmp_path / "kept")
    for file in (path.name for path in folder.iterdir()):
        assert (tmp_path / "kept" / file).read_bytes() == (folder / file).read_bytes()


def alone() -> Run:
    """A block whose name needs quotes, without contacts and measured points."""
    builder = InputBuilder(title="alone")
    builder.add_rock("tuff", young=5e9, poisson=0.2, density=2000.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1)], rock="tuff", name='"Köln", left')
    model = builder.build()
    recorder = RunRecorder(model)
    recorder.start(initial_state(model))
    return recorder.finish(report(initial_state(model)))


def test_tables_of_what_is_not_there_are_left_out_or_refused_by_name(tmp_path: Path):
    paths = write_csv(alone(), tmp_path / "all")
    assert [path.stem for path in paths] == ["blocks", "vertices", "energy", "steps"]
    assert [row["name"] for row in rows_of(tmp_path / "all", "blocks")] == ['"Köln", left']
    for name, said in (("contacts", "no contacts are"), ("histories", "no measured points are")):
        with pytest.raises(CaseError, match=said) as caught:
            write_csv(alone(), tmp_path / "some", tables=["blocks", name])
        assert name in caught.value.remedy
    assert not (tmp_path / "some").exists()


def dug() -> Run:
    """A block upon another one, which is taken out in the second stage."""
    builder = InputBuilder(title="dug", gravity=(0.0, -9.81))
    builder.add_rock("tuff", young=5e9, poisson=0.2, density=2000.0)
    builder.add_joint("default", friction_angle=30.0)
    for y, name in enumerate(("floor", "low", "high")):
        corners = [(0, y), (1, y), (1, y + 1), (0, y + 1)]
        builder.block(vertices=corners, name=name, fixed=name == "floor")
    stages = [
        clast.Stage(name="rest", dynamic_ratio=0.0, time=0.5),
        clast.Stage(name="dig", dynamic_ratio=0.0, time=0.02, excavate=("high",), until="time"),
    ]
    return clast.simulate(builder.build(), stages=stages, step=2e-3, every=0.01)


def test_stages_and_events_are_tables(tmp_path: Path):
    run = dug()
    write_csv(run, tmp_path)
    rest, dig = rows_of(tmp_path, "stages")
    assert [rest["name"], rest["outcome"], dig["outcome"]] == ["rest", "equilibrium", "time over"]
    assert float(rest["end"]) == run.stages[0].end == float(dig["start"])
    assert float(dig["mover_speed"]) == run.stages[1].mover.speed
    events = rows_of(tmp_path, "events")
    assert [row["text"] for row in events] == [event.text for event in run.events]
    assert ("excavated", "high", "dig") in [
        (row["kind"], row["what"], row["stage"]) for row in events
    ]
    rows = rows_of(tmp_path, "blocks")
    assert tuple(row["stage"] for row in rows[::3]) == run.frame_stages
    assert {(row["stage"], row["gone"]) for row in rows if row["name"] == "high"} >= {
        ("rest", "0.0"),
        ("dig", "1.0"),
    }


def test_what_cannot_be_written_is_refused(written: Results, tmp_path: Path):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "blocks.csv").write_text("mine")
    for path, tables, said in (
        (tmp_path, None, "blocks.csv: already exists"),
        (tmp_path / "file", None, "cannot be the folder of tables"),
        (tmp_path / "missing" / "a", None, "cannot be the folder of tables"),
        (tmp_path / "a.csv", None, "is not a valid folder name"),
        (tmp_path / "a", ["vertex"], "there is no table 'vertex'"),
    ):
        with pytest.raises(CaseError, match=said) as caught:
            write_csv(written, path, tables=tables)
        assert caught.value.remedy
    assert sorted(path.name for path in tmp_path.iterdir()) == ["blocks.csv", "file"]
    assert (tmp_path / "blocks.csv").read_text() == "mine"
