"""Pictures of the section, and what is told and marked of its blocks."""

import re
from xml.etree import ElementTree

import matplotlib.image
import numpy as np
import pytest
import shapely

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]
SHARP = """
[[trace]]
points = [[0, 4], [32, 6.5]]

[[trace]]
points = [[0, 4.5], [32, 4.5]]
"""
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def drawn(window):
    """Return a function that opens a case and waits for its blocks; it gives the page."""

    def open_text(text):
        page = window(text, "slope.toml")[0]
        until(page, "clastEditor.section.run !== null")
        return page

    return open_text


def angles_of(block):
    """Return the angles within a polygon that runs counter-clockwise, degrees."""
    corners = shapely.get_coordinates(shapely.geometry.polygon.orient(block).exterior)[:-1]
    before, after = np.roll(corners, 1, axis=0) - corners, np.roll(corners, -1, axis=0) - corners
    turns = np.arctan2(*before.T[::-1]) - np.arctan2(*after.T[::-1])
    return np.degrees(turns) % 360.0


def blocks_of(text):
    model = Case.from_text(text, "slope.toml").model()
    parts = zip(model.block_start[:-1], model.block_start[1:], strict=True)
    return [shapely.Polygon(model.vertices[first:past] + model.origin) for first, past in parts]


def test_a_block_tells_edges_and_smallest_angle(drawn):
    page = drawn(SLOPE + SHARP)
    blocks = blocks_of(SLOPE + SHARP)
    shapes = page.evaluate(
        """() => {
          const { run } = clastEditor.section;
          return run.scene.blocks.map((_, k) => modules.section.shapeOf(run, k));
        }"""
    )
    assert len(shapes) == len(blocks)
    for shape, block in zip(shapes, blocks, strict=True):
        assert shape["edges"] == len(block.exterior.coords) - 1
        assert shape["angle"] == pytest.approx(angles_of(block).min(), abs=0.05)
    assert 0 < sum(one["isSliver"] for one in shapes) < len(shapes)
    sharp = next(k for k, one in enumerate(shapes) if one["isSliver"])
    place = blocks[sharp].representative_point()
    page.evaluate(
        """([x, y]) => {
          const { section } = clastEditor, { origin, run } = section;
          section.state.chosen = run.blockAt(0, x - origin[0], y - origin[1]);
          section.tellPlace(0, 0);
        }""",
        [place.x, place.y],
    )
    said = page.text_content("#section .place")
    assert f"{shapes[sharp]['edges']} edges" in said
    assert "a sliver" in said


def colours(page):
    """Return the colours above the blocks, as a set of numbers."""
    page.wait_for_timeout(200)
    return set(
        page.evaluate(
            """() => {
              const { above } = clastEditor.section;
              const { data } = above.getContext("2d").getImageData(0, 0, above.width, above.height);
              return [...new Set(new Uint32Array(data.buffer))];
            }"""
        )
    )


@pytest.mark.parametrize(("layer", "colour"), [("Slivers", "d81b60"), ("Marks of notes", "1f6fb4")])
def test_slivers_and_marks_are_switched(drawn, layer, colour):
    page = drawn(SLOPE + SHARP)
    until(page, "clastEditor.section.marks.some(({ kind, at }) => kind === 'note' && at.length)")
    red, green, blue = bytes.fromhex(colour)
    number = 0xFF000000 | blue << 16 | green << 8 | red
    page.click("summary >> text=Layers")
    for name in ("Water", "Slivers", "Marks of notes"):
        page.uncheck(f".layers label:has-text('{name}') input")
    assert number not in colours(page)
    page.check(f".layers label:has-text('{layer}') input")
    assert number in colours(page)


def test_pictures_show_the_section_its_title_and_legend(drawn, tmp_path):
    page = drawn(SLOPE)
    page.evaluate("clastEditor.goTo(['bolt', 2, 'start'])")
    page.click("summary >> text=Picture")
    with page.expect_download() as saved:
        page.click(".popup >> text=SVG")
    assert saved.value.suggested_filename == "slope.svg"
    saved.value.save_as(tmp_path / "out.svg")
    text = (tmp_path / "out.svg").read_text("utf-8")
    tree = ElementTree.fromstring(text)
    words = [one.text for one in tree.iter(f"{SVG}text")]
    assert "Slope in bedding, with water and cables" in words
    assert {"sandstone", "water level"} <= set(words)
    filled = [one.get("d") for one in tree.iter(f"{SVG}path") if one.get("fill") != "none"]
    assert sum(path.count("Z") for path in filled) >= 23
    assert "#d81b60" not in text  # of what is chosen
    with page.expect_download() as saved:
        page.click(".popup >> text=PNG")
    saved.value.save_as(tmp_path / "out.png")
    pixels = matplotlib.image.imread(tmp_path / "out.png")
    size = re.match(r'<svg [^>]*width="(\d+)" height="(\d+)"', text)
    assert pixels.shape[:2] == (3 * int(size[2]), 3 * int(size[1]))
    np.testing.assert_allclose(pixels[-5, -5, :3], 1.0)
    assert page.evaluate("clastEditor.section.place") == ["bolt", 2]


def test_a_pdf_has_the_section_alone_on_a_page_of_its_size(drawn):
    page = drawn(SLOPE)
    page.emulate_media(color_scheme="dark")
    page.evaluate("clastEditor.goTo(['bolt', 2, 'start'])")
    page.evaluate("window.print = () => { clastEditor.printed = true; }")
    page.click("summary >> text=Picture")
    page.click(".popup >> text=PDF")
    assert page.evaluate("clastEditor.printed")
    printed = page.pdf(prefer_css_page_size=True)
    assert re.findall(rb"/Count (\d+)", printed) == [b"1"]
    box = re.search(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", printed)
    width, height = page.evaluate(
        "[clastEditor.section.view.width, clastEditor.section.view.height]"
    )
    assert float(box[1]) == pytest.approx(0.75 * width, abs=1.0)
    assert 0.75 * height + 20 < float(box[2]) < 0.75 * height + 80  # title and legend below
    assert page.inner_text("#sheet") == ""  # the window is as it was
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    assert not page.is_visible("main")
    assert page.is_visible("#sheet svg")
    words = page.locator("#sheet text").all_text_contents()
    assert {"Slope in bedding, with water and cables", "sandstone", "15", "m"} <= set(words)
    assert "#d81b60" not in page.inner_html("#sheet")  # of what is chosen


def test_the_chosen_fills_the_view(drawn):
    page = drawn(SLOPE)
    page.evaluate("clastEditor.goTo(['bolt', 2, 'start'])")
    page.focus("#section canvas[tabindex]")
    page.keyboard.press("z")
    ends = page.evaluate(
        "[[21.07, 15.77], [10.23, 13.85]].map((point) => clastEditor.section.screen(point))"
    )
    width = page.evaluate("clastEditor.section.view.width")
    assert 0.3 * width < abs(ends[0][0] - ends[1][0]) < width
    assert all(0 < x < width for x, _ in ends)
