"""Networks whose blocks, intensities, directions and areas are known.

The problems of ``clast verify cutting`` against numbers that owe nothing to them, whole where a
minute does not suffice, and what else such networks must have.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

from clast.rockmass import (
    Baecher,
    Exponential,
    Fisher,
    Horseshoe,
    JointSet,
    Parallel,
    Veneziano,
    VonMises,
    Voronoi,
    apparent,
    cut,
)
from clast.rockmass.joints.plan import MeanDirection
from clast.verification.fixtures import areas, lines_of, rectangle
from clast.verification.problems.cutting import (
    apparent_dip,
    chords,
    intensity,
    persistent_lines,
    random_spacing,
)
from scenes.cuttings import assert_tiles, built


def test_persistent_lines_make_as_many_blocks_as_euler_says():
    found = persistent_lines.network()
    first, second = (persistent_lines.exact_lines(one) for one in persistent_lines.SETS)
    assert [len(first), len(second)] == [9, 14]
    assert persistent_lines.exact_crossings(first, second) == 69
    assert persistent_lines.exact_blocks() == found.report.estimate == found.block_count == 93
    assert persistent_lines.exact_intensity() == pytest.approx(1.882745, abs=1e-6)
    assert persistent_lines.exact_cell() == pytest.approx(1.174469, abs=1e-6)
    # Rounding by 5e-6 m moves the sides of the sliver, some 8 mm long, by less than 1 in 1000.
    assert found.report.block_area.smallest == pytest.approx(3.184e-5, rel=2e-3)
    assert_tiles(found, 80.0)
    built(found)


def test_areas_are_those_of_the_polygons():
    found = persistent_lines.traces_about_a_tunnel()
    shapes = [shapely.Polygon(found.polygon(block)) for block in range(found.block_count)]
    assert areas(found) == pytest.approx([one.area for one in shapes], rel=1e-9)


def test_slivers_are_merged_unless_they_are_asked_for():
    found = cut(rectangle(10, 8), persistent_lines.SETS)
    assert found.report.blocks == 92
    assert found.report.merged.count == 1
    assert found.report.merged.places
    assert_tiles(found, 80.0)


def test_numbers_and_areas_between_random_spacings():
    assert random_spacing.exact_mean() == 525.0
    assert random_spacing.exact_deviation() == pytest.approx(153.5, abs=0.01)
    known = [0.6473, 0.4971, 0.2797, 0.1397, 0.0499]
    assert random_spacing.exact_share(random_spacing.AREAS) == pytest.approx(known, abs=5e-5)
    # products of two exponential lengths, drawn without any network
    rng = np.random.default_rng(0)
    one, other = rng.exponential(1 / random_spacing.UPRIGHT, 40_000), rng.exponential(1.25, 40_000)
    assert random_spacing.distance(one * other) < random_spacing.KOLMOGOROV / 200.0
    assert random_spacing.distance(one * one) > 3.0 * random_spacing.KOLMOGOROV / 200.0


def test_intensities_by_hand():
    assert intensity.exact_of_traces() == 0.375
    off = float(intensity.exact_on_scanline(intensity.ANGLE + 90.0 + intensity.OFF))
    assert off == pytest.approx(0.409576, abs=1e-6)
    assert intensity.exact_anywhere() == pytest.approx(1.27324, abs=1e-5)


def test_traces_with_bridges_have_the_persistence_of_their_lengths():
    report = cut(rectangle(100, 100), [intensity.TRACES]).report.sets[0]
    assert report.p21_asked == pytest.approx(intensity.exact_of_traces(), rel=1e-12)
    assert report.persistence == pytest.approx(report.persistence_asked, rel=0.02)
    assert report.persistence_asked == 0.75
    assert cut(rectangle(100, 100), [intensity.PERSISTENT]).report.sets[0].p10 == pytest.approx(
        0.5, rel=0.02
    )


def test_baecher_traces_reach_their_intensity_to_one_trace():
    one = JointSet(
        name="A",
        model=Baecher(),
        angle=40.0,
        intensity=0.8,
        trace_length=Exponential(mean=6.0),
        angle_spread=VonMises(kappa=60.0),
    )
    report = cut(rectangle(100, 100), [one]).report.sets[0]
    assert report.p21 == pytest.approx(0.8, rel=0.005)
    assert report.p21_asked == 0.8


@pytest.mark.slow
def test_veneziano_lines_have_intensity_and_persistence():
    one = JointSet(
        name="A", model=Veneziano(), angle=10.0, intensity=1.0, trace_length=6.0, bridge_length=2.0
    )
    found = [lines_of(one, rectangle(100, 100), seed) for seed in range(20)]
    lengths = [np.hypot(*(ends[:, 1] - ends[:, 0]).T) for ends in found]
    assert np.mean([some.sum() for some in lengths]) / 1e4 == pytest.approx(1.0, rel=0.05)
    # Traces of exponential length, a little shortened by the boundary.
    assert np.median(np.concatenate(lengths)) == pytest.approx(6.0 * math.log(2.0), rel=0.08)
    report = cut(rectangle(100, 100), [one]).report.sets[0]
    assert report.persistence == pytest.approx(0.75, abs=0.02)


def test_cells_become_regular_when_points_move_to_their_centroids():
    def spread(rounds: int) -> float:
        one = JointSet(name="v", model=Voronoi(rounds=rounds), spacing=0.5)
        found = areas(cut(rectangle(10, 10), [one]))
        return float(found.std() / found.mean())

    assert spread(5) < 0.6 * spread(0)


@pytest.mark.parametrize(
    ("dip", "dip_direction", "azimuth", "angle", "factor"),
    [
        (60, 90, 90, -60.0, 1.0),
        (60, 270, 90, 60.0, 1.0),
        (60, 130, 90, -52.9955, 1.20376),
        (35, 150, 90, -19.2953, 1.15220),
        (75, 10, 90, -32.9458, 3.24236),
        (60, 0, 90, 0.0, 2.0),
        (90, 45, 90, 90.0, 1.41421),
        (5, 200, 120, -0.8704, 1.00370),
    ],
)
def test_dip_and_spacing_as_the_section_shows_them(dip, dip_direction, azimuth, angle, factor):
    plane = apparent_dip.JointPlane(dip, dip_direction, azimuth)
    assert plane in apparent_dip.PLANES
    assert (plane.angle(), plane.factor()) == pytest.approx((angle, factor), abs=1e-4)
    assert apparent(dip, dip_direction, azimuth) == pytest.approx(
        (plane.angle(), plane.factor()), abs=1e-9
    )


def test_a_true_spacing_is_wider_in_the_section():
    def lines(spacing_is: str) -> int:
        one = JointSet(name="A", dip=60.0, dip_direction=130.0, spacing=0.5, spacing_is=spacing_is)
        return cut(rectangle(100, 100, section_azimuth=90.0), [one]).report.sets[0].lines

    assert lines("apparent") / lines("true") == pytest.approx(1.20376, rel=0.02)


def test_scatter_in_space_and_in_the_section_agree_where_the_pole_lies_in_the_section():
    rng = np.random.default_rng(0)
    fisher, mises = Fisher(kappa=200.0), VonMises(kappa=200.0)
    mean = MeanDirection(
        angle=math.radians(-60.0), normal=np.array([math.sin(math.pi / 3), 0.0, 0.5])
    )
    # About a pole in the plane of the section both have a deviation of about 1/sqrt(kappa).
    for scatter in (fisher, mises):
        angles = scatter.angles(mean, rng, 40_000)
        off = (angles - mean.angle + 0.5 * math.pi) % math.pi - 0.5 * math.pi
        assert abs(off.mean()) < 0.002
        assert off.std() == pytest.approx(1.0 / math.sqrt(200.0), rel=0.02)


@pytest.mark.parametrize("count", chords.CHORDS)
def test_a_circle_of_chords_has_the_area_of_the_circle(count):
    known = {16: 1.013002, 32: 1.003222, 64: 1.000804}[count]
    assert chords.exact_factor(count) == pytest.approx(known, abs=1e-6)
    corners = np.array(chords.circle(count).corners(""))
    assert shapely.Polygon(corners).area == pytest.approx(4.0 * math.pi, rel=1e-12)
    assert np.ptp(np.hypot(*(corners - chords.CENTER).T)) < 1e-12
    found = chords.around(count)
    assert found.report.area == pytest.approx(64.0 - 4.0 * math.pi, rel=1e-12)
    assert_tiles(found, 64.0 - 4.0 * math.pi)


@pytest.mark.parametrize("count", [2, 3, 16])
def test_a_horseshoe_has_the_area_of_its_half_circle(count):
    shape = Horseshoe(center=(0, 0), width=4.0, wall_height=3.0, chords=count)
    outline = shapely.Polygon(shape.corners(""))
    assert outline.is_valid
    assert outline.area == pytest.approx(12.0 + 2.0 * math.pi, rel=1e-12)
    assert outline.bounds[:3] == (-2.0, 0.0, 2.0)


def test_a_model_is_an_object():
    assert JointSet(name="A").model == Parallel()
