"""The window for everybody: axe-core, small windows, large letters, touch, keys alone."""

from importlib.resources import files

import pytest

from clast.case.templates import TEMPLATES
from scenes.browsers import CHROMIUM, until
from scenes.edited import edited_file

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
SLOPE = TEMPLATES["slope"]
RUN = """(under) => axe.run(under).then(({ violations, passes }) => ({
  found: violations.map(({ id, nodes }) => `${id}: ${nodes[0].html.slice(0, 200)}`),
  passed: passes.map(({ id }) => id),
}))"""


@pytest.fixture
def window(browser, tmp_path):
    """Return a function that opens a case in a window of some kind."""
    ends = []

    def open_window(text=SLOPE, **kind):
        path = tmp_path / "slope.toml"
        if text:
            path.write_text(text, "utf-8")
        serving = edited_file(path)
        server = serving.__enter__()
        page = browser.new_page(**{"viewport": {"width": 1280, "height": 720}, **kind})
        ends.append((page, serving))
        page.goto(server.address)
        page.wait_for_selector("body[data-ready]")
        return page

    yield open_window
    for page, serving in ends:
        page.close()
        serving.__exit__(None, None, None)


def findings(page):
    """Return what axe-core objects to."""
    axe = pytest.importorskip("axe_playwright_python")
    page.evaluate((files(axe) / "axe.min.js").read_text("utf-8"))
    result = page.evaluate(RUN, "body")
    assert {"color-contrast", "button-name", "label"} <= set(result["passed"])
    return result["found"]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_in_any_part(window, scheme, tmp_path):
    page = window(color_scheme=scheme)
    until(page, "clastEditor.section.run !== null")
    assert findings(page) == []
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    page.fill("#search", "joint")
    assert findings(page) == []
    page.press("#search", "Escape")
    page.click(".form >> text=reference")
    assert findings(page) == []
    page.keyboard.press("Escape")
    page.click("summary >> text=Underlay")
    page.fill(".under input[name=file]", "slope.toml")
    page.click(".under form button")
    page.locator(".under .fault").wait_for()
    for table in (["joint_set", 0], ["domain"], ["stage", 0], ["water", 0], ["amplitude", "rise"]):
        page.evaluate("(place) => clastEditor.goTo(place)", table)
        for part in page.locator(".copies:not([open]) summary").all():
            part.click()
        assert findings(page) == []
    friction = {"do": "set", "place": ["joint", "bedding", "friction_angle"], "toml": "95"}
    page.evaluate("(edit) => clastEditor.hand.edit([edit])", friction)
    page.evaluate("clastEditor.goTo(['joint', 'bedding', 'friction_angle'])")
    page.locator("#faults .fault").wait_for()
    assert findings(page) == []
    (tmp_path / "slope.toml").write_text(TEMPLATES["lined-tunnel"], "utf-8")
    page.locator("#conflict pre").wait_for()  # another program wrote the file meanwhile
    assert findings(page) == []
    page.evaluate("document.querySelector('#faults').append(document.createElement('button'))")
    assert findings(page)[0].startswith("button-name")  # it would be found


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_where_a_case_begins(window, scheme):
    page = window(text="", color_scheme=scheme)
    page.locator("dialog[open]").wait_for()
    assert findings(page) == []


SIZES = {
    "as a small screen": {"viewport": {"width": 1280, "height": 720}},
    "125 %": {"viewport": {"width": 1024, "height": 576}, "device_scale_factor": 1.25},
    "200 %": {"viewport": {"width": 640, "height": 360}, "device_scale_factor": 2},
    "tablet": {"viewport": {"width": 820, "height": 1180}, "has_touch": True},
}


@pytest.mark.parametrize("size", SIZES)
def test_all_parts_have_room(window, size):
    page = window(**SIZES[size])
    until(page, "clastEditor.section.run !== null")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    for part, wide, tall in (("#section canvas", 300, 150), (".form", 280, 150), ("nav", 100, 150)):
        page.locator(part).first.scroll_into_view_if_needed()
        box = page.locator(part).first.bounding_box()
        assert box["width"] > wide, part
        assert box["height"] > tall, part
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= SIZES[size]["viewport"]["width"] + 1
    if "has_touch" in SIZES[size]:
        page.locator("#section canvas[tabindex]").scroll_into_view_if_needed()
        box = page.locator("#section canvas[tabindex]").bounding_box()
        x, y = page.evaluate("clastEditor.section.screen([4, 14])")
        page.touchscreen.tap(box["x"] + x, box["y"] + y)
        until(page, "clastEditor.section.state.chosen >= 0")


def test_keys_alone_lead_to_every_part_and_show_where_they_are(window):
    page = window()
    until(page, "clastEditor.section.run !== null")
    page.click("h1")
    met = set()
    for _ in range(400):
        page.keyboard.press("Tab")
        where, outline = page.evaluate(
            """() => {
              const at = document.activeElement;
              const part = at.closest("header, nav, .form, #section, #below");
              const name = part?.id || part?.className || part?.tagName;
              return [name, getComputedStyle(at).outlineStyle];
            }"""
        )
        if where:
            met.add(where)
            assert outline != "none", where
        if met >= {"HEADER", "NAV", "form", "section", "below"}:
            break
    assert met >= {"HEADER", "NAV", "form", "section", "below"}


def test_a_fault_is_announced_once(window):
    """Only one live region has its words, and what is told again is not another node."""
    page = window()
    until(page, "clastEditor.section.run !== null")
    page.evaluate("clastEditor.goTo(['joint', 'bedding', 'friction_angle'])")
    page.keyboard.press("Control+a")
    page.keyboard.type("95")
    page.locator(".row .fault", has_text="must be below 90").wait_for()
    page.evaluate(
        """() => {
          globalThis.added = 0;
          const seen = new MutationObserver((some) => { added += some.length; });
          const all = [...document.querySelectorAll("[aria-live], [role=alert], [role=status]")];
          const own = all.filter((one) => one.textContent.includes("must be below 90"));
          globalThis.regions = own.length;
          const all_of_it = { childList: true, characterData: true, subtree: true };
          for (const one of own) seen.observe(one, all_of_it);
        }"""
    )
    page.evaluate("clastEditor.hand.edit([{ do: 'set', place: ['title'], toml: '\"b\"' }])")
    until(page, "clastEditor.state.content.title === 'b'")
    page.wait_for_timeout(500)
    assert page.evaluate("[regions, added]") == [1, 0]
