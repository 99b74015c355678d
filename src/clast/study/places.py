"""Where rock fails, in studies whose runs are cut into blocks of their own.

With random joint sets the blocks differ from run to run, and so do their names.  A place of the
section stays the same: it fails in a run where it lies in a block that does.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely

from clast.model.model import Floats, Model
from clast.pictures.study.figures import FailurePlaces
from clast.study.folder import DONE, StudyFolder
from clast.study.trial_cases import changed, content_of
from clast.study.variables.parameters import ParameterPlaces

CELLS = 240
"""Cells along the longer side of the section."""
MOST_RUNS = 500
"""Most runs that are cut again; of more that fail the first are taken as a sample."""


def share_of_places(folder: StudyFolder) -> FailurePlaces | None:
    """Return in which share of the runs each place fails; None where no run has blocks that fail.

    Runs that fail are cut again, as they were: their blocks follow from the study and their number.
    """
    base, study = folder.base, folder.study
    settings = ParameterPlaces.of(content_of(base), study.vary)
    outline = _outline(base.model())
    x, y = _grid(outline)
    count, runs, failed = np.zeros((len(y), len(x))), 0, 0
    for result in folder.results():
        if result["status"] != DONE:
            continue
        runs += 1
        if not result.get("blocks"):
            continue
        failed += 1
        if failed <= MOST_RUNS:
            model = changed(base, settings.case(folder.values(result["run"]))).model()
            fails = np.isin(model.block_name, result["blocks"])
            count += _inside(_outline(model, fails), x, y)
    if not failed:
        return None
    share = count / runs * (failed / min(failed, MOST_RUNS))
    share[~_inside(outline, x, y)] = np.nan
    return FailurePlaces(x=x, y=y, share=share, outline=_rings(outline))


def _outline(model: Model, chosen: np.ndarray | None = None) -> shapely.Geometry:
    """Return the union of blocks, all or those that are chosen (n,), in coordinates of the file."""
    vertices = model.vertices + model.origin
    pairs = list(pairwise(model.block_start))
    kept = range(len(pairs)) if chosen is None else np.flatnonzero(chosen)
    return shapely.union_all([shapely.Polygon(vertices[slice(*pairs[k])]) for k in kept])


def _rings(outline: shapely.Geometry) -> list[Floats]:
    """Return the rings of an outline, m, each of shape (k, 2)."""
    return [shapely.get_coordinates(one) for one in shapely.get_parts(outline.boundary)]


def _grid(outline: shapely.Geometry) -> tuple[Floats, Floats]:
    """Return the centres of the cells along x and y, m, shapes (nx,) and (ny,)."""
    left, low, right, high = outline.bounds
    cell = max(right - left, high - low) / CELLS
    nx, ny = (max(1, round(length / cell)) for length in (right - left, high - low))
    return (
        left + (np.arange(nx) + 0.5) * (right - left) / nx,
        low + (np.arange(ny) + 0.5) * (high - low) / ny,
    )


def _inside(outline: shapely.Geometry, x: Floats, y: Floats) -> np.ndarray:
    """Return which cells have their centre in an outline, shape (ny, nx)."""
    shapely.prepare(outline)
    inside: np.ndarray = shapely.contains_xy(outline, *np.meshgrid(x, y))
    return inside
