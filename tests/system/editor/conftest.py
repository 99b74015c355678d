"""A browser for the windows of cases, and pages of it that say nothing and ask nobody else."""

import pytest

from clast.case.templates import TEMPLATES
from clast.editor.checking import check
from scenes.browsers import CHROMIUM, until
from scenes.edited import edited_file
from scenes.hands import Hand


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=CHROMIUM, args=["--disable-gpu"])
        yield browser
        browser.close()


@pytest.fixture
def opened(browser):
    """Return a function that opens the page of a server; its user closes it."""
    said, asked = [], []

    def open_page(server):
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: asked.append((request.url, server.port)))
        page.goto(server.address)
        return page

    yield open_page
    assert said == []
    assert [url for url, port in asked if not url.startswith(f"http://127.0.0.1:{port}/")] == []


@pytest.fixture
def drawing(opened, tmp_path):
    """Return a function that opens a text as case.toml; it gives the hand in its window."""
    windows = []

    def open_text(text):
        path = tmp_path / "case.toml"
        path.write_text(text, "utf-8", newline="")
        check(text or TEMPLATES["slope"], str(path))  # kernels are compiled before the window waits
        serving = edited_file(path)
        page = opened(serving.__enter__())
        windows.append((page, serving))
        page.wait_for_selector("body[data-ready]")
        if not text:
            page.wait_for_selector("#start[open]")
            page.keyboard.press("Escape")  # begins with nothing at all
        until(page, "clastEditor.section.origin !== null && clastEditor.state.sections > 0")
        return Hand(page)

    yield open_text
    for page, serving in windows:
        page.close()
        serving.__exit__(None, None, None)
