"""Slopes whose factor of safety has a formula."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate, stats

import clast

DIP, LENGTH, WEIGHT = math.radians(38.0), 12.0, 900e3
COHESION, FRICTION = 15e3, 34.0


@dataclass(frozen=True)
class Slab:
    """A slab on a plane through its toe."""

    file: Path

    @staticmethod
    def factor(cohesion: object = COHESION, friction_angle: object = FRICTION) -> np.ndarray:
        """Return F = (c L + W cos a tan phi)/(W sin a)."""
        tan = np.tan(np.radians(friction_angle))
        held = np.asarray(cohesion) * LENGTH + WEIGHT * math.cos(DIP) * tan
        return held / (WEIGHT * math.sin(DIP))

    @staticmethod
    def spare() -> float:
        """Return what strength is left along the plane, N/m."""
        return float(Slab.factor() - 1.0) * WEIGHT * math.sin(DIP)

    @staticmethod
    def pushed() -> float:
        """Return what of it a push of the whole weight to the left takes, N/m."""
        return WEIGHT * (math.cos(DIP) + math.sin(DIP) * math.tan(math.radians(FRICTION)))

    def fails(
        self, cohesion: tuple[float, float], friction: tuple[float, float], r: float
    ) -> float:
        """Return P(F < 1) of lognormal cohesion and normal friction with correlated scores."""
        sigma = math.sqrt(math.log1p((cohesion[1] / cohesion[0]) ** 2))
        middle = math.log(cohesion[0]) - 0.5 * sigma**2

        def given(z: float) -> float:
            angle = friction[0] + friction[1] * z
            least = brought(angle)
            if least <= 0.0:
                return 0.0
            score = (math.log(least) - middle) / sigma
            below = stats.norm.cdf((score - r * z) / math.sqrt(1.0 - r * r))
            return float(below * stats.norm.pdf(z))

        def brought(angle: float) -> float:
            """Return the cohesion at which F = 1."""
            tan = math.tan(math.radians(angle))
            return WEIGHT * (math.sin(DIP) - math.cos(DIP) * tan) / LENGTH

        return float(integrate.quad(given, -8.0, 8.0, limit=200)[0])


def slab_case(path: Path, **changes: object) -> Slab:
    """Write the case of a slab."""
    along, across = (math.cos(DIP), math.sin(DIP)), (-math.sin(DIP), math.cos(DIP))

    def at(s: float, t: float) -> tuple[float, float]:
        return (s * along[0] + t * across[0], s * along[1] + t * across[1])

    builder = clast.ModelBuilder(title="Slab", gravity=(0.0, -9.81))
    builder.add_rock("rock", young=20e9, poisson=0.2, density=2600.0)
    builder.add_joint("plane", friction_angle=FRICTION, cohesion=COHESION)
    height = WEIGHT / (2600.0 * 9.81) / LENGTH
    builder.block(name="base", vertices=[at(-4, -5), at(20, -5), at(20, 0), at(-4, 0)], fixed=True)
    corners = [at(2, 0), at(2 + LENGTH, 0), at(2 + LENGTH, height), at(2, height)]
    builder.block(name="slab", vertices=corners, edge_joint=["plane", "", "", ""])
    builder.measured_point("A", at(2, height), block="slab")
    stages = [clast.Stage(name="rest", dynamic_ratio=0.0)]
    given = {"step": 0.005, "end": 2.0, "stages": stages, **changes}
    path.write_text(builder.to_toml(**given))  # type: ignore[arg-type]
    return Slab(path)


@pytest.fixture
def slab(tmp_path: Path) -> Slab:
    return slab_case(tmp_path / "slab.toml")


@pytest.fixture
def slab_in_steps(tmp_path: Path) -> Slab:
    """A slab that moves for 100 steps, and writes checkpoints."""
    found = slab_case(tmp_path / "slab.toml", stages=(), end=0.5)
    text = found.file.read_text() + "\n[output]\ncheckpoint_every = 1e6\n"
    found.file.write_text(text)
    return found
