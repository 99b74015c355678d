"""A weld holds: a slab in two halves moves as one block does, but for what contact springs give."""

from __future__ import annotations

import pytest

from clast.case.case_file import Case

STIFFNESS = 1e11
SLAB = f"""schema = 1
gravity = [0.0, 0.0]
time = {{step = 1e-2, end = 0.4, dynamic_ratio = 0.0, max_displacement = 1.0}}
[rock.granite]
young = 1e9
poisson = 0.0
density = 2000.0
[method]
contact_law = {{name = "penalty", normal_stiffness = {STIFFNESS}}}
[[fixed_point]]
at = [0, 4]
[[fixed_point]]
at = [2, 4]
[[measured_point]]
name = "left"
at = [0, 0]
[[measured_point]]
name = "right"
at = [2, 0]
[[line_load]]
start = [0, 0]
end = [2, 0]
"""
ONE = "[[block]]\nvertices = [[0, 0], [2, 0], [2, 4], [0, 4]]\n"
WELDED = """[domain]
boundary = [[0, 0], [2, 0], [2, 4], [0, 4]]
[[opening]]
name = "lower half"
shape = "box"
corner = [0, 0]
size = [2, 2]
"""


def moved(blocks: str, load: str):
    """Return displacements (u, v) of the lower corners, m."""
    run = Case.from_toml(SLAB + f"traction = {load}\n" + blocks).run()
    assert run.report.finished
    return [run.history(name).displacement[-1] for name in ("left", "right")]


@pytest.mark.parametrize("traction", [1e5, -1e5], ids=["pressed", "pulled"])
def test_a_weld_bears_tension_and_pressure(traction):
    """Four contacts, two corners of each half: the joint gives F/(4 p)."""
    load = f"[0.0, {traction}]"
    gives = 2.0 * traction / (4.0 * STIFFNESS)
    for one, welded in zip(moved(ONE, load), moved(WELDED, load), strict=True):
        assert welded[1] - one[1] == pytest.approx(gives, rel=2e-3)
        assert abs(welded[0] - one[0]) < 1e-3 * abs(gives)


def test_a_weld_bears_what_no_joint_does():
    """A thousand megapascals, at strains of 1e-4."""
    stiff, load = SLAB.replace("young = 1e9", "young = 1e13"), "traction = [0.0, -1e9]\n"
    one, welded = (
        Case.from_toml(stiff + load + blocks).run().history("left").displacement[-1]
        for blocks in (ONE, WELDED)
    )
    assert welded[1] - one[1] == pytest.approx(-2e9 / (4.0 * STIFFNESS), rel=2e-3)


def test_a_weld_bears_shear_without_any_pressure():
    """It slips by T/(4 k), and turns by M/(4 p) under the moment M = 2 m T about the joint."""
    shear = 2.0 * 1e4
    slip, turn = shear / (4.0 * STIFFNESS), 2.0 * shear / (4.0 * STIFFNESS)
    for one, welded in zip(moved(ONE, "[1e4, 0]"), moved(WELDED, "[1e4, 0]"), strict=True):
        assert welded[0] - one[0] == pytest.approx(slip + 2.0 * turn, rel=0.01)
