"""The page under hands: keys, ticks of the time line, addresses, the colour bar, units."""

from itertools import pairwise

import pytest

from scenes.browsers import settled, until
from scenes.live_runs import live_command

pytestmark = pytest.mark.parametrize("browser", ["canvas"], indirect=True)  # no pixels
FRAME = "clastPage.state.frame"


@pytest.mark.parametrize("part", ["loop", "newest", "follow"])
def test_space_switches_a_focused_box_and_plays_nothing(opened, wall, part):
    page = opened(wall(2, 2))
    box = f"[data-part={part}]"
    page.evaluate("clastPage.$('live').hidden = false; clastPage.choose({ chosen: 3 })")
    settled(page)
    before = page.is_checked(box)
    page.focus(box)
    page.keyboard.press(" ")
    settled(page)
    assert page.is_checked(box) is not before and not page.evaluate("clastPage.playing")
    page.keyboard.press(" ")
    assert page.is_checked(box) is before
    page.focus("[data-part=layers] input[value=before]")
    page.keyboard.press("Space")
    settled(page)
    assert page.evaluate("clastPage.state.layers.has('before')")
    assert not page.evaluate("clastPage.playing")


def test_what_is_in_focus_keeps_its_own_keys(opened, wall):
    page = opened(wall(2, 2))
    page.focus("[data-part=time]")
    page.keyboard.press("Home")
    assert page.evaluate(FRAME) == 0
    x = page.evaluate("clastPage.view.x")
    page.keyboard.press("ArrowRight")
    assert page.evaluate(FRAME) == 1 and page.evaluate("clastPage.view.x") == x
    # what the time line has no use for is the page's
    page.keyboard.press(" ")
    assert page.evaluate("clastPage.playing")
    page.keyboard.press(" ")
    page.keyboard.press("End")
    page.focus("[data-part=low]")
    page.keyboard.type(" 0.,")
    assert page.evaluate(FRAME) == 5 and page.input_value("[data-part=low]").endswith(" 0.,")
    page.focus("[data-part=fit]")
    page.evaluate("clastPage.view.zoom(3)")
    scale = page.evaluate("clastPage.view.scale")
    page.keyboard.press(" ")
    settled(page)
    assert page.evaluate("clastPage.view.scale") < scale
    assert not page.evaluate("clastPage.playing")


MARKS = """([stages, events]) => {
  const { run } = clastPage;
  run.stages = stages;
  run.scene.events = events.map(([frame, text]) => ({ time: run.times[frame], text }));
  clastPage.fillTicks();
}"""


@pytest.mark.parametrize("width", [390, 1280])
@pytest.mark.parametrize("events", [3, 40])
def test_ticks_at_one_place_can_all_be_reached(opened, wall, width, events):
    page = opened(wall(2, 2), width)
    marks = [[1 + k % 3, f"event {k}"] for k in range(events)]
    page.evaluate(MARKS, [["a", "b", "b", "c", "c", "c"], marks])
    texts = {text for _, text in marks} | {f"Stage {name} begins" for name in "abc"}
    wanted = {text: frame for frame, text in marks} | {
        f"Stage {name} begins": frame for name, frame in zip("abc", (0, 1, 3), strict=True)
    }
    ticks = page.locator("[data-part=ticks] button")
    reached = []
    for k in range(ticks.count()):
        tick = ticks.nth(k)
        box = tick.bounding_box()
        # each lies free, with room for a pointer
        own = "([x, y, k]) => clastPage.$('ticks').children[k] === document.elementFromPoint(x, y)"
        middle = [box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"], k]
        assert page.evaluate(own, middle)
        said = tick.get_attribute("title").split("\n")
        for text in said:
            page.mouse.click(*middle[:2])
            if text in wanted:
                assert page.evaluate(FRAME) == wanted[text], text
                reached.append(text)
            else:
                assert text.endswith(" more") and len(said) == 13
    if events == 3:
        assert sorted(reached) == sorted(texts)
    assert all(f"Stage {name} begins" in reached for name in "abc")


def test_a_copied_address_shows_the_same_part_in_another_window(opened, wall, browser, tmp_path):
    results = wall(4, 5)
    wide = opened(results, 1600, 700)
    wide.evaluate("clastPage.view.zoom(3); clastPage.view.pan(60, -40); clastPage.changed()")
    settled(wide)
    seen = "(() => { const { view } = clastPage; return [view.worldX(0), view.worldY(view.height),"
    seen += " view.worldX(view.width), view.worldY(0)]; })()"
    part = wide.evaluate(seen)
    address = wide.evaluate("location.hash")
    for size in ((390, 844), (800, 600), (1600, 700)):
        other = opened(results, *size, address=address)
        left, low, right, high = other.evaluate(seen)
        slack = 1e-3 * (right - left)
        assert left <= part[0] + slack and right >= part[2] - slack
        assert low <= part[1] + slack and high >= part[3] - slack
        # and no more of it than the shape of the window asks for
        assert min((right - left) / (part[2] - part[0]), (high - low) / (part[3] - part[1])) < 1.01
    # all of it, where all of it was seen
    whole = opened(results, 1600, 700)
    assert "view=" not in whole.evaluate("location.hash")


def test_a_window_that_changes_its_size_goes_on_showing_the_same(opened, wall):
    page = opened(wall(4, 5), 1280, 800)
    middle = "[clastPage.view.x, clastPage.view.y]"
    page.evaluate("clastPage.view.zoom(4); clastPage.changed()")
    settled(page)
    before = page.evaluate(f"[...{middle}, clastPage.view.scale]")
    page.set_viewport_size({"width": 640, "height": 844})
    until(page, "clastPage.view.width < 700")
    assert page.evaluate("clastPage.view.scale") < before[2]
    page.set_viewport_size({"width": 1280, "height": 800})
    until(page, "clastPage.view.width > 700")
    settled(page)
    assert page.evaluate(f"[...{middle}, clastPage.view.scale]") == pytest.approx(before)


@pytest.mark.parametrize("width", [390, 800, 1600])
@pytest.mark.parametrize("field", ["displacement", "sigma_xx", "sliding", "sigma_3"])
def test_the_colour_bar_has_room_and_values(opened, wall, width, field):
    page = opened(wall(4, 5), width, address=f"#field={field}&layers=contacts,chains,crosses")
    bar = page.locator(".legend .bar").bounding_box()
    assert bar["width"] >= 150
    right = page.locator(".legend").bounding_box()
    assert bar["x"] + bar["width"] <= right["x"] + right["width"]
    low, high = page.evaluate("['low', 'high'].map((end) => Number(clastPage.$(end).value))")
    marks = page.locator(".legend .bar i")
    assert 1 <= marks.count() <= 4
    places = [marks.nth(k).bounding_box() for k in range(marks.count())]
    texts = marks.all_inner_texts()
    for before, after in pairwise(places):
        assert before["x"] + before["width"] < after["x"]
    for place, text in zip(places, texts, strict=True):
        share = (place["x"] + 0.5 * place["width"] - bar["x"]) / bar["width"]
        value, *unit = text.replace("−", "-").split()
        factors = {"k": 1e3, "M": 1e6, "m": 1e-3, "µ": 1e-6}
        prefix = unit[0][0] if unit and len(unit[0]) > 1 and unit[0] != "m/s" else ""
        found = float(value) * factors.get(prefix, 1.0)
        assert found == pytest.approx(low + share * (high - low), abs=0.02 * (high - low)), text
    # nothing else lies on the values
    for entry in page.locator(".legend > div:not(.scale)").all():
        box = entry.bounding_box()
        for place in places:
            apart = (
                box["y"] >= place["y"] + place["height"]
                or box["y"] + box["height"] <= place["y"]
                or box["x"] >= place["x"] + place["width"]
                or box["x"] + box["width"] <= place["x"]
            )
            assert apart


def test_construction_joints_of_several_openings_are_named_once(opened, wall):
    page = opened(wall(4, 5))
    page.evaluate(
        """() => {
          const [weld, bed] = [["construction joint", "#262626", [4, 2]], ["bed", "#123456", []]];
          Object.assign(clastPage.run.scene.joint_looks, { 97: weld, 98: weld, 99: bed });
          clastPage.set({ layers: new Set(["joints"]) });
        }"""
    )
    settled(page)
    text = page.inner_text("[data-part=legend]")
    assert text.count("construction joint") == 1 and text.count("bed") == 2


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (12340.0, "N m/m", "12.3 kN m/m"),
        (-8.7, "N m/m", "−0.0087 kN m/m"),
        (2e7, "N/m", "20 MN/m"),
        (0.0, "N m/m", "0 kN m/m"),
    ],
)
def test_how_units_are_written(opened, wall, value, unit, text):
    page = opened(wall(2, 2))
    assert page.evaluate("([v, u]) => modules.colours.withUnit(v, u, 3)", [value, unit]) == text


def test_an_axis_has_one_unit(opened, wall):
    page = opened(wall(2, 2))
    marks = page.evaluate("modules.colours.withOneUnit([0, 500, -1500], 'N/m')")
    assert marks == ["0 kN/m", "0.5 kN/m", "−1.5 kN/m"]


def test_a_live_page_says_that_its_run_was_killed(opened, browser, tmp_path):
    with live_command(tmp_path) as (run, address):
        page = opened(None, address=address.replace("/#", f"/?renderer={browser[1]}#"))
        until(page, "clastPage.run.frameCount >= 3")
        assert "killed" not in page.inner_text("[data-part=status]")
        run.kill()  # as kill -9 does
        until(page, "clastPage.root.dataset.live === 'over'", 20.0)
        assert "the run was killed" in page.inner_text("[data-part=status]")
        assert "the run was killed" in page.inner_text("[data-part=report]")
        assert page.is_disabled("[data-part=pause]")
        # what it has got so far is there
        page.keyboard.press("Home")
        assert page.evaluate(FRAME) == 0
