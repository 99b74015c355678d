"""Two versions of a case beside each other in the window."""

import pytest

from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
KEPT = "clastEditor.section.beside.kept"
COARSER = [{"do": "set", "place": ["joint_set", 0, "spacing"], "toml": "9.0"}]
CENTRES = """() => {
  const { section } = clastEditor, { kept } = section.beside;
  return [section, kept].map(({ view: { x, y, scale }, origin: [left, low] }) =>
    [x + left, y + low, scale]);
}"""
DOTS = """() => {
  const canvas = document.querySelector(".version canvas");
  return [...canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data].join();
}"""


def test_a_version_stays_beside_those_that_follow(window):
    page, _, _ = window(TEMPLATES["slope"])
    until(page, "clastEditor.section.run !== null && !clastEditor.state.is_cutting")
    assert page.is_hidden(".version")
    page.click("text=Compare")
    page.wait_for_selector(".version pre >> text=The same text.")
    section = page.locator("#section canvas[tabindex]")
    section.press("+")  # what has been moved by hand is not fitted to each cut
    page.wait_for_timeout(300)
    blocks, dots = page.evaluate(f"{KEPT}.run.blockCount"), page.evaluate(DOTS)
    assert len(set(dots.split(","))) > 10
    page.evaluate("(edits) => clastEditor.hand.edit(edits)", COARSER)
    until(page, f"clastEditor.section.run.blockCount < {blocks}")
    page.wait_for_timeout(300)
    assert page.evaluate(f"{KEPT}.run.blockCount") == blocks
    assert "kept:  spacing" in page.text_content(".version pre")
    assert page.evaluate(DOTS) == dots
    for key in ("+", "ArrowLeft", "ArrowUp"):
        section.press(key)
    page.wait_for_timeout(300)
    here, kept = page.evaluate(CENTRES)
    assert here == pytest.approx(kept, abs=1e-9)
    assert page.evaluate(DOTS) != dots
    page.click("#strip ol button >> nth=3")
    until(page, f"{KEPT}.state.frame === 3")
    page.click(".version >> text=close")
    until(page, f"{KEPT} === null && document.querySelector('.version').hidden")
