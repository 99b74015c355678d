"""Copies of tables in the window: in rows, mirrored, by typed numbers and by clicks."""

import numpy as np
import pytest
import shapely

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]
CUT = """\
time = {step = 1e-3, end = 1.0}
rock.granite = {young = 50e9, poisson = 0.2, density = 2700.0}
joint.default = {friction_angle = 30.0}
[domain]
boundary = [[0, 0], [20, 0], [20, 20], [0, 20]]
[[joint_set]]
name = "steep"
angle = 70
spacing = 3.0
origin = [1.0, 0.5]
[[joint_set]]
name = "flat"
angle = -12.5
spacing = 4.0
[[trace]]
points = [[2, 3], [5, 6], [9, 6]]
[[opening]]
name = "adit"
shape = "box"
corner = [3, 8]
size = [4, 3]
[[opening]]
name = "shaft"
shape = "circle"
center = [14, 13]
radius = 2
"""


def opened_copies(hand, *place):
    hand.choose(*place)
    hand.page.click(".copies summary")


def enter(hand, label, text):
    hand.page.locator(".copies").get_by_label(label, exact=True).fill(text)


def test_a_row_of_copies_has_new_names_and_keeps_what_it_refers_to(drawing):
    hand = drawing(SLOPE)
    first = hand.content["bolt"][0]
    opened_copies(hand, "bolt", 0)
    enter(hand, "copies", "3")
    enter(hand, "each moved by x", "-50 cm")
    enter(hand, "y", "1.25")
    hand.page.click(".copies >> text='copy'")
    bolts = hand.content["bolt"]
    assert [one["name"] for one in bolts[:5]] == [f"cable {n}" for n in (1, 6, 7, 8, 2)]
    for number, one in enumerate(bolts[1:4], 1):
        for end in ("start", "end"):
            shift = np.subtract(one[end], first[end])
            np.testing.assert_allclose(shift, [-0.5 * number, 1.25 * number], atol=1e-9)
        assert {key: one[key] for key in ("kind", "stage")} == {"kind": "cable", "stage": "cables"}
    assert hand.steps == 1
    text = hand.page.evaluate("clastEditor.state.text")
    hand.page.click("#undo")
    hand.rest()
    assert hand.page.evaluate("clastEditor.state.text") == SLOPE
    assert set(SLOPE.splitlines()) <= set(text.splitlines())  # the others are as they were


def test_a_copy_keeps_how_numbers_are_written(drawing):
    hand = drawing(TEMPLATES["lined-tunnel"])
    hand.choose("lining", 0)
    hand.page.click(".form >> text=duplicate")
    hand.rest()
    text = hand.page.evaluate("clastEditor.state.text")
    written = [one.partition("#")[0].split() for one in text.splitlines()]
    assert written.count(["young", "=", "1.5e10"]) == 2
    assert hand.content["lining"][1]["name"] == "shotcrete 2"


def blocks_of(text):
    model = Case.from_text(text, "case.toml").model()
    parts = zip(model.block_start[:-1], model.block_start[1:], strict=True)
    return [shapely.Polygon(model.vertices[first:past] + model.origin) for first, past in parts]


def test_what_is_mirrored_is_cut_as_the_mirror_image(drawing):
    hand = drawing(CUT)
    for table in ("joint_set", "trace", "opening"):
        opened_copies(hand, table)
        enter(hand, "Axis", "10")
        hand.page.click(".copies >> text='mirror'")
        hand.rest()
    content = hand.content
    assert [one["angle"] for one in content["joint_set"]] == [-70, 12.5]
    assert content["trace"][0]["points"] == [[11, 6], [15, 6], [18, 3]]
    assert content["opening"][0]["corner"] == [13, 8]
    assert hand.steps == 3
    before = blocks_of(CUT)
    after = blocks_of(hand.page.evaluate("clastEditor.state.text"))
    flipped = shapely.transform(before, lambda at: np.column_stack((20 - at[:, 0], at[:, 1])))
    assert len(before) == len(after) > 30
    tree = shapely.STRtree(after)
    for one in flipped:
        found = tree.query(one.representative_point(), predicate="within")
        assert one.symmetric_difference(after[found[0]]).area < 1e-4


def test_an_axis_and_a_distance_are_clicked(drawing):
    hand = drawing(CUT)
    opened_copies(hand, "opening", 0)
    hand.page.click(".copies >> text=by a click")
    hand.page.click(".tools .point input")
    hand.type("10, 3")
    hand.page.click(".copies >> text=copy mirrored")
    made = hand.content["opening"]
    assert [one["name"] for one in made] == ["adit", "adit 2", "shaft"]
    assert (made[0]["corner"], made[1]["corner"], made[1]["size"]) == ([3, 8], [13, 8], [4, 3])
    opened_copies(hand, "trace", 0)
    hand.page.click(".copies >> text=by two clicks")
    hand.click(2.0, 3.0)  # snaps to the first point
    hand.type("@0,5")
    hand.page.click(".copies >> text='copy'")
    assert hand.content["trace"][1]["points"] == [[2, 8], [5, 11], [9, 11]]


def test_a_table_is_copied_and_pasted_at_the_pointer(drawing):
    hand = drawing(SLOPE)
    hand.choose("bolt", 1)
    first = hand.content["bolt"][1]
    hand.page.focus("#section canvas[tabindex]")
    hand.keys.press("Control+c")
    hand.page.uncheck(".tools .snap")
    hand.page.focus("#section canvas[tabindex]")
    hand.page.mouse.move(*hand.at(20.0, 18.0))
    hand.keys.press("Control+v")
    until(hand.page, "clastEditor.state.content.bolt.length === 6")
    made = hand.content["bolt"][5]
    assert made["start"] == pytest.approx([20.0, 18.0], abs=0.1)
    shift = np.subtract(made["start"], first["start"])
    np.testing.assert_allclose(np.subtract(made["end"], first["end"]), shift, atol=1e-9)
    assert (made["name"], made["kind"], made["stage"]) == ("cable 6", "cable", "cables")
    until(hand.page, "clastEditor.state.chosen[1] === 5")
    # a text editor gets the text of the table
    hand.page.click("#toml summary")
    hand.page.focus("#text")
    hand.keys.press("Control+End")
    hand.keys.press("Enter")
    hand.keys.press("Control+v")
    assert hand.content["bolt"][6] == first
    assert len(hand.content["bolt"]) == 7


def test_every_drawn_table_mirrored_twice_is_itself(drawing):
    hand = drawing(CUT)
    tables = {
        "bolt": {"kind": "bar", "start": [1.5, 2], "end": [3, 4]},
        "bolt_pattern": {"kind": "bar", "opening": "adit", "length": 2, "from": 20, "to": 130},
        "lining": {"polyline": [[0, 0], [1, 3]], "side": "left", "start": "fixed", "end": "hinge"},
        "joint_set": {"dip": 40, "dip_direction": 75, "origin": [1, 2]},
        "point_load": {"at": [1, 2], "force": [3e4, -2e5]},
        "pressure": {"start": [0, 1], "end": [0, 5], "value": [1e5, 2e5]},
        "water": {"level": 7.5},
        "block_pattern": {"corner": [1, 2], "size": [6, 3], "brick": [0.6, 0.3]},
        "barrier": {"x": 7.0, "height": 3, "inclination": 10},
        "load_train": {"path": [[0, 3], [9, 3]], "axles": [0], "loads": [1e5]},
    }
    twice = """([table, value, axis]) => {
      const { state } = clastEditor, { mirrored } = modules.copies;
      const node = modules.handles.tableNode(state.schema, state.schema.properties[table]);
      const one = mirrored(state.content, node, table, value, axis, 3.25);
      return [one, mirrored(state.content, node, table, one, axis, 3.25)];
    }"""
    for table, value in tables.items():
        for axis in (0, 1):
            once, back = hand.page.evaluate(twice, [table, value, axis])
            assert back == value, (table, axis)
            assert once != value or (table, axis) in {("water", 0), ("barrier", 1)}
    assert hand.page.evaluate(twice, ["bolt_pattern", tables["bolt_pattern"], 0])[0]["from"] == 50
    assert hand.page.evaluate(twice, ["lining", tables["lining"], 0])[0]["polyline"][0] == [5.5, 3]


def test_what_cannot_be_copied_so_is_told(drawing):
    hand = drawing(CUT)
    opened_copies(hand, "opening", 0)
    said = hand.page.locator(".copies .fault")
    hand.page.click(".copies >> text='copy'")
    assert said.inner_text() == "give a distance, m, in x or in y"
    enter(hand, "copies", "1.5")
    hand.page.click(".copies >> text='copy'")
    assert said.inner_text() == "give a whole number of copies, from 1 to 1000"
    hand.page.click(".copies >> text='mirror'")
    assert said.inner_text() == "give the axis, m"
    hand.tool("opening", "opening: horseshoe")
    hand.type("5,2", "4", "1.5")
    hand.rest()
    hand.tool("select")
    until(hand.page, "clastEditor.state.chosen[1] === 2")
    hand.page.click(".copies summary")
    enter(hand, "Axis", "3")
    hand.page.select_option(".copies select", value="1")
    hand.page.click(".copies >> text='mirror'")
    assert "a horseshoe has its arch above" in said.inner_text()
    assert hand.steps == 1
