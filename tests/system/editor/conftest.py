"""A browser for the windows of cases, and pages of it that say nothing and ask nobody else."""

import pytest

from scenes.browsers import CHROMIUM


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
