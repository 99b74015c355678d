"""What is hardly meant is warned of, with its place and a remedy that is right."""

from __future__ import annotations

import pytest

from clast.case.case_file import Case

COLUMN = """
schema = 1
time = {step = 2e-3, end = 0.05}
rock.r = {young = 5e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
[[block]]
name = "left"
vertices = [[-2, -1], [0, -1], [0, 0], [-2, 0]]
[[block]]
name = "right"
vertices = [[0, -1], [2, -1], [2, 0], [0, 0]]
[[fixed_point]]
at = [-2, -1]
[[fixed_point]]
at = [2, -1]
"""
DOMAIN = """
schema = 1
time = {step = 2e-3, end = 0.05}
rock.r = {young = 5e9, poisson = 0.2, density = 2500.0}
joint.default = {friction_angle = 30.0}
[domain]
boundary = [[0, 0], [12, 0], [12, 9], [0, 9]]
fixed_sides = ["bottom"]
"""
SET = '[[joint_set]]\nname = "beds"\nangle = 10.0\n'
HOLE = '[[opening]]\nname = "adit"\nshape = "box"\ncorner = [4, 3]\nsize = [2, 2]\n'
BOLT = (
    '[[bolt]]\nstart = [-1, -0.5]\nend = [1, -0.5]\nkind = "bar"\n[bolt_kind.bar]\nyoung = 2e11\n'
)
BOLT += "out_of_plane_spacing = 1.0\nyield_force = 1e5\n"
SHAKEN = (
    '[ground_motion]\nacts = "base"\ntime = [0.0, 0.02, 0.04]\nacceleration = [0.0, 1.0, 0.0]\n'
)
STAGES = '[[stage]]\nname = "rest"\ntime = 0.02\n[[stage]]\nname = "dig"\ntime = 0.04\n'
STRESS = '[in_situ]\nvertical = "overburden"\nsides = ["left", "right"]\n'


def warned(text: str, *phrases: str) -> bool:
    """Return whether one warning of a case has all phrases."""
    warnings = Case.from_text(text, "case").examine().warnings
    return any(all(phrase in one for phrase in phrases) for one in warnings)


@pytest.mark.parametrize(
    ("area", "phrases"),
    [
        (500.0, ["bolt_kind 'bar': area", "500 mm2 are 0.0005"]),
        (5.0, ["bolt_kind 'bar': area", "5 cm2 are 0.0005"]),
    ],
)
def test_the_area_of_a_bolt_in_mm2(area, phrases):
    assert warned(f"{COLUMN}{BOLT}area = {area}\n", *phrases)
    assert not warned(f"{COLUMN}{BOLT}area = 5e-4\n", "area")


def test_a_ratio_of_stresses_in_per_cent():
    assert warned(f"{DOMAIN}{STRESS}k0 = 50\n", "in_situ: k0", "50 % are 0.5")
    assert not warned(f"{DOMAIN}{STRESS}k0 = 2.5\n", "k0")


@pytest.mark.parametrize("kind", ["normal", "lognormal"])
@pytest.mark.parametrize("key", ["spacing", "trace_length", "bridge_length"])
def test_a_scatter_beyond_the_mean(kind, key):
    def case(std: float) -> str:
        keys = {"spacing": "1.5", "trace_length": "3.0", "bridge_length": "1.0"}
        keys[key] = f'{{distribution = "{kind}", mean = 2.0, sd = {std}}}'
        return DOMAIN + SET + "".join(f"{name} = {value}\n" for name, value in keys.items())

    assert warned(case(2.5), f"joint_set 'beds', {key}", "sd is 2.5")
    assert not warned(case(1.0), "sd")


def test_traces_without_bridges():
    text = f"{DOMAIN}{SET}spacing = 1.0\ntrace_length = 2.0\n"
    assert warned(text, "joint_set 'beds': trace_length", "bridge_length")
    assert not warned(f"{text}bridge_length = 0.5\n", "trace_length")
    assert not warned(
        f'{DOMAIN}{SET}model = "baecher"\nintensity = 1.0\ntrace_length = 2.0\n', "bridge"
    )


def test_an_opening_that_no_stage_excavates():
    text = f"{DOMAIN}{SET}spacing = 1.0\n{HOLE}"
    assert warned(text, "opening 'adit'", "no stage")
    assert warned(text + STAGES, "opening 'adit'", 'excavate = ["adit"]')
    assert not warned(f'{text}{STAGES}excavate = ["adit"]\n', "no stage")
    assert not warned(f"{text}excavated = true\n", "no stage")


@pytest.mark.parametrize("gone", ["left", "right"])
def test_the_points_by_which_the_ground_moves_what_is_excavated(gone):
    dug = f'{COLUMN}{SHAKEN}{STAGES}excavate = ["{gone}"]\n'
    assert warned(f"{dug}ground_motion = true\n", "stage 'dig'", "1 of 2 fixed points", f"'{gone}'")
    shaken_first = dug.replace('name = "rest"\n', 'name = "rest"\nground_motion = true\n')
    assert not warned(shaken_first, "fixed points that the ground moves")
