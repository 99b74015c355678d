"""Figures of studies, by the pixels of their colours."""

from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

from clast.pictures.study import figures
from clast.pictures.study.figures import BLUE, RED, Bar


def longest(picture: Path, colour: str) -> int:
    """Return the length of the longest row of pixels of a colour in a picture."""
    image = pytest.importorskip("matplotlib.image")
    wanted = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    pixels = np.round(255.0 * image.imread(picture)[:, :, :3]).astype(int)
    rows = (pixels == wanted).all(axis=2)
    return max(sum(1 for _ in run) for row in rows for on, run in groupby(row) if on)


@pytest.mark.parametrize(
    ("low", "high"), [(3.0, 3.0), (3.0, 1.5), (1.5, 3.0), (-3.0, -1.5), (-1.5, 3.0), (3.0, -1.5)]
)
def test_a_tornado_shows_both_ends_at_their_length(tmp_path, low, high):
    """Whether they lie on one side of the mean or on both."""
    bars = [Bar(label="a", low=low, high=high, ends=(0.0, 1.0))]
    picture = figures.draw_tornado(bars, 0.0, "u (m)", tmp_path / "tornado.png")
    ends = longest(picture, BLUE), longest(picture, RED)
    assert ends[0] / ends[1] == pytest.approx(abs(low / high), rel=0.02)
    assert max(ends) > 100
