"""Pictures of cuts: what is drawn, in which colours, with which legends, and what is refused."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from clast.errors import CaseError
from clast.pictures.figure_options import DEFAULT, Look
from clast.pictures.rock_mass import plot_cut, plot_cut_statistics, write_cut_report
from clast.pictures.rock_mass.cut_statistics import SECTOR, sectors, statistics_figure
from clast.pictures.rock_mass.section import cut_figure, edges_of_cut
from clast.pictures.strokes import JOINT_COLOURS
from clast.rockmass import (
    BlockPattern,
    Circle,
    Cut,
    Domain,
    Horseshoe,
    JointSet,
    Opening,
    Region,
    Trace,
    Voronoi,
    cut,
)

matplotlib = pytest.importorskip("matplotlib")


def rectangle(width: float, height: float, **settings: float) -> Domain:
    return Domain(boundary=[(0, 0), (width, 0), (width, height), (0, height)], **settings)


@pytest.fixture(scope="module")
def wall() -> Cut:
    """Four courses of bricks of 0.5 m x 0.25 m."""
    brick = BlockPattern(
        name="wall", corner=(0, 0), size=(2, 1), brick=(0.5, 0.25), joint="bed", head_joint="head"
    )
    return cut(rectangle(2, 1), patterns=[brick])


@pytest.fixture(scope="module")
def tunnel() -> Cut:
    """Two sets, one of them without a joint, a fault, rock that will be excavated, a void."""
    return cut(
        rectangle(60, 40),
        [
            JointSet(name="A", angle=30.0, spacing=5.0, joint="bedding"),
            JointSet(name="B", angle=110.0, spacing=7.0),
        ],
        traces=[Trace(points=[(0, 35), (47, 21)], joint="fault $1$")],
        openings=[
            Opening(name="heading", shape=Horseshoe(center=(30, 15), width=10, wall_height=5)),
            Opening(name="adit", shape=Circle(center=(12, 25), radius=3), excavated=True),
        ],
        regions=[Region(name="floor", polygon=[(0, 0), (60, 0), (60, 8), (0, 8)], rock="shale")],
    )


def drawn(found: Cut, by: str = "joint", look: Look = DEFAULT):
    """The figure, and its collections and patches by their labels."""
    figure = cut_figure(found, by=by, title="", look=look)
    axes = figure.axes[0]
    return figure, {one.get_label(): one for one in (*axes.collections, *axes.patches)}


def legend(figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def length(collection) -> float:
    return sum(np.hypot(*np.diff(one, axis=0).T).sum() for one in collection.get_segments())


def colour(collection) -> str:
    return matplotlib.colors.to_hex(collection.get_color()[0])


def test_joints_of_a_wall_have_their_colours_and_lengths(wall: Cut):
    figure, found = drawn(wall)
    assert list(found) == ["bed", "head", "boundary", "rock: rock"]
    assert [colour(found[name]) for name in ("bed", "head")] == list(JOINT_COLOURS[:2])
    # 3 beds of 2 m; 2 courses with 3 head joints, 2 with 4, of 0.25 m each; the rim
    assert length(found["bed"]) == pytest.approx(3 * 2.0)
    assert length(found["head"]) == pytest.approx((2 * 3 + 2 * 4) * 0.25)
    assert length(found["boundary"]) == pytest.approx(2 * (2.0 + 1.0))
    assert legend(figure) == ["bed", "head", "boundary"]
    assert figure.axes[0].get_aspect() == 1.0
    assert (figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()) == ("x (m)", "y (m)")


def test_edges_inside_are_drawn_once(tunnel: Cut):
    found = edges_of_cut(tunnel)
    every = sum(one.lengths.sum() for one in (*found.joints, *found.others))
    rim = np.hypot(*(found.rim[:, 1] - found.rim[:, 0]).T).sum()
    onwards = [np.roll(tunnel.polygon(b), -1, axis=0) for b in range(tunnel.block_count)]
    sides = np.hypot(*(np.concatenate(onwards) - tunnel.vertices).T).sum()
    assert every == pytest.approx(0.5 * (sides + rim))


def test_sets_that_share_a_joint_have_colours_of_their_own():
    sets = [
        JointSet(name="bedding", angle=10.0, spacing=3.0, joint="rough"),
        JointSet(name="steep", angle=80.0, spacing=4.0, joint="rough"),
        JointSet(name="third", angle=130.0, spacing=9.0),
    ]
    found = cut(rectangle(30, 20), sets)
    figure, lines = drawn(found, "set")
    assert legend(figure) == ["bedding", "steep", "third", "boundary"]
    assert len({colour(lines[one.name]) for one in sets}) == 3
    by_joint = drawn(found)[1]
    assert length(lines["bedding"]) + length(lines["steep"]) == pytest.approx(
        length(by_joint["rough"])
    )
    assert length(lines["third"]) == pytest.approx(length(by_joint["no joint named"]))
    # lines run as their set does, but for edges beside collapsed ones
    for one in sets:
        along = np.concatenate([np.diff(k, axis=0) for k in lines[one.name].get_segments()])
        turn = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 180.0
        assert np.mean(np.abs(turn - one.angle) < 0.3) > 0.9


def test_beds_and_heads_of_a_pattern_are_two_sets(wall: Cut, tunnel: Cut):
    assert list(drawn(wall, "set")[1])[:2] == ["wall: bed", "wall: head"]
    assert legend(drawn(tunnel, "set")[0])[:3] == ["A", "B", "traces"]


def test_openings_voids_and_what_is_no_joint_look_different(tunnel: Cut):
    figure, found = drawn(tunnel)
    assert legend(figure) == [
        "bedding",
        r"fault \$1\$",
        "no joint named",
        "construction joint",
        "boundary",
        "opening, not excavated yet",
        "void",
    ]
    assert found["construction joint"].get_linestyle() != found["boundary"].get_linestyle()
    assert found["opening: heading"].get_hatch() != found["void"].get_hatch()
    names = [text.get_text() for text in figure.axes[0].texts]
    assert names == ["heading"]


def test_the_void_is_the_opening_that_is_excavated(tunnel: Cut):
    _, found = drawn(tunnel)
    low, high = found["void"].get_path().get_extents().get_points()
    assert low == pytest.approx([9, 22], abs=0.1)
    assert high == pytest.approx([15, 28], abs=0.1)


def test_blocks_by_rock(tunnel: Cut):
    figure, found = drawn(tunnel, "rock")
    assert {"rock", "shale", "joints"} <= set(legend(figure))
    rocks = [found[f"rock: {name}"] for name in ("rock", "shale")]
    assert rocks[0].get_facecolor() != rocks[1].get_facecolor()
    assert "bedding" not in found
    _, plain = drawn(tunnel)
    assert plain["rock: rock"].get_facecolor() == plain["rock: shale"].get_facecolor()


@pytest.fixture(scope="module")
def ring() -> Cut:
    """A domain with a hole, and no joints."""
    hole = Opening(name="h", shape=Circle(center=(5, 4), radius=2))
    return cut(rectangle(10, 8), openings=[hole])


def test_welds_are_dotted_and_a_ring_has_them(ring: Cut):
    figure, found = drawn(ring)
    assert "welded: no joint" in legend(figure)
    assert found["welded: no joint"].get_linestyle() != found["boundary"].get_linestyle()


def test_more_joints_than_colours_are_dashed():
    sets = [
        JointSet(name=f"set {k}", angle=20.0 * k + 3, spacing=9.0 + k, joint=f"joint {k}")
        for k in range(9)
    ]
    looks = [one.stroke for one in edges_of_cut(cut(rectangle(60, 50), sets)).joints]
    assert len({(one.colour, str(one.dashes)) for one in looks}) == 9


def test_long_names_are_shortened():
    name = "the bedding planes of the upper sandstone at the foot of the eastern wall"
    found = cut(rectangle(10, 8), [JointSet(name="A", angle=30.0, spacing=2.0, joint=name)])
    figure, _ = drawn(found)
    (label,) = (text for text in legend(figure) if text.startswith("the bedding"))
    assert label.endswith("…")
    assert len(label) <= 41


def test_a_part_shows_what_is_in_it(tunnel: Cut):
    figure, found = drawn(tunnel, look=Look(zoom=(40, 1, 55, 12)))
    assert "void" not in legend(figure)
    assert "construction joint" not in legend(figure)
    assert length(found["bedding"]) < 0.5 * length(drawn(tunnel)[1]["bedding"])
    inside_one_block = Look(zoom=(40.0, 1.0, 40.01, 1.01))
    assert len(cut_figure(tunnel, by="set", title="", look=inside_one_block).axes) == 1


def test_many_blocks_are_dots_in_a_drawing(tmp_path: Path):
    many = cut(
        rectangle(60, 45),
        [
            JointSet(name="A", angle=30.0, spacing=0.6, joint="a"),
            JointSet(name="B", angle=115.0, spacing=0.6, joint="b"),
        ],
    )
    assert many.block_count > 5000
    text = plot_cut(many, tmp_path / "many.svg").read_text("utf-8")
    assert "data:image/png" in text
    assert len(text) < 20_000_000


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_formats(wall: Cut, tmp_path: Path, suffix: str):
    assert plot_cut(wall, tmp_path / f"a.{suffix}", by="rock").stat().st_size > 1000
    assert plot_cut_statistics(wall, tmp_path / f"b.{suffix}").stat().st_size > 1000


def test_rose_has_the_length_of_joints_by_direction(wall: Cut):
    length = sectors(edges_of_cut(wall).joints)
    # beds run at 0 degrees, heads at 90
    assert length.shape == (2, round(180 / SECTOR))
    assert length[0, 0] == pytest.approx(6.0)
    assert length[1, round(90 / SECTOR)] == pytest.approx(3.5)
    assert length.sum() == pytest.approx(9.5)


def test_rose_takes_a_line_for_the_same_both_ways(tunnel: Cut):
    bedding, *_ = edges_of_cut(tunnel).joints
    length = sectors([bedding])[0]
    assert length[round(30 / SECTOR)] == pytest.approx(bedding.lengths.sum())


def test_sectors_of_the_rose_have_areas_as_lengths(wall: Cut):
    rose = statistics_figure(wall, title="").axes[0]
    area = {}
    for bars in rose.containers:
        outer = np.array([bar.get_y() + bar.get_height() for bar in bars])
        inner = np.array([bar.get_y() for bar in bars])
        area[bars.get_label()] = float((outer**2 - inner**2).sum())
        # both ways
        half = len(outer) // 2
        assert outer[:half] == pytest.approx(outer[half:])
    assert area["wall: bed"] / area["wall: head"] == pytest.approx(6.0 / 3.5)


def test_histograms_count_all_blocks_and_edges_and_mark_the_limits(tunnel: Cut):
    _, areas, edges = statistics_figure(tunnel, title="").axes
    assert sum(bar.get_height() for bar in areas.patches) == tunnel.block_count
    assert sum(bar.get_height() for bar in edges.patches) == len(tunnel.vertices)
    limits = (tunnel.report.smallest_block, tunnel.report.smallest_edge)
    for axes, limit in zip((areas, edges), limits, strict=True):
        (line,) = (one for one in axes.lines if one.get_label() == "limit")
        assert line.get_xdata()[0] == limit
        assert any(text.get_text().startswith("limit") for text in axes.texts)
        assert axes.get_xscale() == "log"


def test_sizes_that_hardly_differ_have_a_plain_scale(wall: Cut):
    _, areas, edges = statistics_figure(wall, title="").axes
    assert areas.get_xscale() == edges.get_xscale() == "linear"
    assert sum(bar.get_height() for bar in areas.patches) == wall.block_count


def test_a_domain_without_joints_has_statistics_too(ring: Cut):
    rose, *_ = statistics_figure(ring, title="").axes
    assert rose.get_title() == "No joints between blocks"
    assert not rose.patches


class _Page(HTMLParser):
    """Tags that are open, cells of tables, sources of pictures, links."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.cells: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.links: list[str] = []

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        if tag == "img":
            self.pictures.append(found)
        self.links += [found[name] for name in ("href", "src", "srcset") if name in found]
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("td", "th", "p", "h1", "li"):
            self.cells.append(data)


def read(path: Path) -> _Page:
    found = _Page()
    found.feed(path.read_text("utf-8").removeprefix("<!doctype html>"))
    assert not found.open
    return found


def test_page_is_complete_in_itself(tunnel: Cut, tmp_path: Path):
    path = write_cut_report(tunnel, tmp_path / "cut.html", title="<b>Heading</b> & adit")
    found = read(path)
    assert "<b>Heading</b> & adit" in found.cells
    assert len(found.pictures) == 3  # by set, by rock, statistics
    assert all(one["alt"] for one in found.pictures)
    assert all(link.startswith("data:image/png;base64,") for link in found.links)
    assert not re.search(r"url\(|@import|<script", path.read_text("utf-8"))
    report = tunnel.report
    for one in report.sets:
        assert {one.name, f"{one.p21:.4g}", f"{one.p10:.4g}"} <= set(found.cells)
    assert f"{report.block_area.median:.4g}" in found.cells
    places = [re.match(r"\((\S+), (\S+)\)", cell) for cell in found.cells]
    named = np.array([[float(number) for number in one.groups()] for one in places if one])
    assert np.hypot(*(named - report.dangling.places[0]).T).min() < 1e-4


def test_page_names_sets_as_they_are(tmp_path: Path):
    found = cut(rectangle(10, 8), [JointSet(name="<A&B>", angle=30.0, spacing=2.0, joint="<x>")])
    page = read(write_cut_report(found, tmp_path / "cut.htm"))
    assert "<A&B>" in page.cells
    assert len(page.pictures) == 2  # one rock: no picture of rocks


def test_page_of_cells(tmp_path: Path):
    cells = JointSet(name="cells", model=Voronoi(), spacing=1.5, joint="cells")
    found = cut(rectangle(20, 15), [cells], seed=3)
    assert write_cut_report(found, tmp_path / "cut.html").stat().st_size > 10_000


def test_what_cannot_be_drawn_is_refused(wall: Cut, tmp_path: Path):
    with pytest.raises(CaseError, match="did you mean 'rock'"):
        plot_cut(wall, tmp_path / "a.png", by="rocks")
    with pytest.raises(CaseError, match="limits do not apply"):
        plot_cut(wall, tmp_path / "a.png", look=Look(limits=(0.0, 1.0)))
    with pytest.raises(CaseError, match="no block lies in this area"):
        plot_cut(wall, tmp_path / "a.png", look=Look(zoom=(5, 5, 6, 6)))
    assert not list(tmp_path.iterdir())
