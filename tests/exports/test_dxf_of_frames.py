"""Drawings of frames: blocks on the layers of their rocks, joints, contact forces."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from clast.errors import CaseError
from clast.exports import write_dxf
from clast.inputs.builder import InputBuilder
from clast.results import Results
from scenes.recorded_run import record, three_blocks

ezdxf = pytest.importorskip("ezdxf")


def drawing(path: Path) -> Any:
    """Return a drawing in which ezdxf finds nothing to complain of."""
    document = ezdxf.readfile(path)
    assert document.audit().errors == []
    assert document.units == 6
    return document


def lines_on(document: Any, layer: str) -> np.ndarray:
    """Return the ends of the lines on a layer, m, shape (n, 2, 2)."""
    found = document.modelspace().query(f'LINE[layer=="{layer}"]')
    ends = [[(*one.dxf.start,)[:2], (*one.dxf.end,)[:2]] for one in found]
    return np.array(ends).reshape(-1, 2, 2)


def force_of_a_metre(document: Any) -> float:
    about = document.layers.get("CONTACTS").description
    said = re.fullmatch(r"contact forces, 1 m for (\S+) N/m; t = (\S+) s", about)
    assert said is not None
    return float(said[1])


def test_blocks_of_the_last_frame_are_closed_polylines_on_their_rocks(
    written: Results, tmp_path: Path
):
    assert write_dxf(written, tmp_path / "three.dxf") == [tmp_path / "three.dxf"]
    blocks = drawing(tmp_path / "three.dxf").modelspace().query("LWPOLYLINE")
    assert [one.dxf.layer for one in blocks] == ["granite", "granite", "marl"]
    assert all(one.closed for one in blocks)
    corners = np.concatenate([np.array(one.get_points("xy")) for one in blocks])
    np.testing.assert_array_equal(corners, written.vertices(-1))


def test_joints_are_lines_on_layers_of_their_own(written: Results, tmp_path: Path):
    write_dxf(written, tmp_path / "three.dxf", [1])
    document = drawing(tmp_path / "three.dxf")
    at = written.vertices(1)
    np.testing.assert_array_equal(lines_on(document, "JOINTS_bed"), [at[[2, 3]]])
    np.testing.assert_array_equal(lines_on(document, "JOINTS_foot"), [at[[7, 8]]])


def test_contact_forces_are_as_long_as_the_layer_says(written: Results, tmp_path: Path):
    write_dxf(written, tmp_path / "three.dxf", [3])
    document = drawing(tmp_path / "three.dxf")
    contacts = written.contacts(3)
    lines = lines_on(document, "CONTACTS")
    assert len(lines) == 2
    np.testing.assert_allclose(lines.mean(axis=1), contacts.position, rtol=1e-14)
    force = (lines[:, 1] - lines[:, 0]) * force_of_a_metre(document)
    np.testing.assert_allclose(force, contacts.force, rtol=1e-9)
    size = np.hypot(*np.ptp(written.vertices(0), axis=0))
    longest = np.hypot(*(lines[:, 1] - lines[:, 0]).T).max()
    assert 0.05 * size / 2.5 < longest <= 0.05 * size


def test_all_frames_have_one_scale(written: Results, tmp_path: Path):
    paths = write_dxf(written, tmp_path / "three.dxf", None)
    assert [path.name for path in paths] == [f"three-{k:04d}.dxf" for k in range(5)]
    drawings = [drawing(path) for path in paths]
    assert len({force_of_a_metre(one) for one in drawings}) == 1
    assert [len(lines_on(one, "CONTACTS")) for one in drawings] == [0, 2, 2, 2, 2]


def test_a_rock_called_as_the_layer_of_contacts_is_refused(tmp_path: Path):
    builder = InputBuilder(title="one block")
    builder.add_rock("CONTACTS", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1)], rock="CONTACTS")
    kept = record_start(builder)
    with pytest.raises(CaseError, match="would be the same layer"):
        write_dxf(kept, tmp_path / "a.dxf")
    assert list(tmp_path.iterdir()) == []


def record_start(builder: InputBuilder) -> Any:
    """Return a run of which nothing but the start is recorded."""
    from clast.model.state import initial_state
    from clast.results import RunRecorder
    from scenes.recorded_run import report

    model = builder.build()
    recorder = RunRecorder(model)
    recorder.start(initial_state(model))
    return recorder.finish(report(initial_state(model)))


def test_what_cannot_be_written_is_refused(written: Results, tmp_path: Path, monkeypatch):
    kept = record(three_blocks()).run
    (tmp_path / "there.dxf").write_text("mine")
    for path, frames, said in (
        (tmp_path / "a.dwg", [1], "is not a valid name for a drawing"),
        (tmp_path / "there.dxf", [1], "already exists"),
        (tmp_path / "a.dxf", [-9], "no frame -9"),
    ):
        with pytest.raises(CaseError, match=said) as caught:
            write_dxf(kept, path, frames)
        assert caught.value.remedy
    monkeypatch.setitem(sys.modules, "ezdxf.filemanagement", None)
    with pytest.raises(CaseError, match="ezdxf, which is not installed"):
        write_dxf(written, tmp_path / "a.dxf")
    assert (tmp_path / "there.dxf").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["there.dxf"]
