"""Frames of the window while a slider moves: how often lines follow, by its processor time."""

import os
import subprocess
import sys

import pytest

from scenes.browsers import CHROMIUM, until
from scenes.edited import rock_text

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no browser")
FRAME = 1 / 30
SECONDS = 3.0
DRAG = """async (seconds) => {
  const { section } = clastEditor, slider = document.querySelector("[aria-label='angle slider']");
  const { set } = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
  const move = section.move.bind(section), begun = performance.now(), drawn = section.root.dataset;
  const before = Number(drawn.drawn);
  let [moves, frames] = [0, 0];
  section.move = (lines) => { moves += 1; move(lines); };
  slider.dispatchEvent(new PointerEvent("pointerdown"));
  while (performance.now() < begun + 1000 * seconds) {
    set.call(slider, String(5 + 20 * Math.sin(++frames / 40)));
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    await new Promise((done) => requestAnimationFrame(done));
  }
  section.move = move;
  return [frames, Number(drawn.drawn) - before, moves];
}"""


def seconds_of(process):
    """Return the processor time of a process, s."""
    with open(f"/proc/{process.pid}/stat") as file:
        ticks = file.read().rpartition(")")[2].split()[11:13]
    return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")


@pytest.mark.parametrize(("width", "height", "blocks"), [(40, 70, 1000), (90, 160, 5000)])
def test_lines_follow_a_slider_thirty_times_a_second(tmp_path, width, height, blocks):
    playwright = pytest.importorskip("playwright.sync_api")
    file = tmp_path / "rock.toml"
    file.write_text(rock_text(width, height), "utf-8")
    command = [sys.executable, "-m", "clast", "edit", str(file)]
    editor = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        line = next(one for one in editor.stderr if "http://" in one)
        with playwright.sync_playwright() as started:
            browser = started.chromium.launch(executable_path=CHROMIUM, args=["--disable-gpu"])
            page = browser.new_page(viewport={"width": 1400, "height": 900})
            page.goto(line[line.index("http://") :].strip())
            page.wait_for_selector("body[data-ready]")
            until(page, "clastEditor.section.run !== null && clastEditor.state.checked")
            assert page.evaluate("clastEditor.section.run.blockCount") > blocks
            page.evaluate("clastEditor.goTo(['joint_set', 0])")
            cdp = page.context.new_cdp_session(page)
            cdp.send("Performance.enable", {"timeDomain": "threadTicks"})

            def main_thread():
                metrics = cdp.send("Performance.getMetrics")["metrics"]
                return next(one["value"] for one in metrics if one["name"] == "TaskDuration")

            times = main_thread(), seconds_of(editor)
            frames, drawn, moves = page.evaluate(DRAG, SECONDS)
            of_page, of_server = main_thread() - times[0], seconds_of(editor) - times[1]
            browser.close()
    finally:
        editor.kill()
        editor.wait()
    rates, costs = (frames, moves), (of_page / drawn, of_server / moves)
    said = "{} blocks: {:.0f} frames, {:.0f} lines a second; page {:.1f} ms, server {:.1f} ms"
    said = said.format(blocks, *(one / SECONDS for one in rates), *(1e3 * one for one in costs))
    print(said)
    assert min(drawn, moves) > 10, said
    assert max(costs) < FRAME, said
