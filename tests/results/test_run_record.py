"""What a run hands back without any file."""

from __future__ import annotations

import json

import numpy as np
import pytest

from clast.block import polygon
from clast.results import RunRecorder
from clast.results.frame_samples import point_velocity
from clast.results.run_report import report_from_dict
from scenes.recorded_run import SPIN, STEP, TRANSLATION, moved, record, report, three_blocks


def test_history_of_a_point_is_its_exact_motion():
    model = three_blocks()
    recorded = record(model)
    history = recorded.run.history("tip")
    _, centroid, _ = polygon.moments(model.vertices, model.block_start)
    at = np.array([state.points[1] for state in recorded.states])
    now = centroid[1] + np.outer(history.time, TRANSLATION[1])
    offset = at - now
    np.testing.assert_allclose(history.time, STEP * np.arange(21), atol=1e-15)
    np.testing.assert_allclose(history.displacement, at - at[0], atol=1e-15)
    spun = SPIN[1] * np.column_stack([-offset[:, 1], offset[:, 0]])
    np.testing.assert_allclose(history.velocity, TRANSLATION[1] + spun, atol=1e-14)
    np.testing.assert_allclose(history.rotation, SPIN[1] * history.time)


def test_velocity_of_a_point_includes_the_strain_rate():
    offset = np.array([[2.0, 3.0], [-1.0, 0.5]])
    rates = np.array([[1.0, 2.0, 0.5, 0.1, -0.2, 0.4], [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]])
    expected = [[1.0 - 1.5 + 0.2 + 0.6, 2.0 + 1.0 - 0.6 + 0.4], [-1.0, 0.0]]
    np.testing.assert_allclose(point_velocity(offset, rates), expected)


def test_energies_and_step_sizes():
    run = record(three_blocks()).run
    np.testing.assert_allclose(run.energy["time"], STEP * np.arange(21), atol=1e-15)
    np.testing.assert_allclose(run.energy["gravity"], -3.0 * run.energy["time"])
    np.testing.assert_allclose(run.step_sizes, np.full(20, STEP))
    assert run.output is None


def test_final_state_is_in_user_coordinates():
    model = three_blocks(shift=1e6)
    assert model.origin[0] != 0.0
    recorded = record(model)
    expected = recorded.states[-1].vertices + model.origin
    np.testing.assert_array_equal(recorded.run.final.vertices, expected)
    assert recorded.run.final.points[1, 1] == pytest.approx(1e6 + 3, abs=1.0)
    np.testing.assert_array_equal(recorded.run.state.vertices, recorded.states[-1].vertices)


def test_histories_keep_their_digits_far_from_the_origin():
    near, far = record(three_blocks()).run, record(three_blocks(shift=1e6)).run
    for name in ("tip", "left/right"):
        a, b = near.history(name), far.history(name)
        np.testing.assert_allclose(a.displacement, b.displacement, atol=1e-13)
        np.testing.assert_allclose(a.velocity, b.velocity, atol=1e-13)


def test_report_survives_json():
    state = moved(three_blocks(), 1.0)
    given = report(state, finished=False)
    assert report_from_dict(json.loads(json.dumps(given.as_dict()))) == given


def test_state_before_the_start_is_a_programming_error():
    with pytest.raises(RuntimeError, match="call start first"):
        _ = RunRecorder(three_blocks()).state
