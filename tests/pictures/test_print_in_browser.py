"""What comes out of the printer: angles, light colours, and in words what the picture is of."""

import io
import os
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

import clast
from scenes.browsers import settled

DIP = 35.0
SLAB = np.array([0xE0, 0xC9, 0xA0])
WINDOWS = [(390, 844), (1600, 500), (800, 1400)]


@pytest.fixture(scope="module")
def bedding(tmp_path_factory):
    """Return the run of a slab of 10 m by 1 m on a bed that dips by 35 degrees."""
    builder = clast.ModelBuilder(title="Bedding", gravity=(0.0, -9.81))
    builder.add_rock("marl", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=50.0)
    along = np.array([np.cos(np.radians(DIP)), np.sin(np.radians(DIP))])
    up = np.array([-along[1], along[0]])
    for name, low, high in (("bed", -3.0, 0.0), ("slab", 0.0, 1.0)):
        ends = [low * up, 10.0 * along + low * up, 10.0 * along + high * up, high * up]
        builder.block(name=name, vertices=[tuple(one) for one in ends], fixed=name == "bed")
    path = tmp_path_factory.mktemp("bedding") / "bedding.vtkhdf"
    return clast.simulate(builder.build(), step=5e-3, end=0.02, every=0.01, output=path)


def looks(content):
    """Return dip of the slab, degrees, its length over its thickness, and the commonest colour."""
    pixels = np.asarray(Image.open(io.BytesIO(content)).convert("RGB")).astype(int)
    # the legend has its colour, too
    parts, _ = ndimage.label(np.abs(pixels - SLAB).max(axis=2) < 8)
    rows, columns = np.nonzero(parts == np.bincount(parts.ravel())[1:].argmax() + 1)
    assert len(rows) > 500
    spread, ways = np.linalg.eigh(np.cov(columns, -rows))
    dip = np.degrees(np.arctan2(*ways[::-1, 1])) % 180.0
    colours, count = np.unique(pixels.reshape(-1, 3), axis=0, return_counts=True)
    return dip, np.sqrt(spread[1] / spread[0]), colours[count.argmax()].tolist()


@pytest.mark.parametrize("size", WINDOWS)
def test_paper_keeps_angles_and_is_light(opened, bedding, size):
    """The stage has another shape on paper than on the screen; the dip is that of the rock."""
    page = opened(bedding, *size, address="#field=rock&layers=", color_scheme="dark")
    assert page.get_attribute("main", "data-theme") == "dark"
    page.emulate_media(media="print")
    settled(page)
    dip, slender, paper = looks(page.screenshot(full_page=True))
    assert dip == pytest.approx(DIP, abs=0.2)
    assert slender == pytest.approx(10.0, rel=0.1)
    assert paper == [255, 255, 255]
    said = page.inner_text("main").replace("\xa0", " ")
    assert "Colours: Rock; t = 20 ms" in said
    page.emulate_media(media="screen")
    page.wait_for_selector("main[data-theme=dark]", timeout=20_000)
    settled(page)
    assert looks(page.screenshot())[0] == pytest.approx(DIP, abs=0.2)
    assert page.locator(".picture").count() == 0


@pytest.mark.parametrize("size", WINDOWS)
def test_angles_are_kept_where_a_browser_tells_nothing_of_printing(opened, bedding, size):
    page = opened(bedding, *size, address="#field=rock&layers=")
    page.evaluate("clastPage.ending.abort()")
    # some browsers do not tell of the new size either
    page.evaluate("clastPage.resize = () => {}")
    page.emulate_media(media="print")
    settled(page)
    dip, slender, _ = looks(page.screenshot(full_page=True))
    assert dip == pytest.approx(DIP, abs=0.2) and slender == pytest.approx(10.0, rel=0.1)


def test_paper_says_limits_file_version_and_days(opened, bedding):
    os.utime(bedding.output, (1.7e9, 1.7e9))  # 14 November 2023
    page = opened(clast.read(bedding.output), address="#field=sigma_yy&layers=")
    assert not page.is_visible("[data-part=paper]")
    page.emulate_media(media="print")
    settled(page)
    said = page.inner_text("[data-part=paper]")
    low, high = page.evaluate("['low', 'high'].map((end) => Number(clastPage.$(end).value))")
    assert high == 0.0
    assert f"σyy, tension positive from −{-low / 1e3:.4g} kPa to 0 Pa; t = 20 ms." in said
    made = f"File bedding.vtkhdf of 14 November 2023, made by clast {clast.__version__}"
    today = page.evaluate(
        "new Date().toLocaleDateString('en-GB', {day: 'numeric', month: 'long', year: 'numeric'})"
    )
    assert f"{made}; printed on {today}." in said
    assert page.inner_text("[data-part=charted]") == "Reaction fixed blocks, force"
    assert "Click a block" not in page.inner_text("main")
    page.emulate_media(media="screen")
    page.fill("[data-part=low]", "-20000")
    page.fill("[data-part=high]", "10000")
    page.press("[data-part=high]", "Enter")
    settled(page)
    page.emulate_media(media="print")
    said = page.inner_text("[data-part=paper]")
    assert "from −20 kPa to 10 kPa, limits chosen by hand; " in said


@pytest.mark.skipif(shutil.which("pdftoppm") is None, reason="pdftoppm is not installed")
@pytest.mark.parametrize("landscape", [False, True])
def test_a_printed_file_keeps_angles(opened, bedding, tmp_path, landscape):
    page = opened(bedding, 390, 844, address="#field=rock&layers=&theme=dark")
    page.pdf(path=tmp_path / "page.pdf", format="A4", landscape=landscape)
    drawn = ["pdftoppm", "-r", "100", "-f", "1", "-l", "1", "-png", tmp_path / "page.pdf"]
    dip, slender, paper = looks(subprocess.run(drawn, capture_output=True, check=True).stdout)
    assert dip == pytest.approx(DIP, abs=0.2) and slender == pytest.approx(10.0, rel=0.1)
    assert paper == [255, 255, 255]
