"""Templates of masonry: what they consist of, and that they do what their comments say."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from clast.block.inertia import block_frames
from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.cli.case_commands import new
from clast.model.state import initial_state

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("page", ["README.md", "docs/reference/commands.md"])
def test_pages_name_every_template(page):
    words = set(re.findall(r"[a-z]+(?:-[a-z]+)*", (ROOT / page).read_text("utf-8")))
    assert set(TEMPLATES) <= words


def test_the_page_on_templates_and_the_help_name_every_template():
    page = (ROOT / "docs" / "how-to" / "templates.md").read_text("utf-8")
    assert set(re.findall(r"^\| `([a-z-]+)` \|", page, re.MULTILINE)) == set(TEMPLATES)
    helped = str(new.__annotations__["template"])
    assert all(name in helped for name in TEMPLATES)


def test_the_wall_has_a_void_window_under_a_lintel_of_one_block():
    model = Case.from_toml(TEMPLATES["wall"]).model()
    assert model.block_count == 115
    concrete = [k for k, rock in enumerate(model.block_rock) if model.rocks[rock].name != "brick"]
    assert [round(float(model.area[k]), 6) for k in concrete] == [2.4 * 0.3]
    assert model.area[~model.fixed].sum() == pytest.approx(6.0 * 3.6 - 1.8 * 1.2, rel=1e-9)
    assert not [note for note in model.notes if "taken out" in note]
    bricks = Case.from_toml(TEMPLATES["wall"], ["region.1.one_block=false"]).model()
    assert bricks.block_count == 115 - 1 + 5


def test_an_arch_has_the_numbers_of_its_comments():
    text = TEMPLATES["arch"]
    given = dict(re.findall(r"^#   (\w+) += ([\d.]+)", text, re.MULTILINE))
    radius, thickness = float(given["radius"]), float(given["thickness"])
    count = int(given["voussoirs"])
    model = Case.from_toml(text).model()
    assert model.block_count == count + 1
    # the area of a voussoir is R t sin(pi/n): trapezoids between circles
    area = radius * thickness * np.sin(np.pi / count)
    np.testing.assert_allclose(model.area[1:], area, rtol=1e-4)
    at = block_frames(model, initial_state(model)).centroid[1:]
    np.testing.assert_allclose(at[:, 0], -at[::-1, 0], atol=2e-6)
    # each joint is one edge of both voussoirs, to the last digit
    corners = {tuple(one) for one in model.vertices[4:].tolist()}
    assert len(corners) == 2 * (count + 1)


@pytest.mark.parametrize(("push", "stands"), [(1.55, True), (1.9, False)])
def test_a_column_stands_for_less_than_breadth_over_height(push, stands):
    settings = [f"gravity=[{push}, -9.8]", "time.step=5e-3", "time.end=0.8"]
    run = Case.from_toml(TEMPLATES["column"], settings).run()
    assert (abs(run.history("top").displacement[-1, 0]) < 1e-3) == stands
