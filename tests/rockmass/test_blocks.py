"""Holes, short edges, small blocks, joints of edges, rocks, openings, masonry."""

from __future__ import annotations

import json
import math
from collections import Counter

import numpy as np
import pytest
import shapely

from clast.errors import ModelError
from clast.rockmass import (
    CONSTRUCTION,
    WELDED,
    BlockPattern,
    Box,
    Circle,
    CrossJointed,
    Cut,
    Domain,
    Fixed,
    JointSet,
    Opening,
    Polygon,
    Region,
    StackBond,
    Trace,
    Values,
    cut,
)
from scenes.cuttings import assert_tiles, built

SQUARE = Domain(boundary=[(0, 0), (10, 0), (10, 10), (0, 10)])


def square_loop(low: float, high: float) -> list[tuple[float, float]]:
    return [(low, low), (high, low), (high, high), (low, high), (low, low)]


def areas_of(found: Cut) -> np.ndarray:
    return np.array([shapely.Polygon(found.polygon(k)).area for k in range(found.block_count)])


def joints_between(found: Cut) -> dict[str, int]:
    """Return how many inner edges have which joint."""
    names = [*found.joint_names, "none"]
    return dict(Counter(names[joint] for joint in found.edge_joint))


# Holes -------------------------------------------------------------------------------------------


def test_an_island_is_welded_into_its_face():
    found = cut(SQUARE, traces=[Trace(points=square_loop(4, 6), joint="shear")])
    assert found.report.blocks == 3
    assert found.report.rings.count == 1
    assert_tiles(found, 100.0)
    # Two welds with two sides each, the four edges of the island, and the outline.
    assert joints_between(found)[WELDED] == 4
    assert joints_between(found)["shear"] == 8
    built(found)


C = [(2, 2), (8, 2), (8, 4), (4, 4), (4, 6), (8, 6), (8, 8), (2, 8), (2, 2)]


@pytest.mark.parametrize(
    ("loops", "blocks"),
    [
        ([square_loop(5 - k, 5 + k) for k in (1, 2, 3, 4)], 1 + 2 * 4),
        # islands that touch the outline with a corner, or hang on each other
        ([[(0, 5), (5, 4), (5, 6), (0, 5)]], None),
        ([[(0, 0), (5, 6), (5, 4), (0, 0)]], None),
        ([[(10, 10), (5, 6), (5, 4), (10, 10)]], None),
        ([square_loop(2, 3), square_loop(3, 4), square_loop(4, 5.5)], None),
        # a C around an island
        ([C, square_loop(4.8, 5.2)], None),
    ],
)
def test_islands_leave_sound_blocks(loops, blocks):
    found = cut(SQUARE, traces=[Trace(points=one) for one in loops])
    assert blocks in (None, found.report.blocks)
    assert_tiles(found, 100.0)
    built(found)


@pytest.mark.parametrize("excavated", [True, False])
def test_an_opening_inside_one_block(excavated):
    shape = Circle(center=(5, 5), radius=2.0)
    found = cut(SQUARE, openings=[Opening(name="heading", shape=shape, excavated=excavated)])
    void = 4.0 * math.pi if excavated else 0.0
    assert_tiles(found, 100.0 - void)
    assert found.report.blocks == (2 if excavated else 3)
    assert (found.opening == 0).sum() == (0 if excavated else 1)
    built(found)


def test_small_islands_are_taken_out():
    grain = Trace(points=square_loop(5.0, 5.02))
    line = JointSet(name="A", angle=0.0, spacing=7.0, origin=(0, 3))
    found = cut(SQUARE, [line], traces=[grain])
    assert found.report.blocks == 2
    assert found.report.merged.count == 1
    assert found.report.merged.places[0] == pytest.approx((5.01, 5.01), abs=1e-3)
    assert_tiles(found, 100.0)


# Short edges, small blocks -----------------------------------------------------------------------


def test_lines_that_nearly_meet_in_a_point_do():
    traces = [
        Trace(points=[(0, 5), (10, 5)]),
        Trace(points=[(5, 0), (5, 10)]),
        Trace(points=[(0, 0.01), (10, 10)]),
    ]
    found = cut(Domain(boundary=SQUARE.boundary, smallest_edge=0.1), traces=traces)
    assert found.report.collapsed.count >= 1
    assert found.report.edge_length.smallest >= 0.1
    assert found.report.blocks == 6
    assert_tiles(found, 100.0)
    exact = cut(Domain(boundary=SQUARE.boundary, smallest_edge=0.0), traces=traces)
    assert exact.report.blocks == 7
    assert exact.report.collapsed.count == 0
    assert_tiles(exact, 100.0)


def test_two_lines_side_by_side_leave_no_sliver():
    traces = [Trace(points=[(0, y), (10, y)]) for y in (5, 5.002)]
    report = cut(Domain(boundary=SQUARE.boundary, smallest_edge=0.05), traces=traces).report
    assert (report.blocks, report.merged.count) == (2, 1)
    assert report.aspect.largest < 3.0


def test_what_is_in_an_opening_does_not_join_the_rock_around_it():
    cutoff = Trace(points=[(4.0, 4.03), (6.0, 4.03)])
    opening = Opening(name="heading", shape=Box(corner=(4, 4), size=(2, 2)))
    line = JointSet(name="A", angle=90.0, spacing=2.0)
    domain = Domain(boundary=SQUARE.boundary, smallest_block=0.1)
    found = cut(domain, [line], traces=[cutoff], openings=[opening])
    assert areas_of(found)[found.opening == 0].sum() == pytest.approx(4.0, rel=1e-12)
    assert found.report.merged.count == 1
    assert_tiles(found, 100.0)


def test_vertices_on_straight_edges_are_no_vertices():
    # The second trace ends inside: its dangling end leaves no vertex behind on the first.
    traces = [Trace(points=[(0, 5), (3, 5), (10, 5)]), Trace(points=[(4, 4), (4, 6)])]
    found = cut(SQUARE, traces=traces)
    assert found.report.blocks == 2
    assert len(found.vertices) == 8
    assert found.report.dangling.count == 2
    assert found.report.dangling.length == pytest.approx(2.0, abs=1e-6)
    assert found.report.sets[0].kept == pytest.approx(10.0 / 12.0, rel=1e-6)


def test_a_vertex_stays_where_the_joint_changes():
    traces = [
        Trace(points=[(0, 5), (3, 5)], joint="rough"),
        Trace(points=[(3, 5), (10, 5)], joint="smooth"),
    ]
    found = cut(SQUARE, traces=traces)
    assert len(found.vertices) == 10
    assert joints_between(found) == {"rough": 2, "smooth": 2, "none": 6}


# Joints ------------------------------------------------------------------------------------------


def test_where_lines_coincide_the_later_table_has_the_joint_and_it_is_said():
    bedding = JointSet(name="bedding", angle=0.0, spacing=5.0, joint="bedding")
    fault = Trace(points=[(0, 5), (6, 5)], joint="fault")
    found = cut(SQUARE, [bedding], traces=[fault])
    assert joints_between(found) == {"fault": 2, "bedding": 2, "none": 6}
    assert found.report.coincident.count == 1
    assert found.report.coincident.length == pytest.approx(6.0)
    assert found.report.coincident.places[0] == pytest.approx((3.0, 5.0))
    same = cut(SQUARE, [bedding], traces=[Trace(points=[(0, 5), (6, 5)], joint="bedding")])
    assert same.report.coincident.count == 0


def test_outlines_are_construction_joints_until_they_are_excavated():
    line = JointSet(name="A", angle=0.0, spacing=5.0, joint="bedding")
    shape = Box(corner=(4, 4), size=(2, 2))
    found = cut(SQUARE, [line], openings=[Opening(name="heading", shape=shape)])
    assert found.joint_names == ("bedding", f"{CONSTRUCTION}heading", WELDED)
    # Left and right sides are halved by the bedding.
    assert joints_between(found)[f"{CONSTRUCTION}heading"] == 2 * 6
    assert (found.opening >= 0).sum() == 2
    void = cut(SQUARE, [line], openings=[Opening(name="heading", shape=shape, excavated=True)])
    assert void.report.area == pytest.approx(96.0)
    assert joints_between(void) == {"bedding": 4, "none": 12}


def test_an_opening_without_construction_joint_has_whole_blocks():
    line = JointSet(name="A", angle=0.0, spacing=1.0)
    one = Opening(
        name="bench", shape=Box(corner=(0, 7.4), size=(10, 2.6)), construction_joint=False
    )
    found = cut(SQUARE, [line], openings=[one])
    assert found.report.blocks == 10
    # Of the block from 7 to 8 more than half lies in it.
    assert (found.opening == 0).sum() == 3


def test_rock_is_that_of_the_region_with_most_of_a_block():
    line = JointSet(name="A", angle=0.0, spacing=1.0)
    bed = [(0, 0), (10, 0), (10, 3.6), (0, 3.6)]
    found = cut(SQUARE, [line], regions=[Region(name="bed", polygon=bed, rock="shale")])
    assert found.rock_names == ("rock", "shale")
    assert found.report.blocks == 10
    assert (found.rock == 1).sum() == 4
    contact = Region(name="bed", polygon=bed, rock="shale", joint="contact")
    parted = cut(SQUARE, [line], regions=[contact])
    assert parted.report.blocks == 11
    assert (parted.rock == 1).sum() == 4
    assert joints_between(parted)["contact"] == 2


def test_a_set_within_a_region():
    region = Region(name="left", polygon=[(0, 0), (5, 0), (5, 10), (0, 10)])
    wall = Trace(points=[(5, 0), (5, 10)])
    line = JointSet(name="A", angle=0.0, spacing=1.0, within="left")
    found = cut(SQUARE, [line], traces=[wall], regions=[region])
    assert found.report.blocks == 11
    assert found.report.sets[0].p21 == pytest.approx(9 * 5.0 / 50.0)


def test_cross_joints_end_at_the_first_bedding_plane():
    bedding = JointSet(name="bedding", angle=0.0, spacing=1.0, joint="bedding")
    cross = JointSet(
        name="cross",
        model=CrossJointed(),
        angle=90.0,
        spacing=2.0,
        terminates_at=["bedding"],
        stagger=0.5,
        joint="cross",
    )
    found = cut(SQUARE, [bedding, cross])
    # A running bond: 4 and 5 joints in turn, in ten layers.
    assert found.report.sets[1].lines == 5 * 4 + 5 * 5
    assert found.report.blocks == 5 * 5 + 5 * 6
    assert found.report.sets[1].length == pytest.approx(45.0)
    assert_tiles(found, 100.0)
    # The order of the tables does not matter for what is cut.
    assert cut(SQUARE, [cross, bedding]).report.blocks == found.report.blocks


def test_spacings_in_order_on_both_sides_of_the_origin():
    one = JointSet(name="A", angle=90.0, spacing=Values(values=[1.0, 2.0]), origin=(5, 0))
    found = cut(SQUARE, [one])
    assert sorted(set(np.round(found.vertices[:, 0], 9))) == [0, 1, 2, 4, 5, 6, 8, 9, 10]
    assert cut(SQUARE, [JointSet(name="A", angle=90.0, spacing=Fixed(5.0))]).report.blocks == 2


# Geometry as it comes ----------------------------------------------------------------------------


def test_clockwise_outlines_are_turned_round_and_it_is_said():
    clockwise = Domain(boundary=SQUARE.boundary[::-1])
    region = Region(name="bed", polygon=[(0, 0), (0, 3), (10, 3), (10, 0)], rock="shale")
    line = JointSet(name="A", angle=30.0, spacing=1.0)
    found = cut(clockwise, [line], regions=[region])
    assert found.report.notes == (
        "domain, boundary: clockwise, turned round",
        "region 'bed': clockwise, turned round",
    )
    assert_tiles(found, 100.0)
    straight = cut(SQUARE, [line], regions=[region])
    assert straight.vertices.tobytes() == found.vertices.tobytes()


@pytest.mark.parametrize("shift", [(0.0, 0.0), (4.5e5, 5.2e6), (1e6, -1e6)])
def test_large_coordinates_lose_nothing(shift):
    boundary = np.array([(0, 0), (60, 0), (60, 20), (40, 20), (20, 50), (0, 50)]) + shift
    sets = [
        JointSet(name="A", angle=35.0, spacing=2.0, origin=np.array((1.0, 1.0)) + shift),
        JointSet(name="B", angle=110.0, spacing=3.0, origin=np.array((1.0, 1.0)) + shift),
    ]
    found = cut(Domain(boundary=boundary), sets)
    assert_tiles(found, 60 * 20 + 20 * 30 + 0.5 * 20 * 30)
    at_home = cut(
        Domain(boundary=boundary - shift),
        [
            JointSet(name="A", angle=35.0, spacing=2.0, origin=(1.0, 1.0)),
            JointSet(name="B", angle=110.0, spacing=3.0, origin=(1.0, 1.0)),
        ],
    )
    assert found.report.blocks == at_home.report.blocks
    assert found.vertices - shift == pytest.approx(at_home.vertices, abs=2e-9)


def test_ends_of_traces_are_snapped_to_what_they_nearly_reach():
    domain = Domain(boundary=SQUARE.boundary, tolerance=1e-3)
    traces = [
        Trace(points=[(0.0008, 5.0), (9.9993, 5.0)]),
        Trace(points=[(5.0, 5.0007), (5.0, 9.9992)]),
        Trace(points=[(0.0005, 0.0006), (4.9995, 5.0006)]),
    ]
    found = cut(domain, traces=traces)
    assert found.report.blocks == 4
    assert found.report.dangling.count == 0
    assert found.report.snapped.count == 6
    assert_tiles(found, 100.0)


def test_outlines_of_openings_are_snapped_to_the_boundary():
    domain = Domain(boundary=SQUARE.boundary, tolerance=1e-3)
    corners = [(3, 0.0006), (5, 0.0004), (5, 2), (3, 2)]
    found = cut(domain, openings=[Opening(name="o", shape=Polygon(points=corners), excavated=True)])
    assert found.report.area == pytest.approx(96.0, rel=1e-12)
    assert found.report.blocks == 1
    assert found.report.snapped.count == 2


def test_arrays_are_frozen_and_the_report_is_plain():
    found = cut(SQUARE, [JointSet(name="A", angle=30.0, spacing=1.0)])
    for array in (found.vertices, found.block_start, found.rock, found.edge_joint, found.opening):
        assert array.flags.c_contiguous
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    text = json.dumps(found.report.as_dict())
    assert json.loads(text)["sets"][0]["name"] == "A"


# Masonry -----------------------------------------------------------------------------------------


def test_a_wall_in_running_bond():
    wall = BlockPattern(
        corner=(0, 0), size=(8.0, 3.0), brick=(0.4, 0.2), joint="bed", head_joint="head"
    )
    found = cut(Domain(boundary=wall.outline()), patterns=[wall])
    # 15 courses: 8 of 20 bricks, 7 of 19 and two halves.
    assert found.report.blocks == 8 * 20 + 7 * 21
    assert_tiles(found, 24.0)
    assert set(np.round(found.vertices[:, 1] / 0.2, 9)) <= set(range(16))
    names = joints_between(found)
    assert names["head"] == 2 * (8 * 19 + 7 * 20)
    built(found)


def test_a_stack_bond_with_a_window_and_a_lintel():
    wall = BlockPattern(corner=(0, 0), size=(2.0, 1.0), brick=(0.4, 0.2), pattern=StackBond())
    window = Opening(name="window", shape=Box(corner=(0.8, 0.2), size=(0.4, 0.4)), excavated=True)
    lintel = Opening(name="lintel", shape=Box(corner=(0.6, 0.6), size=(0.8, 0.2)), excavated=True)
    found = cut(Domain(boundary=wall.outline()), openings=[window, lintel], patterns=[wall])
    assert found.report.blocks == 25 - 2 - 1
    assert_tiles(found, 2.0 - 0.16 - 0.16)
    # The lintel is a block by hand: it fits to the bit.
    ends = {tuple(at) for at in found.vertices.tolist()}
    assert {(0.6, 0.6), (0.6, 0.8), (1.4, 0.6), (1.4, 0.8)} <= ends


# Regions of one block ----------------------------------------------------------------------------


def lintel(low: float = 0.6, high: float = 1.4, **more: object) -> Region:
    corners = [(low, 0.6), (high, 0.6), (high, 0.8), (low, 0.8)]
    return Region(name="lintel", polygon=corners, rock="concrete", one_block=True, **more)


WALL = BlockPattern(corner=(0, 0), size=(2.0, 1.0), brick=(0.4, 0.2), joint="mortar")


def test_a_lintel_is_one_block_of_a_wall():
    """Its ends are at head joints of its course, which are at 0.2, 0.6, 1, 1.4 and 1.8 m."""
    window = Opening(name="window", shape=Box(corner=(0.8, 0.2), size=(0.4, 0.4)), excavated=True)
    domain = Domain(boundary=WALL.outline(), rock="brick")
    found = cut(
        domain, openings=[window], regions=[lintel(joint="mortar")], patterns=[WALL], seed=1
    )
    assert_tiles(found, 2.0 - 0.16)
    concrete = np.flatnonzero(found.rock == found.rock_names.index("concrete"))
    assert len(concrete) == 1
    corners = found.polygon(concrete[0])
    assert corners.min(axis=0).tolist() == [0.6, 0.6]
    assert corners.max(axis=0).tolist() == [1.4, 0.8]
    assert found.report.dangling.length == 0.0
    assert set(joints_between(found)) == {"mortar", "none"}
    # The same without the key: as many pieces as bricks that the region lies in.
    plain = Region(name="lintel", polygon=lintel().polygon, rock="concrete", joint="mortar")
    pieces = cut(domain, openings=[window], regions=[plain], patterns=[WALL], seed=1)
    assert pieces.report.blocks - found.report.blocks == 1
    built(found)


@pytest.mark.parametrize(("low", "high"), [(0.5, 1.5), (0.61234567, 1.3987654), (0.0, 2.0)])
def test_the_ends_of_a_lintel_need_not_be_at_joints(low, high):
    found = cut(Domain(boundary=WALL.outline()), regions=[lintel(low, high)], patterns=[WALL])
    assert_tiles(found, 2.0)
    assert max(areas_of(found)) == pytest.approx(0.2 * (high - low), rel=1e-5)
    assert "concrete" in found.rock_names
    built(found)


def test_a_boulder_that_traces_do_not_cross():
    angle = np.linspace(0.0, 2.0 * np.pi, 20, endpoint=False)
    corners = np.stack([5.0 + 1.5 * np.cos(angle), 5.0 + 1.2 * np.sin(angle)], axis=1)
    boulder = Region(name="boulder", polygon=corners, one_block=True)
    sets = [
        JointSet(name="A", angle=20.0, spacing=0.4, joint="a"),
        JointSet(name="B", angle=100.0, spacing=0.5, trace_length=2.0, bridge_length=0.3),
    ]
    found = cut(SQUARE, sets, regions=[boulder], seed=2)
    assert_tiles(found, 100.0)
    inside = shapely.Polygon(corners).buffer(-1e-4)
    assert not shapely.contains_xy(inside, *found.vertices.T).any()
    assert max(areas_of(found)) == pytest.approx(shapely.Polygon(corners).area, rel=1e-3)
    built(found)


def test_an_opening_is_cut_out_of_a_region_of_one_block():
    slit = Opening(name="slit", shape=Box(corner=(0.9, 0.5), size=(0.2, 0.2)), excavated=True)
    found = cut(
        Domain(boundary=WALL.outline()), openings=[slit], regions=[lintel()], patterns=[WALL]
    )
    assert_tiles(found, 2.0 - 0.04)
    assert max(areas_of(found)) == pytest.approx(0.8 * 0.2 - 0.2 * 0.1, rel=1e-9)


def test_two_regions_of_one_block_cannot_overlap():
    other = Region(name="sill", polygon=[(1, 0.7), (2, 0.7), (2, 0.9), (1, 0.9)], one_block=True)
    with pytest.raises(ModelError, match="overlaps region 'sill', and both have one_block"):
        cut(Domain(boundary=WALL.outline()), regions=[lintel(), other], patterns=[WALL])
    beside = Region(name="sill", polygon=[(1, 0.8), (2, 0.8), (2, 1), (1, 1)], one_block=True)
    found = cut(Domain(boundary=WALL.outline()), regions=[lintel(), beside], patterns=[WALL])
    assert_tiles(found, 2.0)


def test_lines_that_end_at_an_inner_corner_do_not_dangle():
    """They are cut a little beyond the boundary, which there is rock."""
    ground = [(-1, -1), (3, -1), (3, 0), (2, 0), (2, 1), (0, 1), (0, 0), (-1, 0)]
    found = cut(Domain(boundary=ground), patterns=[WALL])
    assert found.report.dangling.count == 0
    assert_tiles(found, 2.0 + 4.0)
    trace = Trace(points=[(-0.5, -0.5), (0.3, -0.5)])
    assert cut(Domain(boundary=ground), traces=[trace]).report.dangling.length == pytest.approx(0.8)
