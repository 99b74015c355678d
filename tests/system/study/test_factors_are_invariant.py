"""Factors of safety do not depend on what must not matter: place, size, side, numbers, pieces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import clast

DIP, LENGTH, HEIGHT, DENSITY = math.radians(38.0), 12.0, 0.5, 2600.0


@dataclass(frozen=True, kw_only=True)
class Slab:
    """A flat slab on a plane, drawn in many ways; F = 1.1882 by limit equilibrium."""

    size: float = 1.0
    """Length over that of the slab of 12 m; cohesion and stiffness go with it."""
    turned: float = 0.0
    """Angle, degrees, by which slab and gravity are turned."""
    moved: tuple[float, float] = (0.0, 0.0)
    """Displacement of all vertices, m."""
    mirrored: bool = False
    """True: it slides to the other side."""
    reverse: bool = False
    """True: the slab is drawn before its base."""
    first: int = 0
    """Vertex with which each block begins."""
    pieces: int = 1
    """Pieces of the slab."""
    base_pieces: int = 1
    """Pieces of the base."""

    def case(self, path: Path) -> Path:
        """Write the case."""
        down = self._turned(np.array([[0.0, -9.81]]))[0]
        builder = clast.ModelBuilder(title="Slab", gravity=tuple(down.tolist()))
        builder.add_rock("rock", young=20e9 * self.size, poisson=0.2, density=DENSITY)
        weight = DENSITY * 9.81 * HEIGHT * LENGTH
        cohesion = 15e3 / 900e3 * weight * self.size
        builder.add_joint("plane", friction_angle=34.0, cohesion=cohesion)
        blocks = [
            *self._blocks("base", (-4.0, 20.0), (-5.0, 0.0), self.base_pieces),
            *self._blocks("slab", (2.0, 2.0 + LENGTH), (0.0, HEIGHT), self.pieces),
        ]
        for one in blocks[::-1] if self.reverse else blocks:
            builder.block(**one)
        time = math.sqrt(self.size)
        path.write_text(builder.to_toml(step=0.005 * time, end=2.0 * time))
        return path

    def _blocks(
        self, name: str, s: tuple[float, float], t: tuple[float, float], pieces: int
    ) -> list[dict[str, object]]:
        ends = np.linspace(*s, pieces + 1)
        found: list[dict[str, object]] = []
        for k in range(pieces):
            a, b = ends[k], ends[k + 1]
            corners = np.array([(a, t[0]), (b, t[0]), (b, t[1]), (a, t[1])])
            joints = ["plane", "", "", ""] if name == "slab" else ["", "", "plane", ""]
            turn = np.array([[math.cos(DIP), math.sin(DIP)], [-math.sin(DIP), math.cos(DIP)]])
            points = self.size * corners @ turn
            if self.mirrored:
                points, joints = (points * [-1.0, 1.0])[::-1], [*joints[2::-1], joints[3]]
            points = np.roll(self._turned(points) + self.moved, -self.first, axis=0)
            joints = joints[self.first :] + joints[: self.first]
            found.append(
                {
                    "name": f"{name} {k}",
                    "vertices": [tuple(one) for one in points.tolist()],
                    "fixed": name == "base",
                    "edge_joint": joints,
                }
            )
        return found

    def _turned(self, points: np.ndarray) -> np.ndarray:
        angle = math.radians(self.turned)
        return points @ np.array(
            [[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]]
        )


@pytest.mark.parametrize(
    "slab",
    [
        Slab(turned=217.3),
        Slab(mirrored=True, first=1),
        Slab(moved=(1e5, -1e5)),
        Slab(size=1000.0),
        Slab(size=1e-3),
        Slab(reverse=True, first=2),
        Slab(pieces=6, base_pieces=5),
        Slab(pieces=3, base_pieces=7, mirrored=True, turned=63.0, moved=(1e5, 3e4), reverse=True),
    ],
    ids=lambda slab: ", ".join(
        f"{name} {value}" for name, value in vars(slab).items() if value != getattr(Slab(), name)
    ),
)
def test_the_same_slab_has_the_same_factor(slab: Slab, tmp_path: Path) -> None:
    found = clast.factor_of_safety(slab.case(tmp_path / "slab.toml"), tolerance=0.004)
    # the trials are at the same factors; limit equilibrium has 1.18818
    assert (found.low, found.high, found.undecided) == (1.1875, 1.19140625, ())
