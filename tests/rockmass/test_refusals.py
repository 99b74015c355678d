"""What cannot be meant is refused: where, what, and what would do."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
import pytest

from clast.errors import ModelError
from clast.rockmass import (
    Baecher,
    BlockPattern,
    Box,
    Circle,
    CrossJointed,
    Domain,
    Exponential,
    Fisher,
    JointSet,
    Lognormal,
    Normal,
    Opening,
    PoissonLines,
    Polygon,
    Region,
    Trace,
    Uniform,
    Values,
    VonMises,
    Voronoi,
    cut,
)

SQUARE = Domain(boundary=[(0, 0), (10, 0), (10, 10), (0, 10)])
BEDDING = JointSet(name="bedding", angle=30.0, spacing=1.0)


def refused(where: str, *words: str, domain: Domain = SQUARE, **tables) -> ModelError:
    """Cut, and check that the message names the place and has the words."""
    with pytest.raises(ModelError) as caught:
        cut(domain, **tables)
    fault = caught.value
    assert fault.where == where
    for word in words:
        assert word in str(fault), str(fault)
    assert fault.remedy
    return fault


PLANE = {"angle": None, "dip": 40.0, "dip_direction": 90.0}
FAULTS = [
    # changes, key, words
    ({"spacing": 0.0}, "spacing", "above 0"),
    ({"spacing": -2.0}, "spacing", "above 0"),
    ({"spacing": math.nan}, "spacing", "above 0"),
    ({"spacing": None}, "spacing", "needs spacing"),
    ({"spacing": Normal(mean=1.0, sd=-0.1)}, "spacing, sd", "0 or more"),
    ({"spacing": Lognormal(mean=1.0, sd=math.nan)}, "spacing, sd", "standard deviation"),
    ({"spacing": Lognormal(mean=1.0, sd=101.0)}, "spacing, sd", "more than 100 times the mean"),
    ({"spacing": Lognormal(mean=0.0, sd=1.0)}, "spacing, mean", "above 0"),
    ({"spacing": Exponential(mean=-1.0)}, "spacing, mean", "above 0"),
    ({"spacing": Uniform(low=2.0, high=1.0)}, "spacing", "below low"),
    ({"spacing": Uniform(low=0.0, high=1.0)}, "spacing, low", "above 0"),
    ({"spacing": Values(values=[])}, "spacing", "empty"),
    ({"spacing": Values(values=[1.0, -1.0])}, "spacing, value 2", "above 0"),
    ({"angle": None}, "angle", "needs angle or dip"),
    ({"angle": math.nan}, "angle", "finite"),
    ({**PLANE, "angle": 1.0, "spacing_is": "true"}, "angle", "angle and dip are both given"),
    ({"angle": None, "dip": 40.0}, "dip", "belong together"),
    (PLANE, "spacing_is", 'spacing_is = "true"'),
    ({**PLANE, "spacing_is": "true"}, "dip", "domain.section_azimuth"),
    ({**PLANE, "dip": 95.0, "spacing_is": "true"}, "dip", "0 to 90"),
    ({"spacing_is": "true"}, "spacing_is", "dip and dip_direction"),
    ({"spacing_is": "roughly"}, "spacing_is", "unknown"),
    ({"intensity": 1.0}, "intensity", "not used by the model parallel"),
    ({"bridge_length": 1.0}, "bridge_length", "trace_length"),
    ({"trace_length": 3.0, "bridge_length": 1e6}, "bridge_length", "only 3e-06 of their lines"),
    ({"terminates_at": ["x"]}, "terminates_at", "not used"),
    ({"origin": (0.0, math.nan)}, "origin", "not a point"),
    ({"within": "shale"}, "within", "no region 'shale'"),
    ({"within": [(20, 20), (21, 20), (21, 21)]}, "within", "outside"),
    ({"angle_spread": VonMises(kappa=0.0)}, "angle_spread, kappa", "above 0"),
    ({"angle_spread": Fisher(kappa=50.0)}, "angle_spread", "dip_direction"),
    ({"model": Baecher(), "spacing": None, "intensity": 1.0}, "trace_length", "needs trace_length"),
    ({"model": PoissonLines(), "stagger": 0.5}, "stagger", "not used"),
    ({"model": PoissonLines(), "intensity": 1.0}, "intensity", "both given"),
    ({"model": PoissonLines(), "spacing": None, "intensity": -1.0}, "intensity", "above 0"),
    ({"model": Voronoi()}, "angle", "not used by the model voronoi"),
    ({"model": CrossJointed(), "terminates_at": ["beding"]}, "terminates_at", "mean 'bedding'"),
    ({"model": CrossJointed(), "terminates_at": ["bedding"]}, "terminates_at", "at each other"),
]


@pytest.mark.parametrize(("changes", "key", "word"), FAULTS)
def test_sets_that_cannot_be_meant(changes, key, word):
    refused(f"joint_set 'bedding', {key}", word, sets=[replace(BEDDING, **changes)])


def test_a_section_nearly_parallel_to_a_set():
    domain = replace(SQUARE, section_azimuth=0.5)
    one = JointSet(name="bedding", dip=90.0, dip_direction=90.0, spacing=1.0, spacing_is="true")
    fault = refused("joint_set 'bedding', dip", "115", "section_azimuth", domain=domain, sets=[one])
    assert "nearly parallel" in fault.what


def test_a_set_that_passes_beside_the_domain_says_how_far():
    one = JointSet(name="bedding", angle=0.0, spacing=100.0, origin=(0.0, 12.0))
    refused("joint_set 'bedding'", "cuts nothing", "2 m beside", sets=[one])
    along = JointSet(name="bedding", angle=0.0, spacing=10.0, origin=(0.0, 0.0))
    refused("joint_set 'bedding'", "along the boundary", sets=[along])


def test_traces_outside_and_traces_that_are_none():
    away = [Trace(points=[(13, 0), (13, 5)]), Trace(points=[(12, 0), (12, 5)])]
    refused("trace 1", "3 m beside", "units", traces=away[:1])
    refused("trace 1", "no trace of the set 'traces'", "2 m beside", traces=away)
    # Where others of the set do cut, those outside are said and left out.
    found = cut(SQUARE, traces=[Trace(points=[(0, 1), (10, 5)]), *away])
    assert found.report.blocks == 2
    assert found.report.notes == (
        "outside of the domain, and cutting nothing: trace 2 (3 m), trace 3 (2 m)",
    )
    refused("trace 1", "at least 2 points", traces=[Trace(points=[(1, 1)])])
    refused("trace 1", "not finite", traces=[Trace(points=[(1, 1), (math.nan, 2)])])


def test_the_spacing_that_would_do_does():
    sets = [BEDDING, JointSet(name="cross", angle=120.0, spacing=1.0)]
    domain = replace(SQUARE, most_blocks=40)
    with pytest.raises(ModelError) as caught:
        cut(domain, sets)
    times = float(caught.value.remedy.split("spacings ")[1].split(" times")[0])
    assert 1.5 < times < 3.0
    wider = [replace(one, spacing=times * 1.15) for one in sets]
    assert cut(domain, wider).report.blocks <= 40
    count = cut(SQUARE, sets).report.estimate
    assert cut(replace(SQUARE, most_blocks=count), sets).report.estimate == count
    with pytest.raises(ModelError):
        cut(replace(SQUARE, most_blocks=count - 1), sets)


@pytest.mark.parametrize("trace_length", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("intensity", [1.0, 2.0, 4.0])
def test_traces_are_expected_to_make_as_many_blocks_as_they_do(intensity, trace_length):
    """Euler's formula counts ends that dangle: 1 + lines + crossings would be up to ten times."""
    sets = [
        JointSet(
            name=f"{angle}",
            model=Baecher(),
            angle=float(angle),
            intensity=intensity,
            trace_length=trace_length,
        )
        for angle in (20, 100)
    ]
    report = cut(replace(SQUARE, smallest_edge=0.0, smallest_block=0.0), sets).report
    split = report.rings.count
    assert abs(report.estimate - report.blocks) <= 0.03 * report.blocks + split + 2
    lines = sum(one.lines for one in report.sets)
    assert report.estimate < 1 + lines + report.blocks
    enough = replace(SQUARE, most_blocks=report.estimate)
    assert cut(enough, sets).report.estimate == report.estimate
    with pytest.raises(ModelError, match="blocks are expected, more than"):
        cut(replace(SQUARE, most_blocks=report.estimate - 1), sets)


@pytest.mark.parametrize(
    ("boundary", "word"),
    [
        ([(0, 0), (10, 10), (10, 0), (0, 10)], "crosses or touches itself at (5, 5)"),
        ([(5e5, 0), (5e5 + 10, 10), (5e5 + 10, 0), (5e5, 10)], "(500005, 5)"),
        ([(0, 0), (1, 1)], "at least 3"),
        ([(0, 0), (1, math.inf), (2, 0)], "not finite"),
        ([(0, 0), (1, 1), (2, 2)], ""),
        ("site.dxf", "not a list"),
    ],
)
def test_boundaries(boundary, word):
    refused("domain, boundary", word, domain=Domain(boundary=boundary))


@pytest.mark.parametrize(
    ("key", "value", "word"),
    [
        ("tolerance", 1.0, "times the diagonal"),
        ("tolerance", 1e-12, "times the diagonal"),
        ("tolerance", math.nan, "finite"),
        ("smallest_edge", -1.0, "below 0"),
        ("smallest_block", math.nan, "finite"),
        ("most_blocks", 0, "1 or more"),
        ("section_azimuth", math.inf, "finite"),
    ],
)
def test_numbers_of_the_domain(key, value, word):
    refused(f"domain, {key}", word, domain=replace(SQUARE, **{key: value}), sets=[BEDDING])


@pytest.mark.parametrize(
    ("shape", "key", "words"),
    [
        (Box(corner=(12, 0), size=(1, 1)), "", ("outside", "2 m away")),
        (Box(corner=(10, 0), size=(1, 1)), "", ("touches it",)),
        (Polygon(points=[(1, 1), (3, 3), (3, 1), (1, 3)]), "", ("touches itself at (2, 2)",)),
        (Circle(center=(5, 5), radius=0.0), ", radius", ("above 0",)),
        (Circle(center=(5, 5), radius=1.0, chords=2), ", chords", ("3 to 10000",)),
        (Circle(center=5.0, radius=1.0), ", center", ("not a list",)),
    ],
)
def test_shapes_of_openings(shape, key, words):
    refused(f"opening 'heading'{key}", *words, openings=[Opening(name="heading", shape=shape)])


def test_names_given_twice_and_regions_outside():
    one = Opening(name="heading", shape=Box(corner=(1, 1), size=(1, 1)))
    refused("opening 'heading'", "two openings", openings=[one, one])
    away = Region(name="bed", polygon=[(20, 20), (21, 20), (21, 21)], rock="shale")
    refused("region 'bed'", "outside", regions=[away])
    refused("joint_set 'bedding'", "two joint_sets", sets=[BEDDING, BEDDING])


@pytest.mark.parametrize(
    ("changes", "key"), [({"brick": (0.4, 0.0)}, ", brick, size"), ({"corner": (100, 100)}, "")]
)
def test_patterns(changes, key):
    wall = BlockPattern(corner=(0, 0), size=(8, 3), brick=(0.4, 0.2))
    refused(f"block_pattern 'masonry'{key}", patterns=[replace(wall, **changes)])


@pytest.mark.parametrize("name", ["welded", "construction-joint:heading"])
def test_names_of_joints_that_stand_for_welds(name):
    refused("joint_set 'bedding', joint", "welded", sets=[replace(BEDDING, joint=name)])
    refused("trace 1, joint", "welded", traces=[Trace(points=[(0, 5), (10, 5)], joint=name)])


def test_numbers_of_numpy_are_numbers():
    one = replace(BEDDING, angle=np.float64(30.0), spacing=np.float64(1.0))
    assert cut(SQUARE, [one]).report.blocks == cut(SQUARE, [BEDDING]).report.blocks


# Numbers of blocks --------------------------------------------------------------------------------

WIDE = JointSet(name="w", angle=20.0, spacing=1.0)
DENSE = {
    "fixed": [JointSet(name="s", angle=63.0, spacing=1e-5)],
    "random": [JointSet(name="s", angle=63.0, spacing=Exponential(mean=1e-5))],
    "traces": [JointSet(name="s", angle=63.0, spacing=0.5, trace_length=1e-5, bridge_length=1e-5)],
    "crossings": [WIDE, JointSet(name="s", angle=90.0, spacing=1e-4)],
    "layers": [
        JointSet(name="w", angle=0.0, spacing=5e-5),
        JointSet(name="s", model=CrossJointed(), angle=90.0, spacing=1.0, terminates_at=["w"]),
    ],
}


@pytest.mark.parametrize("name", DENSE)
def test_millions_of_lines_are_refused_before_they_are_drawn(name):
    began = time.process_time()
    with pytest.raises(ModelError, match="blocks are expected, more than the 200000 allowed"):
        cut(SQUARE, DENSE[name])
    assert time.process_time() - began < 2.0


def test_millions_of_bricks_are_refused_before_they_are_drawn():
    pattern = BlockPattern(corner=(0, 0), size=(10, 10), brick=(1e-4, 1e-4))
    with pytest.raises(ModelError, match="brick: about 1e"):
        cut(SQUARE, patterns=[pattern])


@pytest.mark.parametrize(
    "shapes",
    [
        [Box(corner=(-1, -1), size=(20, 20))],
        [Box(corner=(0, 0), size=(10, 10))],
        [Polygon(points=[(-5, 5), (5, -6), (16, 5), (5, 16)])],
        [Box(corner=(-1, -1), size=(7, 20)), Box(corner=(5, -1), size=(7, 20))],
    ],
)
@pytest.mark.parametrize("sets", [[], [WIDE]])
def test_openings_that_leave_nothing_are_refused(shapes, sets):
    openings = [
        Opening(name=f"o{k}", shape=shape, excavated=True) for k, shape in enumerate(shapes)
    ]
    with pytest.raises(ModelError, match="nothing is left of the domain"):
        cut(SQUARE, sets, openings=openings)


def test_an_opening_for_later_may_be_all_of_the_domain():
    later = Opening(name="o", shape=Box(corner=(0, 0), size=(10, 10)))
    assert cut(SQUARE, openings=[later]).block_count == 1
