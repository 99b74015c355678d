"""Meshes of frames: every number is where readers of VTK's XML look for it."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.exports import write_vtu
from clast.results import Results
from scenes.recorded_run import record, three_blocks


def arrays_in(path: Path) -> dict[str, np.ndarray]:
    """Return the arrays of a file by their place: "CellData/stress"."""
    root = ElementTree.parse(path).getroot()
    assert root.attrib["type"] == "UnstructuredGrid"
    found = {}
    for parent in root.iter():
        for one in parent.findall("DataArray"):
            kind = {"Float64": np.float64, "Int64": np.int64, "UInt8": np.uint8}
            values = np.array((one.text or "").split(), kind[one.attrib["type"]])
            parts = one.attrib.get("NumberOfComponents")
            shape = (-1, int(parts)) if parts else (-1,)
            found[f"{parent.tag}/{one.attrib['Name']}"] = values.reshape(shape)
    (piece,) = root.iter("Piece")
    assert int(piece.attrib["NumberOfPoints"]) == len(found["Points/Points"])
    assert int(piece.attrib["NumberOfCells"]) == len(found["Cells/types"])
    return found


def test_every_number_of_a_frame_is_in_its_file(written: Results, tmp_path: Path):
    (path,) = write_vtu(written, tmp_path / "three.vtu", [2])
    found = arrays_in(path)
    np.testing.assert_array_equal(found["Points/Points"][:, :2], written.vertices(2))
    np.testing.assert_array_equal(found["Points/Points"][:, 2], 0.0)
    np.testing.assert_array_equal(found["Cells/connectivity"], np.arange(13))
    np.testing.assert_array_equal(found["Cells/offsets"], [4, 7, 13])
    np.testing.assert_array_equal(found["Cells/types"], 7)
    np.testing.assert_array_equal(found["CellData/block"], [0, 1, 2])
    np.testing.assert_array_equal(found["CellData/rock"], [0, 0, 1])
    np.testing.assert_array_equal(found["CellData/fixed"], [1, 0, 0])
    for name in ("displacement", "velocity"):
        np.testing.assert_array_equal(found[f"CellData/{name}"][:, :2], written.field(name, 2))
        np.testing.assert_array_equal(found[f"CellData/{name}"][:, 2], 0.0)
    for name in ("stress", "rotation", "sigma_1", "sigma_3", "max_shear"):
        np.testing.assert_array_equal(found[f"CellData/{name}"], written.field(name, 2))
    moved = written.vertices(2) - written.vertices(0)
    np.testing.assert_array_equal(found["PointData/displacement"][:, :2], moved)
    np.testing.assert_array_equal(found["PointData/edge_joint"], written.edge_joint)
    np.testing.assert_array_equal(found["FieldData/TimeValue"], [written.times[2]])


def test_all_frames_are_listed_with_their_times(written: Results, tmp_path: Path):
    listing, *meshes = write_vtu(written, tmp_path / "a & b.pvd")
    assert [path.name for path in meshes] == [f"a & b-{k:04d}.vtu" for k in range(5)]
    root = ElementTree.parse(listing).getroot()
    assert root.attrib["type"] == "Collection"
    entries = [one.attrib for one in root.iter("DataSet")]
    assert [float(one["timestep"]) for one in entries] == written.times.tolist()
    for frame, one in enumerate(entries):
        found = arrays_in(tmp_path / one["file"])
        np.testing.assert_array_equal(found["Points/Points"][:, :2], written.vertices(frame))


def test_vtk_reads_the_polygons(written: Results, tmp_path: Path):
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    (path,) = write_vtu(written, tmp_path / "three.vtu", [-1])
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    assert [grid.GetCellType(k) for k in range(grid.GetNumberOfCells())] == [7, 7, 7]
    assert [grid.GetCell(k).GetNumberOfPoints() for k in range(3)] == [4, 3, 6]
    stress = vtk_to_numpy(grid.GetCellData().GetArray("stress"))
    np.testing.assert_array_equal(stress, written.field("stress", -1))
    assert grid.GetFieldData().GetArray("TimeValue").GetValue(0) == written.times[-1]


def test_a_run_in_memory_gives_the_same_files(written: Results, tmp_path: Path):
    kept = record(three_blocks()).run
    for name, source in {"a": written, "b": kept}.items():
        write_vtu(source, tmp_path / f"{name}.pvd")
    for frame in range(5):
        texts = [(tmp_path / f"{name}-{frame:04d}.vtu").read_bytes() for name in "ab"]
        assert texts[0] == texts[1]


def test_what_cannot_be_written_is_refused(written: Results, tmp_path: Path):
    def refused(path: Path, frames: list[int] | None, said: str) -> None:
        before = sorted(tmp_path.iterdir())
        with pytest.raises(CaseError, match=said) as caught:
            write_vtu(written, path, frames)
        assert caught.value.remedy
        assert sorted(tmp_path.iterdir()) == before

    refused(tmp_path / "a.pvd", [1], "mesh of one frame")
    refused(tmp_path / "a.vtu", [1, 2], "several frames")
    refused(tmp_path / "a.vtu", [7], "no frame 7")
    refused(tmp_path / "a.vtu", [], "no frame is given")
    refused(tmp_path / "missing" / "a.vtu", [1], "folder does not exist")
    (tmp_path / "a-0002.vtu").touch()
    refused(tmp_path / "a.pvd", None, "a-0002.vtu: already exists")
    damaged = dataclasses.replace(written, path=tmp_path / "gone.vtkhdf")
    with pytest.raises(clast.CaseError, match="no such file"):
        write_vtu(damaged, tmp_path / "b.vtu", [1])
    assert not (tmp_path / "b.vtu").exists()
