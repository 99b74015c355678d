"""What a run is warned of when it is over, and what it is not."""

import re
from dataclasses import fields, replace

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.errors import RunStopped, StepOutcome
from clast.results.run import report_from_dict
from clast.step.convex import Convex
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from clast.step.remedies import GENERAL, remedy
from scenes.systems import at_start, box, by_convex, finish, method, system

HEAD = """
schema = 1
gravity = [0.0, -9.8]
[rock.rock]
young = 5e9
poisson = 0.2
density = 2500.0
[joint.default]
friction_angle = 30.0
[[block]]
name = "floor"
vertices = [[-5, -1], [5, -1], [5, 0], [-5, 0]]
fixed = true
"""


def warnings_of(text, *settings):
    """Return the report's warnings of a case of floor and more."""
    return Case.from_toml(HEAD + text, settings).run().report.warnings


SUNK = """
[[block]]
name = "heavy"
vertices = [[-1, 0.0], [1, 0.0], [1, 1], [-1, 1]]
[method]
contact_law = {name = "penalty", normal_stiffness = 2e5}
[time]
step = 1e-3
end = 0.3
"""


def test_deep_penetration_is_said():
    (text,) = (one for one in warnings_of(SUNK) if "thinner" in one)
    assert "'heavy'" in text and "'floor'" in text
    assert "normal_stiffness" in text


BOX = """
[[block]]
name = "box"
vertices = [[-1, 0], [1, 0], [1, 1], [-1, 1]]
[time]
step = 1e-3
end = 0.2
dynamic_ratio = 0.0
"""


def test_static_run_that_ends_while_moving_is_said():
    push = '[[point_load]]\nat = [-1, 0.5]\nforce = [4e4, 0.0]\nblock = "box"\n'
    (text,) = warnings_of(push + BOX)
    assert "static run" in text and "'box'" in text and "time.end" in text
    assert not warnings_of(BOX, "time.end=0.5")


@pytest.mark.parametrize(("stress", "said"), [((-2e6, -3e6, 0.0), True), ((0.0, 0.0, 0.0), False)])
def test_initial_stress_that_contacts_do_not_hold_is_said(stress, said):
    """Rock between rigid walls: it expands until the contacts bear it."""
    walls = "".join(
        f"[[block]]\nvertices = {np.round(one, 6).tolist()}\nfixed = true\n"
        for one in (box(-2, 0, 1, 1), box(1, 0, 1, 1), box(-2, 1, 4, 1))
    )
    rock = "".join(f"[[block]]\nvertices = {box(x, 0).tolist()}\n" for x in (-1.0, 0.0))
    time = "[time]\nstep = 1e-3\nend = 0.2\ndynamic_ratio = 0.0\n"
    found = warnings_of(walls + rock + time, f"rock.rock.initial_stress={list(stress)}")
    assert any("mean stress" in one and "normal_stiffness" in one for one in found) == said


@pytest.mark.parametrize("name", ["incline", "wall"])
def test_templates_are_not_warned_of(name):
    assert not Case.from_toml(TEMPLATES[name](), ["time.end=0.1"]).run().report.warnings


def test_overlap_is_in_the_report_and_comes_back_from_it():
    """A corner rule that lets nothing in: the boxes go through each other."""
    model = system([box(0, -1), box(0.2, 0.01)], fixed=[0], velocity={1: (0.0, -1.0, 0.0)})
    how = method(corner_rule=Blind(), max_displacement=0.01, critdis=1e-6)
    run = finish(model, how, 1e-3, 0.1).run
    (one,) = run.report.overlaps
    assert one.blocks == ("1", "2")
    assert one.depth > 0.05
    assert any("overlap" in text and "'1'" in text for text in run.report.warnings)
    assert report_from_dict(run.report.as_dict()) == run.report


class Blind:
    """A corner rule that keeps nothing."""

    def choose(self, candidates, vertices):
        """Return False for all."""
        return np.zeros(len(candidates.vertex), np.bool_)


# --- remedies --------------------------------------------------------------------------------

PROCESSES = {"modified": Modified(), "open-close": OpenClose(), "convex": Convex()}


@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.parametrize("outcome", GENERAL)
def test_remedies_name_keys_that_the_process_has(process, outcome):
    model = system([box(0, -1), box(0, 0)], fixed=[0])
    how = method(process=PROCESSES[process])
    text = remedy(outcome, model, how, at_start(model), 1e-6)
    known = {one.name for one in fields(how.process)}
    assert text
    assert set(re.findall(r"method\.process\.(\w+)", text)) <= known
    assert "passes" not in text or "passes" in known


def test_remedy_for_a_start_that_is_too_fast():
    """Nothing flies apart: two blocks meet at a speed that no step allows."""
    model = system([box(0, 0), box(1.01, 0)], velocity={1: (-5e3, 0.0, 0.0)}, gravity=(0, 0))
    with pytest.raises(RunStopped) as caught:
        finish(model, by_convex(1e8, max_displacement=1e-3), 1e-2, 0.1)
    text = str(caught.value)
    assert "'2' moves at 5e+03 m/s" in text
    assert "max_displacement" in text and "apart" not in text


def test_remedy_for_springs_that_are_too_soft():
    model = system([box(0, -1), box(0, 0)], fixed=[0])
    state = at_start(model)
    deep = replace(state.memory, gap=np.array([-0.2]))
    text = remedy(StepOutcome.TUNNELLED, model, by_convex(1e5), replace(state, memory=deep), 1e-6)
    assert "0.2 m deep" in text and "raise method.contact_law.normal_stiffness" in text


# --- the limit on movement -------------------------------------------------------------------


def test_free_flight_is_not_cut():
    """Two blocks that fly beside each other, and a third alone: nothing comes near anything."""
    outlines = [box(0, 0), box(1.02, 0), box(20, 0)]
    speed = {0: (40.0, 0.0, 0.0), 1: (40.0, 0.0, 0.0), 2: (-3.0, 60.0, 1.0)}
    model = system(outlines, velocity=speed)
    done = finish(model, by_convex(5e9, max_displacement=0.05), 1e-2, 0.3)
    assert done.run.report.steps == 30
    assert done.run.report.cut_steps == 0


def test_flight_is_cut_where_it_ends():
    model = system([box(-5, -1, 10), box(0, 3)], fixed=[0], velocity={1: (0.0, -20.0, 0.0)})
    done = finish(model, by_convex(5e9, max_displacement=0.05), 1e-2, 0.2)
    assert 20 < done.run.report.steps < 60
    assert done.run.report.largest_penetration < 0.05
    assert not done.run.report.overlaps
