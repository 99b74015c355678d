"""Excavated blocks: outlined by dashes, without colour, and no part of the scale."""

from __future__ import annotations

import dataclasses

import matplotlib.colors
import numpy as np
import pytest

import clast
from clast.actions.relaxation import no_forces
from clast.exports import write_dxf, write_vtu
from clast.pictures import canvas
from clast.pictures.plot import plot_results
from clast.results import Results, RunRecorder, read_results
from clast.results.frames import absent_in_frame
from scenes.recorded_run import moved, report, three_blocks

GONE = np.array([False, True, False])


@pytest.fixture
def dug(tmp_path) -> Results:
    """Three blocks of which the wedge is excavated after the first frame."""
    model = three_blocks()
    recorder = RunRecorder(model, case_text="schema = 1\n", output=tmp_path / "dug.vtkhdf")
    for time in (0.0, 0.5, 1.0):
        state = moved(model, time)
        if time > 0.0:
            state = dataclasses.replace(state, actions=(None, no_forces(GONE)))
        recorder.instant(state)
        recorder.frame(state)
    recorder.finish(report(state))
    return read_results(tmp_path / "dug.vtkhdf")


def test_frames_say_which_blocks_are_gone(dug: Results):
    assert not absent_in_frame(dug, 0).any()
    assert np.array_equal(absent_in_frame(dug, 1), GONE)
    assert np.array_equal(dug.field("gone"), [[0, 0, 0], [0, 1, 0], [0, 1, 0]])


@pytest.mark.parametrize("field", ["sigma_yy", "rock", "joint", "block"])
def test_a_gone_block_is_a_thin_dashed_outline(dug: Results, monkeypatch, field: str):
    figures: list = []
    monkeypatch.setattr(canvas, "save", lambda figure, path: figures.append(figure) or path)
    for frame in (0, -1):
        plot_results(dug, "x.png", frame=frame, field=field, contacts=False)
    before, after = (figure.axes[0] for figure in figures)
    for axes, gone in ((before, []), (after, [1])):
        polygons = [c for c in axes.collections if type(c).__name__ == "PolyCollection"]
        start, dashed, fixed, coloured = (
            [path.vertices[:-1] for path in c.get_paths()] for c in polygons
        )
        at = dug.vertices(0 if axes is before else -1)
        outlines = np.split(at, dug.block_start[1:-1])
        assert len(start) == 3 - len(gone) and len(fixed) == 1
        assert len(dashed) == len(gone) and len(coloured) == 2 - len(gone)
        for outline, block in zip(dashed, gone, strict=True):
            assert np.array_equal(outline, outlines[block])
            faces = polygons[1].get_facecolor()
            assert len(faces) == 0 or matplotlib.colors.to_rgba(faces[0])[3] == 0.0
    said = [text.get_text() for text in figures[1].findobj(matplotlib.text.Text)]
    assert "excavated" in said
    assert ("wedge" in said) is False


def test_a_gone_block_does_not_count_in_the_scale(dug: Results, monkeypatch):
    """The wedge has a stress of (3, -1, 1) kPa; the block that is left has no yy stress at all."""
    figures: list = []
    monkeypatch.setattr(canvas, "save", lambda figure, path: figures.append(figure) or path)
    plot_results(dug, "x.png", frame=-1, field="sigma_xx", contacts=False)
    coloured = figures[0].axes[0].collections[3]
    assert len(coloured.get_array()) == 1
    low, high = coloured.get_clim()
    assert abs(low) < 1e3 and abs(high) < 1e3  # not the 3 kPa of the wedge


def test_drawings_leave_gone_blocks_out(dug: Results, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_dxf(dug, tmp_path / "dug.dxf")
    blocks = ezdxf.readfile(tmp_path / "dug.dxf").modelspace().query("LWPOLYLINE")
    assert [one.dxf.layer for one in blocks] == ["granite", "marl"]
    corners = np.concatenate([np.array(one.get_points("xy")) for one in blocks])
    assert np.array_equal(corners, np.delete(dug.vertices(-1), np.s_[4:7], axis=0))


def test_meshes_mark_them(dug: Results, tmp_path):
    write_vtu(dug, tmp_path / "dug.vtu", [-1])
    text = (tmp_path / "dug.vtu").read_text()
    values = text.split('Name="gone"')[1].split(">\n")[1].split("</")[0].split()
    assert [float(value) for value in values] == [0.0, 1.0, 0.0]


def test_a_lining_that_comes_later_is_neither_there_nor_excavated(sprayed, monkeypatch):
    """The core goes with the second stage, the segments come with the third."""
    results = clast.read(sprayed.output)
    core = np.array([name == "core" for name in results.block_name])
    assert results.lined.tolist() == ["/" in name for name in results.block_name]
    figures: list = []
    monkeypatch.setattr(canvas, "save", lambda figure, path: figures.append(figure) or path)
    for frame, stage in enumerate(results.frame_stages):
        dug = stage != "settled"
        awaited = results.awaited(frame)
        assert np.array_equal(awaited, results.lined & (stage != "line"))
        assert np.array_equal(absent_in_frame(results, frame), awaited | (core & dug))
        plot_results(results, "x.png", frame=frame, field="rock", contacts=False)
        axes = figures[-1].axes[0]
        polygons = [c for c in axes.collections if type(c).__name__ == "PolyCollection"]
        assert len(polygons[1].get_paths()) == dug
        said = [text.get_text() for text in figures[-1].findobj(matplotlib.text.Text)]
        assert ("excavated" in said) == dug
