"""Layers above blocks, two frames side by side, several histories in one picture."""

import itertools
import re

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

import clast
from clast.errors import CaseError
from clast.pictures import canvas, draw_blocks
from clast.pictures.figure_options import LAYERS, Look
from clast.pictures.histories import _histories_called, plot_histories
from clast.pictures.joint_values import resultants_of
from clast.pictures.layers import _triangles, chains, crosses
from clast.pictures.plot import plot_two_frames
from scenes.drawings import text_of


def drawn(layer, run):
    """Return the collections that a layer draws of the last frame."""
    axes = Figure().add_subplot()
    layer(run, len(run.times) - 1)[1](axes)
    return axes.collections


def test_chains_are_as_wide_as_the_forces_of_faces(parted):
    contacts = parted.contacts(-1)
    faces: dict[tuple[int, int], np.ndarray] = {}
    pairs = zip(contacts.vertex_block, contacts.edge_block, contacts.force, strict=True)
    for one, other, force in pairs:  # blocks of this run meet in one face each
        key = (min(one, other), max(one, other))
        faces[key] = faces.get(key, np.zeros(2)) + (force if one < other else -force)
    size = np.sort([np.hypot(*force) for force in faces.values()])
    kept = size[size > 0.005 * size.max()]
    assert len(kept) < len(contacts)
    (lines,) = drawn(chains, parted)
    widths = np.sort(lines.get_linewidths())
    assert len(widths) == len(kept)
    assert (widths - 0.4) / 4.6 == pytest.approx(kept / size.max())


def test_a_chain_passes_the_centre_of_its_face(parted):
    contacts = parted.contacts(-1)
    found = resultants_of(contacts)
    for at, blocks in zip(found.at, found.block, strict=True):
        own = [set(pair) == set(blocks) for pair in
               zip(contacts.vertex_block, contacts.edge_block, strict=True)]  # fmt: skip
        weight = np.hypot(*contacts.force[own].T)
        assert at == pytest.approx(weight @ contacts.position[own] / weight.sum())


def test_crosses_have_length_and_direction_of_principal_stresses(parted):
    pressed, pulled = drawn(crosses, parted)
    arms = np.array([*pressed.get_segments(), *pulled.get_segments()])
    length = np.hypot(*(arms[:, 1] - arms[:, 0]).T)
    sizes = np.abs(np.r_[parted.field("sigma_1", -1)[1:], parted.field("sigma_3", -1)[1:]])
    assert np.sort(length) == pytest.approx(0.9 * np.sort(sizes) / sizes.max(), rel=1e-3, abs=1e-9)


def test_triangles_cover_blocks_without_the_notch_of_a_table(parted):
    here = parted.vertices(-1)
    corners = here[_triangles(parted, here, len(parted.times) - 1)]
    a, b = (corners[:, k] - corners[:, 0] for k in (1, 2))
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
    assert area == pytest.approx(parted.model.area.sum(), rel=1e-5)


def test_all_layers_are_drawn_and_explained(parted, tmp_path):
    path = tmp_path / "all.svg"
    clast.plot_results(parted, path, look=Look(layers=LAYERS, size=(16.0,)))
    text = path.read_text("utf-8")
    for word in ("force between blocks as width", "compression", "equal displacement, every"):
        assert word in text
    assert "displacement, up" in text


@pytest.mark.parametrize("field", ["displacement", "sigma_1", "slip", "opening", "rock"])
def test_two_frames_have_one_scale(parted, tmp_path, field):
    path = tmp_path / "two.svg"
    plot_two_frames(parted, path, (0, -1), field=field, look=Look(size=(17.0,)))
    text = path.read_text("utf-8")
    assert text.count("t$ = ") == 2 and "t$ = 0.04 s" in text
    points = 72.0 / 2.54 * 17.0
    assert float(re.search(r'width="([0-9.]+)pt"', text)[1]) == pytest.approx(points, rel=0.02)


def test_histories_share_their_abscissa(parted, tmp_path):
    for against in ("time", "A:x"):
        path = tmp_path / "h.svg"
        plot_histories(parted, path, ["A", "energy", "steps"], against)
        text = path.read_text("utf-8")
        for word in ("A, x", "kinetic", "Penetration"):
            assert word in text


def test_two_frames_have_no_room(parted, tmp_path):
    narrow = r"8 cm is too narrow for two frames\n  give a width of (\d+) cm or more"
    with pytest.raises(CaseError, match=narrow) as refused:
        plot_two_frames(parted, tmp_path / "a.png", (0, -1), look=Look(size=(8.0,)))
    least = float(re.search(r"of (\d+) cm", str(refused.value))[1])
    plot_two_frames(parted, tmp_path / "a.png", (0, -1), look=Look(size=(least,)))


def test_two_frames_have_the_water_the_scale_and_the_direction_of_gravity(
    wet_run, tmp_path, monkeypatch
):
    monkeypatch.setitem(matplotlib.rcParams, "svg.fonttype", "none")
    plain, marked = tmp_path / "plain.svg", tmp_path / "marked.svg"
    plot_two_frames(wet_run, plain, (0, -1))
    plot_two_frames(wet_run, marked, (0, -1), look=Look(layers=("scale", "gravity")))
    assert "water level" in text_of(plain) and "water pressure, up to" in text_of(plain)
    before, after = (text_of(path).split() for path in (plain, marked))
    # the letter g, and the length of the bar with its unit
    assert "g" not in before and "g" in after and len(after) == len(before) + 3


def test_levels_say_their_interval_and_blocks_may_stay_without_colours(parted, tmp_path):
    path = tmp_path / "levels.svg"
    clast.plot_results(parted, path, field="none", contacts=False, look=Look(layers=("levels",)))
    shown = " ".join(re.findall("<!-- (.*?) -->", path.read_text("utf-8")))
    moved = np.hypot(*(parted.vertices(-1) - parted.vertices(0)).T).max()
    found = re.search(r"equal displacement, every ([\d.]+) mm", shown)
    assert found and 2.0 < moved * 1e3 / float(found[1]) <= 9.0
    assert "Blocks at" in shown and "Displacement" not in shown
    with pytest.raises(CaseError, match=r"the fields are: displacement, .*none.*worn"):
        clast.plot_results(parted, path, field="qqq")


@pytest.mark.parametrize("width", [1.2, 2.0, 2.8, 4.0])
@pytest.mark.parametrize("limits", [(-1.9, 0.0), (-180.0, 0.0), (0.0, 1.75)])
def test_numbers_below_a_colour_bar_do_not_touch(width, limits):
    sheet = canvas.Sheet(
        size=(6.0, 3.0), axes=(1.0, 1.5, 4.0, 1.0), bar=(1.0, 1.0, width, 0.15), upright=False,
        title=(), legend=0.3,
    )  # fmt: skip
    figure = canvas.new_figure(sheet.size, 100)
    coloured = PolyCollection([])
    coloured.set_array([0.0])
    coloured.set_clim(*limits)
    draw_blocks.draw_colour_bar(figure, sheet, coloured, "Stress (MPa)", "neither")
    agg = FigureCanvasAgg(figure)
    agg.draw()
    numbers = [one for one in figure.axes[-1].get_xticklabels() if one.get_text()]
    boxes = [one.get_window_extent(agg.get_renderer()) for one in numbers]
    seen = sorted((box.x0, box.x1) for box in boxes if box.width > 0.0)
    assert len(seen) >= 2
    assert all(left[1] + 3.0 < right[0] for left, right in itertools.pairwise(seen))


@pytest.mark.parametrize(
    ("name", "panels"),
    [
        ("crown", {"Displacement", "Reaction", "Moment of reactions", "N of", "Q of", "M of"}),
        ("point:crown", {"Displacement"}),
        ("lining:crown", {"N of", "Q of", "M of"}),
        ("reaction:crown", {"Reaction", "Moment of reactions"}),
    ],
)
def test_names_of_two_kinds_do_not_hide_each_other(sprayed, tmp_path, name, panels):
    """A point, a reaction and a lining are called "crown": each is drawn, with its own values."""
    results = clast.read(sprayed.output)
    asked = {
        one.panel.removesuffix(" linings"): one.lines for _, one in _histories_called(results, name)
    }
    assert {*asked} - {"Velocity"} == panels
    for panel, part, values in (
        ("Displacement", "y", results.history("crown").displacement[:, 1]),
        ("Reaction", "y", results.reaction("crown").force[:, 1]),
        ("N of", "least", results.lining("crown").normal_force.min(axis=1)),
    ):
        assert panel not in panels or np.array_equal(asked[panel][part], values)
    plot_histories(results, tmp_path / "crown.svg", [name])


def test_what_is_called_as_the_ledger_does_not_hide_it(tmp_path):
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (0, 1)], name="steps")
    for name in ("energy", "steps"):
        builder.measured_point(name, (0.2, 0.2), block="steps")
    run = clast.simulate(builder, end=0.01, step=1e-3)
    assert {one.panel for _, one in _histories_called(run, "energy")} > {"Displacement", "Energy"}
    assert [(thing, one.panel) for thing, one in _histories_called(run, "run:energy")] == [
        ("", "Energy")
    ]
    assert {one.panel for _, one in _histories_called(run, "steps")} > {"Displacement", "Step"}
    with pytest.raises(CaseError, match="there is no history 'bolt:energy'"):
        _histories_called(run, "bolt:energy")
