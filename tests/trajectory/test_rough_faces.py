"""Rough faces: facets of a length, and what blows on them have in common."""

import numpy as np
import pytest

from clast.trajectory import path
from clast.trajectory.ground import DECK
from clast.trajectory.impact import face_turn
from scenes.trajectories import followed, ledger_error, surface

SPACING, ROUGHNESS = 0.8, 0.1


def turns(places, seeds: int, spacing: float = SPACING) -> np.ndarray:
    """Angles of the face at places, one row for each path."""
    decks = np.repeat(np.array(surface(0.5, roughness=ROUGHNESS, spacing=spacing)), DECK)
    decks = decks.reshape(8, DECK)
    counters = [np.array([seed, seed], np.uint64) for seed in range(seeds)]
    return np.array([[face_turn(decks, x, counter) for x in places] for counter in counters])


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 1.0, 2.3])
def test_blows_at_a_distance_share_an_angle_with_the_chance_that_is_said(share: float) -> None:
    found = turns([7.3, 7.3 + share * SPACING], 20_000)
    chance, same = max(0.0, 1.0 - share), (found[:, 0] == found[:, 1]).mean()
    assert same == pytest.approx(chance, abs=4.0 * np.sqrt(0.25 / len(found)))
    assert np.corrcoef(found.T)[0, 1] == pytest.approx(chance, abs=0.03)
    assert found.std() == pytest.approx(ROUGHNESS, rel=0.02)
    assert abs(found.mean()) < 4.0 * ROUGHNESS / np.sqrt(len(found))


def test_without_a_spacing_each_blow_has_an_angle_of_its_own() -> None:
    found = turns([7.3, 7.3], 1000, 0.0)
    assert abs(np.corrcoef(found.T)[0, 1]) < 0.13
    assert (found[:, 0] != found[:, 1]).all()


def test_facets_of_other_lengths_are_others() -> None:
    assert (turns([7.3], 100) != turns([7.3], 100, 0.5 * SPACING)).all()


STEPS = [(0.0, 20.0), (30.0, 8.0), (80.0, 6.0)]
CUT = [(0.0, 20.0), (3.0, 18.8), (17.5, 13.0), (30.0, 8.0), (47.0, 7.32), (80.0, 6.0)]


def thrown(profile, spacing: float, seed: int = 3, shift: float = 0.0):
    rough = [surface(0.6, 0.7, 0.5, 0.0, 0.15, spacing)]
    start, moved = [3.0 + shift, 24.0, 0.2, 4.0, 0.0, 1.0], [(x + shift, y) for x, y in profile]
    course, _, _ = followed(start, profile=moved, rows=rough, seed=seed)
    assert ledger_error(course) < 1e-12
    rows = course.records[: course.tally[0]].copy()
    rows[:, path.X] -= shift
    return rows


@pytest.mark.parametrize("spacing", [0.3, 4.0])
@pytest.mark.parametrize("seed", [3, 4, 5])
def test_a_path_is_the_same_over_a_profile_in_pieces_and_elsewhere(spacing, seed) -> None:
    whole = thrown(STEPS, spacing, seed)
    columns = slice(path.CLOCK, path.FACE)
    for other in (thrown(CUT, spacing, seed), thrown(STEPS, spacing, seed, 64.0)):
        assert np.allclose(other[:5, columns], whole[:5, columns], rtol=0.0, atol=1e-9)
    assert not np.allclose(thrown(STEPS, 0.0, seed)[:5, columns], whole[:5, columns], atol=1e-3)


def test_a_frictionless_rock_is_thrown_along_the_normal_of_the_facet_that_it_strikes() -> None:
    """Two rocks of a path strike a facet of 5 m at 0.4 m from each other, or two facets."""
    found = []
    for x in (0.0, 0.4, 30.0):
        course, _, _ = followed(
            [x, 0.8, 0.5, 0.0, -9.0, 0.0],
            rows=[surface(0.5, 0.0, roughness=0.05, spacing=5.0)],
            limit=0.1,
            seed=2,
        )
        blow = next(one for one in course.records if one[path.KIND] == path.BLOW)
        change = blow[path.AFTER : path.AFTER + 2] - blow[path.BEFORE : path.BEFORE + 2]
        found.append(np.arctan2(-change[0], change[1]))
    assert found[0] == pytest.approx(found[1], abs=1e-12)
    assert abs(found[0]) > 1e-3
    assert abs(found[2] - found[0]) > 1e-3
