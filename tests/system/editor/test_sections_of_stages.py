"""What is there in each stage, as the section shows it, is there in the run of the case."""

import base64
import zlib

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.checking import check
from clast.case.templates import TEMPLATES
from clast.editor.section import section_of, states_of_stages
from clast.model.state import initial_state
from clast.pictures.page.scene import scene_of
from clast.results.frame_samples import channel_values
from scenes.two_lakes import lakes, rock


def states(scene, blocks):
    """Return which blocks are there and which bolts installed, by frame, and the waters."""
    frames = len(scene["times"])
    there = np.ones((frames, blocks), bool)
    for block, changes in enumerate(scene["gone"]):
        for change in changes:
            there[change:, block] ^= True
    bolts = scene["bolts"]
    planes = np.frombuffer(zlib.decompress(base64.b64decode(bolts["state"])), np.uint8)
    installed = planes.reshape(4, -1)[0].reshape(frames, -1) > 0
    return there, installed, [[number for number, _ in one] for one in scene["levels"]]


@pytest.mark.parametrize("name", ["tunnel", "lined-tunnel", "slope"])
def test_a_stage_shows_what_the_run_has_by_then(name):
    text = TEMPLATES[name]
    case = Case.from_text(text, "case.toml", ["time.end=0.02"])
    shown = section_of(check(text, "case.toml"))["scene"]
    names = [stage.name for stage in case.stage]
    assert shown["stages"] == [names[0], *names]
    ran = scene_of(case.run(warn=lambda _: None), budget=0.0)
    blocks = len(shown["blocks"])
    assert ran["blocks"] == shown["blocks"]
    expected, found = states(ran, blocks), states(shown, blocks)
    for number, stage in enumerate(names):
        last = len(ran["stages"]) - 1 - ran["stages"][::-1].index(stage)
        for of_run, of_section in zip(expected, found, strict=True):
            assert np.array_equal(of_run[last], of_section[number + 1]), stage
    assert np.array_equal(expected[0][0], found[0][0])


FLOWING = """
[[well]]
name = "drain"
line = [[2.0, 5.0], [3.0, 4.0]]
pressure = 0.0
only_outflow = true
[[stage]]
name = "before"
until = "time"
time = 0.02
[[stage]]
name = "drawdown"
until = "time"
time = 0.02
flow_boundary = {lake = {head = 5.0}}
[[stage]]
name = "drained"
until = "time"
time = 0.02
install = ["drain"]
[[stage]]
name = "dug"
until = "time"
time = 0.02
excavate = ["tunnel"]
"""


@pytest.mark.filterwarnings("ignore::clast.RunWarning")
def test_water_flows_in_each_stage_as_it_does_in_the_run():
    text = rock() + lakes() + FLOWING
    case = Case.from_text(text, "case.toml", ["output.every=0.02"])
    model, stages = case.model(), tuple(table.stage() for table in case.stage)
    run = case.run()
    before = None
    for stage, state in zip(
        stages, states_of_stages(model, initial_state(model), stages), strict=True
    ):
        found, expected = channel_values(model, state), run.flow(run.frame(stage=stage.name).number)
        found = found[found[:, 4] > 0.0]
        assert len(found) == len(expected)
        np.testing.assert_allclose(found[:, :2], expected.pressure, rtol=1e-6, atol=1e-3)
        largest = np.abs(expected.flow).max()
        np.testing.assert_allclose(found[:, 6], expected.flow, rtol=1e-6, atol=1e-6 * largest)
        assert found[:, 0].max() > 1e3
        assert before is None or abs(found[:, 0].mean() / before - 1.0) > 0.01
        before = found[:, 0].mean()
    # before all of them the drain is not there: lake and sea are level
    flows = section_of(check(text, "case.toml"))["scene"]["flows"]
    heights = [np.concatenate(one["tables"])[:, 1] for one in flows]
    assert [np.ptp(one) < 1e-3 for one in heights] == [True, True, False, False, False]


def test_bolts_that_no_stage_names_are_there_from_the_start():
    text = TEMPLATES["slope"].replace('stage = "cables"', "")
    assert text != TEMPLATES["slope"]
    shown = section_of(check(text, "case.toml"))["scene"]
    _, installed, _ = states(shown, len(shown["blocks"]))
    assert installed.size and installed.all()
