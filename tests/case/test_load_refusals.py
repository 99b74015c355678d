"""Tables of time and pressures that cannot be: every message names table, key and remedy."""

import pytest

import clast
from clast.errors import CaseError, ModelError

CASE = """
schema = 1
time = {step = 1e-3, end = 0.1}
rock = {stone = {young = 1e9, poisson = 0.2, density = 2500}}
amplitude = {ramp = {time = [0, 1, 2], value = [0, 1, 1]}}
[[block]]
name = "base"
vertices = [[0, -1], [4, -1], [4, 0], [0, 0]]
fixed = true
[[block]]
name = "wall"
vertices = [[0, 0], [1, 0], [1, 2], [0, 2]]
[[pressure]]
start = [0, 0]
end = [0, 2]
value = [2e4, 0]
amplitude = "ramp"
"""

BROKEN = {
    "time falls": (
        ["amplitude.ramp.time=[0, 2, 1]"],
        ["[amplitude.ramp] time", "instant 3", "not after"],
    ),
    "lengths differ": (
        ["amplitude.ramp.value=[0, 1]"],
        ["[amplitude.ramp] value", "2 values for 3"],
    ),
    "value is nan": (["amplitude.ramp.value=[0, nan, 1]"], ["[amplitude.ramp] value 2", "finite"]),
    "value is text": (
        ["amplitude.ramp.value=[0, 'one', 1]"],
        ["[amplitude.ramp] value 2", "number"],
    ),
    "value is huge": (
        ["amplitude.ramp.value=[0, 1e30, 1]"],
        ["[amplitude.ramp] value 2", "too large"],
    ),
    "no values": (["amplitude.ramp={time=[0, 1]}"], ["[amplitude.ramp] value", "is missing"]),
    "unknown key": (["amplitude.ramp.times=[0]"], ["[amplitude.ramp] times", "'time'"]),
    "end is infinite": (["pressure.1.end=[0, inf]"], ["[[pressure]] 1 end", "finite"]),
    "value of three": (["pressure.1.value=[1, 2, 3]"], ["[[pressure]] 1 value", "3 items"]),
    "value of words": (["pressure.1.value=much"], ["[[pressure]] 1 value", "number", "Pa"]),
    "value is not a pressure": (["pressure.1.value=[1, inf]"], ["[[pressure]] 1 value", "finite"]),
    "between two blocks": (
        ["pressure.1.end=[1, 0]"],
        ["pressure 1", "'base'", "'wall'", "(0, 0)", 'block = "base"'],
    ),
    "another block": (["pressure.1.block=base"], ["pressure 1", "no edge", "'base'"]),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_what_cannot_be_is_refused(fault: str):
    settings, phrases = BROKEN[fault]
    with pytest.raises((CaseError, ModelError)) as caught:
        clast.Case.from_toml(CASE, settings).model()
    message = str(caught.value)
    assert len(message) < 600
    for phrase in phrases:
        assert phrase in message


def test_the_case_itself_is_whole():
    model = clast.Case.from_toml(CASE).model()
    assert model.pressures.pressure.tolist() == [[0.0, 2e4]]  # the edge runs downwards
    assert model.pressures.share.tolist() == [[0.0, 1.0]]
    assert model.pressures.factor.tolist() == [0]
    assert model.factors[0].name == "ramp"


def test_rounded_corners_are_found_and_pressed_whole():
    """Given to six digits far from the origin, an edge still is the whole edge."""
    corners = [(1e5 + 1 / 3, 2e5), (1e5 + 7 / 3, 2e5 + 1 / 7), (1e5 + 1, 2e5 + 2)]
    builder = clast.ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=corners)
    start, end = ([round(x, 6) for x in corner] for corner in corners[:2])
    builder.pressure(start, end, 1.0)
    assert builder.build().pressures.share.tolist() == [[0.0, 1.0]]


def test_a_table_that_no_load_names_is_warned_of():
    case = clast.Case.from_toml(CASE.replace('amplitude = "ramp"', ""))
    assert any("no load has the amplitude 'ramp'" in text for text in case.examine().warnings)


def test_pressures_count_as_loads():
    case = clast.Case.from_toml(CASE, ["pressure.1.value=0"])
    assert any("1 pressure(s) are zero" in text for text in case.examine().warnings)
    assert clast.Case.from_toml(CASE).examine().loads == 1
