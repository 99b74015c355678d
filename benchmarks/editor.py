"""How long a person waits in the window of `clast edit`, and the memory that it takes.

    python -m benchmarks.editor    # some three minutes, on a machine that does nothing else

All is measured by wall time where a person sees it, in a browser without a graphics card: from a
key to the message at its field, from a slider to the lines of the joints, from the hand's rest
(with the tenth of a second until it counts as one) to new blocks.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from tests.scenes.browsers import CHROMIUM
from tests.scenes.edited import children, memory, rock_text, started

from clast.case.templates import TEMPLATES

SIZES = {100: 20.0, 1000: 66.0, 5000: 145.0}
"""Blocks, at least -> width of the rock mass, m."""
KEY, START, MEMORY = 30.0, 3.0, 400.0
"""Limits: ms, s, MB."""
LINES = {100: 33.0, 1000: 33.0, 5000: 50.0}
BLOCKS = {100: 100.0, 1000: 200.0, 5000: 600.0}
FRAMES = 30.0
"""Least of frames a second while a slider moves."""
SCRIPTS = {
    "keys": """async (count) => {
      const { hand, state, goTo } = clastEditor, took = [];
      goTo(["rock", "stone", "poisson"]);
      const field = () => document.querySelector("[data-key$='.poisson'] input[type=text]");
      while (!field()) await new Promise(requestAnimationFrame);
      field().focus();
      for (let k = 0; k < count; k++) {
        const one = field(), isBad = k % 2 === 0, begun = performance.now();
        one.value = isBad ? `0.7${k}` : `0.2${k}`;
        one.dispatchEvent(new Event("input", { bubbles: true }));
        const fault = () => document.querySelector("[data-key$='.poisson'] .fault")?.textContent;
        while (Boolean(fault()) !== isBad || hand.isBusy)
          await new Promise((done) => setTimeout(done));
        took.push(performance.now() - begun);
        await new Promise((done) => setTimeout(done, 60));
      }
      return took;
    }""",
    "lines": """async (seconds) => {
      const { hand, goTo } = clastEditor, frames = [];
      goTo(["joint_set", 0, "spacing"]);
      const slider = () => document.querySelector("input[aria-label='spacing slider']");
      while (!slider()) await new Promise(requestAnimationFrame);
      const before = hand.latency.length, end = performance.now() + 1000 * seconds;
      slider().dispatchEvent(new PointerEvent("pointerdown"));
      for (let k = 0, now = performance.now(); now < end; k++) {
        slider().value = 1.5 + 0.01 * (k % 20);
        slider().dispatchEvent(new Event("input", { bubbles: true }));
        now = await new Promise(requestAnimationFrame);
        frames.push(now);
      }
      while (hand.isBusy || hand.waiting.length) await new Promise(requestAnimationFrame);
      return [hand.latency.slice(before), 1000 * (frames.length - 1) / (frames.at(-1) - frames[0])];
    }""",
    "blocks": """async (count) => {
      const { hand, section } = clastEditor, took = [];
      for (let k = 0; k < count; k++) {
        while (!clastEditor.state.checked || hand.isBusy)
          await new Promise((done) => setTimeout(done, 20));
        const before = section.run, begun = performance.now();
        hand.edit([{ do: "set", place: ["joint_set", 0, "spacing"], toml: `1.5${k + 10}` }]);
        while (section.run === before) await new Promise((done) => setTimeout(done));
        took.push(performance.now() - begun);
      }
      return took;
    }""",
}
"""What a page does and times by itself, ms."""

Row = tuple[str, float, float, str]
"""What, its figure, its limit and its unit."""


def p95(values: Sequence[float]) -> float:
    """Return the value that nineteen of twenty stay below."""
    return statistics.quantiles(values, n=20, method="inclusive")[-1]


def measured(browser: Any, folder: Path, blocks: int, repeats: int) -> Iterator[Row]:
    """Give the rows of a rock mass of some ``blocks``, each measured ``repeats`` times."""
    file = folder / f"rock-{blocks}.toml"
    file.write_text(rock_text(SIZES[blocks], 0.7 * SIZES[blocks]), "utf-8")
    with started(file) as (editor, address):
        page = _opened(browser, address)
        page.evaluate(SCRIPTS["keys"], 6)
        yield (
            f"key to message, {blocks:,} blocks",
            p95(page.evaluate(SCRIPTS["keys"], 4 * repeats)),
            KEY,
            "ms",
        )
        page.evaluate(SCRIPTS["blocks"], 3)
        page.evaluate(SCRIPTS["lines"], 0.5)
        took, frames = page.evaluate(SCRIPTS["lines"], 0.2 * repeats)
        yield f"slider to lines, {blocks:,} blocks", p95(took), LINES[blocks], "ms"
        yield f"frames a second meanwhile, {blocks:,} blocks", frames, FRAMES, "at least"
        took = page.evaluate(SCRIPTS["blocks"], repeats)
        yield f"rest to blocks, {blocks:,} blocks", p95(took), BLOCKS[blocks], "ms"
        all_of_it = sum(memory(one) for one in (editor.pid, *children(editor.pid)))
        yield f"memory of server and worker, {blocks:,} blocks", all_of_it / 1e6, MEMORY, "MB"
        page.close()


def start(browser: Any, folder: Path) -> Row:
    """Return how long it takes from the command to the blocks of a template."""
    file, took = folder / "slope.toml", list[float]()
    file.write_text(TEMPLATES["slope"], "utf-8")
    for _ in range(3):
        begun = time.monotonic()
        with started(file) as (_, address):
            _opened(browser, address).close()
            took.append(time.monotonic() - begun)
    return "start to blocks, caches warm, the best of 3", min(took), START, "s"


def _opened(browser: Any, address: str) -> Any:
    page = browser.new_page(viewport={"width": 1400, "height": 900})
    page.goto(address)
    page.wait_for_selector("body[data-ready]")
    while not page.evaluate("clastEditor.section.run !== null"):
        page.wait_for_timeout(20)
    return page


def table(rows: Sequence[Row]) -> str:
    """Return rows as a table in Markdown."""
    lines = ["| what (p95 of wall time) | measured | limit |", "| --- | ---: | ---: |"]
    for what, value, limit, unit in rows:
        most = f"at least {limit:g}" if unit == "at least" else f"{limit:g} {unit}"
        lines.append(f"| {what} | {value:.3g} | {most} |")
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what was measured, and the load of the machine before."""
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(prog="python -m benchmarks.editor", description=__doc__)
    parser.add_argument("--size", default="100,1000,5000", help="blocks: some of these")
    parser.add_argument("--repeats", type=int, default=15, help="cuts that are timed")
    wishes = parser.parse_args(arguments)
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--disable-gpu"])
        rows = [start(browser, Path(folder))]
        for blocks in map(int, wishes.size.split(",")):
            rows += measured(browser, Path(folder), blocks, wishes.repeats)
        browser.close()
    sys.stdout.write(f"{table(rows)}\n\nload before: {load:.2f}\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
