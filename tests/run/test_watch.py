"""What a run is warned of when it is over, and what it is not."""

import re
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

from clast.actions.action import ActionResult, Contribution
from clast.case.case_file import Case
from clast.model.state import LEDGER_ENTRIES, Ledger
from clast.results.run_report import report_from_dict
from clast.run.overlap import unseen_overlaps
from clast.run.run_checks import COUNTED, Watch
from clast.step.convex import Convex
from clast.step.modified import Modified
from clast.step.open_close import OpenClose
from clast.step.remedies import GENERAL, remedy
from scenes.systems import at_start, box, by_convex, finish, method, system, turned

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
    assert "static run fails" in text and "'box'" in text and "towards +x" in text
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

    def choose(self, candidates):
        """Return False for all."""
        return np.zeros(len(candidates.vertex), np.bool_)


# --- overlaps --------------------------------------------------------------------------------

FOUR = [box(-1, -1), box(0, -1), box(-1, 0), box(0, 0)]
"""Squares of 1 m that meet in a point; the first and the last are across from each other."""


def overlaps_of(moved, outlines=FOUR, angle=0.0, scale=1.0):
    """Return the overlaps that are told of where the last block is moved, with no contacts."""
    outlines = [scale * turned(one, angle) for one in outlines]
    model = system(outlines, gravity=(0, 0))
    state, last = at_start(model), model.block_start[-2]
    vertices = state.vertices.copy()
    vertices[last:] += scale * turned(np.array([moved]), angle)
    return unseen_overlaps(model, replace(state, vertices=vertices), critdis=5e-3 * scale)


@pytest.mark.parametrize("scale", [1e-2, 1.0, 50.0])
@pytest.mark.parametrize("angle", [0.0, 0.7, -2.0])
def test_tips_of_corners_that_overlap_where_four_meet_are_not_told(angle, scale):
    """The two beside have moved out of the way by as much: joints have slipped, none is closed."""
    apart = [FOUR[0], box(0.1, -1.1), box(-1.1, 0.1), FOUR[3]]
    beside = [FOUR[0], box(0.005, -1.005), box(-1.005, 0.005), FOUR[3]]
    pair = {"angle": angle, "scale": scale}
    assert not overlaps_of((-0.003, -0.004), beside, **pair)
    assert len(overlaps_of((-0.03, -0.04), beside, **pair)) == 3
    (one,) = overlaps_of((-0.003, -0.004), apart, **pair)
    assert one.depth == pytest.approx(0.003 * scale, rel=0.2)
    (one,) = overlaps_of((-0.003, -0.004), [FOUR[0], FOUR[3]], **pair)
    assert one.blocks == ("1", "2")


@pytest.mark.parametrize("depth", [2e-4, 2e-3, 2e-2, 0.2])
def test_faces_that_overlap_are_told(depth):
    """The last goes into the two beside it, along the whole face; they meet in four as before."""
    told = {one.blocks: one for one in overlaps_of((-depth, -depth))}
    assert {("2", "4"), ("3", "4")} <= set(told)
    for pair in (("2", "4"), ("3", "4")):
        assert told[pair].depth == pytest.approx(depth, rel=1e-6)
        assert told[pair].area == pytest.approx(depth * (1.0 - depth), rel=1e-6)
    assert (("1", "4") in told) == (depth > 0.01)


ROCK = """
schema = 1
plane = "strain"
damping = "adaptive"
[time]
step = 1e-3
end = 0.03
[rock.rock]
young = YOUNG
poisson = 0.2
density = 2600.0
[joint.default]
friction_angle = 35.0
[domain]
boundary = [[0, 0], [12, 0], [12, 6], [5, 9], [0, 9]]
fixed_sides = ["bottom", "left", "right"]
seed = SEED
[output]
every = 3e-3
"""
TWO_SETS = (
    '[[joint_set]]\nname = "a"\nangle = -22\nspacing = {distribution="normal",mean=1.3,sd=0.3}\n'
    '[[joint_set]]\nname = "b"\nangle = 55\nspacing = 1.1\n'
)
RANDOM_LINES = '[[joint_set]]\nname = "a"\nmodel = "poisson-lines"\nintensity = 1.6\n'
CELLS = '[[joint_set]]\nname = "a"\nmodel = "voronoi"\nspacing = 1.3\n'
SETS = {"two sets": TWO_SETS, "random lines": RANDOM_LINES, "cells": CELLS}


@pytest.mark.parametrize("young", ["1e9", "2e10"])
@pytest.mark.parametrize("sets", SETS)
def test_jointed_rock_that_settles_is_not_warned_of(sets, young):
    text = ROCK.replace("YOUNG", young).replace("SEED", "4")
    run = Case.from_toml(text + SETS[sets]).run()
    assert not run.report.warnings
    shifted = run.state.vertices.copy()
    block = int(np.argmax(np.where(run.model.fixed, 0.0, run.model.area)))
    loop = slice(*run.model.block_start[block : block + 2])
    shifted[loop] += [0.004, -0.003]
    told = unseen_overlaps(run.model, replace(run.state, vertices=shifted), critdis=5e-3)
    assert told
    assert all(run.model.block_name[block] in one.blocks for one in told)


# --- the energy balance ----------------------------------------------------------------------


@dataclass(frozen=True)
class Push:
    """A force on the second block; the work that it reports is ``reported`` times what it does."""

    reported: float

    def begin(self, model):
        """Return no state."""

    def contribution(self, start, state):
        """Return the force."""
        return Contribution(block=np.array([1]), force=np.array([[1e3, 0.0, 0.0, 0.0, 0.0, 0.0]]))

    def finish(self, start, state, contribution, solution):
        """Return the work."""
        work = 1e3 * self.reported * float(solution.displacement[1, 0])
        return ActionResult(work=work, ledger=Ledger(loads=work))


@pytest.mark.parametrize("reported", [1.0, 1.0 + 1e-7, 1.001, 0.0])
def test_action_that_says_another_work_than_it_does_is_found_out(reported):
    model = replace(system([box(-5, -1, 10), box(0, 0)], fixed=[0]), actions=(Push(reported),))
    report = finish(model, by_convex(1e9, max_displacement=0.05), 1e-3, 0.3).run.report
    said = [one for one in report.warnings if "unaccounted" in one]
    assert len(said) == (abs(reported - 1.0) > 1e-6)
    assert all("Push" in one for one in said)


def test_steps_that_are_solved_loosely_are_said():
    push = '[[point_load]]\nat = [-1, 0.5]\nforce = [4e4, 0.0]\nblock = "box"\n'
    loose = 'method.process={name="convex", tolerance=0.3}'
    said = warnings_of(push + BOX, loose, "time.dynamic_ratio=1.0")
    said = [one for one in said if "unaccounted" in one]
    assert len(said) == 1
    assert "method.process.tolerance (0.3)" in said[0]
    assert not [one for one in warnings_of(push + BOX) if "unaccounted" in one]


def test_energy_turned_over_counts_every_entry():
    """Water, bolts, damping and what leaves through boundaries are turned over as all else is."""
    model = system([box(-5, -1, 10), box(0, 0)], fixed=[0], gravity=(0, 0))
    watch = Watch(model=model, method=by_convex(1e9))
    state = at_start(model)
    for name in set(LEDGER_ENTRIES) - {"unaccounted"}:
        ledger = replace(Ledger(), **{name: 100.0}, unaccounted=2e-4)
        seen = watch.begin(state)
        seen = replace(
            seen, greatest=np.maximum(seen.greatest, [getattr(ledger, k) for k in COUNTED])
        )
        found = watch.warnings(seen, replace(state, ledger=ledger), 0.0)
        (text,) = (one for one in found if "unaccounted" in one)
        assert "100 J/m" in text


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


# --- the limit on movement -------------------------------------------------------------------
