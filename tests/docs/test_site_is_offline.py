"""The site as it is built: its pages ask no other host, and its search runs from the disk."""

import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import urlsplit

import pytest
import yaml

from scenes.browsers import CHROMIUM

ROOT = Path(__file__).parents[2]
LOADED = {
    "script": ["src"],
    "img": ["src", "srcset"],
    "iframe": ["src"],
    "link": ["href"],
    "source": ["src", "srcset"],
    "video": ["src", "poster"],
    "object": ["data"],
    "embed": ["src"],
}
"""Elements that load something, by the attributes that name it."""


class Loads(HTMLParser):
    """Collects what a page loads."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        if tag == "link" and given.get("rel") in ("canonical", "next", "prev", "alternate"):
            return
        self.found += [given[name] for name in LOADED.get(tag, ()) if given.get(name)]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Return the folder of the site, built anew."""
    if find_spec("zensical") is None:
        pytest.skip("zensical is not installed")
    folder = tmp_path_factory.mktemp("site")
    shutil.copytree(ROOT / "docs", folder / "docs")
    (folder / "src").symlink_to(ROOT / "src")
    (folder / "mkdocs.yml").write_text((ROOT / "mkdocs.yml").read_text("utf-8"), "utf-8")
    program = [sys.executable, "-m", "zensical", "build", "--strict"]
    done = subprocess.run(program, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "build" / "site"


def is_elsewhere(address):
    return bool(urlsplit(address.strip()).netloc)


@pytest.mark.slow
def test_no_page_loads_anything_from_another_host(site):
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 100
    for page in pages:
        text = page.read_text("utf-8")
        loads = Loads()
        loads.feed(text)
        styles = re.findall(r"(?:url\(|@import\s+)[\"']?(https?:)?//[^)\"']*", text)
        assert not [one for one in loads.found if is_elsewhere(one)], page
        assert not styles, page
    for style in site.rglob("*.css"):
        assert not re.search(r"(url\(|@import\s+)[\"']?(https?:)?//", style.read_text("utf-8")), (
            style
        )


@pytest.mark.slow
def test_in_a_browser_nothing_is_asked_for_and_the_search_finds_pages(site):
    driving = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    with driving.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page()
        asked, faults = [], []
        page.on("request", lambda one: asked.append(one.url))
        page.on("pageerror", lambda fault: faults.append(str(fault)))
        for name in ("index.html", "gallery.html", "theory/contact.html", "how-to/page.html"):
            page.goto((site / name).as_uri())
            page.wait_for_load_state("networkidle")
        page.keyboard.press("/")
        page.wait_for_timeout(1000)
        page.keyboard.type("nbconvert", delay=50)
        page.wait_for_selector("text=Read results >> visible=true", timeout=20_000)
        assert [one for one in asked if not one.startswith(("file:", "data:", "blob:"))] == []
        assert faults == []
        browser.close()


def test_the_builder_is_told_of_a_shim_of_our_own():
    text = re.sub(r"!!python/\S+", "", (ROOT / "mkdocs.yml").read_text("utf-8"))
    config = yaml.safe_load(text)
    assert config["theme"]["font"] is False
    paths = [one["path"] for one in config["extra"]["polyfills"]]
    assert any("iframe-worker" in path for path in paths)  # by this name the builder looks for it
    for path in [*paths, *config["extra_css"]]:
        assert not is_elsewhere(path) and (ROOT / "docs" / path).is_file()
