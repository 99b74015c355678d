"""The section beside a text editor, as a person sees it: blocks, faults and notes, live."""

import pytest

from clast.case.templates import TEMPLATES
from clast.editor.server import ViewServer
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]


@pytest.fixture
def view(window):
    """Return a function that opens a text beside a text editor; it gives page and file."""

    def open_text(text):
        page, path, _ = window(text, kind=ViewServer)
        until(page, "clastEditor.state.sections > 0 && clastEditor.section.origin")
        return page, path

    return open_text


def test_blocks_follow_the_file_and_the_view_stays(view):
    page, path = view(SLOPE)
    until(page, "clastEditor.section.run?.blockCount === 23")
    assert not page.is_visible(".wait")
    assert "a text editor edits this case" in page.inner_text("#saved")
    for part in ("#undo", "#run", "#take-over", ".tools", ".add-table"):
        assert not page.is_visible(part)
    page.focus("#section canvas[tabindex]")
    before = page.evaluate("clastEditor.section.view.scale")
    page.keyboard.press("+")
    path.write_text(SLOPE.replace("spacing = 3.5", "spacing = 7.0"), "utf-8")
    until(page, "clastEditor.section.run.blockCount < 23")
    assert page.evaluate("clastEditor.section.view.scale") > before  # what is looked at stays
    assert path.read_text("utf-8") == SLOPE.replace("spacing = 3.5", "spacing = 7.0")


def test_a_fault_stands_at_its_line_and_goes(view):
    page, path = view(SLOPE)
    until(page, "clastEditor.section.run?.blockCount === 23")
    wrong = SLOPE.replace("at = [16.8, 23.8]", "at = [29.0, 20.0]")
    path.write_text(wrong, "utf-8")
    until(page, "document.querySelector('#faults .fault') !== null")
    line = wrong.splitlines().index("at = [29.0, 20.0]") + 1
    entry = page.inner_text("#faults .fault")
    assert f"[[measured_point]] 1 'crest' at, line {line}" in entry
    assert "lies outside every block" in entry
    until(page, "!document.querySelector('.old').hidden")
    assert page.evaluate("clastEditor.section.run.blockCount") == 23
    path.write_text(SLOPE, "utf-8")
    until(page, "document.querySelector('#faults .fault') === null")
    until(page, "document.querySelector('.old').hidden")


def test_an_entry_brings_its_mark_into_sight_and_its_line(view):
    page, _ = view(SLOPE)
    until(page, "clastEditor.section.marks.some((one) => one.what.startsWith('cut: '))")
    note = page.evaluate(
        "clastEditor.section.marks.find((one) => one.what.startsWith('cut: ')).at[0]"
    )
    page.evaluate("clastEditor.section.view.pan(5000, 0)")
    page.click("#notes-count")
    page.locator("#notes button", has_text="cut: ").first.click()
    x, y = page.evaluate("(at) => clastEditor.section.screen(at)", note)
    assert 0 < x < 1400 and 0 < y < 900


def test_a_case_that_is_broken_from_the_start_shows_its_lines(view):
    page, path = view(SLOPE.replace("spacing = 3.5", "spacing = -3.5"))
    until(page, "document.querySelector('#faults .fault') !== null")
    assert page.evaluate("clastEditor.section.lines.length") > 3
    assert page.evaluate("clastEditor.section.run") is None
    path.write_text(SLOPE, "utf-8")
    until(page, "clastEditor.section.run?.blockCount === 23")


def test_names_in_a_case_are_text(view):
    evil = '<img src=x onerror="document.title=1">'
    text = SLOPE.replace('name = "crest"', f"name = '{evil}'").replace(
        "at = [16.8, 23.8]", "at = [99.0, 20.0]"
    )
    page, _ = view(text)
    until(page, "document.querySelector('#faults .fault') !== null")
    assert evil in page.inner_text("#faults .fault")
    assert page.query_selector("#faults img") is None
