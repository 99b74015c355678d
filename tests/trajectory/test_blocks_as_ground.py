"""Rocks over blocks that stand: as over a profile of their outline; blocks of a run as rocks."""

import itertools

import numpy as np
import pytest

import clast
from clast.trajectory import path

SLOPE = [(0, 20), (8, 19), (14, 8), (13, 6), (24, 2), (40, 0), (60, 0)]
SURFACE = {"normal_restitution": 0.5, "tangential_restitution": 0.7, "friction_angle": 30.0}
SOURCE = {"name": "edge", "line": [[3, 22], [7, 21]], "rocks": 6, "volume": 0.5}
FALL = {**SOURCE, "velocity": [3.0, 0.0], "spin": 1.0}
ROCK = {"young": 5e10, "poisson": 0.2, "density": 2600.0}
TIME = {"step": 1e-3, "end": 0.1}


def case_of(**tables):
    named = {"rock": SURFACE, "granite": SURFACE}
    common = {"surface": named, "source": [FALL], "time": TIME, "rock": {"granite": ROCK}}
    return clast.Case.validated({**common, **tables}, "rocks.toml")


def block(*vertices, fixed=True, **keys):
    keys = {"rock": "granite", "fixed": fixed, **keys}
    return {"vertices": [list(map(float, one)) for one in vertices], **keys}


def blows(case, most=5):
    """Times, places and velocities of the first blows of all paths of a case."""
    campaign = case.campaign()
    found = []
    for number in range(1, campaign.count + 1):
        course = campaign.follow(number).course
        rows = course.records[: course.tally[0]]
        rows = rows[rows[:, path.KIND] == path.BLOW][:most, path.CLOCK : path.FACE].copy()
        rows[:, 1:3] += campaign.origin
        found.append(rows)
    return np.concatenate(found)


def drawn(points=SLOPE):
    table = {"profile": [list(map(float, one)) for one in points], "surface": ["rock"]}
    return case_of(rockfall=table, rock={})


def in_pieces(points, bottom=-5.0):
    """Fixed blocks under a line without overhangs, one to a segment."""
    pairs = itertools.pairwise(points)
    return [block((x, bottom), (u, bottom), (u, v), (x, y)) for (x, y), (u, v) in pairs]


PLAIN = [one for one in SLOPE if one != (13, 6)]


def test_a_path_over_fixed_blocks_is_that_over_their_outline() -> None:
    whole = case_of(rockfall={}, block=[block(*SLOPE[::-1], (0, -5), (60, -5))])
    np.testing.assert_allclose(blows(whole), blows(drawn()), rtol=0, atol=1e-9)
    pieces = case_of(rockfall={}, block=in_pieces(PLAIN))
    np.testing.assert_allclose(blows(pieces), blows(drawn(PLAIN)), rtol=0, atol=1e-9)


def test_joints_across_faces_and_on_the_profile_change_no_path() -> None:
    finer = [PLAIN[0]]
    for (x, y), (u, v) in itertools.pairwise(PLAIN):
        finer += [(x + t * (u - x), y + t * (v - y)) for t in (0.25, 0.5, 1.0)]
    cut = case_of(rockfall={}, block=in_pieces(finer))
    np.testing.assert_allclose(blows(cut, 4), blows(drawn(PLAIN), 4), rtol=0, atol=1e-9)
    step = [*PLAIN[:4], (40, 0), (40, 3), (42, 3), (42, 0), (60, 0)]
    table = {"profile": PLAIN, "surface": ["rock"]}
    wall = [block((40, 0), (41, 0), (41, 3), (40, 3)), block((41, 0), (42, 0), (42, 3), (41, 3))]
    stands = case_of(rockfall=table, block=wall)
    np.testing.assert_allclose(blows(stands, 9), blows(drawn(step), 9), rtol=0, atol=1e-9)
    assert {*stands.campaign().face_block.tolist()} == {-1, 0, 1}


def test_a_path_over_blocks_is_mirrored_with_them() -> None:
    def mirrored(points):
        return [(-x, y) for x, y in reversed(points)]

    shape = [(0.0, 0.0), (2.0, 0.0), (1.0, 2.0)]
    one = {**SOURCE, "line": None, "at": [5, 22], "rocks": 1, "velocity": [3.0, 0.0], "spin": 1.0}
    other = {**one, "at": [-5, 22], "velocity": [-3.0, 0.0], "spin": -1.0}
    blocks = in_pieces(PLAIN)
    turned = [{**each, "vertices": mirrored(each["vertices"])} for each in blocks]
    there = blows(case_of(rockfall={}, block=blocks, source=[{**one, "shape": shape}]))
    back = blows(case_of(rockfall={}, block=turned, source=[{**other, "shape": mirrored(shape)}]))
    signs = [1, -1, 1, -1, -1, 1, -1, -1, 1, -1]
    np.testing.assert_allclose(back * signs, there, rtol=0, atol=1e-9)


def test_a_block_apart_from_the_others_is_struck_from_all_sides() -> None:
    roof = block((10, 12), (16, 12), (16, 13), (10, 13), name="roof")
    source = {**SOURCE, "line": [[11, 16], [15, 16]], "rocks": 8}
    ground = block((0, -5), (60, -5), (60, 0), (0, 0), name="floor")
    campaign = case_of(rockfall={}, block=[ground, roof], source=[source]).campaign()
    assert sum(campaign.face_block == 1) == 4
    for number in range(1, 9):
        course = campaign.follow(number).course
        first = course.records[1]
        assert campaign.block_of(int(first[path.FACE])) == "roof"
    up = {**source, "line": [[11, 6], [15, 6]], "velocity": [0.0, 14.0]}
    campaign = case_of(rockfall={}, block=[ground, roof], source=[up]).campaign()
    first = campaign.follow(1).course.records[1]
    assert campaign.block_of(int(first[path.FACE])) == "roof"
    assert first[path.BEFORE + 1] > 0.0 > first[path.AFTER + 1]


def test_each_rock_of_blocks_has_its_surface() -> None:
    soft = {"granite": SURFACE, "clay": {"normal_restitution": 0.0, "friction_angle": 45.0}}
    pieces = in_pieces(PLAIN)
    pieces[3]["rock"] = pieces[4]["rock"] = "clay"
    rocks = {"granite": ROCK, "clay": ROCK}
    campaign = case_of(rockfall={}, block=pieces, rock=rocks, surface=soft).campaign()
    used = [campaign.surfaces[k] for k in campaign.ground.surface]
    assert used == ["granite", "granite", "granite", "clay", "clay"]
    with pytest.raises(clast.ClastError, match=r"no surface 'clay'.*\n.*called as their rock"):
        case_of(rockfall={}, block=pieces, rock=rocks, surface={"granite": SURFACE}).campaign()


@pytest.fixture(scope="module")
def thrown(tmp_path_factory):
    """Two runs of a block that slides off a ledge and turns: one ends in flight, one goes on."""
    folder = tmp_path_factory.mktemp("ledge")
    ledge = block((0, 0), (4, 0), (4, 10), (0, 10), name="ledge")
    floor = block((4, -2), (40, -2), (40, 0), (4, 0), name="floor")
    loose = block((2.5, 10), (3.5, 10), (3.5, 10.8), (2.5, 10.8), fixed=False, name="loose")
    rests = block((0.5, 10), (1.5, 10), (1.5, 11), (0.5, 11), fixed=False, name="rests")
    content = {
        "block": [ledge, floor, {**loose, "velocity": [3.0, 0.0, 0.0]}, rests],
        "joint": {"default": {"friction_angle": 20.0}},
        "rock": {"granite": ROCK},
        "output": {"every": 0.01},
    }
    runs = {}
    for name, end in (("flies", 1.1), ("lands", 2.2)):
        case = clast.Case.validated({**content, "time": {"step": 1e-3, "end": end}}, "ledge.toml")
        runs[name] = case.run(output=folder / f"{name}.vtkhdf", warn=lambda text: None)
    return folder, runs


def test_blocks_that_a_run_has_thrown_are_followed_to_their_end(thrown) -> None:
    folder, runs = thrown
    source = {"name": "failed", "file": str(folder / "flies.vtkhdf")}
    campaign = case_of(rockfall={}, source=[source], rock={}).campaign()
    assert campaign.sources[0].blocks.name == ("loose",)
    assert campaign.blocks.name == ("ledge", "floor", "rests")
    one, run = campaign.follow(1), runs["flies"]
    state, block_number = run.final, run.block_name.index("loose")
    assert one.rock.numbers[0] == pytest.approx(2600.0 * 0.8 * np.sqrt(0.8), rel=1e-6)
    assert one.course.records[0, path.AFTER : path.FACE] == pytest.approx(
        state.velocity[block_number, :3], rel=1e-3
    )
    hit = one.course.records[1]
    assert hit[path.KIND] == path.BLOW
    assert campaign.block_of(int(hit[path.FACE])) == "floor"
    # the same block in the run that goes on: it strikes the floor at that time, so turned
    lands = runs["lands"].block("loose")
    struck = np.flatnonzero(np.diff(lands.velocity[:, 1]) > 0.1)
    struck = struck[lands.time[struck] > 1.1][0]
    when = run.times[-1] + hit[path.CLOCK]
    assert lands.time[struck] - 1e-3 <= when <= lands.time[struck + 1] + 1e-3
    place = hit[path.X] + campaign.origin[0]
    came = np.interp(when, lands.time, lands.displacement[:, 0]) + 3.0
    assert place == pytest.approx(came, abs=5e-3)
    assert one.course.tally[2] == path.REST


def test_of_a_run_in_which_nothing_moves_no_rock_is_made(thrown) -> None:
    folder, _runs = thrown
    source = {"name": "failed", "file": str(folder / "flies.vtkhdf"), "faster_than": 50.0}
    with pytest.raises(clast.ClastError, match=r"no block of flies\.vtkhdf moves faster than 50"):
        case_of(rockfall={}, source=[source], rock={}).campaign()
