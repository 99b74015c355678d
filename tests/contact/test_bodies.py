"""Fixed blocks that lie flush are one body: the outlines on which contacts are looked for."""

import numpy as np
import pytest
import shapely

from clast.model.bodies import joined_outlines
from clast.model.model import Floats
from scenes.systems import box, contacts_of, system, turned


def outlines_of(blocks: list[Floats], free: tuple[int, ...] = ()) -> list[Floats] | None:
    """Return the outlines of blocks that are fixed but for some, None where they are the blocks."""
    start = np.concatenate([[0], np.cumsum([len(one) for one in blocks])])
    vertices = np.concatenate(blocks)
    area = np.array([shapely.Polygon(one).area for one in blocks])
    fixed = ~np.isin(np.arange(len(blocks)), free)
    found = joined_outlines(vertices, start, area, fixed, np.zeros(len(blocks), np.bool_))
    if found is None:
        return None
    corners = vertices[found.vertex]
    return [corners[a:b] for a, b in zip(found.start[:-1], found.start[1:], strict=True)]


def ring() -> list[Floats]:
    """Return eight squares around a hole."""
    return [box(x, y) for x in range(3) for y in range(3) if (x, y) != (1, 1)]


SETS = {
    "side by side": ([box(0, 0), box(1, 0), box(2, 0)], 1),
    "of unequal height": ([box(0, 0), box(1, -0.5, 1, 2)], 1),
    "corner on a side": ([box(0, 0, 2, 1), box(0.5, 1)], 1),
    "four about a point": ([box(x, y) for x in range(2) for y in range(2)], 1),
    "around a hole": (ring(), 2),
    "apart": ([box(0, 0), box(1.1, 0)], 2),
    "corner to corner": ([box(0, 0), box(1, 1)], 2),
}


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_outlines_are_those_of_the_union(name, angle):
    blocks, count = SETS[name]
    blocks = [turned(one, angle, (1e4, -2e4)) for one in blocks]
    found = outlines_of(blocks) or blocks
    assert len(found) == count
    union = shapely.union_all([shapely.Polygon(one) for one in blocks], grid_size=1e-6)
    signed = sum(
        0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        for x, y in ((one - one[0]).T for one in found)
    )
    assert signed == pytest.approx(union.area, rel=1e-6)
    assert sum(len(one) for one in found) == shapely.get_num_coordinates(
        union.simplify(1e-4)
    ) - len(found)


def test_free_blocks_keep_their_outlines():
    found = outlines_of([box(0, 0), box(1, 0), box(2, 0), box(3, 0)], free=(2, 3))
    assert found is not None
    assert [len(one) for one in found] == [4, 4, 4]


def test_corners_on_a_straight_side_are_none():
    one = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.5, 1.0], [0.0, 1.0]])
    found = outlines_of([one])
    assert found is not None
    assert len(found[0]) == 4


def test_a_bend_of_a_degree_is_a_corner():
    rise = np.tan(np.radians(1.0))
    blocks = [box(0, -1), np.array([[1.0, -1.0], [2.0, -1.0], [2.0, rise], [1.0, 0.0]])]
    found = outlines_of(blocks)
    assert found is not None
    assert len(found[0]) == 5


@pytest.mark.parametrize("strength", [{}, {"cohesion": 1e3}])
def test_contacts_are_of_the_pieces_on_which_they_stand(strength):
    """A block over three tiles touches the outer two with its own corners, and no more.

    Where joints are bonded each piece has its share of the bond.
    """
    tiles = [box(0.5 * k, -0.5, 0.5, 0.5) for k in range(3)]
    model = system([*tiles, box(0.2, 0.0, 1.0, 0.5)], fixed=range(3), **strength)
    found = contacts_of(model)
    touching = sorted(zip(found.vertex, found.edge, strict=True))
    own = [(12, 2), (13, 10)]
    assert set(own) <= set(touching)
    assert (touching == own) == (not strength)
    assert model.smallest == pytest.approx(0.25 if strength else 0.5)
