"""Paths of rigid rocks against closed forms and independent integrations."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.case.templates import TEMPLATES
from clast.trajectory import campaign, path
from clast.trajectory.ground import Face
from scenes.trajectories import followed, ledger_error, regular, surface

GRAVITY = 9.8


def struck(mass, inertia, arm, velocity, restitution, tan):
    """Newton's restitution and Coulomb's friction at a contact with a level floor, closed form."""
    (rx, ry), (u, v, w) = arm, velocity
    vn, vt = v + w * rx, u - w * ry
    a, b = 1.0 / mass + rx * rx / inertia, -rx * ry / inertia
    c = 1.0 / mass + ry * ry / inertia
    gain, slip = -(1.0 + restitution) * vn, -vt
    n = (c * gain - b * slip) / (a * c - b * b)
    t = (a * slip - b * gain) / (a * c - b * b)
    if abs(t) > tan * n:
        for sign in (1.0, -1.0):
            n = gain / (a + b * sign * tan)
            t = sign * tan * n
            if n > 0.0 and sign * (vt + b * n + c * t) <= 1e-12:
                break
    return u + t / mass, v + n / mass, w + (rx * n - ry * t) / inertia


def test_one_corner_strikes_as_a_rigid_body_with_friction() -> None:
    grid = itertools.product((8, 30, 44), (0, 6, -6), (0, 6, -6), (0.0, 0.35, 0.8), (0, 20, 45))
    tried = 0
    for degrees, u, w, restitution, phi in grid:
        turn = math.radians(degrees)
        radius, lowest = math.sqrt(0.5), math.radians(225.0) + turn
        gap, tan = 0.002, math.tan(math.radians(phi))

        def height(time: float, gap=gap, lowest=lowest, radius=radius, w=w) -> float:
            level = -radius * math.sin(lowest)
            return level + gap - 4.0 * time + radius * math.sin(lowest + w * time)

        low, high = 0.0, 0.1
        for _ in range(100):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if height(middle) > 0.0 else (low, middle)
        arm = (radius * math.cos(lowest + w * low), radius * math.sin(lowest + w * low))
        if -4.0 + w * arm[0] >= 0.0:
            continue
        start = [0.0, gap - radius * math.sin(lowest), turn, u, -4.0, w]
        course, _, _ = followed(
            start, rows=[surface(restitution, tan)], gravity=(0.0, 0.0), limit=0.5
        )
        blow = course.records[1]
        assert blow[path.KIND] == path.BLOW
        expected = struck(2500.0, 2500.0 / 6.0, arm, (u, -4.0, w), restitution, tan)
        assert blow[path.CLOCK] == pytest.approx(low, abs=1e-11)
        assert blow[path.AFTER : path.FACE] == pytest.approx(expected, abs=1e-9)
        before = 0.5 * 2500.0 * (u * u + 16.0) + 0.5 * 2500.0 / 6.0 * w * w
        assert blow[path.LOST] >= -1e-12 * before
        tried += 1
    assert tried > 200


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.8])
def test_a_rock_that_falls_flat_rests_after_the_sum_of_its_bounces(restitution: float) -> None:
    course, last, _ = followed([0, 3.5, 0, 0, 0, 0], rows=[surface(restitution)])
    fall = math.sqrt(2.0 * 3.0 / GRAVITY)
    assert course.tally[2] == path.REST
    assert course.clock[0] == pytest.approx(fall * (1 + restitution) / (1 - restitution), rel=2e-3)
    assert last[:3] == pytest.approx([0.0, 0.5, 0.0], abs=1e-9)
    assert ledger_error(course) < 1e-12


@pytest.mark.parametrize("degrees, phi", [(30.0, 20.0), (25.0, 25.0), (10.0, 30.0)])
def test_a_box_slides_by_the_law_of_friction(degrees: float, phi: float) -> None:
    slope, tan, fast = math.radians(degrees), math.tan(math.radians(phi)), 6.0
    way = np.array([math.cos(slope), -math.sin(slope)])
    profile = [tuple(-60.0 * way), tuple(60.0 * way)]
    start = [*(0.5 * np.array([math.sin(slope), math.cos(slope)])), -slope, *(fast * way), 0.0]
    station = 4.0 * way[0]
    course, last, _ = followed(
        start, profile=profile, rows=[surface(0.0, tan)], stations=[start[0] + station]
    )
    pull = 2.0 * GRAVITY * (math.sin(slope) - math.cos(slope) * tan)
    assert course.passed[0, path.FAST] ** 2 == pytest.approx(fast**2 + 4.0 * pull, rel=2e-3)
    assert ledger_error(course) < 1e-12
    if pull < 0.0:
        run = math.hypot(last[0] - start[0], last[1] - start[1])
        assert course.tally[2] == path.REST
        assert run == pytest.approx(-(fast**2) / pull, rel=1e-3)


@pytest.mark.parametrize("count", [6, 8, 16])
def test_a_polygon_rolls_down_from_blow_to_blow(count: int) -> None:
    # w after a plastic blow is k w before it: k = (I + m r^2 cos(2 pi/n)) / (I + m r^2)
    slope, radius, step = math.radians(10.0), 0.5, 2.0 * math.pi / count
    corners = regular(count, radius)
    way = np.array([math.cos(slope), -math.sin(slope)])
    normal = np.array([math.sin(slope), math.cos(slope)])
    begin = radius * math.cos(math.pi / count) * normal + 0.0 * way
    spin = -2.0
    turned_by = np.array([[way[0], way[1]], [-way[1], way[0]]])
    arm = np.array(corners[0]) @ turned_by
    speed = -spin * np.array([-arm[1], arm[0]])
    course, _, rock = followed(
        [*begin, -slope, *speed, spin],
        profile=[tuple(-5.0 * way), tuple(20.0 * way)],
        rows=[surface(0.0)],
        corners=corners,
    )
    mass, inertia, _ = rock.numbers
    about = inertia + mass * radius**2
    share = (inertia + mass * radius**2 * math.cos(step)) / about
    edge = 2.0 * radius * math.sin(math.pi / count)
    blows = [one for one in course.records[: course.tally[0]] if one[path.KIND] == path.BLOW]
    expected, turned = spin**2, []
    for _ in range(6):
        expected += 2.0 * mass * GRAVITY * edge * math.sin(slope) / about
        expected *= share**2
        turned.append(math.sqrt(expected))
    found = [-one[path.AFTER + 2] for one in blows if one[path.LOST] > 1.0][:6]
    assert found == pytest.approx(turned, rel=1e-4)
    assert ledger_error(course) < 1e-12


def test_a_round_rock_rolls_at_two_thirds_of_the_slope_less_its_resistance() -> None:
    slope, arm, count, radius = math.radians(10.0), 0.04, 240, 0.5
    way = np.array([math.cos(slope), -math.sin(slope)])
    normal = np.array([math.sin(slope), math.cos(slope)])
    start = [*(radius * math.cos(math.pi / count) * normal), -slope, *way, -1.0 / radius]
    course, _, _ = followed(
        start,
        profile=[tuple(-5.0 * way), tuple(30.0 * way)],
        rows=[surface(0.0, arm=arm)],
        corners=regular(count, radius),
        stations=[start[0] + 2.0 * way[0]],
    )
    # m v' (1 + I/(m r^2)) = m g (sin a - cos a d/r); blows of 240 corners take a little more
    pull = 2.0 / 3.0 * GRAVITY * (math.sin(slope) - math.cos(slope) * arm / radius)
    assert course.passed[0, path.FAST] ** 2 == pytest.approx(1.0 + 4.0 * pull, rel=0.05)
    assert ledger_error(course) < 1e-12


def barrier(x: float, height: float) -> list[Face]:
    foot, top = (x, 0.0), (x, height)
    return [Face(points=np.array([foot, top, foot]), surface=[0, 0], barrier=0)]


def test_a_barrier_takes_its_capacity_and_holds_what_has_less() -> None:
    start = [0.0, 3.0, 0.3, 20.0, 0.0, 0.0]
    energy = 0.5 * 2500.0 * 400.0
    for capacity in (0.4 * energy, 2.0 * energy):
        course, _last, _ = followed(
            start, faces=barrier(5.0, 4.0), capacity=[capacity], rows=[surface(0.5, 0.5)]
        )
        hit = next(one for one in course.records if one[path.BARRIER] == 0.0)
        before, after = (
            0.5 * 2500.0 * (one[0] ** 2 + one[1] ** 2) + 0.5 * 2500.0 / 6.0 * one[2] ** 2
            for one in (hit[path.BEFORE : path.AFTER], hit[path.AFTER : path.FACE])
        )
        assert before - after == pytest.approx(min(capacity, before), rel=1e-12)
        assert (course.tally[2] == path.HELD) == (capacity > energy)
        assert course.hits[0, path.HIT_ENERGY] == pytest.approx(before)
        assert ledger_error(course) < 1e-12


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
ROUGH = [surface(0.5, 0.6, 0.3, 0.01)]


def gone(state, **other):
    return followed(state, profile=TERRAIN, rows=ROUGH, corners=regular(5), **other)


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


@pytest.mark.parametrize("shift", [(64.0, -32.0), (4096.0, 1024.0)])
def test_a_path_moves_with_its_profile(shift: tuple[float, float]) -> None:
    start = [18.0, 62.0, 0.4, 4.0, 0.0, 3.0]
    one, _end, _ = gone(start)
    moved = [(x + shift[0], y + shift[1]) for x, y in TERRAIN]
    other, _there, _ = followed(
        [start[0] + shift[0], start[1] + shift[1], *start[2:]],
        profile=moved,
        rows=ROUGH,
        corners=regular(5),
    )
    blows = range(1, 5)
    for k in blows:
        assert other.records[k, path.CLOCK] == pytest.approx(
            one.records[k, path.CLOCK], abs=1e-9 * max(1.0, abs(shift[0]))
        )


def test_a_path_is_mirrored_with_its_profile_and_the_same_on_a_profile_in_pieces() -> None:
    start = [18.0, 62.0, 0.4, 4.0, 0.0, 3.0]
    one, _, _ = gone(start)
    mirrored, _, _ = followed(
        [-18.0, 62.0, -0.4, -4.0, 0.0, -3.0],
        profile=[(-x, y) for x, y in reversed(TERRAIN)],
        rows=ROUGH,
        corners=[(-x, y) for x, y in reversed(regular(5))],
    )
    pieces = [TERRAIN[0]]
    for (x, y), (u, v) in itertools.pairwise(TERRAIN):
        pieces += [(x + t * (u - x), y + t * (v - y)) for t in (0.25, 0.5, 1.0)]
    cut, _, _ = followed(start, profile=pieces, rows=ROUGH, corners=regular(5))
    for k in range(1, 5):
        for other in (mirrored, cut):
            assert other.records[k, path.CLOCK] == pytest.approx(
                one.records[k, path.CLOCK], abs=1e-9
            )


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


def test_four_blows_on_three_slopes_are_those_of_an_independent_integration() -> None:
    profile = [(0.0, 10.0), (10.0, 10.0), (25.0, 2.0), (45.0, 6.0)]
    restitution, tan, mass = 0.5, 0.4, 2500.0
    course, _, rock = followed(
        [2.0, 14.0, 0.3, 14.0, 0.0, 1.0], profile=profile, rows=[surface(restitution, tan)]
    )
    blows = [one for one in course.records if one[path.KIND] == path.BLOW][:4]
    inertia, now, clock = rock.numbers[1], np.array([2.0, 14.0, 0.3, 14.0, 0.0, 1.0]), 0.0

    def after(time: float) -> np.ndarray:
        there = now + time * np.array([now[3], now[4], now[5], 0.0, -GRAVITY, 0.0])
        there[1] -= 0.5 * GRAVITY * time**2
        return there

    def arms(there: np.ndarray) -> np.ndarray:
        c, s = math.cos(there[2]), math.sin(there[2])
        return rock.corners @ np.array([[c, s], [-s, c]])

    def depths(there: np.ndarray) -> np.ndarray:
        x, y = (there[:2] + arms(there)).T
        return y - np.interp(x, *np.array(profile).T)

    for blow in blows:
        time = 1e-6
        while depths(after(time)).min() > 0.0:
            time += 1e-4
        low, high = time - 1e-4, time
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if depths(after(middle)).min() > 0.0 else (low, middle)
        there = after(low)
        clock += low
        corner = arms(there)[depths(there).argmin()]
        x = there[0] + corner[0]
        k = max(k for k in range(3) if profile[k][0] <= x)
        slope = math.atan2(profile[k + 1][1] - profile[k][1], profile[k + 1][0] - profile[k][0])
        turn = np.array([[math.cos(slope), math.sin(slope)], [-math.sin(slope), math.cos(slope)]])
        moving = struck(
            mass, inertia, turn @ corner, (*(turn @ there[3:5]), there[5]), restitution, tan
        )
        now = np.array([*there[:3], *(np.array(moving[:2]) @ turn), moving[2]])
        assert blow[path.CLOCK] == pytest.approx(clock, abs=1e-9)
        assert blow[path.AFTER : path.FACE] == pytest.approx(now[3:], abs=1e-7)


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
