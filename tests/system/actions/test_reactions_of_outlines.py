"""The reaction of an outline under in-situ stress closes the balance with weight and water."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import clast
from clast.block import polygon
from clast.model.model import Floats
from clast.results import Run

CASE: dict[str, Any] = {
    "schema": 1,
    "title": "A tunnel at depth",
    "time": {"step": 1e-2, "end": 0.5, "dynamic_ratio": 0.0},
    "rock": {"gneiss": {"young": 5e9, "poisson": 0.25, "density": 2700.0}},
    "joint": {
        "default": {
            "friction_angle": 35.0,
            "cohesion": 3e6,
            "tensile_strength": 3e6,
            "normal_stiffness": 2e10,
            "shear_stiffness": 4e9,
        }
    },
    "opening": [{"name": "tunnel", "shape": "circle", "center": [12.0, 8.0], "radius": 3.0}],
    "stage": [
        {"name": "rest"},
        {"name": "dug", "excavate": ["tunnel"]},
        {"name": "shaken", "dynamic_ratio": 1.0, "step": 1e-3, "until": "time", "time": 0.01},
    ],
    "output": {"every": 1e-3},
}
WIDE, HIGH, LEVEL = 24.0, 16.0, 12.0
OUTLINE = np.array([[0.0, 0.0], [WIDE, 0.0], [WIDE, HIGH], [0.0, HIGH]])
STRESS = np.array([[-3e6, 0.4e6], [0.4e6, -4e6]])
MIRROR = np.diag([-1.0, 1.0])
AS_DRAWN, QUARTER = np.eye(2), np.array([[0.0, -1.0], [1.0, 0.0]])
ASKEW = np.array([[0.8, -0.6], [0.6, 0.8]])
SIDES = ("left", "right", "bottom", "top")
UPLIFT = 9.8 * 1e3 * WIDE * LEVEL
"""Pressure of water on the outline, by Archimedes, N/m."""
DRAINED = {"water": [{"level": LEVEL, "drained_at": "tunnel"}]}


def tunnel(q: Floats, boundary: str = "fixed", fixed: list[str] | None = None, **more: Any) -> Run:
    """Return the run of a tunnel that is turned or mirrored by ``q`` with gravity and stress."""
    middle = OUTLINE.mean(axis=0)
    lines = np.array([[np.cos(a), np.sin(a)] for a in np.radians([25.0, 110.0])]) @ q.T
    angles = np.degrees(np.arctan2(lines[:, 1], lines[:, 0])) % 180.0
    xx, xy, _, yy = (q @ STRESS @ q.T).ravel().tolist()
    tables = {
        "gravity": (q @ [0.0, -9.8]).tolist(),
        "in_situ": {"stress": [xx, yy, xy], "boundary": boundary},
        "domain": {
            "boundary": ((OUTLINE - middle) @ q.T + middle).tolist(),
            "fixed_sides": fixed or [],
        },
        "joint_set": [
            {"name": f"{k}", "angle": angle, "spacing": 3.0, "origin": middle.tolist()}
            for k, angle in enumerate(angles.tolist())
        ],
        "measured_reaction": [
            {"name": side, "side": side} for side in SIDES if not (q * q)[0].all()
        ],
    }
    return clast.Case.validated({**CASE, **tables, **more}, "tunnel.toml").run()


def balance(run: Run) -> tuple[Floats, Floats]:
    """Return R + W - M a, N/m, and the moment of R + W about the origin, N, of all frames.

    Static frames start from rest: theirs have no M a.
    """
    model, stage = run.model, np.array(run.frame_stages)
    dug = np.isin(np.arange(model.block_count), model.openings[0].block)
    mass = np.where(model.fixed | ((stage != "rest")[:, None] & dug), 0.0, model.mass)
    momentum = np.array([m @ run.field("velocity", k)[:, :2] for k, m in enumerate(mass)])
    pushed = np.diff(momentum, axis=0, prepend=0.0) / np.diff(run.times, prepend=-1.0)[:, None]
    force = np.where((stage == "shaken")[:, None], -pushed, 0.0)
    force += mass.sum(axis=1)[:, None] * model.gravity
    start = model.block_start
    at = np.array([polygon.moments(run.vertices(k), start)[1] for k in range(len(run.times))])
    moment = (mass * (at[..., 0] * model.gravity[1] - at[..., 1] * model.gravity[0])).sum(axis=1)
    for name in {"outline", "fixed blocks"} & set(run.reaction_name):
        one, about = run.reaction(name), run.model.reactions.about[run.reaction_name.index(name)]
        last = np.searchsorted(one.time, run.times, side="right") - 1
        force += one.force[last]
        x, y = about + model.origin
        moment += one.moment[last] + x * one.force[last, 1] - y * one.force[last, 0]
    return force, moment


SETTINGS: dict[str, dict[str, Any]] = {
    "held": {"q": AS_DRAWN},
    "turned": {"q": ASKEW},
    "turned and mirrored, on rollers": {"q": ASKEW @ MIRROR, "boundary": "roller"},
    "wet": {"q": AS_DRAWN, **DRAINED},
    "wet, on rollers": {"q": AS_DRAWN, "boundary": "roller", **DRAINED},
    "on fixed blocks": {"q": AS_DRAWN, "boundary": "roller", "fixed": ["bottom", "left"]},
}


@pytest.mark.parametrize("name", SETTINGS)
def test_reactions_and_weight_are_in_balance(name: str):
    run = tunnel(**SETTINGS[name])
    assert [one.outcome for one in run.stages] == ["equilibrium", "equilibrium", "time over"]
    force, moment = balance(run)
    # of water on faces that have moved, its change by their displacements is left
    wet = "water" in SETTINGS[name]
    force += [0.0, UPLIFT if wet else 0.0]
    stage = np.array(run.frame_stages)
    ends = np.array([np.flatnonzero(stage == one)[-1] for one in ("rest", "dug")])
    known = np.concatenate([ends, np.flatnonzero(stage == "shaken")])
    weight = 9.8 * float(run.model.mass.sum())
    assert np.abs(force[known]).max() < (1e-6 if wet else 1e-10) * weight
    if name != "on fixed blocks":  # whose own weight presses on neighbours that move
        turned = moment[ends] + (0.5 * WIDE * UPLIFT if wet else 0.0)
        assert np.abs(turned).max() < (2e-6 if wet else 1e-10) * weight * HIGH


def at_end_of(run: Run, stage: int, name: str) -> Floats:
    """Return a reaction, N/m, at the end of a stage."""
    one = run.reaction(name)
    last = np.searchsorted(one.time, run.stages[stage].end, side="right") - 1
    return np.asarray(one.force[last])


def test_sides_bear_the_stress():
    run = tunnel(AS_DRAWN, gravity=[0.0, 0.0])
    high, wide = STRESS @ [HIGH, 0.0], STRESS @ [0.0, WIDE]
    for side, force in zip(SIDES, (-high, high, -wide, wide), strict=True):
        assert at_end_of(run, 0, side) == pytest.approx(force, rel=1e-9)


def test_sides_share_the_outline_and_turn_with_it():
    turns = (AS_DRAWN, MIRROR, QUARTER)
    runs = [tunnel(q) for q in turns]
    across = {"left": "right", "right": "left", "bottom": "bottom", "top": "top"}
    round_about = {"left": "bottom", "right": "top", "bottom": "right", "top": "left"}
    names = ({side: side for side in SIDES}, across, round_about)
    largest = 4e6 * WIDE
    for run, q, there in zip(runs, turns, names, strict=True):
        shares = np.array([run.reaction(side).force for side in SIDES])
        whole = run.reaction("outline").force
        assert shares.sum(axis=0) == pytest.approx(whole, abs=1e-12 * largest)
        for side in SIDES:
            first = at_end_of(runs[0], 1, side)
            assert at_end_of(run, 1, there[side]) == pytest.approx(q @ first, abs=1e-6 * largest)


def test_a_fixed_point_of_an_excavated_block_holds_nothing():
    tables = {name: CASE[name] for name in ("schema", "title", "time", "rock", "joint")}
    corners = [np.array([[k, 0], [k + 1, 0], [k + 1, 1], [k, 1]], float) for k in (0, 3)]
    case = {
        **tables,
        "block": [{"name": f"{k}", "vertices": one.tolist()} for k, one in enumerate(corners, 1)],
        "fixed_point": [{"at": at} for one in corners for at in one[:2].tolist()],
        "stage": [{"name": "both"}, {"name": "one", "excavate": ["2"]}],
    }
    run = clast.Case.validated(case, "points.toml").run()
    weight = np.array([0.0, 2700.0 * 9.8])
    assert at_end_of(run, 0, "fixed points") == pytest.approx(2.0 * weight, abs=1e-3)
    assert at_end_of(run, 1, "fixed points") == pytest.approx(weight, abs=1e-3)
