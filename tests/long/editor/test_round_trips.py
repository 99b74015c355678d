"""Every value of every case that there is, changed and changed back: the bytes are the old ones."""

import re
import tomllib

import pytest

from clast.case.templates import TEMPLATES
from scenes.odd_toml import ODD, changed_and_back, written
from scenes.places import ROOT

TEXTS = {**TEMPLATES, "odd": ODD, "odd, from Windows": ODD.replace("\n", "\r\n")}
TEXTS |= {path.name: path.read_bytes().decode() for path in (ROOT / "cases").rglob("*.toml")}
SNIPPETS = {
    f"{path.name} {number}": text
    for path in (ROOT / "docs").rglob("*.md")
    for number, text in enumerate(
        re.findall(r"^```toml\n(.*?)^```", path.read_text("utf-8"), re.M | re.S)
    )
}


@pytest.mark.parametrize("name", [*TEXTS, *SNIPPETS])
def test_every_value_changed_and_changed_back_gives_the_old_bytes(name):
    text = {**TEXTS, **SNIPPETS}[name]
    content, found = tomllib.loads(text), written(text)
    assert found
    for place, raw in found.items():
        changed_and_back(text, content, place, raw)
