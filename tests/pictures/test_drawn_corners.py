"""Corners as they are drawn, found in the pixels of the page, against those of the result file."""

import base64
import io

import numpy as np
from PIL import Image
from scipy.ndimage import map_coordinates

import clast
from scenes.browsers import settled

ACROSS = np.arange(-4.0, 4.01, 0.125)
"""Where a line is looked for, pixels across it."""


def turned_block(path):
    """Return the run of a block that slides down a plane of 30 degrees."""
    builder = clast.ModelBuilder(title="Turned", gravity=(0.0, -9.8))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=10.0)
    way, up = np.array([np.sqrt(0.75), -0.5]), np.array([0.5, np.sqrt(0.75)])
    plane = [-3 * way - up, 5 * way - up, 5 * way, -3 * way]
    builder.block(name="plane", vertices=[tuple(one) for one in plane], fixed=True)
    block = [0 * way, way, way + 0.7 * up, 0.7 * up]
    builder.block(name="block", vertices=[tuple(one) for one in block])
    return clast.simulate(builder.build(), step=5e-3, end=0.5, every=0.1, output=path)


def line_near(grey, start, end):
    """Return how far the dark line from ``start`` to ``end`` (2,) is off, pixels across it."""
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    shares = np.linspace(0.25, 0.75, 60)[:, None, None]
    places = start + shares * (end - start) + ACROSS[:, None] * across
    # the middle of a pixel is half a pixel on
    dark = 255.0 - map_coordinates(grey, [places[..., 1] - 0.5, places[..., 0] - 0.5], order=1)
    weight = np.maximum(0.0, dark - 0.3 * dark.max())
    return float((weight * ACROSS).sum() / weight.sum()), across


def test_corners_are_drawn_where_the_file_has_them(opened, tmp_path):
    run = turned_block(tmp_path / "turned.vtkhdf")
    page = opened(run, address="#field=none&layers=")
    for zoom in (1.0, 1.7):
        page.evaluate(f"(clastPage.fitAll(), clastPage.view.zoom({zoom}, 300, 200))")
        page.evaluate("clastPage.changed()")
        settled(page)
        picture = page.evaluate("(clastPage.draw(), clastPage.canvas.toDataURL('image/png'))")
        content = base64.b64decode(picture.partition(",")[2])
        grey = np.asarray(Image.open(io.BytesIO(content)).convert("L"), float)
        view = page.evaluate("({ ...clastPage.view, origin: clastPage.run.scene.origin })")
        true = run.vertices(-1)[4:] - view["origin"]
        seen = np.column_stack(
            [
                0.5 * view["width"] + (true[:, 0] - view["x"]) * view["scale"],
                0.5 * view["height"] - (true[:, 1] - view["y"]) * view["scale"],
            ]
        )
        lines = [line_near(grey, seen[k], seen[(k + 1) % 4]) for k in range(4)]
        for k, corner in enumerate(seen):
            (one, first), (other, second) = lines[k - 1], lines[k]
            # where both lines, moved as they are drawn, cross
            away = np.linalg.solve(np.stack([first, second]), [one, other])
            assert np.hypot(*away) < 0.15, (k, corner, away)
