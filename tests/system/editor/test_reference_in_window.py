"""Help of each key: what the form says of it, and the reference of the case file in the window."""

import json
import re
from pathlib import Path

import pytest

from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
PAGE = Path(__file__).parents[3] / "docs" / "reference" / "case-file.md"
ROW = re.compile(r"(?<!\\)\|")


def tables_of_page():
    """Return the reference as it is published: heading -> key -> type, default, key is needed."""
    found = {}
    for part in re.split(r"^## ", PAGE.read_text("utf-8"), flags=re.M)[1:]:
        heading, _, text = part.partition("\n")
        lines = text.split("\n### ")[0].splitlines()
        cells = [
            [one.strip() for one in ROW.split(line)[1:-1]] for line in lines if line[:1] == "|"
        ]
        rows = {
            key.strip("`"): (kind.replace("`", "").replace("e+0", "e+"), given)
            for key, kind, _, given, _ in cells[2:]
        }
        if rows:
            found[heading.strip("`")] = rows
    return found


def value(text):
    """Return a default as it is compared, None where there is none."""
    return None if text in ("", "-", "needed") else json.loads(text.strip("`"))


def test_the_window_says_what_the_published_reference_says(window):
    page, _, _ = window(TEMPLATES["slope"])
    page.click("nav [data-table='[]']")
    page.click(".form >> text=reference")
    published, shown = tables_of_page(), {}
    for name in page.locator("#reference option").evaluate_all("(all) => all.map((o) => o.value)"):
        page.select_option("#reference select", value=name)
        heading = page.inner_text("#reference h3 >> nth=0")
        assert page.input_value("#reference select") == name
        shown[heading] = {
            cells[0]: cells[1:]
            for cells in page.locator("#reference section:first-of-type tbody tr").evaluate_all(
                "(rows) => rows.map((row) => [...row.children].map((one) => one.textContent))"
            )
        }
    # of a choice each name has a section of its own
    assert set(published) - set(shown) == {"[damping]"}
    assert any(heading.startswith("[damping] = ") for heading in shown)
    del published["[damping]"]
    for heading, rows in published.items():
        assert set(rows) == set(shown[heading]), heading
        for key, (kind, given) in rows.items():
            kind_shown, _, given_shown, _ = shown[heading][key]
            assert kind_shown == kind, (heading, key)
            assert (given_shown == "needed") == (given == ""), (heading, key)
            assert value(given_shown) == value(given), (heading, key)


def test_help_of_a_key_leads_to_its_row_in_the_reference(window):
    page, _, _ = window(TEMPLATES["slope"])
    page.click('nav [data-table=\'["joint","bedding"]\']')
    page.focus(".form [aria-label='What friction_angle means']")
    page.keyboard.press("Enter")
    said = page.inner_text(".form .row .help")
    assert "degrees" in said
    assert "number ≥ 0, < 90" in said
    assert "default 0" in said
    page.keyboard.press("Tab")
    while page.evaluate("document.activeElement.className") != "link":
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    row = page.locator("#reference .wanted")
    assert row.locator("th").inner_text() == "friction_angle"
    assert row.is_visible()
    page.keyboard.press("Escape")
    assert not page.locator("#reference").is_visible()
    assert page.evaluate("document.activeElement.className") == "link"
