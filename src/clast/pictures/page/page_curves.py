"""The curves of a page: measured points, bolts, energies, steps over time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from clast.model.model import Floats
from clast.pictures.supports.draw_linings import DIAGRAMS
from clast.results import Recording

CURVE_POINTS = 2_000
"""Instants of a curve at most."""


OF_CONTACTS = (
    ("stress", "Pa", ("normal", "shear")),
    ("slip", "m", ("slip", "slip_least", "slip_most")),
    ("opening", "m", ("opening", "opening_least", "opening_most")),
)
"""Quantities of measured contacts, with their units and columns."""


def curves_of(results: Recording) -> list[dict[str, Any]]:
    """Return the curves over time: points, bolts, contacts, supports, energies, steps."""
    found = (*_of_measurements(results), *_of_supports(results), *_of_run(results))
    return [one for one in found if len(one["time"])]


def _of_measurements(results: Recording) -> Iterator[dict[str, Any]]:
    """Yield the curves of measured points, of bolts and of measured contacts."""
    for name in results.point_name:
        point = results.history(name)
        for quantity, unit in (("displacement", "m"), ("velocity", "m/s")):
            x, y = getattr(point, quantity).T
            yield _curve(f"Point {name}, {quantity}", unit, point.time, {"x": x, "y": y})
    for name in results.bolt_name:
        bolt = results.bolt_history(name)
        yield _curve(f"Bolt {name}, force", "N/m", bolt.time, {"": bolt.force})
    for name in results.measured_contact_name:
        rows = results.measured_contact(name)
        for quantity, unit, columns in OF_CONTACTS:
            lines = {column: rows[column] for column in columns}
            yield _curve(f"Contact {name}, {quantity}", unit, rows["time"], lines)


def _of_supports(results: Recording) -> Iterator[dict[str, Any]]:
    """Yield the curves of reactions, links and linings."""
    for name in results.reaction_name:
        reaction = results.reaction(name)
        lines = {"x": reaction.force[:, 0], "y": reaction.force[:, 1]}
        yield _curve(f"Reaction {name}, force", "N/m", reaction.time, lines)
        yield _curve(f"Reaction {name}, moment", "N m/m", reaction.time, {"": reaction.moment})
    for name in results.link_name:
        link = results.link(name)
        lines = {"along": link.force[:, 0], "across": link.force[:, 1]}
        yield _curve(f"Link {name}, force", "N/m", link["time"], lines)
        yield _curve(f"Link {name}, moment", "N m/m", link["time"], {"": link["moment"]})
    for name in results.lining_name:
        lining = results.lining(name)
        for one in DIAGRAMS.values():
            values = np.nan_to_num(getattr(lining, one.column))
            lines = {"most": values.max(axis=1), "least": values.min(axis=1)}
            yield _curve(f"Lining {name}, {one.letter}", one.unit, lining.time, lines)


def _of_run(results: Recording) -> Iterator[dict[str, Any]]:
    """Yield the curves of energies and steps."""
    energy = results.energy
    parts = {key: values for key, values in energy.items() if key != "time" and np.any(values)}
    yield _curve("Energy", "J/m", energy["time"], parts)
    steps = results.steps
    if len(steps):
        time = steps["time"]
        yield _curve("Step", "s", time, {"": steps["step"]})
        yield _curve("Deepest penetration", "m", time, {"": steps["penetration"]})
        yield _curve("Contacts", "", time, {"": steps["contacts"]})
        if "unbalanced" in steps and np.isfinite(steps["unbalanced"]).any():
            lines = {"of all forces": steps["unbalanced"]}
            yield _curve("Unbalanced force", "", time, lines)


def _curve(name: str, unit: str, time: Floats, lines: dict[str, Any]) -> dict[str, Any]:
    """Return a chart; of long ones lowest and highest values of stretches are kept."""
    kept = np.arange(len(time))
    if len(time) > CURVE_POINTS:
        chosen = [np.array([0, len(time) - 1])]
        for values in lines.values():
            for part in np.array_split(kept, max(1, CURVE_POINTS // (2 * max(1, len(lines))))):
                here = np.nan_to_num(np.asarray(values)[part])
                chosen.append(part[[int(here.argmin()), int(here.argmax())]])
        kept = np.unique(np.concatenate(chosen))
    return {
        "name": name,
        "unit": unit,
        "time": [float(f"{t:.9g}") for t in np.asarray(time, float)[kept]],
        "lines": [
            {"name": key.replace("_", " "), "values": [_short(v) for v in np.asarray(values)[kept]]}
            for key, values in lines.items()
        ],
    }


def _short(value: Any) -> float | None:
    """Return a number with six digits; None for one that is not finite, unknown to JSON."""
    number = float(value)
    return float(f"{number:.6g}") if np.isfinite(number) else None
