"""Templates drawn from nothing in the window of a case, as a person does it: the same case results."""

import pytest

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.editor.checking import check
from scenes.browsers import CHROMIUM, until
from scenes.edited import edited_file
from scenes.hands import Hand

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")


@pytest.fixture
def empty(opened, tmp_path):
    """Return the hand in the window of an empty file, and the file."""
    path = tmp_path / "case.toml"
    path.write_text("", "utf-8")
    check(TEMPLATES["slope"], str(path))  # kernels are compiled before the window is waited for
    with edited_file(path) as server:
        page = opened(server)
        page.wait_for_selector("body[data-ready]")
        until(page, "clastEditor.section.origin !== null && clastEditor.state.sections > 0")
        page.locator(".level select").select_option("more")
        yield Hand(page), path
        page.close()


def drawn(hand, path):
    """Return the case that the file has when the hand rests."""
    until(hand.page, "!clastEditor.state.unsaved && clastEditor.state.faults.length === 0")
    return Case.from_text(path.read_text("utf-8"), str(path))


def same(case, template):
    """Say whether a case is that of a template, whichever way it is written."""
    expected = Case.from_text(TEMPLATES[template], "case.toml").model_dump()
    found = case.model_dump()
    return {key for key in expected if found[key] != expected[key]} == set()


CABLES = (
    ("24.33,9.24", "18.42,8.19"),
    ("23.21,11.47", "15.33,10.08"),
    ("21.07,15.77", "10.23,13.85"),
    ("19.95,18.00", "7.14,15.74"),
    ("17.85,22.20", "2.09,19.42"),
)


def test_the_slope(empty):
    hand, path = empty
    hand.choose()
    hand.fill(title="Slope in bedding, with water and cables", plane="strain", damping="adaptive")
    hand.add("time")
    hand.fill(step="2e-3", end="1.0")
    hand.add("rock", "sandstone")
    hand.fill(young="5e9", poisson="0.25", density="2500.0")
    hand.add("joint", "default")
    hand.fill(friction_angle="40.0")
    hand.add("joint", "bedding")
    hand.fill(friction_angle="38.0")
    hand.page.focus("#section canvas[tabindex]")
    hand.keys.press("2")
    hand.type("0,3", "32,3", "@3<90", "26,6")
    hand.click(17.0, 24.0)
    hand.click(0.0, 24.0)
    hand.keys.press("Enter")
    hand.rest()
    hand.fill(rock="sandstone")
    hand.tool("support", "domain: fixed sides")
    for x, y in ((16.0, 3.2), (0.2, 14.0), (31.8, 4.5)):
        hand.click(x, y)
        hand.rest()
    hand.tool("joint set")
    hand.type("25.5, 7", "@5<-35", "3.5")
    hand.fill(name="bedding", joint="bedding")
    hand.tool("outline", "region: polygon")
    hand.type("-0.2,24.9", "25.5,6.9", "25.5,25", "")
    hand.fill(name="beds")
    hand.tool("joint set")
    hand.type("3,3", "@5<60", "4.5")
    hand.fill(name="cross joints", within="beds", seed="7")
    hand.drop("origin")
    hand.form_of("spacing", "spread {...}")
    hand.fill(distribution="normal", mean="4.5", sd="0.5")
    hand.add("amplitude", "rise")
    hand.fill(time=["0", "0.2"], value=["0", "1"])
    hand.tool("water", "water: line")
    hand.type("0,22", "14,20")
    hand.click(26.0, 6.0)
    hand.keys.press("Enter")
    hand.rest()
    hand.fill(acts_on="joints")
    hand.form_of("amplitude", "text")
    hand.fill(amplitude="rise")
    for name in ("dry", "cables", "water"):
        hand.add("stage")
        hand.fill(name=name)
    hand.fill(loads=["rise"])
    hand.choose("stage", 0)
    hand.fill(dynamic_ratio="0.0", reset_displacement=True)
    hand.add("bolt_kind", "cable")
    hand.fill(stiffness="1e7", yield_force="2e5", pretension="5e4")
    for number, (start, end) in enumerate(CABLES, 1):
        hand.tool("bolt", "bolt")
        hand.type(start, end)
        hand.fill(name=f"cable {number}", stage="cables")
    hand.tool("more", "measured point")
    hand.type("16.8,23.8")
    hand.fill(name="crest")
    hand.add("output")
    hand.fill(every="0.05")
    assert same(drawn(hand, path), "slope")
