"""Fields, blocks, contacts and histories read the same from a run just made and from its file."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.results import Run
from clast.results.result_tables import Columns
from scenes.recorded_run import moved, record, three_blocks


@pytest.fixture
def both(tmp_path: Path) -> tuple[Run, Run]:
    """The same run with its frames in memory, and in a file."""
    return record(three_blocks()).run, record(three_blocks(), tmp_path / "a.vtkhdf").run


@pytest.mark.parametrize("name", [*record(three_blocks()).run.field_names, "vertices"])
def test_all_frames_of_a_field_at_once(both, name):
    kept, written = both
    read = clast.read(written.output)
    whole = kept.field(name)
    assert len(whole) == len(kept.times) > 2
    for source in (written, read):
        np.testing.assert_array_equal(source.field(name), whole)
        np.testing.assert_array_equal(source.field(name, 1), whole[1])
        np.testing.assert_array_equal(source.frame(-1).field(name), whole[-1])
        assert source.field_names == kept.field_names
    assert kept.field("stress").shape == (len(kept.times), 3, 3)
    assert kept.field("velocity").shape == (len(kept.times), 3, 2)
    assert kept.field("rotation").shape == (len(kept.times), 3)


def test_parts_of_fields_have_names(both):
    for source in (*both, clast.read(both[1].output)):
        np.testing.assert_array_equal(source.field("sigma_xy"), source.field("stress")[:, :, 2])
        np.testing.assert_array_equal(
            source.field("velocity_y", 1), source.field("velocity", 1)[:, 1]
        )
        with pytest.raises(CaseError, match="did you mean 'sigma_x"):
            source.field("sigma_x")


def test_frames_by_time_are_the_nearest(both):
    for source in (*both, clast.read(both[1].output)):
        times = source.times
        between = 0.6 * times[1] + 0.4 * times[2]
        frame = source.frame(at=between)
        assert (frame.number, frame.time) == (1, times[1])
        np.testing.assert_array_equal(frame.vertices, moved(three_blocks(), times[1]).vertices)
        assert source.frame(at=times[-1]).number == len(times) - 1
        assert source.frame().number == len(times) - 1
        with pytest.raises(CaseError, match=r"no frame at t = 7 s\n.*between 0 and"):
            source.frame(at=7.0)
        with pytest.raises(CaseError, match="no frame at t = nan"):
            source.frame(at=float("nan"))
        with pytest.raises(CaseError, match="no frame 77"):
            source.frame(77)


def test_blocks_by_name(both):
    for source in (*both, clast.read(both[1].output)):
        wedge = source.block("wedge")
        assert (wedge.name, wedge.number) == ("wedge", 1)
        np.testing.assert_array_equal(wedge.time, source.times)
        np.testing.assert_array_equal(wedge.displacement, source.field("displacement")[:, 1])
        np.testing.assert_array_equal(wedge.stress, source.field("stress")[:, 1])
        np.testing.assert_array_equal(wedge["rotation"], source.field("rotation")[:, 1])
        np.testing.assert_array_equal(wedge.vertices, source.field("vertices")[:, 4:7])
        with pytest.raises(CaseError, match="did you mean 'wedge'"):
            source.block("wege")


def test_contacts_name_the_blocks_of_both_ends(both):
    kept, written = both
    found = kept.contacts(1)
    assert len(found) > 0
    for source in (written, clast.read(written.output)):
        other = source.contacts(1)
        assert list(other) == list(found)
        for name, values in found.items():
            np.testing.assert_array_equal(other[name], values)
        np.testing.assert_array_equal(other.force, found.force)
    start = kept.model.block_start
    np.testing.assert_array_equal(found.vertex_block, np.digitize(found.vertex, start) - 1)
    np.testing.assert_array_equal(found.edge_block, np.digitize(found.edge, start) - 1)
    assert len(kept.contacts(0)) == 0


def test_tables_and_runs_survive_being_sent_to_another_process(both):
    for run in both:
        again = pickle.loads(pickle.dumps(run))
        np.testing.assert_array_equal(again.field("stress"), run.field("stress"))
    history = pickle.loads(pickle.dumps(both[0].history("tip")))
    np.testing.assert_array_equal(history.velocity, both[0].history("tip").velocity)
    assert history["time"][-1] == history.time[-1]


def test_a_file_that_holds_another_run_now_is_refused(both, tmp_path):
    _, written = both
    record(three_blocks(), written.output, steps=3)
    with pytest.raises(CaseError, match="now holds another run"):
        written.field("stress")


def test_frames_beyond_the_memory_are_left_out_and_said():
    whole = record(three_blocks()).run
    run = record(three_blocks(), memory_limit=2200).run
    assert 2 < len(run.times) < len(whole.times)
    assert run.times[-1] == whole.times[-1]
    np.testing.assert_array_equal(run.field("stress")[-1], whole.field("stress")[-1])
    (note,) = run.report.notes
    assert f"from t = {whole.times[len(run.times) - 1]:.4g} s on" in note


def test_columns_of_vectors_are_told_apart():
    rows = np.zeros(2, [("a", "f8", 2), ("b", "f8", 3), ("c", "i8")])
    assert list(Columns(rows)) == ["a_x", "a_y", "b_xx", "b_yy", "b_xy", "c"]
