"""Every place of a fault is in a form: of its key, or of its table where no key is at fault."""

import json
import tomllib
from functools import partial

import pytest

from clast.inputs.declaring.text import with_values
from scenes.broken_inputs import (
    BASE,
    ROCK_MASS,
    SETTINGS,
    broken,
    changed,
    keys_in,
    made_of,
    places_of,
)
from scenes.browsers import CHROMIUM, until
from scenes.edited import edited_file

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
WRONG = ("nonsense", -1e30, {"nonsense": 1})

LOST = """async (places) => {
  const { state, goTo } = clastEditor, same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
  return places.filter((place) => {
    goTo(place);
    if (same(state.chosen, place)) return false; // the table itself: its form has a line for it
    for (let length = place.length; length; length--) {
      const row = JSON.stringify(place.slice(0, length));
      if (document.querySelector(`.form [data-place=${CSS.escape(row)}]`))
        return place.slice(length).some((part) => typeof part === "string");
    }
    return place.length > 1;
  });
}"""
"""Places of which the form has no row, nor one of the list or the value around."""


def toml(content):
    """Return a content as a text of TOML, a line for each table."""
    return "".join(f"{key} = {inline(value)}\n" for key, value in content.items())


def inline(value):
    if isinstance(value, dict):
        keys = ", ".join(f"{json.dumps(key)} = {inline(one)}" for key, one in value.items())
        return f"{{{keys}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(inline, value))}]"
    return repr(value) if isinstance(value, float) else json.dumps(value)


@pytest.mark.parametrize("text", [BASE, ROCK_MASS], ids=["all tables", "rock mass"])
def test_every_fault_leads_to_a_place_of_a_form(opened, tmp_path, text):
    content, broken_texts = tomllib.loads(text), {}
    for path in keys_in(content):
        for value in WRONG:
            wrong = changed(content, list(path), value)
            for place in places_of(partial(made_of, wrong)):
                broken_texts[place] = wrong
    if text is BASE:
        for settings in SETTINGS.values():
            for place in places_of(partial(broken, settings)):
                broken_texts[place] = with_values(content, settings)
    broken_texts.pop((), None)
    assert len(broken_texts) > 80
    file = tmp_path / "case.toml"
    file.write_text(text, "utf-8")
    with edited_file(file) as server:
        page = opened(server)
        page.wait_for_selector("body[data-ready]")
        page.locator(".level select").select_option("rare")
        every = sorted((list(one) for one in broken_texts), key=json.dumps)
        lost = page.evaluate(LOST, every)
        assert len(lost) < 0.2 * len(every)
        for place in lost:  # of values that are other ones in the broken text
            page.evaluate("(text) => clastEditor.hand.text(text)", toml(broken_texts[tuple(place)]))
            until(page, "!clastEditor.hand.isBusy && !clastEditor.hand.waiting.length")
            assert page.evaluate(LOST, [place]) == []
        page.close()
