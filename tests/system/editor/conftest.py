"""A browser for the windows of cases, and pages of it that say nothing and ask nobody else."""

from contextlib import ExitStack

import pytest

from clast.case.checking import check
from clast.case.templates import TEMPLATES
from clast.editor.server import EditServer
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
def window(opened, tmp_path):
    """Return a function that opens a text in a file; it gives page, file and server."""
    with ExitStack() as ends:

        def open_text(text, name="case.toml", kind=EditServer):
            file = tmp_path / name
            file.write_text(text, "utf-8", newline="")
            # kernels are compiled before the window is waited for
            check(text or TEMPLATES["slope"], str(file))
            server = ends.enter_context(edited_file(file, kind))
            page = opened(server)
            ends.callback(page.close)
            page.wait_for_selector("body[data-ready]")
            return page, file, server

        yield open_text


@pytest.fixture
def drawing(window):
    """Return a function that opens a text as case.toml; it gives the hand in its window."""

    def open_text(text):
        page, _, _ = window(text)
        if not text:
            page.wait_for_selector("#start[open]")
            page.keyboard.press("Escape")  # begins with nothing at all
        until(page, "clastEditor.section.origin !== null && clastEditor.state.sections > 0")
        # messages of the check take room from the section, which is fitted anew until it is moved
        until(page, "clastEditor.state.checked || clastEditor.state.faults.length > 0")
        return Hand(page)

    return open_text
