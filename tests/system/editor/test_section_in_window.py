"""The section in the window of a case: it follows the case, marks faults, shows what is chosen."""

import pytest

from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]


@pytest.fixture
def slope(window):
    """Return the window of the slope, and its file."""
    page, path, _ = window(SLOPE, "slope.toml")
    until(page, "clastEditor.section.run?.blockCount === 23 && clastEditor.state.checked")
    return page, path


def colour_above(page, point):
    """Return the colour of what is drawn above the blocks at a place of the case, m."""
    return page.evaluate(
        """async (point) => {
          const frame = () => new Promise((done) => requestAnimationFrame(done));
          const { section } = clastEditor;
          do await frame(); while (section.waiting);
          const at = section.screen(point).map(Math.round);
          return [...section.above.getContext("2d").getImageData(...at, 1, 1).data].slice(0, 3);
        }""",
        list(point),
    )


def test_the_section_follows_a_field(slope):
    page, _ = slope
    page.evaluate("clastEditor.goTo(['joint_set', 0, 'spacing'])")
    field = page.locator('[data-place=\'["joint_set",0,"spacing"]\'] input[type=text]').first
    field.fill("7")
    until(page, "clastEditor.section.run.blockCount < 23")
    page.click("#undo")
    until(page, "clastEditor.section.run.blockCount === 23")


def test_a_fault_is_marked_and_the_mark_leads_to_its_field(slope):
    page, path = slope
    path.write_text(SLOPE.replace("at = [16.8, 23.8]", "at = [29.0, 20.0]"), "utf-8")
    until(page, "clastEditor.section.marks.some(({ kind }) => kind === 'fault')")
    assert colour_above(page, (29.0, 20.0)) == [0xD3, 0x2F, 0x2F]
    box = page.locator("#section canvas[tabindex]").bounding_box()
    x, y = page.evaluate("clastEditor.section.screen([29, 20])")
    page.mouse.click(box["x"] + x, box["y"] + y)
    assert page.evaluate("clastEditor.state.chosen") == ["measured_point", 0]


def test_a_table_that_is_chosen_is_lit_in_the_section(slope):
    page, _ = slope
    middle = (7.0, 21.0)  # of the first part of the water line
    before = colour_above(page, middle)
    page.evaluate("clastEditor.goTo(['water', 0, 'line'])")
    assert colour_above(page, middle) != before
    assert colour_above(page, middle) == pytest.approx([0xD8, 0x1B, 0x60], abs=1)
    page.evaluate("clastEditor.goTo(['time', 'step'])")
    assert colour_above(page, middle) == before


def test_lines_follow_a_slider_until_the_blocks_are_there(slope):
    page, _ = slope
    wider = {"do": "set", "place": ["joint_set", 0, "spacing"], "toml": "7.0"}
    page.evaluate("(wider) => clastEditor.hand.move([wider], 'slide')", wider)
    until(page, "clastEditor.section.moving.length > 3")
    ends = page.evaluate("clastEditor.section.moving")
    assert all(len(one) == 4 for one in ends)
    assert page.evaluate("clastEditor.section.run.blockCount") == 23
    until(page, "clastEditor.section.run.blockCount < 23")
    assert page.evaluate("clastEditor.section.moving") == []


def test_the_view_stays_where_sections_come_close_together(drawing):
    hand = drawing(TEMPLATES["slope"])
    centre, after, origin = hand.page.evaluate(
        """async () => {
          const { section } = clastEditor, { view, lines, origin, run: { scene } } = section;
          const at = () => [view.x + section.origin[0], view.y + section.origin[1]];
          const moved = (by) => ({ lines, scene: { ...scene, origin: origin.map((x) => x + by) } });
          view.moved(); // by somebody: all is not shown again
          const before = at();
          await Promise.all([1, 7].map((by) => section.show(moved(by), [])));
          return [before, at(), section.origin.map((x, k) => x - origin[k])];
        }"""
    )
    assert origin == pytest.approx([7, 7])  # the last one is shown
    assert after == pytest.approx(centre)
