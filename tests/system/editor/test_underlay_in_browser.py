"""A new case drawn after a drawing and a picture that lie under the section."""

import json

import ezdxf
import matplotlib.image
import numpy as np
import pytest

from scenes.browsers import CHROMIUM, until
from scenes.edited import edited_file

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
RIM = [(0, 0), (20_000, 0), (20_000, 10_000), (0, 10_000)]


@pytest.fixture
def window(opened, served):
    """Return the window of that case, and its path."""
    page = opened(served)
    page.wait_for_selector("body[data-ready]")
    yield page, served.document.path
    page.close()


@pytest.fixture
def served(tmp_path):
    """Return the server of a case that is not there yet, beside a drawing and a picture."""
    document = ezdxf.new("R2010", units=4)
    sheet = document.modelspace()
    for one, other in zip(RIM, RIM[1:] + RIM[:1], strict=True):
        sheet.add_line(one, other, dxfattribs={"layer": "Umriss"})
    for y in (2_000, 5_000):
        sheet.add_line((0, y), (20_000, y + 500), dxfattribs={"layer": "JOINTS_bedding"})
    sheet.add_lwpolyline([(0, 7_000), (20_000, 4_000)], dxfattribs={"layer": "Wasser"})
    document.saveas(tmp_path / "site.dxf")
    pixels = np.full((60, 120, 3), 255, np.uint8)
    pixels[:30, :60] = (200, 30, 30)
    matplotlib.image.imsave(tmp_path / "scan.png", pixels)
    with edited_file(tmp_path / "new.toml") as server:
        yield server


def add(page, file):
    page.fill(".under input[name=file]", file)
    page.click(".under form button")
    there = "images.get('{0}')?.bitmap" if file.endswith("png") else "drawings['{0}']?.lines"
    until(page, f"Boolean(clastEditor.under.{there.format(file)})")


def click(page, point):
    until(page, "!clastEditor.hand.isBusy && !clastEditor.state.is_cutting")
    page.wait_for_timeout(300)  # faults below the section come and go
    box = page.locator("#section canvas[tabindex]").bounding_box()
    x, y = page.evaluate("(point) => clastEditor.section.screen(point)", point)
    page.mouse.click(box["x"] + x, box["y"] + y)


def take(page, role, point):
    page.select_option(".under select", label=role)
    click(page, point)
    page.locator(".said", has_text=f"Taken over as {role}").wait_for()


def test_lines_of_a_drawing_become_tables_of_the_case(window):
    page, path = window
    page.click("dialog >> text=an empty section")
    until(page, "clastEditor.state.faults.length === 4")
    page.click("summary >> text=Underlay")
    add(page, "site.dxf")
    page.click(".under >> text=zoom to it")
    take(page, "domain boundary", (3, 0))
    assert page.evaluate("clastEditor.state.content.domain.boundary") == [
        [0, 0],
        [20, 0],
        [20, 10],
        [0, 10],
    ]
    before = page.evaluate("clastEditor.state.undo[0]")
    page.select_option(".under select", label="trace")
    page.click(".under p:has-text('JOINTS_bedding') button")
    until(page, "clastEditor.state.content.trace?.length === 2")
    assert page.evaluate("clastEditor.state.undo[0]") == before + 1
    assert page.evaluate("clastEditor.state.content.trace[1].points") == [[0, 5], [20, 5.5]]
    take(page, "water", (4, 6.4))
    assert page.evaluate("clastEditor.state.chosen") == ["water", 0]
    page.select_option(".under select", label="opening")
    click(page, (4, 6.4))
    page.locator(".said", has_text="is not part of a closed outline").wait_for()
    page.locator("label:has-text('Wasser') input").click()
    page.select_option(".under select", label="water")
    click(page, (4, 6.4))
    page.locator(".said", has_text="There is no line").wait_for()
    kept = json.loads(path.with_name("new.edit.json").read_text("utf-8"))
    assert kept["underlays"][0]["hidden"] == ["Wasser"]
    assert not path.exists()
    assert "site.dxf" not in page.evaluate("clastEditor.state.text")
    given = {
        ("rock", "rock", "young"): "5 GPa",
        ("rock", "rock", "poisson"): "0.2",
        ("rock", "rock", "density"): "2600",
        ("joint", "default", "friction_angle"): "30",
    }
    for place, number in given.items():
        page.evaluate("(place) => clastEditor.goTo(place)", list(place))
        page.keyboard.press("Control+a")
        page.keyboard.type(number)
    until(page, "clastEditor.state.unsaved === false && clastEditor.state.blocks === 3")
    assert path.read_text("utf-8") == page.evaluate("clastEditor.state.text")


def test_a_picture_is_placed_by_two_points(window):
    page, _ = window
    page.click("dialog li >> text=slope")
    until(page, "clastEditor.section.run !== null")
    page.click("summary >> text=Underlay")
    add(page, "scan.png")
    where = """(pixel) => {
      const { under } = clastEditor, [A, B, x, y] = under.placeOf(under.list[0]);
      return [A * pixel[0] + B * pixel[1] + x, B * pixel[0] - A * pixel[1] + y];
    }"""
    for number, (pixel, place) in enumerate([((0, 60), (4, 5)), ((120, 60), (28, 5))]):
        page.click(f".under p:has-text('point {number + 1}') button")
        click(page, page.evaluate(where, pixel))
        for value in place:
            page.keyboard.type(str(value))
            page.keyboard.press("Tab")
    until(page, "clastEditor.under.list[0].points !== null")
    corner = page.evaluate(where, [0, 60])
    scale = page.evaluate("clastEditor.section.view.scale")
    np.testing.assert_allclose(corner, [4, 5], atol=0.06 + 1 / scale)  # pixels have one decimal
    np.testing.assert_allclose(page.evaluate(where, [0, 0])[1], 17, atol=0.2)
    page.locator(".under input[type=range]").fill("1")
    page.locator(".under >> text=locked").click()
    until(page, "clastEditor.under.list[0].locked && clastEditor.under.list[0].opacity === 1")
    colour = """async (point) => {
      const frame = () => new Promise((done) => requestAnimationFrame(done));
      const { section } = clastEditor;
      do await frame(); while (section.waiting);
      const at = section.screen(point).map(Math.round);
      return [...section.above.getContext("2d").getImageData(...at, 1, 1).data].slice(0, 3);
    }"""
    assert page.evaluate(colour, [5, 16]) == [200, 30, 30]
    assert page.locator(".under >> text=click it").count() == 0
    page.reload()
    until(page, "Boolean(globalThis.clastEditor?.under.images.get('scan.png')?.bitmap)")
    assert page.evaluate("clastEditor.under.list[0].opacity") == 1


def test_a_window_that_looks_on_lays_nothing_under(window, served, opened):
    page, path = window
    page.click("dialog li >> text=slope")
    until(page, "clastEditor.section.run !== null")
    other = opened(served)
    until(other, "globalThis.clastEditor?.state.looks_on === true")
    other.click("summary >> text=Underlay")
    other.fill(".under input[name=file]", "site.dxf")
    other.click(".under form button")
    other.locator(".said", has_text="is edited in another window").wait_for()
    assert other.evaluate("clastEditor.under.list") == []
    assert not path.with_name("new.edit.json").exists()
    page.click("summary >> text=Underlay")
    add(page, "site.dxf")
    until(other, "clastEditor.under.drawings['site.dxf']?.lines.length === 7")
    other.close()


def test_files_that_change_on_disk_are_drawn_anew(window):
    page, path = window
    page.click("dialog >> text=an empty section")
    page.click("summary >> text=Underlay")
    lines = path.with_name("lines.csv")
    lines.write_text("x1,y1,x2,y2\n0,0,8,0\n", "utf-8")
    for file in ("lines.csv", "scan.png"):
        add(page, file)
    lines.write_text("x1,y1,x2,y2\n0,0,8,0\n0,2,8,3\n", "utf-8")
    matplotlib.image.imsave(path.with_name("scan.png"), np.zeros((30, 90, 3), np.uint8))
    until(page, "clastEditor.under.drawings['lines.csv'].lines.length === 2")
    until(page, "clastEditor.under.images.get('scan.png')?.bitmap.width === 90")
    lines.unlink()
    page.locator(".under .fault", has_text="there is no such file").wait_for()
