"""What the page shows of a run, as plain numbers and texts: blocks, contacts, curves, report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clast.model.model import Bools, Floats, Ints
from clast.pictures.fields import SCALARS
from clast.pictures.page.packing import affine, packed, raw
from clast.pictures.scale import colours_between
from clast.results import Recording
from clast.results.frames import gone_in_frame

MOST_VALUES = 4_000_000
"""Blocks times frames on a page; of longer runs frames are left out evenly."""
CONTACT_BYTES = 14
"""Bytes of a contact in a frame, before they are compressed."""
CURVE_POINTS = 2_000
"""Instants of a curve at most."""
COLOURS = 64
"""Colours of a scale."""


class _Frames(Sequence[Floats]):
    """The vertices (nv, 2) of some frames, read one after the other."""

    def __init__(self, results: Recording, numbers: Ints) -> None:
        self._results, self._numbers = results, numbers

    def __len__(self) -> int:
        return len(self._numbers)

    def __getitem__(self, k: Any) -> Any:
        return self._results.vertices(int(self._numbers[k]))

    def __iter__(self) -> Iterator[Floats]:
        for number in self._numbers:
            yield self._results.vertices(int(number))


def scene_of(results: Recording, budget: float, most_values: int = MOST_VALUES) -> dict[str, Any]:
    """Return what the page shows; contacts may take ``budget`` bytes before they are compressed."""
    count, blocks = len(results.times), len(results.block_name)
    most = max(2, most_values // max(blocks, 1))
    numbers = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))
    start = results.vertices(0)
    origin = start.mean(axis=0)
    motion = affine(start, _Frames(results, numbers), results.block_start)
    stages = results.frame_stages
    return {
        "title": results.title or results.name,
        "file": results.name,
        "times": results.times[numbers].tolist(),
        "frames": {"shown": len(numbers), "of": count},
        "stages": [stages[n] for n in numbers] if stages else [],
        "origin": origin.tolist(),
        "vertices": raw(start - origin, "<f4"),
        "block_start": raw(results.block_start, "<i4"),
        "blocks": list(results.block_name),
        "fixed": np.flatnonzero(results.fixed).tolist(),
        "gone": _gone_from(results, numbers).tolist(),
        "rocks": list(results.rock_name),
        "rock": np.asarray(results.field("rock", 0), np.int64).tolist(),
        "joints": list(results.joint_name),
        "edge_joint": raw(results.edge_joint, "<i4"),
        "motion": {name: packed(values) for name, values in motion.items()},
        "fields": {name: packed(values) for name, values in _fields(results, numbers)},
        "labels": _labels(),
        "colours": _colours(),
        "contacts": _contacts(results, numbers, budget, origin),
        "bolts": _bolts(results, numbers, origin),
        "points": _points(results, numbers, origin),
        "curves": _curves(results),
        "events": [_event(one) for one in results.events],
        "report": _report(results),
    }


def _gone_from(results: Recording, numbers: Ints) -> Ints:
    """Return the frame from which on each block is excavated; the number of frames for never."""
    found = np.full(len(results.block_name), len(numbers))
    for k in range(len(numbers) - 1, -1, -1):
        gone: Bools = gone_in_frame(results, int(numbers[k]))
        if not gone.any():
            break
        found[gone] = k
    return found


def _fields(results: Recording, numbers: Ints) -> Iterator[tuple[str, Floats]]:
    """Give the fields that the page cannot work out by itself, (frames, n)."""
    for name in ("velocity_x", "velocity_y", "sigma_xx", "sigma_yy", "sigma_xy"):
        yield name, np.stack([results.field(name, int(number)) for number in numbers])


def _labels() -> dict[str, tuple[str, str]]:
    """Return label and unit of every field that the page can colour blocks by."""
    plain = {r"$\sigma_{xx}$": "σxx", r"$\sigma_{yy}$": "σyy", r"$\sigma_{xy}$": "σxy"}
    plain |= {r"$\sigma_1$": "σ1", r"$\sigma_3$": "σ3"}
    found = {}
    for name, field in SCALARS.items():
        label = field.label
        for written, read in plain.items():
            label = label.replace(written, read)
        found[name] = (label, field.unit)
    return found


def _colours() -> dict[str, list[str]]:
    """Return the colours of scales above zero, below, and on both sides, as in still pictures."""
    from matplotlib.colors import to_hex

    ends = {"rising": (0.0, 1.0), "falling": (-1.0, 0.0), "both": (-1.0, 1.0)}
    shares = np.linspace(0.0, 1.0, COLOURS)
    return {
        name: [to_hex(colour) for colour in colours_between(*pair)(shares)]
        for name, pair in ends.items()
    }


def _contacts(results: Recording, numbers: Ints, budget: float, origin: Floats) -> dict[str, Any]:
    """Return the largest contact forces of every frame, as many as the budget allows."""
    most = max(1, int(budget / CONTACT_BYTES / len(numbers)))
    shown = total = 0
    rows: list[NDArray[Any]] = []
    counts = []
    for number in numbers:
        table = results.contacts(int(number))
        force = table.force
        size = np.hypot(*force.T) if len(table) else np.zeros(0)
        kept = np.sort(np.argsort(-size, kind="stable")[:most])
        total, shown = total + len(table), shown + len(kept)
        counts.append(len(kept))
        rows.append(
            np.column_stack(
                [
                    (table.position - origin)[kept],
                    force[kept],
                    table.vertex_block[kept],
                    table.edge_block[kept],
                    table.mode[kept],
                ]
            )
            if len(table)
            else np.zeros((0, 7))
        )
    flat = np.concatenate([np.zeros((0, 7)), *rows])
    return {
        "shown": shown,
        "of": total,
        "count": counts,
        "x": raw(flat[:, 0], "<f4"),
        "y": raw(flat[:, 1], "<f4"),
        "fx": raw(flat[:, 2], "<f4"),
        "fy": raw(flat[:, 3], "<f4"),
        "on": raw(flat[:, 4], "<i4"),
        "by": raw(flat[:, 5], "<i4"),
        "mode": raw(flat[:, 6], "<i4"),
    }


def _bolts(results: Recording, numbers: Ints, origin: Floats) -> dict[str, Any] | None:
    """Return points, forces and states of bolts in every frame; None without any."""
    first = results.bolts(0)
    if not len(first):
        return None
    every = [results.bolts(int(number)) for number in numbers]
    at = np.stack([one.points - origin for one in every])
    return {
        "names": list(first.name),
        "bolt": first.bolt.tolist(),
        "x": raw(at[..., 0], "<f4"),
        "y": raw(at[..., 1], "<f4"),
        "force": raw(np.stack([one.force for one in every]), "<f4"),
        "state": raw(np.stack([one.state for one in every]), "<i4"),
    }


def _points(results: Recording, numbers: Ints, origin: Floats) -> list[dict[str, Any]]:
    """Return the measured points with where they are in every frame."""
    found = []
    for name, at in zip(results.point_name, results.point_start, strict=True):
        history = results.history(name)
        # a static run has several rows at one time: the last of them is the frame's
        row = np.searchsorted(history.time, results.times[numbers] * (1.0 + 1e-12), side="right")
        moved = history.displacement[np.maximum(row - 1, 0)]
        place = at - origin + moved
        found.append({"name": name, "x": place[:, 0].tolist(), "y": place[:, 1].tolist()})
    return found


def _curves(results: Recording) -> list[dict[str, Any]]:
    """Return the curves over time: measured points, bolts, energies, steps."""
    found = []
    for name in results.point_name:
        history = results.history(name)
        found.append(
            _curve(
                f"Point {name}, displacement",
                "m",
                history.time,
                {"x": history.displacement[:, 0], "y": history.displacement[:, 1]},
            )
        )
        found.append(
            _curve(
                f"Point {name}, velocity",
                "m/s",
                history.time,
                {"x": history.velocity[:, 0], "y": history.velocity[:, 1]},
            )
        )
    for name in results.bolt_name:
        history_of_bolt = results.bolt_history(name)
        found.append(
            _curve(f"Bolt {name}, force", "N/m", history_of_bolt.time, {"": history_of_bolt.force})
        )
    energy = results.energy
    parts = {key: values for key, values in energy.items() if key != "time" and np.any(values)}
    found.append(_curve("Energy", "J/m", energy["time"], parts))
    steps = results.steps
    if len(steps):
        time = steps["time"]
        found.append(_curve("Step", "s", time, {"": steps["step"]}))
        found.append(_curve("Deepest penetration", "m", time, {"": steps["penetration"]}))
        found.append(_curve("Contacts", "", time, {"": steps["contacts"]}))
    return [one for one in found if len(one["time"])]


def _curve(name: str, unit: str, time: Floats, lines: dict[str, Any]) -> dict[str, Any]:
    """Return a chart; of long ones lowest and highest values of stretches are kept."""
    kept = np.arange(len(time))
    if len(time) > CURVE_POINTS:
        chosen = [np.array([0, len(time) - 1])]
        for values in lines.values():
            for part in np.array_split(kept, max(1, CURVE_POINTS // (2 * max(1, len(lines))))):
                here = np.asarray(values)[part]
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
    """Return a number with six digits; None for what is not finite, which JSON does not know."""
    number = float(value)
    return float(f"{number:.6g}") if np.isfinite(number) else None


def _event(event: Any) -> dict[str, Any]:
    """Return an event as time, stage and text."""
    plain = asdict(event)
    return {"time": plain["time"], "stage": plain.get("stage", ""), "text": str(event)}


def _report(results: Recording) -> dict[str, Any]:
    """Return how the run went, in words and numbers."""
    report = results.report
    if report is None:
        return {"outcome": "the run has no report: it was killed, or goes on", "rows": []}
    rows = [
        ("steps", f"{report.steps} ({report.cut_steps} cut)"),
        ("largest penetration", f"{report.largest_penetration:.3g} m"),
        ("most contacts in a step", f"{report.largest_contacts}"),
        ("unaccounted energy", f"{report.ledger.unaccounted:.2g} J/m"),
        ("wall time", f"{report.wall_seconds:.3g} s"),
    ]
    return {
        "outcome": report.outcome,
        "rows": rows,
        "stages": [str(one) for one in report.stages],
        "warnings": list(report.warnings),
        "notes": list(report.notes),
    }
