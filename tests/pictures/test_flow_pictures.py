"""Water that flows in joints on pictures, pages and films."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import clast
from clast.pictures.draw_flow import (
    flows_of,
    largest_of_cells,
    levels_of,
    text_of_flow,
    with_heads,
)
from clast.pictures.figure_options import Look
from clast.pictures.film import FilmLook, FrameDrawer
from clast.pictures.flow_values import FLOW_FIELDS, LITRES, dry_channels
from clast.pictures.frames import FrameDrawing
from clast.pictures.joint_values import THICK, THIN, scale_of_faces
from clast.pictures.magnified import magnified
from clast.verification.problems.water.flow_uplift import dam
from scenes.browsers import settled
from scenes.wet_rock import CUT, SET

matplotlib.use("Agg")
WATER, HEAD, LENGTH, APERTURE = 9810.0, 4.0, 10.0, 2e-4


def plates_of(gravity: float = -9.81, fixed: bool = True) -> clast.ModelBuilder:
    """Two plates on a rock, from x = 1e4: water enters below the left one, and leaves at the toe.

    Between the plates is an upright joint, open above, up to 6 m.
    """
    builder = clast.ModelBuilder(title="Plates", gravity=(0.0, gravity))
    builder.add_rock("rock", young=30e9, poisson=0.2, density=2400.0)
    builder.add_joint(friction_angle=40.0, aperture=APERTURE)
    left, middle, right = 1e4, 1e4 + 0.5 * LENGTH, 1e4 + LENGTH
    builder.block(vertices=[(left, -2), (right, -2), (right, 0), (left, 0)], fixed=True)
    for x in (left, middle):
        x2 = x + 0.5 * LENGTH
        builder.block(vertices=[(x, 0), (x2, 0), (x2, 6), (x, 6)], fixed=fixed)
    builder.flow = {"state": "steady"}
    kind = {"head": HEAD} if gravity else {"pressure": WATER * HEAD}
    builder.flow_boundary("lake", edges=[((left, -2), (left, 6))], presses=False, **kind)
    builder.flow_boundary("toe", edges=[((right, -2), (right, 6))], seepage=True)
    return builder


def column(gravity: float = -9.81, fixed: bool = True) -> clast.Run:
    return clast.simulate(plates_of(gravity, fixed), end=0.02, step=0.01)


@pytest.fixture(scope="module")
def plates() -> clast.Run:
    return column()


def test_pressure_falls_along_the_joint(plates: clast.Run):
    """Linear from the lake to the toe, in pieces; the upright joint is full to half the head."""
    faces = FLOW_FIELDS["pressure"].values(plates, -1)
    middle = faces.ends.mean(axis=1) - [1e4, 0.0]
    level = np.abs(np.diff(faces.ends[:, :, 1], axis=1)).ravel() < 1e-9
    assert level.sum() > 8 and (~level).sum() > 4
    exact = np.where(
        level,
        WATER * HEAD * (1.0 - middle[:, 0] / LENGTH),
        WATER * (0.5 * HEAD - middle[:, 1]),
    )
    np.testing.assert_allclose(faces.value, exact, rtol=1e-9, atol=1e-3)
    assert faces.ends[~level, :, 1].max() == pytest.approx(0.5 * HEAD)
    # what stands does not flow: thin; what flows is as wide as any
    assert faces.width is not None
    np.testing.assert_allclose(faces.width, level.astype(float), atol=1e-9)


def test_what_is_above_the_water_is_dry(plates: clast.Run):
    dry = dry_channels(plates, -1)
    assert dry.ends[:, :, 1].min() == pytest.approx(0.5 * HEAD)
    assert dry.ends[:, :, 1].max() == pytest.approx(6.0)
    assert dry.length.sum() == pytest.approx(6.0 - 0.5 * HEAD)


def test_other_fields_are_those_of_the_joint(plates: clast.Run):
    flow = APERTURE**3 * WATER * HEAD / (12.0 * 1e-3 * LENGTH)
    values = {name: one.values(plates, -1) for name, one in FLOW_FIELDS.items()}
    flowing = values["flow"].value > 0.0
    np.testing.assert_allclose(values["flow"].value[flowing], LITRES * flow, rtol=1e-9)
    # lines run as the water flows
    assert (np.diff(values["flow"].ends[flowing, :, 0], axis=1) > 0.0).all()
    np.testing.assert_allclose(values["aperture"].value, APERTURE)
    np.testing.assert_allclose(values["saturation"].value, 100.0)
    assert values["head"].value.max() < HEAD
    at = values["head"].ends.mean(axis=1)
    level = values["head"].ends[:, :, 1].max(axis=1) < 1e-9
    exact = np.where(level, HEAD * (1.0 - (at[:, 0] - 1e4) / LENGTH), 0.5 * HEAD)
    np.testing.assert_allclose(values["head"].value, exact, rtol=1e-9)
    told = {name: (at.tolist(), rate) for name, at, rate in flows_of(plates, -1)}
    assert told["lake"][1] == pytest.approx(-flow) and told["toe"][1] == pytest.approx(flow)
    assert told["toe"][0] == pytest.approx([1e4 + LENGTH, 2.0])
    assert text_of_flow("toe", flow) == f"toe: {LITRES * flow:.3g} l/min per 10 m leaves"


def test_each_cell_has_the_arrow_of_its_largest_flow():
    random = np.random.default_rng(3)
    at, size = random.uniform(-5.0, 5.0, (300, 2)), random.random(300)
    best: dict[tuple[int, int], int] = {}
    for k, (x, y) in enumerate(at):
        cell = int(x // 1.7), int(y // 1.7)
        if cell not in best or size[k] > size[best[cell]]:
            best[cell] = k
    assert sorted(largest_of_cells(at, size, 1.7)) == sorted(best.values())
    assert len(largest_of_cells(at[:0], size[:0], 1.0)) == 0


@pytest.mark.parametrize("field", FLOW_FIELDS)
def test_pictures_say_what_they_show(plates: clast.Run, tmp_path: Path, field: str):
    path = clast.plot_results(plates, tmp_path / "one.svg", field=field, contacts=False)
    text = path.read_text("utf-8")
    for words in (FLOW_FIELDS[field].label, "water table", "dry joint", "flow as width, up to"):
        assert words in text
    assert "lake: " in text and "l/min per 10 m enters" in text and "toe: " in text
    look = Look(water=False)
    rest = clast.plot_results(plates, path, field=field, contacts=False, look=look)
    assert "water table" not in rest.read_text("utf-8")


def test_heads_are_compared_with_each_other(plates: clast.Run):
    drawing = FrameDrawing(plates, [-1], "head", Look())
    scale = drawing.scale([-1], drawing.part, None)
    assert scale is not None and 0.0 < scale.low < 0.5 < HEAD - 0.5 < scale.high < HEAD
    given = drawing.scale([-1], drawing.part, (1.0, 2.0))
    assert given is not None and (given.low, given.high) == (1.0, 2.0)


def test_the_numbers_are_those_of_the_run_where_displacements_are_magnified():
    run = column(fixed=False)
    one, other = (FLOW_FIELDS["head"].values(each, -1) for each in (run, magnified(run, 1e4)))
    np.testing.assert_array_equal(one.value, other.value)
    assert np.abs(one.ends - other.ends).max() > 1e-3


def test_films_and_files_hold_the_same(plates: clast.Run, tmp_path: Path):
    run = column()
    path = tmp_path / "plates.vtkhdf"
    assert run.save(path) == path
    back = clast.read(path)
    for name, one in FLOW_FIELDS.items():
        first, second = one.values(run, -1), one.values(back, -1)
        np.testing.assert_allclose(first.value, second.value, rtol=1e-6, err_msg=name)
    np.testing.assert_array_equal(run.channels.place, back.channels.place)
    picture = FrameDrawer(back, [0, 1], FilmLook(field="pressure", size=(480.0,)), 480).picture(1)
    assert (picture[..., 2] < 120).any()  # the colours of pressure


def test_what_cannot_be_drawn_is_refused(plates: clast.Run, tmp_path: Path):
    weightless = column(gravity=0.0)
    assert FLOW_FIELDS["pressure"].values(weightless, -1).value.max() > 0.9 * WATER * HEAD
    with pytest.raises(clast.CaseError, match="without gravity there is no head"):
        clast.plot_results(weightless, tmp_path / "one.svg", field="head")
    builder = clast.ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (0, 1)], fixed=True)
    dry = clast.simulate(builder, end=0.002, step=1e-3)
    with pytest.raises(clast.CaseError, match="no water flows in the joints of this run"):
        clast.plot_results(dry, tmp_path / "one.svg", field="pressure")


@pytest.mark.parametrize("field", ["pressure", "head"])
def test_pages_have_the_scale_and_the_colours_of_still_pictures(
    opened: Callable[..., Any], plates: clast.Run, field: str
):
    page = opened(plates, address=f"#field={field}&layers=water")
    faces = FLOW_FIELDS[field].values(plates, -1)
    limits = (faces.value.min(), faces.value.max()) if field == "head" else None
    scale = scale_of_faces(faces, np.ones(len(faces.value), bool), limits)
    low, high = page.evaluate("['low', 'high'].map((end) => clastPage.$(end).value).map(Number)")
    assert [low, high] == pytest.approx([scale.low, scale.high], rel=1e-3)
    most = int(faces.value.argmax())
    origin = page.evaluate("clastPage.run.scene.origin")
    place = faces.ends[most, 0] + 0.1 * (faces.ends[most, 1] - faces.ends[most, 0]) - origin
    settled(page)
    drawn = page.evaluate(
        "([x, y]) => { const { view, above } = clastPage; const ratio = above.width / view.width;"
        " return [...above.getContext('2d').getImageData(Math.round(ratio * view.screenX(x)),"
        " Math.round(ratio * view.screenY(y)), 1, 1).data].slice(0, 3) }",
        place.tolist(),
    )
    assert np.abs(np.subtract(drawn, np.multiply(to_rgb(scale.colours(1.0)), 255))).max() < 12
    legend = page.inner_text("[data-part=legend]")
    for words in (FLOW_FIELDS[field].label, "water table", "dry joint", "flow as width, up to"):
        assert words in legend
    (table,) = page.evaluate("clastPage.run.flows.at(-1).tables")
    assert np.array(table)[:, 1] + origin[1] == pytest.approx(
        plates.flow(-1).water_table[0][:, 1], abs=1e-4
    )


def test_walls_below_water_are_not_in_the_water_table():
    """A void in full rock: the table is its top, not the wall that the water comes out of."""
    text = CUT.format(boundary=[[0, 0], [10, 0], [10, 10], [0, 10]])
    text += "".join(SET.format(*one) for one in ((5, 1.1), (93, 1.2)))
    text += """
[[opening]]
name = "tunnel"
shape = "circle"
center = [5, 5]
radius = 1.5
excavated = true
[flow]
"""
    for side in ("left", "right", "top"):
        text += f'[[flow_boundary]]\nname = "{side}"\nwhere = {{side = "{side}"}}\nhead = 10.0\n'
    model = clast.Case.from_text(text, "case").model()
    run = clast.simulate(model, end=1e-4, step=1e-4)
    assert run.inflow("tunnel").inflow[-1] > 0.0
    (table,) = run.flow(-1).water_table
    np.testing.assert_allclose(table[:, 1], 10.0)
    assert len(table) > 5
    (place,) = (at for name, at, _ in flows_of(run, -1) if name == "tunnel")
    np.testing.assert_allclose(place, 5.0, atol=0.1)


def test_a_head_that_presses_has_its_level_in_the_picture(tmp_path: Path):
    """The reservoir stands 12 m above the ground before the dam; the picture is as high as that."""
    run = clast.simulate(dam(), end=0.01, step=0.01)
    (level,) = levels_of(run, -1).values()
    np.testing.assert_allclose(level[:, 1], 12.0, rtol=1e-4)
    assert (level[:, 0].min(), level[:, 0].max()) == (-5.0, 0.0)
    low = np.array([-5.0, -5.0]), np.array([15.0, 4.0])
    assert with_heads(run, -1, low)[1][1] == pytest.approx(4.0)  # too far above to be shown
    near = np.array([-5.0, -5.0]), np.array([15.0, 8.0])
    assert with_heads(run, -1, near)[1][1] == pytest.approx(12.0, rel=1e-4)
    assert not levels_of(column(), -1)  # presses = false
    assert run.save(tmp_path / "dam.vtkhdf")
    np.testing.assert_allclose(levels_of(clast.read(tmp_path / "dam.vtkhdf"), -1)[0], level)


def test_arrows_of_forces_are_left_out_where_water_has_its_own(tmp_path: Path):
    run = clast.simulate(dam(), end=0.01, step=0.01)
    path = tmp_path / "dam.svg"
    for field, contacts, drawn in (
        ("pressure", None, False),
        ("pressure", True, True),
        ("displacement", None, True),
        ("displacement", False, False),
    ):
        clast.plot_results(run, path, field=field, contacts=contacts)
        assert ("contact force" in path.read_text("utf-8")) is drawn


def test_widths_of_several_frames_compare(tmp_path: Path):
    """Twice the head is twice the flow: lines of the first stage are half as wide as the others."""
    builder = plates_of()
    stages = (
        clast.Stage(name="low", until="time", time=0.01, flow_boundary={"lake": {"head": 2.0}}),
        clast.Stage(name="high", until="time", time=0.01, flow_boundary={"lake": {"head": 4.0}}),
    )
    run = clast.simulate(builder, end=0.02, step=0.01, stages=stages)
    low, high = (run.frame(-1, stage=name).number for name in ("low", "high"))
    drawing = FrameDrawing(run, [low, high], "flow", Look())
    scale = drawing.scale([low, high], drawing.part, None)
    widths = []
    for frame in (low, high):
        axes = Figure().add_subplot()
        lines, _ = drawing.draw(axes, frame, drawing.part, scale)
        widths.append(np.max(lines.get_linewidths()) - THIN)
    assert widths == pytest.approx([0.5 * (THICK - THIN), THICK - THIN])
