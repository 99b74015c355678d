"""The gallery has every template, with a picture and a page that is a run of it."""

import json
import re
import runpy
from pathlib import Path

import pytest

import clast
from clast.case.templates import TEMPLATES

DOCS = Path(__file__).parents[2] / "docs"


FALLS = {"key-block"}
"""Its wedge falls freely: joints open, and nothing touches."""


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_template_is_in_the_gallery(name):
    text = (DOCS / "gallery.md").read_text("utf-8")
    assert f"](gallery/{name}.html)" in text and f"images/template-{name}.png" in text
    assert (DOCS / "images" / f"template-{name}.png").exists()
    page = (DOCS / "gallery" / f"{name}.html").read_text("utf-8")
    case = clast.Case.from_text(TEMPLATES[name], f"{name}.toml")
    if case.rockfall is not None:
        assert f"<h1>{case.title}" in page and f"{case.campaign().count} paths" in page
        return
    data = re.search(r'<script type="application/json" id="scene">(.*?)</script>', page, re.DOTALL)
    scene = json.loads(data[1])
    assert scene["title"] == case.title
    assert len(scene["blocks"]) == case.model().block_count
    assert (scene["faces"]["slip"]["of"] > 0) == (name not in FALLS)
    assert scene["faces"]["opening" if name in FALLS else "slip"]["of"] > 0
    assert len(page) < 1.6e6


@pytest.mark.parametrize(
    "name", runpy.run_path(str(DOCS.parent / "tools" / "gallery.py"))["WORKED"]
)
def test_a_worked_case_has_a_page_to_play_with(name):
    text = (DOCS / "gallery.md").read_text("utf-8")
    assert f"](how-to/{name}.md)" in text and f"](gallery/worked-{name}.html)" in text
    page = (DOCS / "gallery" / f"worked-{name}.html").read_text("utf-8")
    data = re.search(r'<script type="application/json" id="scene">(.*?)</script>', page, re.DOTALL)
    scene = json.loads(data[1])
    assert f'title = "{scene["title"]}"' in (DOCS / "how-to" / f"{name}.md").read_text("utf-8")
    assert scene["frames"]["shown"] > 10 and len(page) < 1.5e6
