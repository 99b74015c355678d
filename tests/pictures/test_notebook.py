"""Runs in a notebook: their page as widget and as frame, their picture, and their rich reprs."""

import json
import re
import sys

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.pictures.notebook import PageFrame, page_view
from clast.pictures.page.document import BUDGET, widget_script
from clast.pictures.page.scene import scene_of
from scenes.browsers import CHROMIUM, RENDERERS, until

NASTY = "</table><script>alert(1)</script> \"'&\u202e\U0001f600"


def test_a_run_has_its_picture(parted, tmp_path):
    picture = parted.plot(field="slip", contacts=False)
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert picture.save(tmp_path / "a.svg").stat().st_size > 5000
    with pytest.raises(CaseError, match="no field 'slipp'"):
        parted.plot(field="slipp")


def test_without_anywidget_the_page_is_in_a_frame(parted, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    page = parted.page()
    assert isinstance(page, PageFrame)
    text = page._repr_html_()
    assert text.startswith("<iframe srcdoc=") and 'sandbox="allow-scripts allow-downloads"' in text
    # nothing of the page ends the attribute
    assert re.fullmatch(r'<iframe srcdoc="[^"]*" sandbox="[^"]*" style="[^"]*"></iframe>', text)


def test_with_anywidget_it_is_a_widget(wall):
    pytest.importorskip("anywidget")
    scene = scene_of(wall(2, 3, title=NASTY), 1e6)
    widget = page_view(scene)
    assert json.loads(widget.scene)["title"] == NASTY
    assert "export default" in widget_script()


def test_the_output_of_a_widget_has_the_page_beside_it(parted):
    pytest.importorskip("anywidget")
    data, _ = parted.page()._repr_mimebundle_()
    assert data["application/vnd.jupyter.widget-view+json"]["model_id"]
    assert data["text/html"] == PageFrame(scene_of(parted, BUDGET))._repr_html_()


@pytest.mark.parametrize("renderer", RENDERERS)
def test_a_page_survives_saving_and_nbconvert(parted, tmp_path, renderer):
    pytest.importorskip("anywidget")
    nbformat = pytest.importorskip("nbformat", reason="nbformat is not installed")
    nbconvert = pytest.importorskip("nbconvert", reason="nbconvert is not installed")
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    data, about = parted.page()._repr_mimebundle_()
    output = nbformat.v4.new_output("execute_result", data, metadata=about, execution_count=1)
    cell = nbformat.v4.new_code_cell("run.page()", outputs=[output], execution_count=1)
    saved = tmp_path / "run.ipynb"
    nbformat.write(nbformat.v4.new_notebook(cells=[cell]), saved)
    text, _ = nbconvert.HTMLExporter().from_filename(str(saved))
    (tmp_path / "run.html").write_text(text, encoding="utf-8")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", *RENDERERS[renderer]]
        )
        page = browser.new_page(viewport={"width": 1200, "height": 900})
        # what the notebook's own frame asks other hosts for does not matter
        page.route("http*://**", lambda route: route.abort())
        faults = []
        page.on("pageerror", lambda fault: faults.append(str(fault)))
        page.goto((tmp_path / "run.html").as_uri())
        page.wait_for_selector("iframe")
        frame = page.frames[-1]
        frame.wait_for_selector("main[data-ready=yes]", timeout=60_000)
        drawn = frame.evaluate("Array.from(clastPage.run.vertices(clastPage.state.frame))")
        origin = frame.evaluate("clastPage.run.scene.origin")
        assert np.abs(np.reshape(drawn, (-1, 2)) + origin - parted.vertices(-1)).max() < 1e-5
        frame.click("[data-part=back]")
        until(frame, f"clastPage.state.frame === {len(parted.times) - 2}")
        # the notebook's own scripts may miss the libraries that they load from elsewhere
        assert not [fault for fault in faults if "require" not in fault and "MathJax" not in fault]
        browser.close()


@pytest.mark.parametrize("title", ["A wall", NASTY])
def test_what_a_run_and_its_model_look_like(wall, title):
    results = wall(3, 4, title=title)
    text = results._repr_html_()
    assert text.count("<path") == 12 and "12" in text and "top" in text
    assert "<script" not in text and "</table><s" not in text
    history = results.history("top")
    text = history._repr_html_()
    assert text.count("<path") == 2 and "Measured point top" in text
    assert ">displacement_x (m)</text>" in text and "<th>velocity_y (m/s)</th>" in text


def test_models_cases_and_runs_have_reprs(parted, tmp_path):
    assert parted.model._repr_html_().count("<path") == 3
    assert parted._repr_html_().count("<path") == 3
    assert "3 (1 fixed)" in parted.model._repr_html_()
    case = clast.Case.validated({**BROKEN, "block": BROKEN["block"][:1]}, "test")
    assert case._repr_html_().count("<path") == 1 and "convex" in case._repr_html_()
    broken = clast.Case.validated(BROKEN, "test")
    assert "cannot be built" in broken._repr_html_()
    contacts = parted.contacts(-1)._repr_html_()
    assert "<table>" in contacts and ">slide</td>" in contacts and "slip (m)" in contacts
    steps = parted.steps._repr_html_()
    assert "Steps" in steps and ">20</td>" in steps and "penetration (m)</text>" in steps
    energy = parted.energy._repr_html_()
    assert energy.count("<path") == 4 and "t = 0 to 0.04 s" in energy
    block = parted.block("moved")._repr_html_()
    assert "Block moved" in block and "stress_yy (Pa)" in block


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
BROKEN = {
    "time": {"step": 1e-3, "end": 0.1},
    "rock": {"rock": {"young": 5e9, "poisson": 0.2, "density": 2500.0}},
    "block": [
        {"name": "a", "vertices": SQUARE},
        {"name": "b", "vertices": [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]]},
    ],
}


COUNT_CONTEXTS = """
  globalThis.contexts = [];
  const { getContext } = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    const found = getContext.call(this, kind, ...more);
    if (kind === "webgl2" && found) contexts.push(found);
    return found;
  };
"""


def test_the_widget_draws_in_a_shadow_tree_and_leaves_the_address(parted):
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    scene = scene_of(parted, 1e6)
    with playwright.sync_playwright() as driver:
        for renderer in RENDERERS.values():
            browser = driver.chromium.launch(
                executable_path=CHROMIUM, args=["--no-sandbox", *renderer]
            )
            page = browser.new_page(viewport={"width": 900, "height": 700})
            faults = []
            page.on("pageerror", lambda fault, found=faults: found.append(str(fault)))
            page.add_init_script(COUNT_CONTEXTS)
            page.goto("about:blank")
            page.set_content("<h1>Notebook</h1><div id='a'></div><div style='height:3000px'></div>")
            before = page.evaluate("getComputedStyle(document.querySelector('h1')).fontSize")
            page.evaluate(
                """async ([script, scene]) => {
                  const blob = new Blob([script], { type: "text/javascript" });
                  const { default: widget } = await import(URL.createObjectURL(blob));
                  const el = document.getElementById("a");
                  globalThis.away = widget.render({ model: { get: () => scene }, el });
                  await el.clastPage.ready;
                }""",
                [widget_script(), json.dumps(scene)],
            )
            drawn = page.evaluate("Array.from(a.clastPage.run.vertices(a.clastPage.state.frame))")
            away = np.reshape(drawn, (-1, 2)) + scene["origin"] - parted.vertices(-1)
            assert np.abs(away).max() < 1e-5
            assert page.evaluate("location.hash") == ""
            assert (
                page.evaluate("getComputedStyle(document.querySelector('h1')).fontSize") == before
            )
            # out of sight the graphics card is let go, in sight it is drawn again
            page.evaluate("a.clastPage.rest(); a.clastPage.wake(); a.clastPage.draw()")
            page.evaluate("away()")
            until(page, "contexts.every((gl) => gl.isContextLost())")
            assert page.evaluate("contexts.length") > 0 or renderer == RENDERERS["canvas"]
            assert faults == []
            browser.close()
