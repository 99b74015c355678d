"""Slip and opening of joints on pictures: which lines, with which numbers."""

import numpy as np
import pytest

import clast
from clast.pictures.film import FilmLook, FrameDrawer
from clast.pictures.joint_values import JOINT_FIELDS, faces_opened
from clast.pictures.plot import plot_results


def test_opening_is_how_far_edges_are_apart(parted):
    moved = parted.history("A").displacement[-1, 0]
    faces = faces_opened(parted, -1)
    assert moved > 0.02
    # between the bricks upright; between bricks and table closed
    upright = np.abs(np.diff(faces.ends[:, :, 0], axis=1)).ravel() < 0.01
    assert upright.sum() == 1
    assert faces.value[upright] == pytest.approx(moved, rel=1e-2)
    assert faces.value[~upright] == pytest.approx(0.0, abs=1e-5)
    middle = faces.ends[upright].mean(axis=(0, 1))
    assert middle == pytest.approx([1.0 + 0.5 * moved, 0.5], abs=1e-3)


def test_nothing_is_open_at_the_start(parted):
    assert faces_opened(parted, 0).value == pytest.approx(0.0, abs=1e-12)


def test_slip_is_drawn_along_the_faces(parted):
    moved = parted.history("A").displacement[-1, 0]
    faces = JOINT_FIELDS["slip"].values(parted, -1)
    assert len(faces.value) == 2
    still, slid = np.argsort(np.abs(faces.value))
    # to the right as seen from the table
    assert faces.value[slid] == pytest.approx(-moved, rel=1e-4)
    assert abs(faces.value[still]) < 1e-4
    assert faces.length[slid] == pytest.approx(1.0, abs=1e-3)


def test_a_joint_that_slides_mobilises_its_friction(parted, tmp_path):
    slip, mobilised, sliding, utilised = (
        JOINT_FIELDS[name].values(parted, -1)
        for name in ("slip", "mobilised", "sliding", "utilisation")
    )
    still, slid = np.argsort(np.abs(slip.value))
    assert mobilised.value[slid] == pytest.approx(20.0, abs=0.01)
    assert mobilised.value[still] < 10.0
    assert sliding.value[slid] == pytest.approx(100.0)
    assert sliding.value[still] == 0.0
    assert utilised.value[slid] == pytest.approx(100.0)
    tangents = np.tan(np.radians([mobilised.value[still], 20.0]))
    assert utilised.value[still] == pytest.approx(100.0 * tangents[0] / tangents[1])
    for field in ("mobilised", "sliding", "utilisation"):
        picture = plot_results(parted, tmp_path / f"{field}.svg", field=field)
        unit = {"mobilised": "(°)", "sliding": "(%)", "utilisation": "(%)"}[field]
        assert unit in picture.read_text("utf-8")
    # at the start nothing touches
    assert len(JOINT_FIELDS["mobilised"].values(parted, 0).value) == 0


def test_neighbours_that_are_far_from_each_other_are_no_joint_any_more():
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("rock", young=5e9, poisson=0.2, density=2500.0)
    builder.block(vertices=[(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(vertices=[(1, 0), (2, 0), (2, 1), (1, 1)], velocity=(10.0, 0.0, 0.0))
    run = clast.simulate(builder.build(), step=1e-3, end=0.1, every=0.02)
    assert [len(faces_opened(run, frame).value) for frame in (0, 2, -1)] == [1, 1, 0]


@pytest.mark.parametrize("field", ["slip", "opening"])
def test_a_film_has_one_scale_for_joints(parted, field):
    drawing = FrameDrawer(parted, range(len(parted.times)), FilmLook(field=field), 640)
    first, last = drawing.picture(0), drawing.picture(len(parted.times) - 1)
    moved = parted.history("A").displacement[-1, 0]
    ends = drawing._scale.low, drawing._scale.high
    assert np.abs(ends).max() == pytest.approx(moved, rel=1e-2)
    assert (first != last).any()
    strip = slice(None), slice(-130, None)  # the colour bar stays as it is
    assert (first[strip] == last[strip]).all()
