"""One case in many views: numbered otherwise, mirrored, turned, moved."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from clast.results import Run
from scenes.parted import Placed

Tables = dict[str, Any]

POINTS = {"vertices", "at", "start", "end", "polyline", "part", "about", "line"}
VECTORS = {"force", "traction", "gravity", "direction"}
NUMBERED = "block", "link", "bolt", "point_load", "motion", "opening"
"""Lists of tables whose order means nothing."""


@dataclass(frozen=True, kw_only=True)
class View:
    """How a case is looked at."""

    place: Placed = field(default_factory=Placed)
    order: int | None = None
    """Number by which blocks, and what is on them, are shuffled; -1 reverses them."""

    def seen(self, case: Tables) -> Tables:
        """Return the tables of the case as they are seen."""
        found = self._placed(case)
        for key in NUMBERED if self.order is not None else ():
            if key in found:
                count = len(found[key])
                numbers = np.arange(count)[::-1]
                if self.order != -1:
                    numbers = np.random.default_rng([self.order, count]).permutation(count)
                found[key] = [found[key][k] for k in numbers]
        found["block"] = [self._round(one) for one in found["block"]]
        return found

    def displacements(self, run: Run, blocks: list[str]) -> np.ndarray:
        """Return how far the vertices of blocks have moved, unplaced, m, (k, 2)."""
        model = run.model
        moved = run.state.vertices - model.vertices
        back = np.array([self.place([1.0, 0.0]), self.place([0.0, 1.0])]) - self.place.at
        parts = np.split(moved @ back.T, model.block_start[1:-1])
        of = dict(zip(model.block_name, parts, strict=True))
        return np.concatenate([self._unrolled(of[name]) for name in blocks])

    def _round(self, block: Tables) -> Tables:
        """Return a block that begins with another vertex, counter-clockwise."""
        corners = np.array(block["vertices"])
        joints = block.get("edge_joint")
        if self.place.flip < 0.0:
            corners = corners[::-1]
            joints = joints and [*joints[-2::-1], joints[-1]]
        first = self._first(len(corners))
        found = {**block, "vertices": np.roll(corners, -first, axis=0).tolist()}
        if joints:
            found["edge_joint"] = joints[first:] + joints[:first]
        return found

    def _first(self, corners: int) -> int:
        """Return with which vertex blocks begin."""
        return 0 if self.order is None else corners // 2

    def _unrolled(self, moved: np.ndarray) -> np.ndarray:
        """Return what belongs to the vertices of a block (k, 2) in their first order."""
        found = np.roll(moved, self._first(len(moved)), axis=0)
        return found[::-1] if self.place.flip < 0.0 else found

    def _placed(self, value: Any, key: str = "") -> Any:
        place = self.place
        if key in POINTS and isinstance(value, list):
            found = place(value).tolist()
            return sorted(found) if key == "line" else found
        if key in VECTORS:
            return (place(value) - place.at).tolist()
        if key == "stress":
            turn = np.array([place([1.0, 0.0]), place([0.0, 1.0])]).T - np.array([place.at] * 2).T
            xx, yy, xy = value
            (xx, xy), (_, yy) = turn @ np.array([[xx, xy], [xy, yy]]) @ turn.T
            return [xx, yy, xy]
        if key == "velocity" and len(value) == 3:
            return [*(place(value[:2]) - place.at).tolist(), place.flip * value[2]]
        if key == "side" and place.flip < 0.0:
            return {"left": "right", "right": "left"}.get(value, value)
        if key == "motion":
            return [self._moved(one) for one in value]
        if isinstance(value, dict):
            return {name: self._placed(one, name) for name, one in value.items()}
        if isinstance(value, list) and value and isinstance(value[0], dict):
            return [self._placed(one) for one in value]
        return value

    def _moved(self, motion: Tables) -> Tables:
        found = self._placed(motion)
        if "x" in motion or "y" in motion:
            given = motion.get("x", 0.0), motion.get("y", 0.0)
            x, y = (self.place(given) - self.place.at).tolist()
            found.update({k: v for k, v in (("x", x), ("y", y)) if k in motion})
        if "rotation" in motion:
            found["rotation"] = self.place.flip * motion["rotation"]
        return found
