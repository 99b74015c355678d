"""Any network tiles its domain with sound blocks: C3, by random boundaries, sets and openings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from clast.rockmass import (
    Baecher,
    Box,
    Circle,
    Domain,
    Exponential,
    JointSet,
    Opening,
    Polygon,
    Trace,
    Voronoi,
    cut,
)
from clast.rockmass.noding import noded
from clast.rockmass.planar import Graph, loops_of, parts_of
from scenes.cuttings import assert_tiles, built, random_network


@pytest.mark.slow
@settings(max_examples=40)
@given(st.integers(100_000, 200_000), st.sampled_from([10, 60, 250]))
def test_blocks_tile_the_domain(seed, blocks):
    domain, tables = random_network(seed, blocks)
    found = cut(domain, **tables)
    boundary = shapely.Polygon(domain.boundary)
    void = [shapely.Polygon(o.outline().corners) for o in tables["openings"] if o.excavated]
    middle = np.array(boundary.bounds[:2])

    def local(polygon):
        return shapely.transform(polygon, lambda xy: xy - middle)

    area = local(boundary).area
    if void:
        area -= local(boundary).intersection(local(shapely.union_all(void))).area
    assert_tiles(found, area)
    built(found)


def bytes_of(found) -> tuple[bytes, ...]:
    arrays = (found.vertices, found.block_start, found.edge_joint, found.rock, found.opening)
    return tuple(array.tobytes() for array in arrays)


@settings(max_examples=8)
@given(st.integers(0, 10_000))
def test_the_same_seed_gives_the_same_bytes(seed):
    domain, tables = random_network(seed, 80)
    assert bytes_of(cut(domain, **tables)) == bytes_of(cut(domain, **tables))


SQUARE = Domain(boundary=[(0, 0), (10, 0), (10, 10), (0, 10)])
RANDOM = JointSet(
    name="A", model=Baecher(), angle=30.0, intensity=2.0, trace_length=Exponential(mean=4.0)
)
OTHER = JointSet(name="B", angle=100.0, spacing=Exponential(mean=1.0))


def test_another_set_leaves_the_lines_of_the_others():
    from clast.rockmass.cut_lines import set_lines, site

    at = site(SQUARE, [], [])
    alone = set_lines(at, [RANDOM, OTHER], [], 4)
    with_more = set_lines(at, [RANDOM, OTHER, replace(RANDOM, name="C", angle=None)], [], 4)
    for one, same in zip(alone, with_more, strict=False):
        assert one.ends.tobytes() == same.ends.tobytes()
    elsewhere = set_lines(at, [RANDOM, OTHER], [], 5)
    assert alone[0].ends.tobytes() != elsewhere[0].ends.tobytes()


def test_a_seed_of_its_own_is_not_that_of_the_case():
    own = replace(RANDOM, seed=1)
    same = [cut(SQUARE, [own, OTHER], seed=seed).report.sets[0].length for seed in (1, 2)]
    assert same[0] == same[1]
    other = [cut(SQUARE, [RANDOM, OTHER], seed=seed).report.sets[0].length for seed in (1, 2)]
    assert other[0] != other[1]


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.integers(2, 60))
def test_faces_edges_nodes_and_parts_obey_euler(seed, count):
    # F = E - V + C, the outside not counted
    rng = np.random.default_rng(seed)
    net = noded(rng.uniform(0, 300, (count, 2, 2)))
    blank = np.zeros(len(net.edge), np.int64)
    graph = Graph(
        xy=net.xy,
        edge=net.edge,
        line=blank,
        joint=blank,
        barrier=blank > 0,
        side=np.zeros((len(net.edge), 2), np.int64),
    )
    loops = loops_of(graph)
    parts = parts_of(graph).max() + 1
    assert (loops.area2 > 0).sum() == len(net.edge) - len(net.xy) + parts
    assert (loops.area2 <= 0).sum() == parts
    assert loops.area2.sum() == 0
    # GEOS finds the same faces; theirs are without holes, as ours are.
    faces = shapely.get_parts(
        shapely.polygonize(shapely.linestrings(net.xy[net.edge].astype(float)))
    )
    shells = [shapely.Polygon(face.exterior).area for face in faces]
    simple = np.sort(loops.area2[loops.area2 > 0]) / 2
    assert simple.sum() == pytest.approx(sum(shells))


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.integers(2, 40))
def test_pieces_meet_in_nodes_only_and_lie_on_their_lines(seed, count):
    rng = np.random.default_rng(seed)
    ends = rng.uniform(0, 100, (count, 2, 2))
    net = noded(ends)
    pieces = shapely.linestrings(net.xy[net.edge].astype(float))
    first, _ = shapely.STRtree(pieces).query(pieces, predicate="crosses")
    assert len(first) == 0
    for piece, line in net.of:
        whole = shapely.LineString(ends[line])
        for node in net.edge[piece]:
            assert shapely.distance(shapely.Point(net.xy[node]), whole) <= 0.7072
    assert set(net.of[:, 0]) == set(range(len(net.edge)))


def test_cells_limited_to_a_triangle_become_an_island():
    one = JointSet(name="v", model=Voronoi(), spacing=0.5, within=[(3, 3), (6, 3), (6, 6)])
    found = cut(SQUARE, [one])
    assert_tiles(found, 100.0)
    assert found.report.dangling.count > 0
    assert found.report.rings.count == 1


def lattice_traces(rng: np.random.Generator, size: int) -> list[Trace]:
    """Return polylines between points of a lattice, some of them a little beside it."""
    found = []
    for _ in range(int(rng.integers(1, 40))):
        points = rng.integers(0, size + 1, (int(rng.integers(2, 5)), 2)).astype(float)
        if rng.random() < 0.3:
            points += rng.normal(0.0, rng.choice([1e-7, 1e-5, 1e-3]), points.shape)
        found.append(Trace(points=points, joint=str(rng.choice(["a", "b"]))))
    middle = 0.25 * size
    return [*found, Trace(points=[(0, middle), (size, middle)], joint="c")]


SHARP = (
    [(0, 0), (8, 0), (8, 8), (0, 8)],
    [(0, 0), (8, 0), (8, 4), (4, 4), (4, 8), (0, 8)],
    [(0, 0), (8, 0), (4, 2), (8, 8), (0, 8), (2, 4)],
)
"""Boundaries whose corners and edges meet the lattice."""


@pytest.mark.slow
@settings(max_examples=40)
@given(
    st.integers(0, 100_000),
    st.sampled_from(SHARP),
    st.sampled_from([{}, {"smallest_edge": 0.0, "smallest_block": 0.0}, {"smallest_edge": 0.3}]),
)
def test_lines_that_meet_in_corners_and_run_along_each_other(seed, boundary, limits):
    rng = np.random.default_rng(seed)
    opening = Opening(
        name="o",
        shape=Box(corner=rng.integers(1, 3, 2), size=rng.integers(1, 4, 2)),
        excavated=bool(rng.random() < 0.5),
    )
    diagonal = JointSet(name="s", angle=45.0, spacing=float(np.sqrt(0.5)), origin=(0, 0))
    found = cut(
        Domain(boundary=boundary, **limits),
        [diagonal] if rng.random() < 0.4 else [],
        lattice_traces(rng, 8),
        openings=[opening] if rng.random() < 0.5 else [],
    )
    assert_tiles(found)
    built(found)


def openings(seed: int, count: int) -> list[Opening]:
    rng = np.random.default_rng(seed)
    found = []
    for number in range(count):
        center, corners = rng.uniform(0, 10, 2), int(rng.integers(3, 7))
        angle = (np.arange(corners) + rng.uniform(0, 0.9, corners)) * 2 * np.pi / corners
        radius = rng.uniform(0.3, 2, (corners, 1))
        shape = Polygon(points=center + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        if rng.random() < 0.5:
            chords = int(rng.integers(5, 20))
            shape = Circle(center=center, radius=rng.uniform(0.3, 2), chords=chords)
        excavated = bool(rng.random() < 0.5)
        found.append(Opening(name=f"{number}", shape=shape, excavated=excavated))
    return found


def domain(tolerance: float) -> Domain:
    square = [(0, 0), (10, 0), (10, 10), (0, 10)]
    return Domain(boundary=square, tolerance=tolerance, smallest_edge=0.0, smallest_block=0.0)


def sets(seed: int) -> list[JointSet]:
    rng = np.random.default_rng(1000 + seed)
    spacings = {"a": 0.7, "b": 0.9}
    return [
        JointSet(name=name, angle=rng.uniform(0, 180), spacing=spacing)
        for name, spacing in spacings.items()
    ]


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-5, 1e-3, 1e-2])
@pytest.mark.one_in(3)
def test_areas_of_thirty_openings(tolerance):
    """Blocks have all of the rock: to round-off, but where the rock is thinner than the grid.

    On a grid of 1e-3 of the domain some acute corners between voids are thinner than four cells;
    the blocks there are merged, which costs no more than the tip: some cells times its length.
    """
    errors = []
    for seed in range(12):
        report = cut(domain(tolerance), sets(seed), openings=openings(seed, 30)).report
        errors.append(abs(report.area - report.domain_area))
        assert (abs(report.area_error) > 1e-9) == any(
            "differ from that" in one for one in report.notes
        )
    exact = np.sum(np.array(errors) < 1e-9 * 40.0)
    # Tips of a cell's width are a hundred times as frequent on a grid a hundred times as coarse.
    assert exact >= {1e-5: 12, 1e-3: 10, 1e-2: 7}[tolerance]
    assert max(errors) < 4.0 * tolerance * 0.5


def test_outlines_that_meet_in_one_cell_stay_on_the_rim():
    """Two outlines cross next to the wall of a void: their crossing is put onto the wall."""
    void = Opening(name="void", shape=Box(corner=(4, 2), size=(4, 6)), excavated=True)
    tips = [(3.999_6, 5.0), (1.0, 7.0), (1.0, 6.0)], [(3.999_7, 5.000_3), (1.5, 2.0), (1.0, 4.0)]
    others = [
        Opening(name=f"{number}", shape=Polygon(points=tip)) for number, tip in enumerate(tips)
    ]
    found = cut(domain(1e-3), sets(0), openings=[void, *others]).report
    assert abs(found.area - (100.0 - 24.0)) < 1e-9
