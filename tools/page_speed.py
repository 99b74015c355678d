"""Measure the page of a run: its size, and how fast a browser goes through its frames.

    python -m tools.page_speed                       walls of 100, 1,000 and 10,000 blocks
    python -m tools.page_speed --blocks 1000 --frames 50 --keep build/pages
    python -m tools.page_speed FILE.vtkhdf           a run of one's own

The walls collapse, with a frame for each step.  A row of the table is a page: its size and the
processor time to write it; frames a second while it is scrubbed through, with the blocks coloured
by a stress, and with the contact forces drawn above them; how far corners stand from those of the
result file; requests and messages of errors, of which there must be none.  Speeds are the best of
three, for another program may be at work beside.

Needs chromium on the PATH, and playwright.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

import clast
from benchmarks.scenes import WHOLE_SCENES, WHOLE_SHARE, WHOLE_STEP, YOUNG
from clast.pictures.page.document import write_page
from clast.results import Results, read_results

RENDERERS = {
    "canvas": ["--disable-gpu"],
    "webgl2": ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
}
"""Ways of drawing -> arguments of chromium; both draw by software here."""
SIZE = {"width": 1280, "height": 800}
"""Size of the window, pixels."""
TRIES = 3
HEAD = (
    f"{'blocks':>7}{'frames':>7}{'contacts shown':>24}{'MB':>7}{'made s':>8}  renderer"
    f"{'ready s':>9}{'fps':>7}{'fps with forces':>17}{'corner px':>11}  errors"
)

SCRUB = """async ([layers, count]) => {
  clastPage.set({ field: "sigma_yy", layers: new Set(layers) });
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  await frame();
  const begun = performance.now();
  for (let k = 0; k < count; k++) {
    clastPage.goTo(Math.floor((k * clastPage.run.frameCount) / count));
    await frame();
  }
  return (1000 * count) / (performance.now() - begun);
}"""


def collapsed(count: int, frames: int, path: Path) -> Results:
    """Return the results of a collapsing wall of about ``count`` bricks, a frame for each step."""
    clast.simulate(
        WHOLE_SCENES["collapse"].build(count),
        step=WHOLE_STEP,
        end=WHOLE_STEP * (frames - 1),
        every=WHOLE_STEP,
        output=path,
        contact_law={"name": "penalty", "normal_stiffness": WHOLE_SHARE * YOUNG},
    )
    return read_results(path)


# Measuring ---------------------------------------------------------------------------------------


def measured(page: Any, results: Results) -> tuple[float, float, float]:
    """Return frames a second without and with forces, and how far corners are off, pixels."""
    count = min(len(results.times), 60)
    speeds = [
        max(page.evaluate(SCRUB, [layers, count]) for _ in range(TRIES))
        for layers in ([], ["contacts"])
    ]
    page.evaluate("clastPage.fitAll()")
    away = 0.0
    for frame in np.linspace(0, len(results.times) - 1, 5).astype(int).tolist():
        time = float(results.times[frame])
        drawn = page.evaluate(
            "(time) => { const { run, view } = clastPage;"
            " const here = Array.from(run.vertices(run.frameAt(time)));"
            " return here.map((one, k) => k % 2 ? view.screenY(one) : view.screenX(one)); }",
            time,
        )
        seen = page.evaluate("({ ...clastPage.view, origin: clastPage.run.scene.origin })")
        true = results.vertices(frame) - seen["origin"]
        x = 0.5 * seen["width"] + (true[:, 0] - seen["x"]) * seen["scale"]
        y = 0.5 * seen["height"] - (true[:, 1] - seen["y"]) * seen["scale"]
        off = np.reshape(drawn, (-1, 2)) - np.column_stack([x, y])
        away = max(away, float(np.hypot(*off.T).max()))
    return speeds[0], speeds[1], away


def rows(results: Results, folder: Path) -> Iterator[str]:
    """Give a line of the table for each renderer."""
    from playwright.sync_api import sync_playwright

    begun = process_time()
    file = write_page(results, folder / f"{results.name.rpartition('.')[0]}.html")
    made = process_time() - begun
    for renderer, arguments in RENDERERS.items():
        faults: list[str] = []
        with sync_playwright() as playwright:
            driver: Any = playwright  # its types do not know of lists that are filled
            browser = driver.chromium.launch(
                executable_path=shutil.which("chromium"), args=["--no-sandbox", *arguments]
            )
            page = browser.new_page(viewport=SIZE)
            page.on("pageerror", lambda fault, found=faults: found.append(str(fault)))
            page.on(
                "console",
                lambda said, found=faults: found.append(said.text) if said.type == "error" else 0,
            )
            page.on(
                "request",
                lambda asked, found=faults: (
                    None
                    if asked.url.startswith(("file:", "blob:", "data:"))
                    else found.append(asked.url)
                ),
            )
            page.goto(f"{file.resolve().as_uri()}?renderer={renderer}")
            page.wait_for_selector("main[data-ready=yes]", timeout=300_000)
            ready = page.evaluate("performance.now()") / 1e3
            plain, forces, away = measured(page, results)
            shown = page.evaluate("[clastPage.run.contacts.shown, clastPage.run.contacts.of]")
            browser.close()
        size = file.stat().st_size / 1e6
        yield (
            f"{len(results.block_name):>7}{len(results.times):>7}{shown[0]:>12} of {shown[1]:<8}"
            f"{size:>7.2f}{made:>8.1f}  {renderer:<8}{ready:>9.1f}{plain:>7.1f}"
            f"{forces:>17.1f}{away:>11.4f}  {'; '.join(faults) or 'none'}"
        )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("files", nargs="*", type=Path, help="result files; walls if none")
    parser.add_argument("--blocks", default="100,1000,10000")
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--keep", type=Path, help="folder for files and pages")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = given.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        sys.stdout.write(HEAD + "\n")
        counts = [] if given.files else [int(one) for one in given.blocks.split(",")]
        runs: list[Callable[[], Results]] = [partial(read_results, file) for file in given.files]
        runs += [
            partial(collapsed, count, given.frames, folder / f"wall-{count}.vtkhdf")
            for count in counts
        ]
        for run in runs:
            for row in rows(run(), folder):
                sys.stdout.write(row + "\n")
                sys.stdout.flush()


if __name__ == "__main__":
    main()
