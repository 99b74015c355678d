"""A lined opening that is turned, mirrored, moved or numbered otherwise is the same opening."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import clast
from clast.model.surroundings import blocks_called
from scenes.systems import turned

OPENING = [(2.0 * np.cos(t), 2.0 * np.sin(t)) for t in 2.0 * np.pi * np.arange(24) / 24]
LINING: dict[str, Any] = {
    "thickness": 0.2,
    "segment": 0.8,
    "young": 1.5e10,
    "tension": 2e6,
    "compression": 2.5e7,
    "joint": "bond",
    "stage": "spray",
}
VIEWS = {
    "7": {"angle": 7.0},
    "30": {"angle": 30.0},
    "45": {"angle": 45.0},
    "90": {"angle": 90.0},
    "mirrored": {"mirrored": True},
    "all": {"angle": 30.0, "mirrored": True, "away": 1e5, "reverse": True},
}


def cut_rock() -> tuple[clast.Model, set[int]]:
    """Return blocks of two joint sets round an opening, and the numbers of those inside."""
    domain = {"boundary": [[-6, -6], [6, -6], [6, 6], [-6, 6]], "smallest_block": 0.1}
    sets = [
        {"name": name, "angle": angle, "spacing": spacing, "origin": [0.9, -0.3]}
        for name, angle, spacing in (("a", 35.0, 1.6), ("b", -62.0, 1.9))
    ]
    content = {
        "schema": 1,
        "time": {"step": 1e-2, "end": 1.0},
        "rock": {"rock": {"young": 5e9, "poisson": 0.25, "density": 2700.0}},
        "joint": {"default": {"friction_angle": 35.0}},
        "domain": domain,
        "joint_set": sets,
        "opening": [{"name": "tunnel", "shape": "polygon", "points": OPENING}],
        "stage": [{"name": "dig", "excavate": ["tunnel"]}],
    }
    model = clast.Case.validated(content, "rock").model()
    return model, set(blocks_called(["tunnel"], model.openings, model.block_name).tolist())


def lined(
    angle: float = 0.0, mirrored: bool = False, away: float = 0.0, reverse: bool = False
) -> clast.ModelBuilder:
    """Return a view of the lined opening under in-situ stress; ``angle`` in degrees."""
    rock, inside = cut_rock()
    flip, turn = np.array([-1.0 if mirrored else 1.0, 1.0]), np.radians(angle)
    builder = clast.ModelBuilder(plane="strain", gravity=(0.0, 0.0))
    builder.add_rock("rock", young=5e9, poisson=0.25, density=2700.0)
    stiff = {"normal_stiffness": 2e10, "shear_stiffness": 4e9}
    builder.add_joint("default", friction_angle=35.0, **stiff)
    builder.add_joint("bond", friction_angle=35.0, cohesion=5e5, tensile_strength=5e5, **stiff)
    numbers = range(rock.block_count)
    for k in numbers[::-1] if reverse else numbers:
        corners = rock.vertices[rock.block_start[k] : rock.block_start[k + 1]] + rock.origin
        fixed = bool(np.isclose(np.abs(corners).max(), 6.0))
        place = turned(flip * corners, turn, (away, -away))
        place = place[::-1] if mirrored else place
        builder.block(name=f"rock {k}", vertices=place, fixed=fixed)
    xx, yy, xy = -4e6, -2e6, 5e5 * flip[0]
    rotation = turned(np.eye(2), turn)
    stress = rotation.T @ np.array([[xx, xy], [xy, yy]]) @ rotation
    builder.in_situ = clast.InSituStress(stress=(stress[0, 0], stress[1, 1], stress[0, 1]))
    builder.opening("tunnel", blocks=[f"rock {k}" for k in sorted(inside, reverse=reverse)])
    builder.lining("lining", opening="tunnel", **LINING)
    return builder


def segments(view: dict[str, Any]) -> np.ndarray[Any, Any]:
    """Return corners of the segments as they are without the view, sorted, m."""
    model = lined(**view).build()
    own = np.char.startswith(np.array(model.block_name), "lining/")[model.vertex_block]
    away = view.get("away", 0.0)
    places = model.vertices[own] + model.origin - (away, -away)
    places = turned(places, -np.radians(view.get("angle", 0.0)))
    places = places * (-1.0 if view.get("mirrored") else 1.0, 1.0)
    return places[np.lexsort(np.round(places, 6).T)]


@pytest.mark.parametrize("view", list(VIEWS))
def test_a_lining_has_the_same_segments_in_every_view(view: str):
    usual = segments({})
    assert len(usual) > 40
    assert segments(VIEWS[view]) == pytest.approx(usual, abs=1e-9)


def sections(view: dict[str, Any]) -> np.ndarray[Any, Any]:
    """Return forces of a lining that is installed as the rock comes in, (N, |Q|, |M|), sorted."""
    stages = (
        clast.Stage(name="rest", dynamic_ratio=0.0),
        clast.Stage(
            name="dig",
            dynamic_ratio=0.0,
            excavate=("tunnel",),
            relax=0.5,
            relax_time=0.2,
            until="time",
            time=0.1,
        ),
        clast.Stage(name="spray", dynamic_ratio=0.0),
    )
    run = lined(**view).case(stages=stages, step=5e-2, end=1.0).run(progress=False)
    found = run.lining("lining")
    forces = [found.normal_force[-1], np.abs(found.shear_force[-1]), np.abs(found.moment[-1])]
    order = np.argsort(forces[0])
    return np.stack(forces, axis=1)[order]


# corners of rock that coincide enter by the edge with the lower number, another one in a mirror
@pytest.mark.parametrize(("view", "tolerance"), [("30", 1e-7), ("90", 1e-7), ("mirrored", 2e-5)])
def test_a_lining_bears_the_same_in_every_view(view: str, tolerance: float):
    usual, other = sections({}), sections(VIEWS[view])
    largest = np.abs(usual).max(axis=0)
    assert (largest > [4e5, 1e4, 1e3]).all()
    assert other / largest == pytest.approx(usual / largest, abs=tolerance)
