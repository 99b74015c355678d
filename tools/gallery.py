"""Make the pages of the gallery: ``python tools/gallery.py [NAME ...]``, all of them if none.

A template is run as it is, a worked case as its page in docs/how-to says; the page that plays the
run goes to docs/gallery/NAME.html with at most FRAMES frames, and a picture of the last frame of a
template to docs/images/template-NAME.png where there is none yet.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import numpy as np

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.pictures.page.document import page_text
from clast.pictures.page.scene import scene_of
from clast.pictures.plot import plot_results

DOCS = Path(__file__).resolve().parents[1] / "docs"
FRAMES = 60
"""Frames of a page at most: the site is to stay small."""
BUDGET = 5e6
"""Bytes of contacts and joints before they are compressed."""
BLOCK = re.compile(r"^```(python|toml)([^\n]*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Worked:
    """A worked case of the documentation."""

    file: str
    """The case file that its page writes."""
    settings: tuple[str, ...] = ()
    """What the run that is shown sets otherwise, as --set has it."""


WORKED = {
    "slope-from-a-drawing": Worked("slope.toml", ("output.every=0.02",)),
    "bolted-slope": Worked("beds.toml", ("bolt=[]", "bolt_kind={}", "output.every=0.02")),
    "bolted-key-block": Worked(
        "roof.toml", ("bolt=[]", "stage.3.damping=none", "output.every=0.02")
    ),
    "shaken-wall": Worked(
        "wall.toml", ("ground_motion.scale=4.5", "block_pattern.1.brick=[0.4,0.3]")
    ),
    "settling-facade": Worked("facade.toml", ("output.every=0.05",)),
    "jointed-slope": Worked(
        "jointed-slope.toml",
        ("stage=[]", "joint.bedding.friction_angle=30", "output.every=0.02"),
    ),
}
"""Page in docs/how-to -> the case that it works through."""


def case_of(name: str) -> Case:
    """Return a template, or a worked case, in the folder that is the working one."""
    if name in TEMPLATES:
        file = Path(f"{name}.toml")
        file.write_text(TEMPLATES[name], encoding="utf-8")
        return Case.from_toml(file)
    worked = WORKED[name.removeprefix("worked-")]
    page = (DOCS / "how-to" / f"{name.removeprefix('worked-')}.md").read_text("utf-8")
    for language, options, text in BLOCK.findall(page):
        if language == "toml" and f'title="{worked.file}"' in options:
            Path(worked.file).write_text(text, encoding="utf-8")
        elif language == "python":
            exec(compile(text, name, "exec"), {})  # a script of our own page, which writes the file
        if Path(worked.file).exists():
            break
    return Case.from_toml(worked.file, worked.settings)


def make(name: str) -> Path:
    """Run a case and write its page; return the page's path."""
    with in_an_empty_folder():
        if case_of(name).rockfall is not None:
            return make_report(name)
        run = case_of(name).run(output="run.vtkhdf", warn=lambda text: None)
        blocks = len(run.block_name)
        page = DOCS / "gallery" / f"{name}.html"
        page.parent.mkdir(exist_ok=True)
        text = page_text(scene_of(run, BUDGET, most_values=FRAMES * blocks))
        page.write_text(text, encoding="utf-8")
        picture = DOCS / "images" / f"template-{name}.png"
        if name in TEMPLATES and not picture.exists():
            plot_results(run, picture, frame=int(np.argmax(run.times)))
    return page


def make_report(name: str) -> Path:
    """Follow the rocks of a template and keep the report and the picture of their paths."""
    command = ["clast", "rockfall", f"{name}.toml", "-o", "out", "--workers", "1", "-q"]
    subprocess.run([sys.executable, "-m", *command], check=True)
    page = DOCS / "gallery" / f"{name}.html"
    shutil.copy("out/report.html", page)
    shutil.copy("out/figures/paths.png", DOCS / "images" / f"template-{name}.png")
    return page


@contextlib.contextmanager
def in_an_empty_folder() -> Iterator[None]:
    """Work in an empty folder."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def main() -> None:
    """Make the pages that are asked for."""
    every = [*TEMPLATES, *(f"worked-{name}" for name in WORKED)]
    for name in sys.argv[1:] or every:
        begun = process_time()
        page = make(name)
        size = page.stat().st_size / 1e6
        spent = process_time() - begun
        sys.stdout.write(f"{page.name}: {size:.2f} MB, {spent:.1f} s of processor time\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
