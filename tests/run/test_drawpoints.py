"""Blocks that leave past a line while the run goes on."""

from pathlib import Path

import numpy as np
import pytest

import clast
from scenes.restarts import pressed_at

MASS = 2000.0
"""Mass of a block, kg/m."""
CASE = """
schema = 1
gravity = [0, -10]
time = {step = 2e-3, end = 1.5}
rock.stone = {young = 1e8, poisson = 0.2, density = 2000.0}
joint.default = {friction_angle = 20.0}
drawpoint = [{name = "chute", line = [[-2, 0], [2, 0]], MORE}]

[[block]]
name = "low"
vertices = [[0, 1], [1, 1], [1, 2], [0, 2]]

[[block]]
name = "high"
vertices = [[0, 4], [1, 4], [1, 5], [0, 5]]

[[block]]
name = "beside"
vertices = [[3, 1], [4, 1], [4, 2], [3, 2]]

[[block]]
name = "below"
vertices = [[-1, -3], [0, -3], [0, -2], [-1, -2]]

[[block]]
name = "ground"
fixed = true
vertices = [[-9, -99], [9, -99], [9, -98], [-9, -98]]
"""


def case_of(more: str = "rate = 1e9", text: str = CASE) -> clast.Case:
    return clast.Case.from_text(text.replace("MORE", more).replace(", }", "}"), "case")


def test_blocks_leave_as_their_centroids_pass():
    """A free fall of 1.5 and 4.5 m takes sqrt(2 h / g); what falls beside or from below stays."""
    run = case_of().run()
    time, mass = run.drawn("chute")
    exact = np.sqrt(2.0 * np.array([1.5, 4.5]) / 10.0)
    assert ((time > exact - 1e-9) & (time < exact + 2.1e-3)).all()
    np.testing.assert_allclose(mass, [MASS, 2.0 * MASS])
    assert run.report.ledger.removed == pytest.approx(0.0, abs=1e-3)  # 4.5e5 of fall, as much speed


def test_no_more_leaves_than_the_rate_lets():
    run = case_of(f"rate = {MASS / 0.7}").run()
    time, mass = run.drawn("chute")
    np.testing.assert_allclose(mass, [MASS, 2.0 * MASS])
    np.testing.assert_allclose(time, [0.7, 1.4], atol=2.1e-3)


def test_a_turned_line_draws_from_its_other_side():
    run = case_of(text=CASE.replace("[[-2, 0], [2, 0]]", "[[2, 0], [-2, 0]]")).run()
    with pytest.raises(clast.ClastError, match="nothing has left at a drawpoint 'chute'"):
        run.drawn("chute")


def test_a_run_goes_on_where_it_was_broken_off(tmp_path: Path):
    case = case_of(f"rate = {MASS / 0.7}")
    whole = case.run()
    part = case.run(output=tmp_path / "part.vtkhdf", progress=pressed_at(400))
    assert part.checkpoint is not None
    again = clast.resume(part.checkpoint)
    assert again.report.events == whole.report.events
    np.testing.assert_array_equal(again.final.vertices, whole.final.vertices)


def test_the_last_block_stays():
    """A drawpoint takes all that passes but what would leave no model."""
    alone = CASE[: CASE.index('[[block]]\nname = "beside"')]
    run = case_of(text=alone).run()
    assert run.drawn("chute")[1].tolist() == [MASS] and run.report.finished


@pytest.mark.parametrize(
    ("more", "text", "what"),
    [
        ('stage = "later"', CASE, "there is no stage 'later'"),
        ("rate = -1", CASE, "rate"),
        ("rate = 1", CASE.replace("[2, 0]]", "[-2, 0]]"), "begins and ends at the same point"),
        ("rate = 1", CASE.replace("end = 1.5", "end = 1, dynamic_ratio = 0"), "steps are static"),
    ],
)
def test_impossible_drawpoints_are_refused(more: str, text: str, what: str):
    with pytest.raises(clast.ClastError, match=what):
        case_of(more, text).run()
