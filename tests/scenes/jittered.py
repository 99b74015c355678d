"""Random rock masses of jittered quadrilaterals: excavated in stages, and thrown and driven."""

from __future__ import annotations

from typing import Any

import numpy as np

Tables = dict[str, Any]
LINKED = {"x": 1e8, "y": 3e7, "rotation": 1e7, "direction": [0.8, 0.6]}


def quadrilaterals(
    rng: np.random.Generator, columns: int, rows: int, jitter: float
) -> dict[str, np.ndarray]:
    """Return blocks of a lattice with inner points moved at random, by name, (4, 2) each, m."""
    at = np.stack(np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij"), -1)
    at[1:-1, 1:-1] += rng.uniform(-jitter, jitter, (columns - 1, rows - 1, 2))
    return {
        f"b{i}_{k}": np.array([at[i, k], at[i + 1, k], at[i + 1, k + 1], at[i, k + 1]])
        for i in range(columns)
        for k in range(rows)
    }


def excavated(seed: int) -> Tables:
    """Return a static case: stress, a room, bolts, a lining, water, a load, softer joints."""
    rng = np.random.default_rng([2, seed])
    blocks = quadrilaterals(rng, 6, 5, 0.25)
    fixed = {name for name in blocks if name[1] in "05" or name.endswith("_0")}
    stress, young = -(10.0 ** rng.uniform(5.5, 6.5)), 10.0 ** rng.uniform(9.0, 10.3)
    angle = rng.uniform(25.0, 40.0)
    roof, beside = blocks["b2_3"].mean(0).tolist(), blocks["b3_4"].mean(0).tolist()
    case: Tables = {
        "schema": 1,
        "plane": "strain",
        "gravity": [0.0, -9.81],
        "time": {"step": 2e-3, "end": 0.3, "dynamic_ratio": 0.0, "max_displacement": 0.02},
        "rock": {"r": {"young": young, "poisson": 0.2, "density": 2600.0}},
        "joint": {"default": {"friction_angle": angle}},
        "method": {
            "contact_law": {"name": "penalty", "normal_stiffness": young * rng.uniform(0.2, 2.0)}
        },
        "in_situ": {"stress": [rng.uniform(0.5, 1.5) * stress, stress, 0.0]},
        "block": [
            {"name": name, "vertices": corners.tolist(), "fixed": name in fixed}
            for name, corners in blocks.items()
        ],
        "opening": [{"name": "room", "blocks": ["b2_2", "b3_2"]}],
        "bolt_kind": {"bar": {"stiffness": 2e8, "pretension": 1e4}},
        "bolt": [{"kind": "bar", "start": roof, "end": beside, "blocks": ["b2_3", "b3_4"]}],
        "point_load": [
            {"name": "push", "at": beside, "block": "b3_4", "force": [6e4, -2e5]},
        ],
        "stage": [
            {"name": "rest"},
            {"name": "dig", "excavate": ["room"], "relax": 0.3, "relax_time": 0.02},
            {"name": "bolt", "install": ["bar"], "loads": ["push"]},
            {"name": "soft", "joint": {"default": {"friction_angle": 0.8 * angle}}},
        ],
    }
    case["in_situ"]["boundary"] = "traction" if seed % 2 else "roller"
    if seed % 3 == 0:
        shell = {"name": "shell", "opening": "room", "thickness": 0.1, "segment": 0.5}
        case["lining"] = [{**shell, "young": 1e10, "stage": "bolt"}]
    if seed % 3 == 1:
        case["link"] = [{**LINKED, "at": roof, "blocks": ["b2_3", "b2_4"]}]
    if seed % 4 == 2:
        case["water"] = [{"name": "wet", "line": [[0.0, 3.5], [6.0, 3.5]], "acts_on": "joints"}]
        case["stage"].append({"name": "wet", "loads": ["wet"]})
    return case


STRENGTHS: tuple[Tables, ...] = (
    {"friction_angle": 30.0},
    {"friction_angle": 35.0, "residual_friction_angle": 20.0, "slip_weakening": 1e-3},
    {"friction_angle": 30.0, "cohesion": 5e4, "tensile_strength": 3e4},
    {"law": "barton-bandis", "jrc": 8.0, "jcs": 5e7, "residual_friction_angle": 28.0},
)


def thrown(seed: int) -> Tables:
    """Return eight steps of blocks on a base that are thrown together, linked and driven."""
    rng = np.random.default_rng([5, seed])
    gap, young = (0.0, 0.01, 0.05)[seed % 3], 10.0 ** rng.uniform(8.0, 10.3)
    blocks = quadrilaterals(rng, 3, 3, 0.2)
    step, middle = (1e-3, 2e-3, 5e-3)[seed // 3 % 3], blocks["b1_1"].mean(0)
    drawn = [
        {
            "name": name,
            "vertices": (corners.mean(0) + (1.0 - gap) * (corners - corners.mean(0))).tolist(),
            "velocity": (rng.normal(size=3) * [1.0, 1.0, 0.5]).tolist(),
        }
        for name, corners in blocks.items()
    ]
    base = [[-3.0, -1.0 - gap], [6.0, -1.0 - gap], [6.0, -gap], [-3.0, -gap]]
    case: Tables = {
        "schema": 1,
        "plane": "strain",
        "gravity": [0.0, -9.81],
        "time": {"step": step, "end": 8.0 * step},
        "rock": {"r": {"young": young, "poisson": 0.2, "density": 2500.0}},
        "joint": {"default": STRENGTHS[seed % 4]},
        "method": {"contact_law": {"name": "penalty", "normal_stiffness": young}},
        "block": [{"name": "base", "vertices": base, "fixed": True}, *drawn],
        "link": [{**LINKED, "at": middle.tolist(), "blocks": ["b1_1", "b1_2"]}],
    }
    if seed % 2:
        case["motion"] = [{"block": "b2_0", "x": -0.3, "y": 0.1, "rotation": 10.0}]
    if seed % 5 == 0:
        line = [[3.5, 0.0], [3.5, 1.5], [4.5, 2.0], [5.5, 1.5], [5.5, 0.0]]
        arch = {"name": "arch", "polyline": line, "side": "left", "thickness": 0.15}
        case["lining"] = [{**arch, "segment": 0.5, "young": 2e10}]
    return case
