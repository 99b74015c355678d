"""Drawing in the window of a case: tools, typed points, snaps, handles, and the file."""

import math
import tomllib

import pytest

from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]


def test_an_outline_is_drawn_from_nothing_by_clicks_and_typed_points(drawing):
    hand = drawing("")
    hand.page.focus("#section canvas[tabindex]")
    hand.keys.press("2")
    hand.click(0.0, 3.0)
    hand.type("32, 3", "@3<90", "@-6,0")
    hand.click(17.0, 24.0)
    hand.click(4.0, 21.0)
    hand.keys.press("Backspace")
    hand.type("0,24")
    assert hand.content == {}
    hand.keys.press("Enter")
    hand.rest()
    (x, y), *typed = hand.content["domain"]["boundary"]
    assert typed[:3] == [[32, 3], [32, 6], [26, 6]] and typed[4] == [0, 24]
    scale = hand.page.evaluate("clastEditor.section.view.scale")
    assert math.hypot(x, y - 3.0) * scale < 9.0
    assert hand.steps == 1
    assert hand.page.get_attribute('[data-tool="select"]', "aria-pressed") == "true"
    hand.page.click("#undo")
    assert hand.content == {}


def test_a_click_is_the_grid_or_its_pixel(drawing):
    hand = drawing("")
    hand.tool("more", "measured point")
    scale, step = hand.page.evaluate(
        "[clastEditor.section.view.scale, modules.snaps.gridStep(clastEditor.section.view.scale)]"
    )
    hand.click(5 * step + 3 / scale, 4 * step - 3 / scale)  # 3 pixels beside a node of the grid
    hand.page.uncheck(".tools .snap")
    x, y = 3.1234 * step, 7.2345 * step
    hand.click(x, y)
    hand.page.check(".tools .snap")
    hand.click(10.5 * step, 9.5 * step)  # in the middle of the grid
    points = [one["at"] for one in hand.content["measured_point"]]
    assert points[0] == [5 * step, 4 * step]
    for (px, py), at in ((points[1], (x, y)), (points[2], (10.5 * step, 9.5 * step))):
        assert abs(px - at[0]) * scale <= 1.0 and abs(py - at[1]) * scale <= 1.0
        assert len(repr(px)) <= 6
    names = [one["name"] for one in hand.content["measured_point"]]
    assert len(set(names)) == 3


def test_a_click_at_a_vertex_is_that_vertex(drawing):
    hand = drawing(SLOPE)
    hand.tool("bolt", "bolt")
    scale = hand.page.evaluate("clastEditor.section.view.scale")
    hand.click(26.0 - 4 / scale, 6.0 + 4 / scale)
    hand.click(25.0 + 3 / scale, 8.0 + 3 / scale)  # beside the face of the slope
    bolt = hand.content["bolt"][-1]
    assert bolt["start"] == [26, 6]
    x, y = bolt["end"]
    assert abs((x - 26.0) * 18.0 + (y - 6.0) * 9.0) < 1e-3
    assert (bolt["kind"], bolt["stage"]) == ("cable", "cables")  # like the one before


def test_a_corner_follows_the_hand_as_one_step(drawing):
    hand = drawing(SLOPE)
    hand.page.evaluate("clastEditor.goTo(['domain', 'rock'])")
    hand.page.evaluate(
        """() => {
          const { section } = clastEditor, move = section.move.bind(section);
          clastEditor.moved = 0;
          section.move = (lines) => { clastEditor.moved += 1; move(lines); };
        }"""
    )
    hand.drag((17.0, 24.0), (19.0, 25.5))
    x, y = hand.content["domain"]["boundary"][4]
    assert (x, y) == pytest.approx((19.0, 25.5), abs=0.3)
    assert hand.steps == 1
    assert hand.page.evaluate("clastEditor.moved") > 0
    text = hand.page.evaluate("clastEditor.state.text")
    changed = [a for a, b in zip(SLOPE.splitlines(), text.splitlines(), strict=True) if a != b]
    assert changed == ["boundary = [[0,3],[32,3],[32,6],[26,6],[17,24],[0,24]]"]
    hand.page.click("#undo")
    until(hand.page, "!clastEditor.state.unsaved")
    assert hand.page.evaluate("clastEditor.state.text") == SLOPE


def test_points_are_added_taken_away_and_nudged(drawing):
    hand = drawing(SLOPE)
    hand.page.evaluate("clastEditor.goTo(['domain', 'rock'])")
    hand.drag((8.5, 24.0), (8.0, 22.0))  # the middle of a side
    boundary = hand.content["domain"]["boundary"]
    assert len(boundary) == 7 and boundary[5] == pytest.approx([8.0, 22.0], abs=0.5)
    assert hand.steps == 1
    hand.click(*boundary[5])
    hand.keys.press("ArrowUp")
    step = hand.page.evaluate("modules.snaps.gridStep(clastEditor.section.view.scale)")
    assert hand.content["domain"]["boundary"][5] == pytest.approx(
        [boundary[5][0], boundary[5][1] + step]
    )
    hand.keys.press("Delete")
    assert hand.content["domain"]["boundary"] == tomllib.loads(SLOPE)["domain"]["boundary"]
    hand.page.mouse.dblclick(*hand.at(29.0, 3.0))
    inserted = hand.content["domain"]["boundary"]
    assert len(inserted) == 7 and inserted[1] == pytest.approx([29.0, 3.0], abs=0.2)


def test_a_whole_outline_is_dragged(drawing):
    hand = drawing(SLOPE)
    hand.page.evaluate("clastEditor.goTo(['water', 0, 'acts_on'])")
    line = tomllib.loads(SLOPE)["water"][0]["line"]
    middle = [sum(one[k] for one in line) / 3 for k in (0, 1)]
    hand.drag(middle, (middle[0] + 2.0, middle[1] - 1.0))
    moved = hand.content["water"][0]["line"]
    shift = {
        (round(b[0] - a[0], 2), round(b[1] - a[1], 2)) for a, b in zip(line, moved, strict=True)
    }
    assert len(shift) == 1
    assert next(iter(shift)) == pytest.approx((2.0, -1.0), abs=0.3)
    assert hand.steps == 1


EMPTY = """\
time = {step = 1e-3, end = 1.0}
rock.granite = {young = 50e9, poisson = 0.2, density = 2700.0}
joint.default = {friction_angle = 30.0}
bolt_kind.bar = {stiffness = 1e7}
[domain]
boundary = [[0, 0], [20, 0], [20, 20], [0, 20]]
[[opening]]
name = "adit"
shape = "box"
corner = [8, 8]
size = [4, 3]
"""
DRAWN = {
    ("trace", None): (["2,3", "5,6", "9,6", ""], "trace", {"points": [[2, 3], [5, 6], [9, 6]]}),
    ("joint set", None): (
        ["1,1", "@10<40", "2.5"],
        "joint_set",
        {"origin": [1, 1], "angle": 40, "spacing": 2.5},
    ),
    ("opening", "opening: circle"): (
        ["5,5", "1.5"],
        "opening",
        {"shape": "circle", "center": [5, 5], "radius": 1.5},
    ),
    ("opening", "opening: horseshoe"): (
        ["5,2", "4", "1.5"],
        "opening",
        {"shape": "horseshoe", "center": [5, 2], "width": 4, "wall_height": 1.5},
    ),
    ("opening", "opening: box"): (
        ["6,5", "@-3,-2"],
        "opening",
        {"shape": "box", "corner": [3, 3], "size": [3, 2]},
    ),
    ("opening", "opening: polygon"): (
        ["1,1", "4,1", "2,3", ""],
        "opening",
        {"shape": "polygon", "points": [[1, 1], [4, 1], [2, 3]]},
    ),
    ("bolt", "bolt"): (["8,9", "@3<180"], "bolt", {"start": [8, 9], "end": [5, 9], "kind": "bar"}),
    ("bolt", "bolt pattern"): (
        ["9,9", "2", "1.5"],
        "bolt_pattern",
        {"opening": "adit", "length": 2, "spacing": 1.5, "kind": "bar"},
    ),
    ("lining", "lining: opening"): (["9,9", ""], "lining", {"opening": "adit"}),
    ("lining", "lining: polyline"): (
        ["8,8", "8,11", ""],
        "lining",
        {"polyline": [[8, 8], [8, 11]]},
    ),
    ("water", "water: line"): (["0,15", "20,12", ""], "water", {"line": [[0, 15], [20, 12]]}),
    ("water", "water: level"): (["14.5"], "water", {"level": 14.5}),
    ("load", "point load"): (
        ["10,20", "0,-5e4"],
        "point_load",
        {"at": [10, 20], "force": [0, -50000]},
    ),
    ("load", "line load"): (
        ["4,20", "6,20", "0,-1e4"],
        "line_load",
        {"start": [4, 20], "end": [6, 20], "traction": [0, -10000]},
    ),
    ("load", "pressure"): (
        ["4,20", "6,20", "2e5"],
        "pressure",
        {"start": [4, 20], "end": [6, 20], "value": 2e5},
    ),
    ("load", "fill"): (["0,22", "20,22", ""], "fill", {"surface": [[0, 22], [20, 22]]}),
    ("support", "fixed point"): (["3,0"], "fixed_point", {"at": [3, 0]}),
    ("outline", "region: polygon"): (
        ["0,0", "20,0", "20,4", ""],
        "region",
        {"polygon": [[0, 0], [20, 0], [20, 4]]},
    ),
    ("more", "measured point"): (["3,3"], "measured_point", {"at": [3, 3]}),
    ("more", "block pattern"): (
        ["1,1", "@6,3", "@0.6,0.3"],
        "block_pattern",
        {"corner": [1, 1], "size": [6, 3], "brick": [0.6, 0.3]},
    ),
    ("more", "barrier"): (["7"], "barrier", {"x": 7}),
    ("more", "source: line"): (["1,9", "2,9"], "source", {"line": [[1, 9], [2, 9]]}),
}
"""Tool and what it draws -> points as they are typed, table, values that the file gets."""


def test_every_tool_writes_its_table(drawing):
    hand = drawing(EMPTY)
    for (tool, label), (points, table, expected) in DRAWN.items():
        before = hand.content
        steps = hand.steps
        hand.tool(tool, label)
        hand.type(*points)
        made = hand.content[table][-1]
        assert len(hand.content[table]) == len(before.get(table, [])) + 1, label
        assert {key: made[key] for key in expected} == expected, label
        assert hand.steps == steps + 1, label
        hand.page.click("#undo")
        assert hand.content == before, label


def test_a_lining_gets_the_sides_that_are_clicked(drawing):
    hand = drawing(EMPTY)
    hand.tool("lining", "lining: opening")
    hand.click(10.0, 9.5)
    hand.click(12.0, 9.0)  # right wall
    hand.click(8.0, 9.0)  # left wall: over the roof
    assert hand.content["lining"][0]["part"] == [[12, 8], [8, 8]]
    hand.tool("lining", "lining: opening")
    hand.click(10.0, 9.5)
    hand.click(10.0, 11.0)
    hand.click(10.0, 11.0)  # the roof alone
    assert hand.content["lining"][1]["part"] == [[12, 11], [8, 11]]
    names = [one["name"] for one in hand.content["lining"]]
    assert len(set(names)) == 2


def test_sides_are_held_and_freed(drawing):
    hand = drawing(EMPTY)
    hand.tool("support", "domain: fixed sides")
    for x, y in ((10.0, 0.3), (0.3, 9.0), (19.0, 9.0), (0.4, 9.0)):
        hand.click(x, y)
        hand.rest()
    assert hand.content["domain"]["fixed_sides"] == ["bottom", "right"]


def test_sizes_have_handles(drawing):
    hand = drawing(EMPTY)
    hand.tool("opening", "opening: circle")
    hand.type("5,5", "1.5")
    hand.rest()
    hand.tool("select")
    hand.drag((6.5, 5.0), (7.5, 5.0))
    assert hand.content["opening"][1]["radius"] == pytest.approx(2.5, abs=0.1)
    hand.drag((5.0, 5.0), (4.0, 4.0))
    assert hand.content["opening"][1]["center"] == pytest.approx([4.0, 4.0], abs=0.1)
    hand.page.evaluate("clastEditor.goTo(['opening', 0, 'name'])")
    hand.drag((12.0, 11.0), (13.0, 12.0))
    assert hand.content["opening"][0]["size"] == pytest.approx([5.0, 4.0], abs=0.1)
    hand.tool("bolt", "bolt pattern")
    hand.type("9,9", "2", "1.5")
    hand.rest()
    hand.tool("select")
    handles = dict(
        hand.page.evaluate("clastEditor.tools.handles.map(({ what, at }) => [what, at])")
    )
    x, y = handles["length"]
    hand.drag((x, y), (x - 1.0, y))
    assert hand.content["bolt_pattern"][0]["length"] == pytest.approx(3.0, abs=0.1)
    x, y = handles["spacing"]
    hand.drag((x, y), (x, y - 1.5))
    assert hand.content["bolt_pattern"][0]["spacing"] == pytest.approx(3.0, abs=0.1)


def test_a_line_that_crosses_itself_is_marked_at_the_crossing(drawing):
    hand = drawing(EMPTY)
    hand.tool("outline", "region: polygon")
    hand.type("0,0", "10,10", "10,2")
    assert hand.page.evaluate("clastEditor.tools.cross ?? null") is None
    hand.type("2, 10")
    hand.page.mouse.move(*hand.at(1.0, 12.0))
    until(hand.page, "clastEditor.tools.cross")
    assert hand.page.evaluate("clastEditor.tools.cross") == pytest.approx([6.0, 6.0])
    hand.keys.press("Enter")
    until(
        hand.page,
        "clastEditor.state.faults.some(({ at }) => at.length === 1 && "
        "Math.hypot(at[0][0] - 6, at[0][1] - 6) < 1e-6)",
    )


def test_everything_is_drawn_without_a_mouse(drawing):
    hand = drawing(EMPTY)
    hand.page.focus("#section canvas[tabindex]")
    hand.keys.press("6")
    for text in ("8,9", "@3<180"):
        hand.keys.type(text)
        hand.keys.press("Enter")
    assert hand.content["bolt"][0]["end"] == [5, 9]
    hand.keys.press("Escape")
    assert hand.page.get_attribute('[data-tool="select"]', "aria-pressed") == "true"
    hand.keys.press("n")
    hand.keys.press("n")
    assert hand.say() == "end of bolt: 5, 9"
    hand.keys.press("ArrowLeft")
    step = hand.page.evaluate("modules.snaps.gridStep(clastEditor.section.view.scale)")
    assert hand.content["bolt"][0]["end"] == [5 - step, 9]
    hand.keys.press("Escape")
    hand.keys.press("Delete")
    assert "bolt" not in hand.content


def test_what_is_no_point_is_told(drawing):
    hand = drawing(EMPTY)
    hand.tool("trace")
    hand.type("seven")
    assert "is no point" in hand.say()
    hand.type("1,1")
    hand.page.press(".tools .point input", "Enter")
    assert "needs 2 points" in hand.say()
    assert "trace" not in hand.content


def test_a_typed_point_comes_into_sight(drawing):
    hand = drawing(EMPTY)
    hand.tool("trace")
    hand.type("5,5", "-90,60")
    x, y = hand.page.evaluate("clastEditor.section.screen([-90, 60])")
    width, height = hand.page.evaluate(
        "[clastEditor.section.view.width, clastEditor.section.view.height]"
    )
    assert 0 < x < width and 0 < y < height


def test_loads_are_arrows_with_handles(drawing):
    hand = drawing(EMPTY)
    hand.tool("load", "pressure")
    hand.type("4,20", "6,20", "2e5")
    hand.tool("load", "point load")
    hand.type("10,20", "0,-5e4")
    hand.rest()
    hand.tool("select")
    until(
        hand.page,
        "clastEditor.state.checked && clastEditor.tools.where === clastEditor.tools.viewKey",
    )
    arrows = hand.page.evaluate("clastEditor.tools.shapes.flatMap((one) => one.arrows)")
    assert len(arrows) == 4
    for (x0, y0), (x1, y1) in arrows[:3]:  # from above the rock onto it
        assert y0 > y1 == pytest.approx(20.0) and x0 == pytest.approx(x1)
    (_, (x, y)) = arrows[3]
    half = 0.5 * (20.0 + y)
    hand.page.uncheck(".tools .snap")
    hand.drag((x, y), (10.0, half))
    fx, fy = hand.content["point_load"][0]["force"]
    assert (fx, fy) == pytest.approx((0.0, -25e3), abs=3e3)
    assert hand.steps == 3


def test_the_stress_in_the_rock_is_told_at_the_pointer(drawing):
    hand = drawing(EMPTY + "[in_situ]\nvertical = 'overburden'\nk0 = 0.5\ndatum = 100.0\n")
    stress = hand.page.evaluate("modules.signs.stressAt(clastEditor.state.content, 20)")
    assert stress == pytest.approx([-0.5 * 2700 * 9.8 * 80, -2700 * 9.8 * 80, 0.0])
    hand.choose("in_situ")
    hand.page.mouse.move(*hand.at(5.0, 5.0))
    other = hand.page.evaluate(
        "modules.signs.stressAt({in_situ: {stress: [-1, -2, 0.5], gradient: [-1, 0, 0]}}, -3)"
    )
    assert other == [-4, -2, 0.5]


def test_another_seed_is_a_key(drawing):
    hand = drawing(EMPTY)
    hand.tool("joint set")
    hand.type("1,1", "@10<40", "2.5")
    hand.rest()
    hand.keys.press("Escape")
    hand.keys.press("r")
    assert hand.content["joint_set"][0]["seed"] >= 0


SNAPS = {
    (9.97, 0.02): ([10, 0], "vertex"),
    (4.5, 0.03): ([4.5, 0.0], "edge"),
    (3.04, 4.02): ([3.0, 4.0], "corner of a block"),
    (3.03, 4.6): ([3.0, 4.6], "joint"),
    (5.02, 7.33): ([5, 7.33], "plumb"),
    (7.31, 6.03): ([7.31, 6], "level"),
    (6.7, 7.72): ([6.71, 7.71], "right angle"),
    (8.04, 2.97): ([8, 3], "grid"),
    (8.5, 3.5): ([8.5, 3.5], ""),
    (8.5, 2.12): ([8.5, 2.12], ""),
}
"""Place of the pointer, m, -> the point that it means, and what that lies on."""


def test_a_pointer_means_what_is_nearest_to_it(drawing):
    hand = drawing(EMPTY)
    given = """(at) => modules.snaps.snapped(at, {
      lines: [{ points: [[0, 0], [10, 0]], closed: false },
        { points: [[-50, 2.1], [50, 2.1]], closed: false, isEndless: true }],
      dots: [], joints: [[[3, 4], [3, 5]]], corners: [[3, 4]],
      before: [[4, 7], [5, 6]], near: 0.1, step: 1, digits: 2 })"""
    for place, (at, snap) in SNAPS.items():
        found = hand.page.evaluate(given, list(place))
        assert (found["at"], found["snap"]) == (pytest.approx(at, abs=1e-9), snap), place
    typed = "([text, last]) => modules.snaps.typed(text, last)"
    for text, at in (("12.5, 8", [12.5, 8]), ("@1,2", [2, 4]), ("@3<60", [2.5, 4.598076211])):
        assert hand.page.evaluate(typed, [text, [1, 2]])["at"] == pytest.approx(at, abs=1e-8)
    assert hand.page.evaluate(typed, ["1e3", [0, 0]]) == {"number": 1000}
    assert hand.page.evaluate(typed, ["1,", [0, 0]]) is None
