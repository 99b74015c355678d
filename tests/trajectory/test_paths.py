"""Paths of rigid rocks: the problems of the catalogue, and what has once gone wrong."""

import math
from dataclasses import replace

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.trajectory import campaign, path
from clast.trajectory.ground import Face
from clast.verification.catalogue import GROUPS
from clast.verification.problem import misses
from clast.verification.rocks import PATHS
from scenes.trajectories import followed, ledger_error, regular, surface

SLOW = {"rock-spread", "rock-angle"}
"""Statistics of many paths, which the tests of all problems draw by chance."""
QUICK = [problem for problem in GROUPS["rockfall"] if problem.name not in SLOW]


@pytest.mark.parametrize("problem", QUICK, ids=lambda problem: problem.name)
def test_a_problem_of_the_catalogue_is_solved(problem) -> None:
    missed = misses(problem.run(PATHS))
    assert not missed, missed


def barrier(x: float, height: float) -> list[Face]:
    foot, top = (x, 0.0), (x, height)
    return [Face(points=np.array([foot, top, foot]), surface=[0, 0], barrier=0)]


def test_a_wall_throws_rocks_back() -> None:
    course, last, _ = followed(
        [0.0, 3.0, 0.3, 20.0, 0.0, 0.0],
        faces=barrier(5.0, 4.0),
        capacity=[math.inf],
        rows=[surface(0.5, 0.5)],
    )
    assert course.tally[2] == path.REST
    assert last[0] < 5.0 - 0.49


TERRAIN = [(0, 60), (20, 58), (30, 40), (45, 38), (50, 20), (49, 15), (70, 10), (100, 0), (140, 0)]


def test_energy_is_accounted_for_and_no_rock_enters_the_ground() -> None:
    rng = np.random.default_rng(5)
    ends = set()
    for seed in range(30):
        start = [15.0 + 5.0 * rng.random(), 62.0, 6.0 * rng.random(), 4.0, 0.0, 3.0]
        rough = [surface(0.5, 0.6, 0.3, 0.0, 0.2)]
        course, _last, rock = followed(
            start, profile=TERRAIN, rows=rough, corners=regular(5), seed=seed + 1
        )
        assert ledger_error(course) < 1e-12
        ends.add(int(course.tally[2]))
        records = course.records[: course.tally[0]]
        assert (records[records[:, path.KIND] == path.BLOW][:, path.LOST] > -1e-6).all()
        for one in records:
            c, s = math.cos(one[path.ANGLE]), math.sin(one[path.ANGLE])
            corners = one[[path.X, path.Y]] + rock.corners @ np.array([[c, s], [-s, c]])
            assert one[path.X] > 139.0 or deepest(corners) < 1e-8
    assert path.REST in ends


def deepest(corners: np.ndarray) -> float:
    """Depth of a rock in the terrain: by its own corners, the profile closed far below."""
    import shapely

    ground = shapely.Polygon([*TERRAIN, (150, -50), (-50, -50), (-50, 60)])
    inside = ground.intersection(shapely.Polygon(corners))
    return float(inside.area)


def test_a_fast_thin_rock_does_not_pass_through_a_fast_spin_or_a_thin_wall() -> None:
    sliver = [(-1.0, -0.01), (1.0, -0.01), (1.0, 0.01), (-1.0, 0.01)]
    for spin in (0.0, 5.0, 300.0):
        course, last, _ = followed(
            [0.0, 3.0, 0.3, 200.0, 0.0, spin],
            corners=sliver,
            faces=barrier(5.0, 40.0),
            capacity=[math.inf],
            rows=[surface(0.1, 0.5)],
            limit=20.0,
        )
        assert last[0] < 5.0
        assert not math.isnan(course.hits[0, path.HIT_TIME])


def of_template(number):
    """Return a path of the template, whatever the number of its rocks."""
    made = Case.from_text(TEMPLATES["rockfall"], "rockfall").campaign()
    more = tuple(replace(one, count=10_000) for one in made.sources)
    return replace(made, sources=more).follow(number)


def test_a_rock_that_lies_flat_comes_to_rest() -> None:
    """This one crept on at 4 mm/s to the limit of its time, its spin turned round in each step."""
    one = of_template(6130)
    assert one.course.tally[2] == path.REST
    assert one.course.clock[0] < 20.0
    assert not one.state[3:].any()


def test_a_rock_that_slides_on_does_not_rattle() -> None:
    """This one struck 8,825 times, from one corner to the other."""
    assert of_template(2990).course.tally[1] < 500


def test_no_record_of_a_path_is_lost(monkeypatch) -> None:
    whole = of_template(1)
    monkeypatch.setattr(campaign, "RECORDS", 3)
    again = of_template(1)
    count = whole.course.tally[0]
    assert again.course.tally[0] == count > 3
    assert (again.course.records[:count] == whole.course.records[:count]).all()
    assert again.course.records[count - 1, path.KIND] == path.END


def test_a_rock_that_is_jammed_between_two_faces_comes_to_rest() -> None:
    """These crept down at 0.4 mm/s to the limit of their time: 150,000 steps."""
    text = """
[rockfall]
profile = [[0, 10], [1.5, 8], [2, -40], [2.5, 8], [60, 9]]
surface = ["rock"]
[surface.rock]
normal_restitution = 0.4
tangential_restitution = 0.8
[[source]]
name = "edge"
at = [2, 12]
rocks = 3
volume = 0.5
"""
    rocks = Case.from_text(text, "crack").campaign()
    for number in (1, 2, 3):
        one = rocks.follow(number)
        assert one.course.tally[2] == path.REST
        assert one.course.clock[0] < 10.0
        assert ledger_error(one.course) < 1e-12


CLIFF = [(-9.0, 5.0), (0.0, 5.0), (0.0, 0.0), (30.0, 0.0)]


@pytest.mark.parametrize(("speed", "tan"), [(4.0, 0.2), (8.0, 0.1)])
def test_a_rock_slides_over_an_edge_and_falls(speed: float, tan: float) -> None:
    """Its front struck the edge as a wall, and it was drawn along a line to its next blow."""
    course, _last, _rock = followed(
        [-3.0, 5.5, 0.0, speed, 0.0, 0.0], profile=CLIFF, rows=[surface(0.0, tan)]
    )
    records = course.records[: course.tally[0]]
    landing = next(k for k, one in enumerate(records) if one[path.Y] < 1.0)
    assert records[:landing, path.LOST].max() < 0.1  # J of 20 kJ and more
    slides = records[(records[:, path.X] > -0.9) & (records[:, path.X] < -0.45)]
    gone = (slides[:, path.X] + 3.0) * 2.0 * 9.8 * tan
    assert slides[:, path.AFTER] ** 2 == pytest.approx(speed**2 - gone, rel=1e-2)
    row, blow = records[landing - 1], records[landing]
    assert (row[path.KIND], blow[path.KIND]) == (path.START, path.BLOW)
    span = blow[path.CLOCK] - row[path.CLOCK]
    fallen = row[path.Y] + span * row[path.AFTER + 1] - 0.5 * 9.8 * span**2
    assert blow[path.Y] == pytest.approx(fallen, abs=1e-9)
    assert ledger_error(course) < 1e-12


def test_every_path_over_a_profile_in_short_segments_ends() -> None:
    """One in a hundred of these struck for ever: a corner that touched by less than its tolerance
    opened and closed again, and was taken back to where it had opened, or not let to."""
    rng = np.random.default_rng(2)
    for trial in range(1, 5):
        count = int(rng.integers(20, 150))
        x = np.cumsum(rng.uniform(0.2, 1.5, count))
        y = (
            60.0
            - 0.8 * x
            + 8.0 * np.sin(x / 7.0)
            + rng.normal(0.0, rng.choice([0, 0.02, 0.2]), count)
        )
        y = np.where(x > 0.7 * x[-1], np.minimum(y, y[int(0.7 * count)]), y)
        surface = {
            "normal_restitution": float(rng.choice([0, 0.2, 0.5, 0.9])),
            "tangential_restitution": float(rng.choice([0, 0.5, 0.9, 1.0])),
            "roughness": float(rng.choice([0, 5, 15])),
            "rolling_resistance": float(rng.choice([0, 0.02, 0.1])),
            "friction_angle": float(rng.choice([5, 20, 40])),
        }
        if surface["roughness"] and rng.random() < 0.5:
            surface["roughness_spacing"] = 0.5
        low, high = float(y[:6].max() + 3.0), float(y[:6].max() + 6.0)
        source = {
            "name": "edge",
            "line": [[float(x[2]), low], [float(x[5]), high]],
            "rocks": 40,
            "volume": "uniform(0.01, 2)",
            "corners": "discrete([3, 4, 5, 6, 8, 20])",
            "elongation": "uniform(1, 3)",
            "velocity": ["uniform(0, 5)", 0.0],
            "spin": "uniform(-5, 5)",
        }
        profile = {"profile": np.stack([x, y], axis=1).tolist(), "surface": ["rock"], "seed": trial}
        content = {"rockfall": profile, "surface": {"rock": surface}, "source": [source]}
        rocks = Case.validated(content, "short").campaign()
        for number in range(31, 41):
            one = rocks.follow(number)
            assert one.course.tally[2] in (path.REST, path.LEFT)
            assert ledger_error(one.course) < 1e-12
