"""Bolts in case files and scripts: what they become, and how they are written."""

import numpy as np
import pytest

import clast
from clast.errors import ModelError
from clast.run.model_warnings import model_warnings


def row() -> clast.ModelBuilder:
    """Three squares in a row, the first fixed."""
    builder = clast.ModelBuilder(gravity=(0, 0))
    builder.add_rock("rock", young=1e9, poisson=0.2, density=2500.0)
    for k, name in enumerate("abc"):
        corners = [(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)]
        builder.block(vertices=corners, name=name, fixed=name == "a")
    return builder


KIND = {"stiffness": 1e7, "yield_force": 1e5, "rupture_elongation": 0.05, "pretension": 1e3}


GROUTED = {"anchorage": "grouted", "free_length": 0.1}


def test_a_void_wider_than_the_free_length_is_not_bridged():
    builder = row()
    builder.block(vertices=[(3.05, 0), (4, 0), (4, 1), (3.05, 1)], name="d")
    builder.add_bolt_kind("bar", **KIND)
    builder.bolt((2.1, 0.5), (3.9, 0.5), kind="bar", **GROUTED)
    assert builder.build().bolts.blocks.tolist() == [[2, 3]]
    builder.bolt((2.1, 0.4), (3.9, 0.4), kind="bar", anchorage="grouted", free_length=0.01)
    with pytest.raises(ModelError, match=r"runs through 0.05 m of void from \(3, 0.4\)"):
        builder.build()


def test_a_grouted_bolt_has_a_spring_where_it_crosses_joints():
    builder = row()
    builder.add_bolt_kind("bar", young=2e11, area=5e-4, out_of_plane_spacing=2.0)
    builder.bolt((0.1, 0.5), (2.9, 0.5), kind="bar", anchorage="grouted", free_length=0.7)
    bolts = builder.build().bolts
    assert bolts.blocks.tolist() == [[0, 1], [1, 2]]
    # the middle block is shared: half of it for each joint
    np.testing.assert_allclose(bolts.at[:, 0], [0.1, 0.3, 1.5, 1.5, 2.7, 2.9])
    np.testing.assert_allclose(bolts.stiffness, 2e11 * 5e-4 / 2.0 / 1.2)


def test_numbers_are_of_one_bolt_where_bolts_stand_at_a_distance():
    """Three metres apart, a metre of thickness has a third of each."""
    builder = row()
    axial = {"young": 2e11, "area": 6e-4, "rupture_strain": 0.05}
    builder.add_bolt_kind("bar", **axial, out_of_plane_spacing=3.0, pretension=6e4, yield_force=3e5)
    builder.add_bolt_kind("strip", stiffness=4e7, pretension=2e4, yield_force=1e5)
    for kind in ("bar", "strip"):
        builder.bolt((0.5, 0.5), (1.5, 0.5), kind=kind)
    bolts = builder.build().bolts
    np.testing.assert_allclose(bolts.stiffness, [4e7, 4e7])
    np.testing.assert_allclose(bolts.pretension, [2e4, 2e4])
    np.testing.assert_allclose(bolts.yield_force, [1e5, 1e5])
    np.testing.assert_allclose(bolts.rupture, [0.05, np.inf])


@pytest.mark.parametrize(("rupture", "is_refused"), [(2.4e-3, True), (2.6e-3, False)])
def test_a_bolt_at_a_distance_breaks_after_it_yields(rupture: float, is_refused: bool):
    """Yielding at 300 kN a bolt is stretched by F L/(E A) = 2.5 mm, whatever the distance."""
    builder = row()
    axial = {"young": 2e11, "area": 6e-4, "out_of_plane_spacing": 3.0}
    builder.add_bolt_kind("bar", **axial, yield_force=3e5, rupture_elongation=rupture)
    builder.bolt((0.5, 0.5), (1.5, 0.5), kind="bar")
    if is_refused:
        with pytest.raises(ModelError, match=r"but it yields at 0\.0025 m"):
            builder.build()
    else:
        assert builder.build().bolts.rupture == rupture


def test_forces_in_a_refusal_are_of_one_bolt():
    axial = {"young": 2e11, "area": 6e-4, "out_of_plane_spacing": 3.0}
    with pytest.raises(ModelError, match="a pretension of 20000 N is above yield_force, 10000 N\n"):
        row().add_bolt_kind("bar", **axial, yield_force=1e4, pretension=2e4)


def test_a_bolt_between_fixed_blocks_is_warned_of():
    builder = row()
    builder.block(vertices=[(0, 1), (3, 1), (3, 2), (0, 2)], name="roof", fixed=True)
    builder.add_bolt_kind("bar", stiffness=1e7, yield_force=120.0)
    builder.bolt((0.5, 0.5), (0.5, 1.5), kind="bar", name="idle")
    said = " ".join(model_warnings(builder.build(), 1e-3, 1.0))
    assert "bolt 'idle' is anchored in blocks that are all fixed" in said
    assert "looks like kN" in said


HEADING = """
gravity = [0, -9.8]
[time]
step = 1e-3
end = 0.01
[rock.r]
young = 1e10
poisson = 0.2
density = 2600
[domain]
boundary = [[0, 0], [20, 0], [20, 20], [0, 20]]
[[joint_set]]
name = "a"
angle = 30
spacing = 2.0
[[joint_set]]
name = "b"
angle = 110
spacing = 2.5
[[opening]]
name = "heading"
shape = "circle"
center = [10, 10]
radius = 3.0
excavated = true
[bolt_kind.swellex]
stiffness = 2e7
pretension = 5e4
[[bolt_pattern]]
kind = "swellex"
opening = "heading"
length = 3.0
spacing = 1.5
from = 20
to = 160
"""


@pytest.mark.parametrize("excavated", ["true", "false"])
def test_a_pattern_is_radial_and_as_far_apart_as_it_says(excavated: str):
    text = HEADING.replace("excavated = true", f"excavated = {excavated}")
    bolts = clast.Case.from_toml(text).model().bolts
    assert bolts.name == tuple(f"heading-{k}" for k in range(1, 6))
    heads, ends = bolts.at[::2], bolts.at[1::2]
    away = heads - [10.0, 10.0]
    np.testing.assert_allclose(np.hypot(*away.T), 3.0, rtol=0.01)  # on chords
    np.testing.assert_allclose(np.hypot(*(ends - heads).T), 3.0, atol=1e-4)
    np.testing.assert_allclose(np.hypot(*np.diff(heads, axis=0).T), 1.5, rtol=0.02)
    angle = np.degrees(np.arctan2(away[:, 1], away[:, 0]))
    np.testing.assert_allclose(angle + angle[::-1], 180.0, atol=0.1)  # centred in 20 to 160
    turned = np.degrees(np.arctan2(*(ends - heads).T[::-1]))
    np.testing.assert_allclose(turned, angle, atol=0.01)


def test_what_a_script_has_set_is_written_to_a_file():
    builder = row()
    builder.block(vertices=[(0, 1), (3, 1), (3, 3), (0, 3)], name="roof")
    builder.block(vertices=[(0, 3), (3, 3), (3, 4), (0, 4)], name="top")
    builder.add_bolt_kind("bar", compression=True, **KIND)
    builder.bolt((0.5, 0.5), (1.5, 0.5), kind="bar", name="first", pretension_is="jacked")
    builder.bolt((0.1, 0.2), (2.9, 0.3), kind="bar", **GROUTED)
    outline = [(1, 0), (2, 0), (2, 1), (1, 1)]
    choices = {"kind": "bar", "length": 2.3, "spacing": 0.4, "angles": (60, 120)}
    builder.bolt_pattern(outline, name="ring", **choices)
    model = builder.build()
    assert model.bolts.name == ("first", "2", "ring-1", "ring-2")
    again = clast.Case.from_toml(builder.to_toml()).model()
    for name in ("at", "block", "ends", "stiffness", "rupture", "jacked", "compression"):
        np.testing.assert_array_equal(getattr(again.bolts, name), getattr(model.bolts, name))
    assert again.bolts.name == model.bolts.name


def test_a_stage_installs_its_bolts_and_locks_those_before():
    builder = row()
    builder.add_bolt_kind("bar", **KIND)
    builder.bolt((0.5, 0.5), (1.5, 0.5), kind="bar", name="early")
    builder.bolt((1.5, 0.5), (2.5, 0.5), kind="bar", name="late", stage="support")
    bolts = builder.build().bolts
    assert bolts.installed.tolist() == [True, False]
    after = bolts.locked_by_now().at_stage("support")
    assert after.installed.tolist() == [True, True]
    assert after.locked.tolist() == [True, False]
    assert bolts.without(["early"]).at_stage("x", ["bar"]).installed.all()
