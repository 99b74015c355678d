"""Make the pages of the gallery: ``python tools/gallery.py [NAME ...]``, all templates if none.

Each template is run as it is; its page goes to docs/gallery/NAME.html with at most FRAMES frames,
and a picture of its last frame to docs/images/template-NAME.png where there is none yet.
"""

from __future__ import annotations

import sys
import tempfile
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
BUDGET = 1e6
"""Bytes of contacts and joints before they are compressed."""


def make(name: str) -> Path:
    """Run a template and write its page; return the page's path."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"{name}.toml"
        file.write_text(TEMPLATES[name](), encoding="utf-8")
        run = Case.from_toml(file).run(output=file.with_suffix(".vtkhdf"), warn=lambda text: None)
        blocks = len(run.block_name)
        page = DOCS / "gallery" / f"{name}.html"
        page.parent.mkdir(exist_ok=True)
        text = page_text(scene_of(run, BUDGET, most_values=FRAMES * blocks))
        page.write_text(text, encoding="utf-8")
        picture = DOCS / "images" / f"template-{name}.png"
        if not picture.exists():
            plot_results(run, picture, frame=int(np.argmax(run.times)))
    return page


def main() -> None:
    """Make the pages that are asked for."""
    for name in sys.argv[1:] or TEMPLATES:
        begun = process_time()
        page = make(name)
        size = page.stat().st_size / 1e6
        spent = process_time() - begun
        sys.stdout.write(f"{page.name}: {size:.2f} MB, {spent:.1f} s of processor time\n")


if __name__ == "__main__":
    main()
