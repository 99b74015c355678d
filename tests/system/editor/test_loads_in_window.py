"""Loads in the window: pressures that vary, curves of amplitudes; linings before they are there."""

import pytest

from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
LOADED = """\
time = {step = 1e-3, end = 1.0}
rock.granite = {young = 50e9, poisson = 0.2, density = 2700.0}
joint.default = {friction_angle = 30.0}
[domain]
boundary = [[0, 0], [20, 0], [20, 20], [0, 20]]
[amplitude.pulse]
time = [0, 0.2, 0.5, 1.0]
value = [0, 1, -0.4, 0.2]
[[pressure]]
start = [20, 4]
end = [20, 16]
value = [4e5, 1e5]
amplitude = "pulse"
"""


def test_a_pressure_of_two_values_has_a_handle_at_each_end(drawing):
    hand = drawing(LOADED)
    hand.choose("pressure", 0)
    arrows, handles = hand.page.evaluate(
        "[clastEditor.tools.chosen[0].arrows, clastEditor.tools.handles.map(({ at }) => at)]"
    )
    lengths = [tail[0] - foot[0] for tail, foot in arrows]
    shares = [(foot[1] - 4) / 12 for _, foot in arrows]
    longest = lengths[0]
    assert len(arrows) == 5
    # from outside into the block, as long as the pressure there is large
    assert lengths == pytest.approx([longest * (1 - 0.75 * share) for share in shares])
    first, last = ([20 + longest * share, y] for share, y in ((1.0, 4), (0.25, 16)))
    assert all(any(one == pytest.approx(at) for one in handles) for at in (first, last))
    hand.drag(last, (20 + 0.75 * longest, 16))
    value = hand.content["pressure"][0]["value"]
    assert value[0] == 4e5
    assert value[1] == pytest.approx(3e5, rel=0.1)
    hand.drag(first, (20 - 0.5 * longest, 4))  # pulls
    assert hand.content["pressure"][0]["value"][0] == pytest.approx(-2e5, rel=0.1)
    assert hand.steps == 2


def of_curve(hand, t, v):
    """Return where a point of the curve with axes from 0 to 1 s and -0.4 to 1 is on the screen."""
    box = hand.page.locator(".amplitude svg").bounding_box()
    dots = box["width"] / 320
    x, y = 16 + t * (320 - 32), 16 + (1 - v) / 1.4 * (130 - 32)
    return box["x"] + dots * x, box["y"] + dots * y


def test_points_of_an_amplitude_are_dragged(drawing):
    hand = drawing(LOADED)
    hand.choose("pressure", 0)  # the curve stands with the load that names it
    mouse = hand.page.mouse
    mouse.move(*of_curve(hand, 0.5, -0.4))
    mouse.down()
    mouse.move(*of_curve(hand, 0.6, 0.4), steps=4)
    mouse.up()
    pulse = hand.content["amplitude"]["pulse"]
    assert pulse["time"] == pytest.approx([0, 0.2, 0.6, 1.0], abs=0.015)
    assert pulse["value"] == pytest.approx([0, 1, 0.4, 0.2], abs=0.015)
    assert hand.steps == 1
    hand.page.click("#undo")
    hand.rest()
    mouse.move(*of_curve(hand, 0.5, -0.4))
    mouse.down()
    mouse.move(*of_curve(hand, 0.05, -0.4), steps=4)  # beyond its neighbour
    mouse.up()
    time = hand.content["amplitude"]["pulse"]["time"]
    assert time == sorted(set(time))
    assert time[2] == pytest.approx(0.2, abs=0.02)


def test_points_of_an_amplitude_come_and_go_by_mouse_and_keys(drawing):
    hand = drawing(LOADED)
    hand.choose("amplitude", "pulse")
    hand.page.mouse.dblclick(*of_curve(hand, 0.8, 0.6))
    pulse = hand.content["amplitude"]["pulse"]
    assert pulse["time"] == pytest.approx([0, 0.2, 0.5, 0.8, 1.0], abs=0.015)
    assert pulse["value"] == pytest.approx([0, 1, -0.4, 0.6, 0.2], abs=0.015)
    hand.page.focus(".amplitude circle >> nth=3")
    hand.keys.press("Delete")
    assert hand.content["amplitude"]["pulse"] == {
        "time": [0, 0.2, 0.5, 1.0],
        "value": [0, 1, -0.4, 0.2],
    }
    hand.page.focus(".amplitude circle >> nth=1")
    for key in ("ArrowLeft", "ArrowLeft", "Shift+ArrowDown"):
        hand.keys.press(key)
        hand.rest()
    assert hand.content["amplitude"]["pulse"]["time"][1] == pytest.approx(0.18)
    assert hand.content["amplitude"]["pulse"]["value"][1] == pytest.approx(0.9)
    hand.page.click(".amplitude >> text=add a point")
    assert hand.content["amplitude"]["pulse"]["time"][-1] == pytest.approx(1.5)


def test_a_record_is_a_line_without_handles(drawing):
    times = [0.01 * k for k in range(200)]
    text = LOADED.replace("[0, 0.2, 0.5, 1.0]", str(times)).replace(
        "[0, 1, -0.4, 0.2]", str([0.5] * 200)
    )
    hand = drawing(text)
    hand.choose("pressure", 0)
    assert hand.page.locator(".amplitude circle").count() == 0
    assert hand.page.get_attribute(".amplitude .line", "d").count("L") == 199
    assert "200 points" in hand.page.inner_text(".amplitude")


def test_a_lining_is_drawn_as_thick_as_it_will_be(drawing):
    hand = drawing(TEMPLATES["lined-tunnel"])
    hand.page.evaluate(
        """() => {
          const { section } = clastEditor, { above } = section;
          clastEditor.rows = (x0, x1, y) => {
            section.draw();
            const [[left, at], [right]] = [section.screen([x0, y]), section.screen([x1, y])];
            const { data } = above.getContext("2d").getImageData(left, at, right - left, 1);
            const inked = [];
            for (let k = 0; 4 * k < data.length; k++) if (data[4 * k + 3] > 100) inked.push(k);
            return [inked[0], inked.at(-1)].map((k) => k / section.view.scale + x0);
          };
        }"""
    )
    hand.page.click("#strip ol li:nth-child(4) button")
    until(hand.page, "clastEditor.section.state.frame === 3")
    # the wall is shotcrete of 0.2 m from x = 2.8 m
    found = hand.page.evaluate("clastEditor.rows(2.5, 3.5, -1.2)")
    assert found == pytest.approx([2.8, 3.0], abs=0.06)
    hand.page.click("#strip ol li:last-child button")
    until(hand.page, "clastEditor.section.state.frame === 6")
    # it is a block of the drawing below; what is excavated keeps its outline
    assert hand.page.evaluate("clastEditor.rows(2.5, 3.5, -1.2)[0]") > 2.9


def test_surfaces_of_a_profile_keep_to_its_segments(drawing):
    hand = drawing(TEMPLATES["rockfall"])
    hand.choose("rockfall")
    before = hand.content["rockfall"]
    (ax, ay), (bx, by) = before["profile"][1:3]
    middle = 0.5 * (ax + bx), 0.5 * (ay + by)
    hand.page.mouse.dblclick(*hand.at(*middle))
    after = hand.content["rockfall"]
    assert len(after["profile"]) == len(before["profile"]) + 1
    names = before["surface"]
    assert after["surface"] == [*names[:2], names[1], *names[2:]]
    assert hand.steps == 1
    until(hand.page, "clastEditor.state.checked && !clastEditor.state.faults.length")
    hand.click(*after["profile"][2])
    hand.keys.press("Delete")
    assert hand.content["rockfall"] == before
    hand.drag(middle, (middle[0], middle[1] + 3.0))
    assert hand.content["rockfall"]["surface"] == after["surface"]
    hand.page.locator(".form [data-key$='.profile'] .list .drop").last.click()
    assert hand.content["rockfall"]["surface"] == after["surface"][:-1]
    until(hand.page, "clastEditor.state.checked && !clastEditor.state.faults.length")


def test_a_table_without_its_name_has_the_form_of_its_keys(drawing):
    hand = drawing(TEMPLATES["lined-tunnel"])
    hand.choose("stage", 5)
    damping = hand.page.locator(".form [data-key$='.damping']")
    assert damping.locator("output, button >> text=rayleigh").count() == 1
    row = hand.page.locator(".form [data-key$='.mass']")
    assert row.locator("small").inner_text() == "1/s"
    row.locator("input").first.fill("0.75")
    assert hand.content["stage"][5]["damping"] == {"mass": 0.75, "stiffness": 0.0001}
