"""Networks whose blocks, intensities, directions and areas are known: C1, C2, C4, C6, C7, C8."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from scipy import special, stats

from clast.rockmass import (
    Baecher,
    Circle,
    Cut,
    Domain,
    Exponential,
    Fisher,
    Horseshoe,
    JointSet,
    Opening,
    Parallel,
    PoissonLines,
    Veneziano,
    VonMises,
    Voronoi,
    apparent,
    cut,
)
from clast.rockmass.account import frequency
from clast.rockmass.joints.directions import Direction
from scenes.cuttings import assert_tiles, built


def rectangle(width: float, height: float, **settings) -> Domain:
    return Domain(boundary=[(0, 0), (width, 0), (width, height), (0, height)], **settings)


def areas(found: Cut) -> np.ndarray:
    return np.array(
        [shapely.Polygon(found.polygon(block)).area for block in range(found.block_count)]
    )


TWO_SETS = (
    JointSet(name="A", angle=30.0, spacing=1.3, origin=(0, 0), joint="a"),
    JointSet(name="B", angle=115.0, spacing=0.9, origin=(0.2, 0.1), joint="b"),
)


def test_persistent_lines_make_as_many_blocks_as_euler_says():
    # C1: 9 + 14 lines, 69 crossings inside: 1 + 23 + 69.
    found = cut(rectangle(10, 8, smallest_block=0.0), TWO_SETS)
    report = found.report
    assert [one.lines for one in report.sets] == [9, 14]
    assert report.estimate == report.blocks == 93
    assert abs(report.area - 80.0) < 1e-12 * 80.0
    assert sum(one.p21 for one in report.sets) == pytest.approx(1.882745, abs=1e-6)
    # Rounding by 5e-6 m moves the sides of the sliver, some 8 mm long, by less than 1 in 1000.
    assert report.block_area.smallest == pytest.approx(3.184e-5, rel=2e-3)
    assert report.block_area.median == pytest.approx(1.174469, rel=1e-4)
    assert_tiles(found, 80.0)
    built(found)


def test_slivers_are_merged_unless_they_are_asked_for():
    found = cut(rectangle(10, 8), TWO_SETS)
    assert found.report.blocks == 92
    assert found.report.merged.count == 1
    assert found.report.merged.places
    assert_tiles(found, 80.0)


@pytest.mark.slow
def test_two_sets_with_exponential_spacings_make_the_blocks_that_probability_says():
    # C2: the numbers of lines are Poisson(l1 W) and Poisson(l2 H), independent; a typical block is
    # the product of two exponential lengths, P(A > a) = z K1(z) with z = 2 sqrt(l1 l2 a).
    l1, l2, width, height = 0.5, 0.8, 40.0, 30.0
    domain = rectangle(width, height, smallest_block=0.0)
    upright = JointSet(name="v", angle=90.0, spacing=Exponential(mean=1 / l1))
    level = JointSet(name="h", angle=0.0, spacing=Exponential(mean=1 / l2))
    counts, typical = [], []
    for seed in range(400):
        found = cut(domain, [upright, level], seed=seed)
        counts.append(found.report.blocks)
        rng = np.random.default_rng(seed)
        # The block about a corner drawn at random, on its upper right: typical, not size-biased.
        inner = [
            block
            for block in range(found.block_count)
            if found.polygon(block).max(axis=0)[0] < width - 1e-6
            and found.polygon(block).max(axis=0)[1] < height - 1e-6
        ]
        block = found.polygon(int(rng.choice(inner)))
        typical.append(np.prod(np.ptp(block, axis=0)))
    expected = (1 + l1 * width) * (1 + l2 * height)
    assert expected == 525
    assert abs(np.mean(counts) - expected) < 3.0 * 153.5 / math.sqrt(len(counts))
    assert np.std(counts) == pytest.approx(153.5, rel=0.15)

    def below(a: np.ndarray) -> np.ndarray:
        z = 2.0 * np.sqrt(l1 * l2 * a)
        return 1.0 - z * special.k1(z)

    assert below(np.array([2.5]))[0] == pytest.approx(1 - 0.2797, abs=1e-4)
    assert stats.kstest(typical, below).pvalue > 0.01


def test_traces_with_bridges_have_the_intensity_of_their_lengths():
    # C4: P21 = t/((t + g) s); of whole lines P10 = cos(d)/s along a scanline d off the normal.
    big = rectangle(100, 100)
    one = JointSet(
        name="A", angle=20.0, spacing=2.0, trace_length=6.0, bridge_length=2.0, stagger=0.5
    )
    report = cut(big, [one]).report.sets[0]
    assert report.p21 == pytest.approx(0.375, rel=0.02)
    assert report.p21_asked == pytest.approx(0.375, rel=1e-12)
    assert report.persistence == pytest.approx(report.persistence_asked, rel=0.02)
    assert report.persistence_asked == 0.75
    persistent = JointSet(name="A", angle=20.0, spacing=2.0)
    assert cut(big, [persistent]).report.sets[0].p10 == pytest.approx(0.5, rel=0.02)
    ends = lines_of(persistent, big)
    off = math.radians(110.0 + 35.0)
    scanline = np.array([math.cos(off), math.sin(off)])
    assert frequency(ends, scanline, 1e4) == pytest.approx(0.409576, rel=0.02)


def lines_of(one: JointSet, domain: Domain, seed: int = 0) -> np.ndarray:
    """Return the lines of a set inside a domain, m, shape (n, 2, 2)."""
    from clast.rockmass.sources import set_lines, site

    return set_lines(site(domain, [], []), [one], [], seed)[0].ends


@pytest.mark.parametrize(("model", "times"), [(Baecher(), 4), (PoissonLines(), 60)])
def test_isotropic_lines_are_met_two_over_pi_times_their_intensity(model, times):
    big = rectangle(100, 100)
    length = 5.0 if isinstance(model, Baecher) else None
    one = JointSet(name="A", model=model, intensity=2.0, trace_length=length)
    ends = np.concatenate([lines_of(one, big, seed) for seed in range(times)])
    p21 = np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum() / (times * 1e4)
    assert p21 == pytest.approx(2.0, rel=0.02)
    for angle in (0.0, 0.7, 1.9):
        met = frequency(ends, np.array([math.cos(angle), math.sin(angle)]), times * 1e4)
        assert met == pytest.approx(2.0 * 2.0 / math.pi, rel=0.03)


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


@pytest.mark.slow
def test_cells_of_random_points_have_the_known_areas_and_corners():
    # C6: Poisson-Voronoi cells have 6 corners on average, and areas with a coefficient of 0.529.
    count = 5000
    found = cut(
        rectangle(10, 10, smallest_block=0.0),
        [JointSet(name="v", model=Voronoi(count=count))],
        seed=3,
    )
    assert found.block_count == count
    assert found.report.area / found.block_count == pytest.approx(100.0 / count, rel=1e-12)
    inner = [
        block
        for block in range(count)
        if found.polygon(block).min() > 1e-6 and found.polygon(block).max() < 10.0 - 1e-6
    ]
    corners = np.diff(found.block_start)[inner]
    assert corners.mean() == pytest.approx(6.0, rel=0.03)
    sizes = areas(found)[inner]
    assert sizes.std() / sizes.mean() == pytest.approx(0.529, rel=0.03)


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
    # C7: tan(angle) = -tan(dip) cos(D - a); 1/|n in the section|
    found = apparent(dip, dip_direction, azimuth)
    assert found == pytest.approx((angle, factor), abs=1e-4)
    if dip < 90:
        formula = math.degrees(
            math.atan(math.tan(math.radians(dip)) * math.cos(math.radians(dip_direction - azimuth)))
        )
        assert found[0] == pytest.approx(-formula, abs=1e-9)


def test_a_true_spacing_is_wider_in_the_section():
    def lines(spacing_is: str) -> int:
        one = JointSet(name="A", dip=60.0, dip_direction=130.0, spacing=0.5, spacing_is=spacing_is)
        return cut(rectangle(100, 100, section_azimuth=90.0), [one]).report.sets[0].lines

    assert lines("apparent") / lines("true") == pytest.approx(1.20376, rel=0.02)


def test_scatter_in_space_and_in_the_section_agree_where_the_pole_lies_in_the_section():
    rng = np.random.default_rng(0)
    fisher, mises = Fisher(kappa=200.0), VonMises(kappa=200.0)
    mean = Direction(angle=math.radians(-60.0), normal=np.array([math.sin(math.pi / 3), 0.0, 0.5]))
    # About a pole in the plane of the section both have a deviation of about 1/sqrt(kappa).
    for scatter in (fisher, mises):
        angles = scatter.angles(mean, rng, 40_000)
        off = (angles - mean.angle + 0.5 * math.pi) % math.pi - 0.5 * math.pi
        assert abs(off.mean()) < 0.002
        assert off.std() == pytest.approx(1.0 / math.sqrt(200.0), rel=0.02)


@pytest.mark.parametrize("chords", [16, 32, 64])
def test_a_circle_of_chords_has_the_area_of_the_circle(chords):
    # C8: inscribed polygons have a share of n/(2 pi) sin(2 pi/n); corners move out by its root.
    corners = np.array(Circle(center=(3, 4), radius=2.0, chords=chords).corners(""))
    assert shapely.Polygon(corners).area == pytest.approx(4.0 * math.pi, rel=1e-12)
    factor = {16: 1.013002, 32: 1.003222, 64: 1.000804}[chords]
    assert np.hypot(*(corners - (3, 4)).T) == pytest.approx(2.0 * factor, abs=1e-6 * 2)
    found = cut(
        rectangle(8, 8),
        openings=[
            Opening(
                name="t", shape=Circle(center=(3, 4), radius=2.0, chords=chords), excavated=True
            )
        ],
    )
    assert found.report.area == pytest.approx(64.0 - 4.0 * math.pi, rel=1e-12)
    assert_tiles(found, 64.0 - 4.0 * math.pi)


@pytest.mark.parametrize("chords", [2, 3, 16])
def test_a_horseshoe_has_the_area_of_its_half_circle(chords):
    shape = Horseshoe(center=(0, 0), width=4.0, wall_height=3.0, chords=chords)
    outline = shapely.Polygon(shape.corners(""))
    assert outline.is_valid
    assert outline.area == pytest.approx(12.0 + 2.0 * math.pi, rel=1e-12)
    assert outline.bounds[:3] == (-2.0, 0.0, 2.0)


def test_a_model_is_an_object():
    assert JointSet(name="A").model == Parallel()
