"""The text beside forms and section: what is chosen is marked in it, its caret chooses; search."""

import json

import pytest

from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]
LINES = SLOPE.split("\n")


@pytest.fixture
def page(window):
    """Return the window of the slope with its text open."""
    page = window(SLOPE, "slope.toml")[0]
    page.click("#toml summary")
    return page


def marked(page):
    """Return the texts of the lines that are marked and in sight."""
    numbers = page.evaluate(
        """() => {
          const { top, bottom } = document.querySelector("#text").getBoundingClientRect();
          return [...document.querySelectorAll("#lines mark")].filter((line) => {
            const box = line.getBoundingClientRect();
            return box.bottom > top && box.top < bottom;
          }).map((line) => Number(line.textContent));
        }"""
    )
    return [LINES[number - 1] for number in numbers]


def caret(page, line):
    """Put the caret into a line of the text, as a click does."""
    page.evaluate(
        """(at) => {
          const field = document.querySelector("#text");
          field.focus();
          field.setSelectionRange(at, at);
        }""",
        len("\n".join(LINES[:line])) + 1,
    )


def test_what_is_chosen_is_marked_in_the_text(page):
    page.click("nav [data-table='[\"bolt\",4]']")
    assert marked(page)[0] == "[[bolt]]"
    assert any('"cable 5"' in line for line in marked(page))
    page.click("nav [data-table='[\"joint_set\",1]']")
    page.focus("[data-key='JointSetTable.seed'] input")
    assert [line.split("#")[0].strip() for line in marked(page)] == ["seed = 7"]
    page.evaluate("clastEditor.tools.choose(['water', 0])")  # as a click on its line does
    assert marked(page)[0] == "[[water]]"
    band = page.evaluate(
        "getComputedStyle(document.querySelector('#text')).getPropertyValue('--count')"
    )
    assert int(band) == len(marked(page))


def test_the_caret_chooses_the_table(page):
    for number, line in enumerate(LINES):
        if line.startswith("spacing = {"):
            caret(page, number)
    until(page, "JSON.stringify(clastEditor.state.chosen) === '[\"joint_set\",1]'")
    assert page.evaluate("document.activeElement.id") == "text"
    assert page.evaluate("clastEditor.section.place") == ["joint_set", 1]
    caret(page, LINES.index("[[measured_point]]"))
    until(page, "JSON.stringify(clastEditor.state.chosen) === '[\"measured_point\",0]'")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    until(page, "clastEditor.state.chosen[0] !== 'measured_point'")


def test_caret_and_view_stay_when_a_form_changes_the_text(page):
    line = LINES.index("[[measured_point]]")
    caret(page, line)
    page.evaluate("document.querySelector('#text').scrollTop = 400")
    page.evaluate(
        """async () => {
          const edit = { do: "set", place: ["title"], toml: '"much longer than it was before"' };
          await clastEditor.hand.edit([edit]);
        }"""
    )
    where = """(() => {
      const { value, selectionStart, scrollTop } = document.querySelector("#text");
      return [value.slice(selectionStart, selectionStart + 18), scrollTop];
    })()"""
    until(page, "document.querySelector('#text').value.includes('much longer')")
    assert page.evaluate(where) == ["[[measured_point]]", 400]
    page.evaluate("clastEditor.hand.undo()")
    until(page, "!document.querySelector('#text').value.includes('much longer')")
    assert page.evaluate(where) == ["[[measured_point]]", 400]
    assert page.input_value("#text") == SLOPE


def test_a_fault_of_the_text_leads_to_its_line(page):
    page.fill("#text", SLOPE.replace("38.0", "38.0 ]"))
    until(page, "clastEditor.state.faults[0]?.line === 29")
    page.click("h1")
    page.click("#faults .fault")
    at = page.evaluate("document.querySelector('#text').selectionStart")
    assert page.evaluate("document.activeElement.id") == "text"
    assert SLOPE[:at].count("\n") == 28
    assert page.text_content("#lines b").strip() == "29"


@pytest.mark.parametrize(
    ("words", "first", "place"),
    [
        ("water table", "water", ["water", 0]),
        ("jkn", "joint normal stiffness", ["joint", "default"]),
        ("crack", "trace (new)", ["trace", 0]),
        ("earthquake", "ground motion (new)", ["ground_motion"]),
        ("joint set seed", "joint set seed", ["joint_set", 0]),
        ("Fixed Sides", "domain fixed sides", ["domain"]),
    ],
)
def test_words_lead_to_a_form(page, words, first, place):
    page.keyboard.press("Control+k")
    page.keyboard.type(words)
    named = page.evaluate("document.querySelector('#found button').firstChild.data")
    assert named + " (new)" * ("(new)" in page.text_content("#found button")) == first
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    chosen = json.dumps(place, separators=(",", ":"))
    until(page, f"JSON.stringify(clastEditor.state.chosen) === '{chosen}'")
    page.wait_for_timeout(100)
    assert page.evaluate("document.activeElement.closest('.form') !== null")
    assert page.is_hidden("#found")


def test_words_that_nothing_has_are_told(page):
    page.fill("#search", "xyzzy")
    assert page.text_content("#found [role=status]") == "nothing found"
    page.press("#search", "Escape")
    assert page.is_hidden("#found")
