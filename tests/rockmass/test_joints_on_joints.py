"""Joints that end on joints part the rock: counts by construction, and by GEOS without a grid."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely

from clast.rockmass import CrossJointed, Domain, JointSet, Opening, Polygon, Region, Trace, cut
from clast.rockmass.cut_lines import set_lines, site
from clast.rockmass.cut_report import place_text
from scenes.command_line import clast_command, good
from scenes.cuttings import assert_tiles
from scenes.parted import Placed, ladder, parted, rectangle

ALL = {"smallest_edge": 0.0, "smallest_block": 0.0}
"""Limits that keep every block."""
TOLERANCES = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2]
FAR = [0.0, 1.3e3, 1.7e6, 5.6e6]


def placed(rng: np.random.Generator) -> Placed:
    """Return a place, most of them turned, at local or national coordinates."""
    turn = rng.choice([0.0, 0.5 * np.pi, rng.uniform(0.0, 2.0 * np.pi)])
    at = tuple(float(one) for one in rng.choice(FAR, 2))
    return Placed(float(turn), float(rng.choice([-1.0, 1.0])), at)


def traces(lines) -> list[Trace]:
    return [Trace(points=line) for line in lines]


@pytest.mark.parametrize("seed", range(15))
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_chords_across_faces_make_one_block_each(seed, tolerance):
    rng = np.random.default_rng(seed)
    chords = int(rng.integers(3, 60))
    place, corners = placed(rng), rectangle(*rng.uniform(15.0, 60.0, 2))
    lines = place(parted(rng, corners, chords, 30.0 * tolerance))
    found = cut(Domain(boundary=place(corners), tolerance=tolerance, **ALL), traces=traces(lines))
    assert found.block_count == len(lines) + 1
    assert found.report.dangling.count == 0
    assert found.report.warnings == ()
    assert_tiles(found)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_ladder_keeps_its_rungs(seed, tolerance):
    rng = np.random.default_rng(seed)
    place = placed(rng)
    domain = Domain(boundary=place(rectangle(40.0, 40.0)), tolerance=tolerance, **ALL)
    found = cut(domain, traces=traces(ladder(100, 40.0, place)))
    assert found.block_count == 103
    assert found.report.snapped.count <= 4  # the ends of the rails, at the boundary


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_rungs_end_on_the_lines_of_a_joint_set(seed, tolerance):
    rng = np.random.default_rng(seed)
    place, angle = placed(rng), rng.uniform(-40.0, 40.0)
    along = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    across = np.array([-along[1], along[0]])
    # Lines 3 m apart through the middle of a square of 30 m; rungs between the first three.
    level, at = rng.integers(-1, 1, 40), 0.35 * (np.arange(40) - 20.0)
    foot = np.array([15.0, 15.0]) + 3.0 * level[:, None] * across + at[:, None] * along
    lean = 3.0 * across + rng.uniform(0.0, 0.1, (40, 1)) * along
    turned = place(np.array([[0.0, 0.0], along]))
    direction = np.degrees(np.arctan2(*(turned[1] - turned[0])[::-1]))
    bedding = JointSet(
        name="a", angle=float(direction), spacing=3.0, origin=place(np.array([15.0, 15.0]))
    )
    corners = rectangle(30.0, 30.0)
    found = cut(
        Domain(boundary=place(corners), tolerance=tolerance, **ALL),
        [bedding],
        traces(place(np.stack([foot, foot + lean], axis=1))),
    )
    levels = (corners - 15.0) @ across / 3.0
    lines = np.floor(levels.max()) - np.ceil(levels.min()) + 1
    assert found.block_count == lines + 1 + 40


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_set_within_a_region_ends_on_its_outline(seed, tolerance):
    rng = np.random.default_rng(seed)
    place = placed(rng)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, 6)) if seed % 2 else np.arange(5) * 1.2566
    lens = place(15.0 + 10.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    if shapely.Polygon(lens - lens[0]).area < 20.0:
        return
    direction = float(rng.uniform(0.0, 180.0))
    normal = np.array([-np.sin(np.radians(direction)), np.cos(np.radians(direction))])
    middle = lens.mean(axis=0)
    levels = (lens - middle) @ normal / 0.4
    count = np.floor(levels.max()) - np.ceil(levels.min()) + 1
    if min(levels.max() % 1.0, -levels.min() % 1.0) < 0.1:
        return  # a line through a corner cuts off less than the grid
    joints = JointSet(name="s", angle=direction, spacing=0.4, origin=middle, within="lens")
    found = cut(
        Domain(boundary=place(rectangle(30.0, 30.0)), tolerance=tolerance, **ALL),
        [joints],
        regions=[Region(name="lens", polygon=lens, joint="edge")],
    )
    # The rock around the lens is a ring: two welds make two blocks of it.
    assert found.block_count == count + 1 + 2
    assert found.report.dangling.count == 0


@pytest.mark.parametrize("excavated", [True, False])
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_joints_end_on_the_outline_of_an_opening(seed, tolerance, excavated):
    rng = np.random.default_rng(seed)
    place, corners = placed(rng), rectangle(30.0, 30.0)
    inner = 11.0 + rectangle(8.0, 8.0)
    side, share = rng.integers(0, 4, 30), rng.uniform(0.1, 0.9, 30)
    start, end = (
        c[side] + share[:, None] * (c[(side + 1) % 4] - c[side]) for c in (inner, corners)
    )
    apart = np.abs(np.subtract.outer(side + share, side + share)) + np.eye(30)
    if apart.min() < 20.0 * tolerance or len(np.unique(side)) < 2:
        return
    opening = Opening(name="o", shape=Polygon(points=place(inner)), excavated=excavated)
    domain = Domain(boundary=place(corners), tolerance=tolerance, **ALL)
    found = cut(domain, [], traces(place(np.stack([start, end], axis=1))), [opening])
    assert found.block_count == 30 + (not excavated)


def faces_and_holes(lines, rim) -> int:
    """Return the faces that lines make, lengthened by a hair, and their holes: by GEOS."""
    way = lines[:, 1] - lines[:, 0]
    hair = 1e-9 * way / np.hypot(*way.T)[:, None]
    longer = lines + np.stack([-hair, hair], axis=1)
    united = shapely.unary_union([*shapely.linestrings(longer), rim.exterior])
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(united)))
    return len(faces) + int(shapely.get_num_interior_rings(faces).sum())


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("tolerance", TOLERANCES[:4])  # coarser ones merge a dozen slivers
def test_sets_that_end_at_sets_that_end_at_sets(seed, tolerance):
    rng = np.random.default_rng(seed)
    place = placed(rng)
    angle = float(rng.uniform(0.0, 180.0))
    sets = [
        JointSet(name="a", angle=angle, spacing=3.1),
        JointSet(
            name="b",
            model=CrossJointed(),
            angle=angle + 70.0,
            spacing=2.3,
            stagger=0.4,
            terminates_at=["a"],
        ),
        JointSet(
            name="c",
            model=CrossJointed(),
            angle=angle + 20.0,
            spacing=1.1,
            terminates_at=["a", "b"],
        ),
    ]
    domain = Domain(boundary=place(rectangle(20.0, 20.0)), tolerance=tolerance, **ALL)
    at = site(domain, [], [])
    lines = np.concatenate([one.ends for one in set_lines(at, sets, [], 0)])
    found = cut(domain, sets)
    # What is thinner than four cells is not a block.
    merged = found.report.merged.count
    assert found.block_count == faces_and_holes(lines, at.window.polygon) - merged
    assert merged <= 3
    assert found.report.dangling.length < 1e-3


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("tolerance", [1e-5, 1e-3])
def test_ends_within_the_tolerance_of_a_line_are_on_it(seed, tolerance):
    rng = np.random.default_rng(seed)
    place = placed(rng)
    lines = ladder(40, 40.0, lambda points: points)
    lines[2:] += rng.uniform(-0.6, 0.6, (40, 2, 2)) * tolerance
    domain = Domain(boundary=place(rectangle(40.0, 40.0)), tolerance=tolerance, **ALL)
    assert cut(domain, traces=traces(place(lines))).block_count == 43


CASE = """
schema = 1
time = {{step = 1e-3, end = 2e-3}}
gravity = [0.0, 0.0]
rock.r = {{young = 2e10, poisson = 0.2, density = 2700.0}}
joint.default = {{friction_angle = 30.0}}
[domain]
boundary = [[{x}, {y}], [{x1}, {y}], [{x1}, {y1}], [{x}, {y1}]]
tolerance = 1e-4
[[trace]]
points = [[{x}, {ym}], [{x1}, {ym}]]
[[trace]]
points = [[{xm}, {end}], [{xm}, {y1}]]
"""


def near_tee(x: float, y: float, gap: float) -> str:
    """Return a case whose second trace ends this far above the first one, m."""
    numbers = {"x": x, "y": y, "x1": x + 10, "y1": y + 10, "xm": x + 5.25, "ym": y + 4}
    return CASE.format(**numbers, end=f"{y + 4 + gap:.6f}")


@pytest.mark.parametrize("corner", [(0.0, 0.0), (1234567.0, 5678901.0)])
def test_an_end_just_short_of_a_line_is_warned_of_with_its_place(tmp_path, corner):
    x, y = corner
    (tmp_path / "near.toml").write_text(near_tee(x, y, 5e-4))
    place = place_text((x + 5.25, y + 4.0005), 1e-4)
    case, output = tmp_path / "near.toml", tmp_path / "near.vtkhdf"
    report = json.loads(good("cut", case, "--json"))
    assert report["loose"]["count"] == 1
    assert place in report["warnings"][0]
    for command in (["cut", case], ["check", case], ["run", case, "-o", output, "--quiet"]):
        result = clast_command(*command)
        assert result.exit_code == 0
        assert place in result.stderr.replace("\n", " "), command
    assert place in json.loads(good("info", output, "--json"))["report"]["warnings"][-1]


@pytest.mark.parametrize(("gap", "blocks"), [(0.0, 3), (8e-5, 3), (-5e-4, 3), (2e-3, 2)])
def test_ends_that_meet_a_line_or_are_far_from_it_are_not_warned_of(tmp_path, gap, blocks):
    (tmp_path / "tee.toml").write_text(near_tee(0.0, 0.0, gap))
    report = json.loads(good("cut", tmp_path / "tee.toml", "--json"))
    assert (report["blocks"], report["warnings"]) == (blocks, [])
