"""The page under a person's hands: keys, wheel, drag; and what the system asks of it."""

import numpy as np
import pytest

from scenes.browsers import settled, until

MOVES = [
    ("+", lambda before: (before[0], before[1], 1.25 * before[2])),
    ("-", lambda before: (before[0], before[1], 0.8 * before[2])),
    ("ArrowLeft", lambda before: (before[0] - 40 / before[2], before[1], before[2])),
    ("ArrowRight", lambda before: (before[0] + 40 / before[2], before[1], before[2])),
    ("ArrowUp", lambda before: (before[0], before[1] + 40 / before[2], before[2])),
    ("ArrowDown", lambda before: (before[0], before[1] - 40 / before[2], before[2])),
]


@pytest.mark.parametrize("focused", [True, False])
def test_keys_move_the_view_and_go_through_the_frames(opened, wall, focused):
    page = opened(wall(4, 5))
    if focused:
        page.focus("[data-part=above]")
    for key, wanted in MOVES:
        page.keyboard.press("0")
        before = page.evaluate("[clastPage.view.x, clastPage.view.y, clastPage.view.scale]")
        page.keyboard.press(key)
        after = page.evaluate("[clastPage.view.x, clastPage.view.y, clastPage.view.scale]")
        assert after == pytest.approx(wanted(before), abs=1e-9), key
    for keys, frame in (
        (["Home"], 0),
        (["."], 1),
        (["."], 2),
        ([","], 1),
        (["Shift+."], 5),
        (["Shift+,"], 0),
        (["End"], 5),
    ):
        for key in keys:
            page.keyboard.press(key)
        assert page.evaluate("clastPage.state.frame") == frame, keys
    page.keyboard.press("Space")
    assert page.evaluate("clastPage.playing")
    page.keyboard.press("Space")
    assert not page.evaluate("clastPage.playing")


def test_wheel_and_drag_move_what_is_under_the_pointer(opened, wall):
    page = opened(wall(4, 5))
    box = page.locator("[data-part=above]").bounding_box()
    x, y = round(box["x"] + 0.7 * box["width"]), round(box["y"] + 0.3 * box["height"])
    place = (
        "([x, y]) => { const box = clastPage.above.getBoundingClientRect(); const { view } ="
        " clastPage; return [view.worldX(x - box.left), view.worldY(y - box.top), view.scale]; }"
    )
    before = page.evaluate(place, [x, y])
    page.mouse.move(x, y)
    page.mouse.wheel(0, -300)
    settled(page)
    after = page.evaluate(place, [x, y])
    assert after[:2] == pytest.approx(before[:2], abs=1e-6)
    assert after[2] == pytest.approx(before[2] * np.exp(0.45), rel=1e-6)
    page.mouse.down()
    page.mouse.move(x - 60, y + 25, steps=4)
    page.mouse.up()
    settled(page)
    assert page.evaluate(place, [x - 60, y + 25])[:2] == pytest.approx(after[:2], abs=1e-6)
    assert page.evaluate("clastPage.state.chosen") == -1  # a drag is not a click


def test_whoever_wants_less_motion_sees_few_frames(opened, wall):
    page = opened(wall(2, 3), reduced_motion="reduce")
    page.evaluate("""() => {
      const { goTo } = clastPage;
      clastPage.shownFrames = [];
      clastPage.goTo = (frame) => {
        clastPage.shownFrames.push(frame);
        goTo.call(clastPage, frame);
      };
      clastPage.speed = 20; // a frame each tenth of a second, where nobody minds
      clastPage.play(true);
    }""")
    until(page, "!clastPage.playing")
    # a quarter of a second is half of the run: from the first frame at most two steps
    seen = page.evaluate("clastPage.shownFrames")
    assert seen[0] == 0 and seen[-1] == 5 and len(seen) <= 3


def test_a_dark_system_has_a_dark_page_and_a_print_has_no_controls(opened, wall):
    page = opened(wall(3, 3), color_scheme="dark")
    assert page.get_attribute("main", "data-theme") == "dark"
    paper = "getComputedStyle(document.querySelector('main')).backgroundColor"
    assert page.evaluate(paper) == "rgb(22, 24, 27)"
    page.click("[data-part=theme]")
    assert page.evaluate(paper) == "rgb(255, 255, 255)"
    page.emulate_media(media="print")
    for part in ("field", "play", "png", "layers", "csv"):
        assert not page.is_visible(f"[data-part={part}]"), part
    for part in ("title", "legend", "stage", "chart", "report"):
        assert page.is_visible(f"[data-part={part}]"), part


def test_fingers_move_enlarge_and_choose(opened, wall):
    page = opened(wall(4, 5), 390, 844, has_touch=True, is_mobile=True)
    hand = page.context.new_cdp_session(page)
    box = page.locator("[data-part=above]").bounding_box()
    middle = np.array([box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]])

    def touch(kind, *fingers):
        points = [{"x": float(x), "y": float(y), "id": k} for k, (x, y) in enumerate(fingers)]
        hand.send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": points})

    def seen():
        return np.array(page.evaluate("[clastPage.view.x, clastPage.view.y, clastPage.view.scale]"))

    before, away = seen(), np.array([60.0, 0.0])
    # two fingers that part: twice as large, about the point between them
    touch("Start", middle - away, middle + away)
    for grown in (1.25, 1.5, 1.75, 2.0):
        touch("Move", middle - grown * away, middle + grown * away)
    touch("End")
    settled(page)
    after = seen()
    assert after[2] == pytest.approx(2.0 * before[2], rel=1e-6)
    assert (after[:2] - before[:2]) * after[2] == pytest.approx([0.0, 0.0], abs=1.5)
    assert page.evaluate("clastPage.state.chosen") == -1
    # one finger takes the drawing along, and the page does not scroll
    touch("Start", middle)
    for k in range(1, 5):
        touch("Move", middle + k * np.array([10.0, -5.0]))
    touch("End")
    settled(page)
    moved = (seen()[:2] - after[:2]) * after[2]
    assert moved == pytest.approx([-40.0, -20.0], abs=1e-6)
    assert page.evaluate("[scrollX, scrollY]") == [0, 0]
    # a tap chooses
    page.touchscreen.tap(*middle)
    settled(page)
    assert page.evaluate("clastPage.state.chosen") >= 0 or page.evaluate("clastPage.state.joint")
