"""Two convex corners against the entrance block: the sum of one and the other one reversed.

Blocks A and B overlap where the origin lies inside B - A = {b - a} (Shi 2015), and for two corners
its outline is made of the entrance lines.  The sum is formed as a convex hull here.
"""

import itertools

import numpy as np
import pytest
import shapely

from clast.contact.corner_rules import Bisector, EntranceLines
from scenes.corners import TOP, remembering
from scenes.systems import REACH, box, contacts_of, system, touches_of

RULES = {"bisector": Bisector(), "shi": EntranceLines()}


def wedge(tip, towards, opening):
    """Return a triangle of 1 m by its tip, the direction of its middle and its angle, degrees."""
    sides = np.radians([towards - 0.5 * opening, towards + 0.5 * opening])
    return np.asarray(tip, float) + np.array(
        [[0.0, 0.0], *np.stack([np.cos(sides), np.sin(sides)], 1)]
    )


def entrance_block(a, b):
    """Return the outline of {p - q : p in b, q in a}, counter-clockwise."""
    sums = shapely.MultiPoint([p - q for p, q in itertools.product(b, a)])
    return np.array(shapely.geometry.polygon.orient(sums.convex_hull).exterior.coords)[:-1]


def way_out(a, b):
    """Return the signed distance, m, of the origin to the entrance lines nearest to it: largest.

    Negative where the blocks overlap: the shortest way out.
    """
    outline = entrance_block(a, b)
    along = np.roll(outline, -1, axis=0) - outline
    cross = -outline[:, 0] * along[:, 1] + outline[:, 1] * along[:, 0]
    return (cross / np.hypot(*along.T)).max()


def encounters_of_corners(count):
    """Yield two wedges, tips up to critdis (5 mm) apart in all directions, no sides parallel."""
    rng = np.random.default_rng(3)
    while count:
        openings = rng.uniform(8.0, 172.0, 2)
        towards = rng.uniform(0.0, 360.0, 2)
        sides = (towards[:, None] + 0.5 * openings[:, None] * [-1.0, 1.0]).ravel()
        if any(
            abs((x - y + 90.0) % 180.0 - 90.0) < 4.0 for x, y in itertools.combinations(sides, 2)
        ):
            continue
        angle = rng.uniform(0.0, 2.0 * np.pi)
        tip = rng.uniform(0.0, 0.99 * REACH.critdis) * np.array([np.cos(angle), np.sin(angle)])
        # corners that face each other: the sum of the wedges is a wedge again
        if abs((towards[0] - towards[1]) % 360.0 - 180.0) + 0.5 * openings.sum() >= 178.0:
            continue
        count -= 1
        yield wedge([0.0, 0.0], towards[0], openings[0]), wedge(tip, towards[1], openings[1])


@pytest.mark.slow
@pytest.mark.parametrize("rule", RULES)
def test_corners_are_in_contact_where_both_entrance_lines_are_passed(rule):
    """From all directions and at all depths: one contact, with the shortest way out, or none."""
    inside = 0
    for resting, moving in encounters_of_corners(2000):
        wanted = way_out(moving, resting)
        found = touches_of([resting, moving], rule=RULES[rule])
        closed = [one.gap for one in found if one.gap < 0.0]
        assert closed == pytest.approx([wanted] if wanted < 0.0 else [], abs=1e-12)
        inside += wanted < 0.0
    assert 200 < inside < 1800


def test_rules_agree_where_corners_meet_at_an_angle():
    for outlines in encounters_of_corners(500):
        assert touches_of(outlines) == touches_of(outlines, rule=RULES["shi"])


# --- walls and arches ------------------------------------------------------------------------


def test_coinciding_corners_make_one_contact_that_keeps_to_its_vertex():
    """A box on a box of the same width: one contact at each end of the joint, not two."""
    for shift in (-1e-6, 0.0, 1e-6):
        pile = [box(0.0, 0.0), box(shift, 1.0)]
        assert len(touches_of(pile)) == 4
        found = touches_of(pile, rule=RULES["shi"])
        on_edge = {(0, 3), (1, 1)} if shift < 0.0 else {(0, 2), (1, 0)}
        assert {one.vertex for one in found} == (on_edge if shift else {(0, 2), (0, 3)})
    before = remembering(TOP, vertex=5, block=0)  # the upper box's lower right corner
    for shift in (-1e-6, 0.0, 1e-6):
        found = touches_of([box(0.0, 0.0), box(shift, 1.0)], memory=before, rule=RULES["shi"])
        assert (1, 1) in {one.vertex for one in found}
        assert (0, 2) not in {one.vertex for one in found}


@pytest.mark.parametrize("rule", RULES)
def test_contacts_of_two_faces_stand_for_their_common_length(rule):
    pile = system([box(0.0, 0.0), box(0.0, 1.0), box(0.3, 2.0)])
    contacts = contacts_of(pile, rule=RULES[rule])
    between = [contacts.length[contacts.pair == q].sum() for q in range(2)]
    assert between == pytest.approx([1.0, 0.7])
