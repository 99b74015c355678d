"""Which faces of a planar graph are rock, which belong to openings, and which holes they have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from clast.model.model import Ints
from clast.rockmass.network.planar import Graph, Loops, loops_of, parts_of

NOTHING = -2
"""Side of an edge where nothing is left: outside of the domain, or excavated."""
ROCK = -1
"""Side of an edge where rock is that belongs to no opening."""

Geometries = NDArray[Any]


@dataclass(frozen=True, kw_only=True)
class FaceOutlines:
    """The outlines that decide the kind of a face, as shapely polygons in cells."""

    domain: Any
    """The domain."""
    openings: Sequence[Any]
    """All openings; later ones go before earlier ones."""
    excavated: Sequence[bool]
    """Whether each of them is void from the start."""
    cut: Sequence[bool]
    """Whether the outline of each is cut."""

    def side(self, point: Any) -> int:
        """Return the kind of a point: nothing, rock, or the number of an opening."""
        if not shapely.contains(self.domain, point):
            return NOTHING
        found = ROCK
        for number, polygon in enumerate(self.openings):
            if self.cut[number] and shapely.contains(polygon, point):
                if self.excavated[number]:
                    return NOTHING
                found = number
        return found


def holders(graph: Graph, loops: Loops) -> Ints:
    """Return the loop around the face of each loop: itself, for a hole the one about it, or -1.

    Shape (nl,); -1 is the outside of everything.
    """
    holder = np.where(loops.area2 > 0, np.arange(len(loops.area2)), -1)
    part = parts_of(graph)
    node = loops.nodes(graph)
    first = node[loops.start[:-1]]
    holes = np.flatnonzero(loops.area2 <= 0)
    if len(holes) < 2:
        return holder
    shells = np.flatnonzero(loops.area2 > 0)
    tree = shapely.STRtree(polygons(graph, loops, shells))
    point = shapely.points(graph.xy[first[holes]].astype(float))
    hole, shell = tree.query(point, predicate="intersects")
    hole, shell = holes[hole], shells[shell]
    other = part[first[hole]] != part[first[shell]]
    hole, shell = hole[other], shell[other]
    # Of the loops about a hole the smallest is the one of its face.
    order = np.lexsort((-loops.area2[shell], hole))
    holder[hole[order]] = shell[order]
    return holder


def polygons(graph: Graph, loops: Loops, which: Ints) -> Geometries:
    """Return loops (k,) as shapely polygons without holes, in cells, shape (k,)."""
    count = np.diff(loops.start)[which]
    row = np.repeat(loops.start[which] - (np.cumsum(count) - count), count)
    entry = row + np.arange(count.sum())
    at = graph.xy[loops.nodes(graph)[entry]].astype(float)
    rings = shapely.linearrings(at, indices=np.repeat(np.arange(len(which)), count))
    return np.asarray(shapely.polygons(rings))


def sided(graph: Graph, place: FaceOutlines) -> Graph:
    """Return the graph with the kinds of the faces on both sides of each edge.

    Faces between which no outline runs are alike: the largest of them decides for all, so that no
    sliver along an outline is taken for something else.
    """
    if len(graph.edge) == 0:
        return graph
    loops = loops_of(graph)
    holder = holders(graph, loops)
    face = np.where(holder < 0, len(holder), holder)
    side = face[loops.of.reshape(-1, 2)]
    free = ~graph.barrier
    links = coo_array(
        (np.ones(int(free.sum()), np.int8), (side[free, 0], side[free, 1])),
        shape=(len(holder) + 1,) * 2,
    )
    alike = connected_components(links, directed=False)[1]
    value = np.full(alike.max() + 1, NOTHING, np.int64)
    shells = np.flatnonzero(loops.area2 > 0)
    order = shells[np.lexsort((loops.area2[shells], alike[shells]))]
    largest = order[np.r_[alike[order][1:] != alike[order][:-1], True][: len(order)]]
    for shell in largest[alike[largest] != alike[-1]]:
        inner = np.flatnonzero((holder == shell) & (loops.area2 <= 0))
        whole = polygons(graph, loops, np.array([shell]))[0]
        for hole in polygons(graph, loops, inner):
            whole = shapely.difference(whole, hole)
        value[alike[shell]] = place.side(shapely.point_on_surface(whole))
    return replace(graph, side=value[alike[side]])
