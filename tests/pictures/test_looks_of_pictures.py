"""What a picture shows is that of its frame, and it fits on its paper."""

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb

import clast
from clast.pictures import canvas
from clast.pictures.draw_blocks import KIND_COLOURS
from clast.pictures.draw_water import BLUE, PALE, pressures_of, waters_of
from clast.pictures.figure_options import Look
from clast.pictures.strokes import JOINT_COLOURS
from clast.pictures.supports import BOLT_LOOKS

matplotlib.use("Agg")

LONG = "a rock with quite a long name, weathered and folded"


@pytest.fixture(scope="module", params=["file", "memory"])
def staged(request, tmp_path_factory):
    """A pier in a pool that comes in the second of three stages, and one with a table."""
    builder = clast.ModelBuilder(title="A pier in a pool", gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.add_rock(LONG, young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, -1), (4, -1), (4, 0), (0, 0)], fixed=True, rock="stone")
    builder.block(name="pier", vertices=[(1, 0), (4, 0), (4, 2), (1, 2)], rock=LONG)
    builder.measured_point("upper right corner of the pier", (4, 2), block="pier")
    builder.add_amplitude("rise", [0.0, 0.01], [0.0, 1.0])
    builder.water(0.5, name="pool")
    builder.water(1.0, name="flood", amplitude="rise")
    stages = [
        clast.Stage(name="dry", until="time", time=0.01),
        clast.Stage(name="wet", until="time", time=0.01, loads=["pool"]),
        clast.Stage(name="flooded to the brim", until="time", time=0.01, loads=["rise"]),
    ]
    path = tmp_path_factory.mktemp("pier") / "pier.vtkhdf"
    output = path if request.param == "file" else None
    run = clast.simulate(builder, end=1.0, step=1e-3, every=5e-3, stages=stages, output=output)
    return clast.read(path) if output else run


def drawn(monkeypatch, results, **options):
    """Return the figure that is drawn of results."""
    figures = []
    monkeypatch.setattr(canvas, "save", lambda figure, path: figures.append(figure))
    clast.plot_results(results, "unused.png", **options)
    return figures[0]


def texts(figure):
    """Return the texts of a figure: title, labels of axes, names, legend."""
    found = list(figure.texts)
    for axes in figure.axes:
        found += [*axes.texts, axes.xaxis.label, axes.yaxis.label]
    for legend in figure.legends:
        found += legend.get_texts()
    return [text for text in found if text.get_text().strip()]


@pytest.mark.parametrize(
    ("stage", "names"), [("dry", []), ("wet", ["pool"]), ("flooded to the brim", ["pool", "flood"])]
)
def test_water_is_drawn_from_its_stage_on(staged, monkeypatch, stage, names):
    number = staged.frame(stage=stage).number
    assert [water.name for water in waters_of(staged, number)] == names
    figure = drawn(monkeypatch, staged, frame=number)
    said = " ".join(text.get_text() for text in texts(figure))
    assert ("water" in said) == bool(names)
    assert f"stage {stage}" in said


def test_a_table_that_a_stage_begins_counts_from_there(staged):
    """Half of its rise, the pressure of the flood is half of what it is at its end."""
    *_, half, last = range(len(staged.times))
    assert staged.times[[half, last]] == pytest.approx([0.025, 0.03])
    halves = [
        pressures_of(staged, waters_of(staged, n)[1:], n, staged.vertices(n)).largest
        for n in (half, last)
    ]
    assert halves[1] == pytest.approx(9810.0 * 2.0, rel=1e-3)
    assert halves[0] == pytest.approx(0.5 * halves[1], rel=1e-3)


@pytest.mark.parametrize("size", [6.0, 8.0, 12.0, None])
@pytest.mark.parametrize("field", ["displacement", "rock"])
def test_nothing_is_cut_off_at_the_edge_of_the_paper(staged, monkeypatch, field, size):
    look = Look() if size is None else Look(size=(size,))
    figure = drawn(monkeypatch, staged, field=field, look=look)
    FigureCanvasAgg(figure).draw()
    width, height = figure.bbox.size
    slack = 0.02 * figure.dpi
    for text in texts(figure):
        box = text.get_window_extent()
        fits = -slack <= box.x0 and box.x1 <= width + slack
        fits &= -slack <= box.y0 and box.y1 <= height + slack
        assert fits, text.get_text()


def test_only_water_is_blue():
    def is_blue(colour):
        red, green, blue = to_rgb(colour)
        return blue > 0.05 + max(red, green)

    assert is_blue(BLUE) and is_blue(PALE)
    others = [*KIND_COLOURS, *JOINT_COLOURS, *(colour for _, colour, _ in BOLT_LOOKS)]
    others.remove("#8e24aa")  # a yielded bolt: purple
    assert not [colour for colour in others if is_blue(colour)]
    apart = [np.abs(np.subtract(to_rgb(PALE), to_rgb(one))).sum() for one in others]
    assert min(apart) > 0.4
