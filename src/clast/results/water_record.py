"""Water in a result file: /model/water/0, /model/water/1, ...

Each is a group with its name, the weight of water, N/m3, and the share of the full head as
attributes, and as datasets the phreatic line, about the model's origin, and the edges that it wets.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from clast.model.factors import Factor
from clast.model.water import Water, WetFaces, WetJoints
from clast.results.open_file import MalformedError

SHAPES: dict[str, tuple[str, tuple[int, ...]]] = {
    "surface": ("f8", (2,)),
    "face_edge": ("i8", ()),
    "face_share": ("f8", (2,)),
    "joint_edge": ("i8", (2,)),
    "joint_share": ("f8", (2, 2)),
    "joint_lowered": ("f8", (2,)),
    "joint_widest": ("f8", ()),
    "joint_ends": ("f8", (2, 2)),
    "joint_near": ("f8", ()),
    "joint_conducts": ("?", ()),
    "joint_drain": ("i8", (2,)),
    "drain_at": ("f8", (2,)),
    "factor_time": ("f8", ()),
    "factor_value": ("f8", ()),
}
"""Datasets of a water: type and shape of a row."""


def write_water(group: Any, waters: tuple[Water, ...]) -> None:
    """Write waters into the group of the model."""
    for number, water in enumerate(waters):
        place = group.create_group(f"water/{number}")
        place.attrs["name"] = water.name
        place.attrs["weight"] = water.weight
        place.attrs["share"] = water.share
        place.attrs["factor"] = water.factor.name if water.factor else ""
        arrays = {
            "surface": water.surface,
            **{f"face_{key}": value for key, value in vars(water.faces).items()},
            **{f"joint_{key}": value for key, value in vars(water.joints).items()},
            "drain_at": water.drain_at,
        }
        if water.factor:
            arrays |= {"factor_time": water.factor.time, "factor_value": water.factor.value}
        for name, values in arrays.items():
            if len(values):
                place.create_dataset(name, data=values, compression="gzip", fletcher32=True)


def waters_in(group: Any, edges: int) -> tuple[Water, ...]:
    """Return the waters in the group of a model with so many edges; raises MalformedError."""
    damaged = MalformedError("/model/water does not hold the expected data")
    waters = []
    for number in range(len(group["water"]) if "water" in group else 0):
        place = group.get(f"water/{number}")
        if place is None:
            raise damaged
        arrays = {}
        for name, (kind, shape) in SHAPES.items():
            values = np.asarray(place[name]) if name in place else np.zeros((0, *shape), kind)
            if values.dtype.kind != np.dtype(kind).kind or values.shape[1:] != shape:
                raise damaged
            arrays[name] = values
        counts = {name.split("_")[0]: len(values) for name, values in arrays.items()}
        whole = all(len(values) == counts[name.split("_")[0]] for name, values in arrays.items())
        touched = np.concatenate([arrays["face_edge"], arrays["joint_edge"].ravel()])
        numbers = ("weight", "share", "name", "factor")
        if (
            not whole
            or not len(arrays["surface"])
            or any(key not in place.attrs for key in numbers)
        ):
            raise damaged
        if len(touched) and not (0 <= touched.min() and touched.max() < edges):
            raise damaged
        waters.append(_water(place.attrs, arrays))
    return tuple(waters)


def _water(attributes: Any, arrays: dict[str, Any]) -> Water:
    factor = None
    if len(arrays["factor_time"]):
        factor = Factor(
            name=str(attributes["factor"]), time=arrays["factor_time"], value=arrays["factor_value"]
        )

    def of(kind: str) -> dict[str, Any]:
        return {k.removeprefix(kind): v for k, v in arrays.items() if k.startswith(kind)}

    return Water(
        name=str(attributes["name"]),
        surface=arrays["surface"],
        weight=float(attributes["weight"]),
        share=float(attributes["share"]),
        factor=factor,
        faces=WetFaces(**of("face_")),
        joints=WetJoints(**of("joint_")),
        drain_at=arrays["drain_at"],
    )
