"""The content of the page of a run, as numbers and texts: blocks, contacts, curves, report."""

from __future__ import annotations

import re
from datetime import date
from typing import Any

import numpy as np

from clast.model.model import Floats
from clast.pictures.canvas import check_installed
from clast.pictures.draw_surcharge import AXLE, FILL
from clast.pictures.fields import SCALARS, colours_between
from clast.pictures.histories import History, histories_of
from clast.pictures.joint_values import JOINT_FIELDS, THICK, THIN
from clast.pictures.page.frame_data import moving, supports_of
from clast.pictures.page.packing import raw
from clast.pictures.strokes import strokes_of
from clast.pictures.supports import BOLT_LOOKS
from clast.results import Recording
from clast.thumbnails import CURVE_COLOURS

BLOCK_FRAMES_MAX = 4_000_000
"""Blocks times frames on a page; of longer runs frames are left out evenly."""
SCALE_COLOURS, CURVE_POINTS_MAX = 64, 2_000
"""Colours of a scale, and instants of a curve."""
MONTHS = (
    "January February March April May June July August September October November December"
).split()


def scene_of(
    results: Recording, budget: float, most_values: int = BLOCK_FRAMES_MAX
) -> dict[str, Any]:
    """Return the page's content; contacts and joints may take ``budget`` bytes uncompressed."""
    count, blocks = len(results.times), len(results.block_name)
    most = max(2, most_values // max(blocks, 1))
    numbers = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))
    start = results.vertices(0)
    origin = start.mean(axis=0)
    return {
        "title": results.title or results.name,
        "file": results.name,
        "made": [results.version, _day_of(results)],
        "frames": {"shown": len(numbers), "of": count},
        "origin": origin.tolist(),
        "vertices": raw(start - origin, "<f4"),
        "block_start": raw(results.block_start, "<i4"),
        "blocks": list(results.block_name),
        "fixed": np.flatnonzero(results.fixed).tolist(),
        "lined": np.flatnonzero(results.lined).tolist(),
        "rocks": list(results.rock_name),
        "rock": np.asarray(results.field("rock", 0), np.int64).tolist(),
        "joints": list(results.joint_name),
        "edge_joint": raw(results.edge_joint, "<i4"),
        "labels": _labels(),
        "joint_labels": {
            **{name: (one.label, one.unit, one.from_zero) for name, one in JOINT_FIELDS.items()},
            **({"water": ("Water pressure", "Pa")} if results.water else {}),
        },
        "joint_looks": _joint_looks(results),
        "bolt_looks": [(label, colour) for label, colour, _ in BOLT_LOOKS],
        "waters": [(one.surface + results.origin - origin).tolist() for one in results.water],
        "surcharge": _surcharge(results, origin),
        "colours": _colours(),
        "curve_colours": CURVE_COLOURS,
        "line_widths": [THIN, THICK],
        "supports": supports_of(results),
        **moving(results, numbers, budget),
        **words_of(results),
    }


def _surcharge(results: Recording, origin: Floats) -> dict[str, Any]:
    """Return fill and axles about the page's origin, and when each begins to act, s."""
    every, shift = results.surcharge, results.origin - origin
    begun = results.begun_at(len(results.times) - 1)

    def since(name: str) -> float | None:
        return begun.get(name, float(results.times[0]))

    return {
        "colours": [FILL, AXLE],
        "fill": [
            {"outline": (outline + shift).tolist(), "since": since(name)}
            for outline, name in zip(every.fill, every.fill_name, strict=True)
        ],
        "axles": [
            {"at": (at + shift).tolist(), "load": load, "name": name, "since": since(name)}
            for at, load, name in zip(every.axle, every.load.tolist(), every.axle_name, strict=True)
            if load > 0.0
        ],
    }


def _day_of(results: Recording) -> str:
    """Return the day on which the file was last written, "" without a file."""
    try:
        day = date.fromtimestamp(results.file.stat().st_mtime) if results.file else None
    except OSError:
        return ""
    return f"{day.day} {MONTHS[day.month - 1]} {day.year}" if day else ""


def words_of(results: Recording) -> dict[str, Any]:
    """Return the words and curves of the page of a run, which grow while it goes on."""
    return {
        "curves": [_curve(one) for one in histories_of(results) if len(one.time)],
        "events": [
            {"time": one.time, "stage": getattr(one, "stage", ""), "text": str(one)}
            for one in results.events
        ],
        "report": _report(results),
    }


def _curve(history: History) -> dict[str, Any]:
    """Return the chart of a history; of long ones lowest and highest values of stretches."""
    lines, count = history.lines, len(history.time)
    kept = np.arange(count)
    if count > CURVE_POINTS_MAX:
        chosen = [np.array([0, count - 1])]
        for values in lines.values():
            for part in np.array_split(kept, max(1, CURVE_POINTS_MAX // (2 * len(lines)))):
                here = np.nan_to_num(np.asarray(values)[part])
                chosen.append(part[[int(here.argmin()), int(here.argmax())]])
        kept = np.unique(np.concatenate(chosen))
    return {
        "name": history.title,
        "unit": history.unit,
        "time": [float(f"{t:.9g}") for t in np.asarray(history.time, float)[kept]],
        "lines": [
            {"name": key.replace("_", " "), "values": [_short(v) for v in np.asarray(values)[kept]]}
            for key, values in lines.items()
        ],
    }


def _short(value: Any) -> float | None:
    """Return a number with six digits; None for one that is not finite, unknown to JSON."""
    number = float(value)
    return float(f"{number:.6g}") if np.isfinite(number) else None


def _labels() -> dict[str, tuple[str, str]]:
    """Return label and unit of every field that the page can colour blocks by."""
    formula = re.compile(r"\$\\sigma_\{?(\w+)\}?\$")
    return {name: (formula.sub(r"σ\1", field.label), field.unit) for name, field in SCALARS.items()}


def _joint_looks(results: Recording) -> dict[int, tuple[str, str, list[float]]]:
    """Return label, colour and dashes, pixels, of each joint that edges have, by its number."""
    joint = results.edge_joint
    names = {number: results.joint_name[number] for number in np.unique(joint[joint >= 0]).tolist()}
    looks = strokes_of(names)
    dashes = {number: () if one.dashes == "-" else one.dashes[1] for number, one in looks.items()}
    return {
        number: (looks[number].label, looks[number].colour, [2.0 * d for d in dashes[number]])
        for number in names
    }


def _colours() -> dict[str, Any]:
    """Return the colours of scales above zero, below, and on both sides, as in still pictures."""
    check_installed()
    from matplotlib.colors import to_hex

    ends = {"rising": (0.0, 1.0), "falling": (-1.0, 0.0), "both": (-1.0, 1.0)}
    # the middle of each of the steps that the page divides a scale into
    shares = (np.arange(SCALE_COLOURS) + 0.5) / SCALE_COLOURS
    scales = {name: colours_between(*pair) for name, pair in ends.items()}
    beyond = {
        name: [to_hex(tuple(end)) for end in (scale.get_under(), scale.get_over())]
        for name, scale in scales.items()
    }
    steps = {name: [*map(to_hex, scale(shares))] for name, scale in scales.items()}
    return {**steps, "beyond": beyond}


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
