"""Ends of lines that stop just short of another line, where they were meant to reach it."""

from __future__ import annotations

import numpy as np
import shapely

from clast.model.model import Bools, Floats
from clast.rockmass.network.noding import Noded
from clast.rockmass.network.planar import Graph

SHORT_OF = 10.0
"""Ends that are so near to a line, in cells, are taken to be intended to lie on it."""


def loose_ends(net: Noded, dangling: Graph, ends: Floats, free: Bools) -> Floats:
    """Return the ends of lines, in cells, that were taken out just short of another line, (k, 2).

    ``dangling`` are the pieces that were taken out, ``ends`` (n, 2, 2) all lines, ``free`` (n,)
    those that are not outlines.  An end that has crossed the line beside it has reached it.
    """
    degree = np.bincount(net.edge.reshape(-1), minlength=len(net.xy))
    line = np.repeat(dangling.line, 2)
    node = dangling.edge.reshape(-1)
    alone = (degree[node] == 1) & free[line]
    line, node = line[alone], node[alone]
    if len(line) == 0:
        return np.zeros((0, 2))
    away = np.abs(np.floor(ends[line] + 0.5) - net.xy[node][:, None]).max(axis=2)
    own = away.min(axis=1) <= 1.0
    line, at = line[own], ends[line, np.argmin(away, axis=1)][own]
    lines = shapely.linestrings(ends)
    which, near = shapely.STRtree(lines).query(
        shapely.points(at), predicate="dwithin", distance=SHORT_OF
    )
    reached = shapely.dwithin(lines[line[which]], lines[near], 1.0)
    return np.unique(at[which[~reached]], axis=0)
