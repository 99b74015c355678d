"""The strip of stages as a person uses it: what is there by then, order, names, what they bring."""

import pytest

from clast.block import polygon
from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
GONE = """(() => { const { run, state } = clastEditor.section;
return run.scene.blocks.filter((_, k) => run.isGone(state.frame, k)).length; })()"""
NAMES = "clastEditor.state.content.stage.map((one) => one.name).join()"
FIRST = "settled,heading,bolts,bench,shotcrete,earthquake"


@pytest.fixture
def tunnel(window):
    """Return the page of the template of a lined tunnel, its blocks drawn, and the file."""
    page, file, _ = window(TEMPLATES["lined-tunnel"], "tunnel.toml")
    until(page, "clastEditor.section.run?.frameCount === 7")
    return page, file


def stage(page, number):
    page.click(f"#strip li:nth-child({number + 1}) button")


def named(page, names):
    until(page, f"{NAMES} === '{names}'")


def test_a_stage_shows_what_is_there_by_then(tunnel):
    page, _ = tunnel
    lined, heading = page.evaluate(GONE), {}
    assert page.text_content("#strip [aria-current] b") == "start"
    for number in (1, 2, 4, 5):
        stage(page, number)
        heading[number] = page.evaluate(GONE)
    assert heading[1] == lined < heading[2] < heading[4]
    assert heading[5] == heading[4] - lined  # the segments of the lining have come
    assert page.text_content(".form h2") == "stage 5"
    legend = page.text_content(".entries")
    assert "excavated" in legend and "not installed" not in legend
    page.keyboard.press("ArrowLeft")
    assert page.evaluate(GONE) == heading[4]
    page.click("nav [data-table='[\"stage\",2]']")  # the tree and the strip choose the same
    assert page.text_content("#strip [aria-current] b") == "3 bolts"
    told = page.text_content("#strip [aria-current]")
    assert told == "3 boltsbolt pattern 1"
    assert page.text_content("#strip li:nth-child(6) small") == "lining shotcrete"


def test_count_smallest_block_and_edge_are_in_sight(tunnel):
    page, _ = tunnel
    model = Case.from_text(TEMPLATES["lined-tunnel"], "case.toml").model()
    area, _, _ = polygon.moments(model.vertices, model.block_start)
    _, edges = polygon.edges(model.vertices, model.block_start)
    name = model.block_name[int(area.argmin())]
    told = f"182 blocks, some 800 steps, perhaps 4 s, smallest block {name} of "
    told += f"{area.min():.3g} m², shortest edge {edges.min():.3g} m"
    until(page, f"document.getElementById('saved').textContent.includes('{told}')")


def test_stages_are_added_moved_named_and_taken_away(tunnel):
    page, file = tunnel
    stage(page, 3)
    page.click("#strip [data-tool=add]")
    named(page, FIRST.replace("bench", "stage 7,bench"))
    name = page.locator("#strip [data-tool=name]")
    name.fill("invert")
    name.press("Enter")
    named(page, FIRST.replace("bench", "invert,bench"))
    page.click("#strip [data-tool=earlier]")
    named(page, FIRST.replace("bolts", "invert,bolts"))
    page.locator("#strip [aria-current] b", has_text="3 invert").wait_for()
    page.click("#strip [data-tool=later]")
    page.locator("#strip [aria-current] b", has_text="4 invert").wait_for()
    page.click("#strip [data-tool=later]")
    page.locator("#strip [aria-current] b", has_text="5 invert").wait_for()
    named(page, FIRST.replace("bench", "bench,invert"))
    page.click("#strip [data-tool=remove]")
    named(page, FIRST)
    stage(page, 3)
    name.fill("anchors")
    name.press("Enter")
    until(page, "clastEditor.state.content.bolt_pattern[0].stage === 'anchors'")
    page.keyboard.press("Control+z")
    until(page, "clastEditor.state.unsaved === false && !clastEditor.hand.isBusy")
    assert file.read_text("utf-8") == TEMPLATES["lined-tunnel"]


def test_openings_are_dug_where_they_are_chosen(tunnel):
    page, _ = tunnel
    stage(page, 4)
    assert page.locator("#strip [data-tool=excavate]").count() == 0  # all are dug
    page.click("#strip [data-tool=remove]")
    named(page, FIRST.replace(",bench", ""))
    stage(page, 4)
    page.select_option("#strip [data-tool=excavate]", "bench")
    until(page, "clastEditor.state.content.stage[3].excavate?.[0] === 'bench'")
    until(page, "clastEditor.section.run.frameCount === 6 && clastEditor.state.checked")
    both = page.evaluate(GONE)
    stage(page, 2)
    assert page.evaluate(GONE) > both  # the lining is not there yet
    page.click("#strip [data-tool=remove]")
    page.click("#strip [data-tool=remove]")
    until(page, "clastEditor.state.content.stage.length === 3")


def test_what_is_dragged_onto_a_stage_comes_with_it(tunnel):
    page, file = tunnel
    page.drag_and_drop("nav [data-table='[\"bolt_pattern\",0]']", "#strip li:nth-child(5) button")
    until(page, "clastEditor.state.content.bolt_pattern[0].stage === 'bench'")
    page.drag_and_drop("nav [data-table='[\"opening\",1]']", "#strip li:nth-child(4) button")
    until(page, "clastEditor.state.content.stage[2].excavate?.join() === 'bench'")
    assert page.evaluate("clastEditor.state.content.stage[3].excavate ?? null") is None
    page.locator("#strip [aria-current] b", has_text="3 bolts").wait_for()
    until(page, "!clastEditor.hand.isBusy")
    before = page.evaluate("clastEditor.state.text")
    page.drag_and_drop("nav [data-table='[\"joint_set\",0]']", "#strip li:nth-child(4) button")
    page.drag_and_drop("nav [data-table='[\"bolt_pattern\",0]']", "#strip li:nth-child(1) button")
    assert page.evaluate("clastEditor.state.text") == before
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    until(page, "clastEditor.state.unsaved === false && !clastEditor.hand.isBusy")
    assert file.read_text("utf-8") == TEMPLATES["lined-tunnel"]
