"""Pressures and amplitudes of a case file: what they become, and what is warned of."""

import clast

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


def test_a_pressure_lies_on_its_edge():
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
