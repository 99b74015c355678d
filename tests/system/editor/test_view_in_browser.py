"""The section beside a text editor, as a person sees it: blocks, faults and notes, live."""

import threading

import pytest

from clast.case.templates import TEMPLATES
from clast.editor.checking import check, checks
from clast.editor.view import ViewServer
from scenes.browsers import CHROMIUM, until

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]


@pytest.fixture
def window(opened, tmp_path):
    """Return a function that opens a text in a file."""
    ends = []

    def open_text(text):
        path, stop = tmp_path / "case.toml", threading.Event()
        path.write_text(text, "utf-8")
        server = ViewServer(("127.0.0.1", 0), path)

        def watch():
            for checked in checks(path):
                if checked is not None:
                    server.show(checked)
                if stop.is_set():
                    return

        for target, more in ((server.serve_forever, (0.01,)), (watch, ())):
            threading.Thread(target=target, args=more, daemon=True).start()
        page = opened(server)
        until(page, "globalThis.clastView?.shown.count > 0")
        ends.append((page, stop, server))
        return page, path

    yield open_text
    for page, stop, server in ends:
        page.close()
        stop.set()
        server.shutdown()
        server.server_close()


def shown(page, write):
    """Write into the file, and wait until the window shows it."""
    count = page.evaluate("clastView.shown.count")
    write()
    until(page, f"clastView.shown.count > {count}")
    page.evaluate(
        "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )


def colour_at(page, point, layer):
    """Return the colour of a place of the case, m, of the blocks or of what lies above them."""
    return page.evaluate(
        """([point, layer]) => {
          const { section } = clastView;
          const canvas = section[layer];
          const dots = canvas.width / section.view.width;
          const at = section.screen(point).map((one) => Math.round(one * dots));
          return [...canvas.getContext("2d").getImageData(...at, 1, 1).data].slice(0, 3);
        }""",
        [list(point), layer],
    )


def test_blocks_follow_the_file(window):
    page, path = window(SLOPE)
    assert page.inner_text("#file") == "Slope in bedding, with water and cables"
    assert page.inner_text("#counts").startswith("23 blocks")
    assert colour_at(page, (12.0, 21.0), "below") == [0xE0, 0xC9, 0xA0]
    assert colour_at(page, (31.0, 20.0), "below") == [0xFF, 0xFF, 0xFF]
    wide = SLOPE.replace("spacing = 3.5", "spacing = 7.0")
    assert wide != SLOPE
    shown(page, lambda: path.write_text(wide, "utf-8"))
    assert page.evaluate("clastView.section.run.blockCount") < 23
    page.focus("#section canvas[tabindex]")
    before = page.evaluate("clastView.section.view.scale")
    page.keyboard.press("+")
    assert page.evaluate("clastView.section.view.scale") > before
    shown(page, lambda: path.write_text(SLOPE, "utf-8"))
    assert page.evaluate("clastView.section.view.scale") > before  # what is looked at stays


def test_a_window_says_that_it_waits(browser, tmp_path):
    server = ViewServer(("127.0.0.1", 0), tmp_path / "case.toml")
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    page = browser.new_page()
    page.goto(server.address)
    assert "Reading the case" in page.inner_text(".wait")
    server.show(check(SLOPE, "case.toml"))
    until(page, "globalThis.clastView?.shown.count > 0")
    assert not page.is_visible(".wait")
    page.close()
    server.shutdown()
    server.server_close()


def test_a_fault_stands_at_its_line_and_its_place_and_goes(window):
    page, path = window(SLOPE)
    wrong = SLOPE.replace("at = [16.8, 23.8]", "at = [29.0, 20.0]")
    assert wrong != SLOPE
    shown(page, lambda: path.write_text(wrong, "utf-8"))
    line = wrong.splitlines().index("at = [29.0, 20.0]") + 1
    entry = page.inner_text("#list li.fault")
    assert f"line {line}, [[measured_point]] 1 'crest' at" in entry
    assert "lies outside every block" in entry
    assert colour_at(page, (29.0, 20.0), "above") == [0xD3, 0x2F, 0x2F]
    assert page.is_visible(".old")
    assert page.evaluate("clastView.section.run.blockCount") == 23
    shown(page, lambda: path.write_text(SLOPE, "utf-8"))
    assert page.query_selector("#list li.fault") is None
    assert not page.is_visible(".old")


def test_a_mark_and_its_entry_lead_to_each_other(window):
    page, _ = window(SLOPE)
    note = page.evaluate(
        "clastView.section.marks.find((one) => one.what.startsWith('cut: ')).at[0]"
    )
    box = page.evaluate(
        "(({ left, top }) => [left, top])(clastView.section.above.getBoundingClientRect())"
    )
    x, y = page.evaluate("(at) => clastView.section.screen(at)", note)
    page.mouse.click(box[0] + x, box[1] + y)
    assert page.evaluate("document.activeElement.textContent").startswith("line ")
    assert page.evaluate("clastView.section.lit.what").startswith("cut: ")
    page.evaluate("clastView.section.view.pan(5000, 0)")
    page.click("#list li >> nth=0")
    x, y = page.evaluate("(at) => clastView.section.screen(at)", note)
    assert 0 < x < 1200 and 0 < y < 760


def test_a_block_is_named_by_a_click(window):
    page, _ = window(SLOPE)
    x, y = page.evaluate("clastView.section.screen([12, 21])")
    box = page.evaluate(
        "(({ left, top }) => [left, top])(clastView.section.above.getBoundingClientRect())"
    )
    page.mouse.click(box[0] + x, box[1] + y)
    assert "sandstone" in page.inner_text("#section .place")
    assert "m²" in page.inner_text("#section .place")


def test_a_case_that_is_broken_from_the_start_shows_its_lines(window):
    broken = SLOPE.replace("spacing = 3.5", "spacing = -3.5")
    page, path = window(broken)
    assert page.query_selector("#list li.fault") is not None
    assert page.evaluate("clastView.section.lines.length") > 3
    assert page.evaluate("clastView.section.run") is None
    shown(page, lambda: path.write_text(SLOPE, "utf-8"))
    assert page.evaluate("clastView.section.run.blockCount") == 23


def test_names_in_a_case_are_text(window):
    evil = '<img src=x onerror="document.title=1">'
    text = SLOPE.replace('name = "crest"', f"name = '{evil}'").replace(
        "at = [16.8, 23.8]", "at = [99.0, 20.0]"
    )
    page, _ = window(text)
    assert evil in page.inner_text("#list li.fault")
    assert page.query_selector("#list img") is None
