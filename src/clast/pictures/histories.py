"""Several histories in one picture: points, bolts, contacts, supports, energy and steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import CaseError
from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import INK, SMALL_SIZE, TEXT_SIZE
from clast.pictures.fields import prefixed
from clast.results import Recording

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#7a6a00", "#56b4e9", "#444444", "#e69f00")
"""Colours of lines, told apart by most eyes (after Okabe and Ito)."""
DASHES = ("-", "--", ":")
WIDTH, PANEL = 6.4, 1.75
"""Width of the picture and height of a panel, inches."""
LEGEND_LINE = 0.172
"""Height of a line of the legend, inches."""
MOST_LINES = 24
"""Lines of a panel at most."""
COMPONENTS = {"x": 0, "y": 1}
LOST = 4
"""State of a joint of a lining from which on it carries nothing."""


@dataclass(frozen=True)
class _Line:
    """A quantity over time."""

    quantity: str
    """Title of the panel."""
    unit: str
    label: str
    time: Floats
    value: Floats


def plot_histories(
    results: Recording, path: Path | str, names: Sequence[str], against: str = "time"
) -> Path:
    """Draw histories over the same abscissa, a panel for each quantity; return the path.

    ``names`` are measured points, bolts, measured contacts, reactions, links, linings, "energy" or
    "steps": everything that is called so, or one kind of it, as "lining:crown".  ``against`` is
    "time", or a displacement of a measured point: "crown:y".  Raises CaseError for names that do
    not exist.
    """
    lines = [line for name in names for line in _lines(results, name)]
    panels: dict[tuple[str, str], list[_Line]] = {}
    for line in lines:
        panels.setdefault((line.quantity, line.unit), []).append(line)
    label, abscissa = _abscissa(results, against)
    title = canvas.wrapped(results.title or results.name, 6.0, canvas.TITLE_SIZE)
    tall = [max(PANEL, 0.25 + LEGEND_LINE * min(len(own), MOST_LINES)) for own in panels.values()]
    high = canvas.BELOW + sum(tall) + 0.2 * len(tall) + 0.1 + canvas.LINE * (len(title) + 0.5)
    figure = canvas.new_figure((WIDTH, high), 160)
    canvas.head(figure, 0.85, title, "")
    for place, ((quantity, unit), own) in enumerate(panels.items()):
        up = canvas.BELOW + sum(tall[place + 1 :]) + 0.2 * (len(tall) - 1 - place)
        axes = figure.add_axes((0.85 / WIDTH, up / high, 4.1 / WIDTH, tall[place] / high))
        largest = max(float(np.nanmax(np.abs(line.value), initial=0.0)) for line in own)
        factor, unit_drawn = prefixed(largest, unit) if unit else (1.0, "")
        for number, line in enumerate(own[:MOST_LINES]):
            axes.plot(
                abscissa(line.time),
                factor * line.value,
                DASHES[number // len(COLOURS) % len(DASHES)],
                color=COLOURS[number % len(COLOURS)],
                lw=1.2,
                label=canvas.literal(line.label),
            )
        axes.set_ylabel(
            f"{quantity} ({unit_drawn})" if unit_drawn else quantity, fontsize=TEXT_SIZE, color=INK
        )
        axes.grid(color="#e4e4e4", lw=0.6)
        axes.margins(x=0.01)
        # beside the lines, not on them
        axes.legend(
            loc="upper left",
            bbox_to_anchor=(1.01, 1.02),
            frameon=False,
            fontsize=SMALL_SIZE,
            labelcolor=INK,
        )
        canvas.style(axes)
        if place == len(panels) - 1:
            axes.set_xlabel(label, fontsize=TEXT_SIZE, color=INK)
        else:
            axes.tick_params(labelbottom=False)
    return canvas.save(figure, Path(path))


def _abscissa(results: Recording, against: str) -> tuple[str, Callable[[Floats], Floats]]:
    """Return the label of the abscissa, and the function of its values at some times."""
    if against == "time":
        return "Time (s)", lambda time: time
    name, _, part = against.rpartition(":")
    if part not in COMPONENTS or name not in results.point_name:
        known = [f"{point}:{end}" for point in results.point_name for end in COMPONENTS]
        raise CaseError(
            f"histories cannot be drawn against '{against}'",
            where="against",
            remedy=spelling.advice(against, ["time", *known], kind="abscissa"),
        )
    history = results.history(name)
    moved = history.displacement[:, COMPONENTS[part]]
    factor, unit = prefixed(float(np.abs(moved).max()), "m")
    label = f"Displacement of {canvas.literal(name)} in {part} ({unit})"
    return label, lambda time: np.asarray(factor * np.interp(time, history.time, moved))


def _lines(results: Recording, name: str) -> list[_Line]:
    """Return the lines of everything called so, or of one kind of it: "lining:crown".

    Raises CaseError where nothing is called so.
    """
    kinds: tuple[tuple[str, Sequence[str], Callable[[Recording, str], list[_Line]]], ...] = (
        ("point", results.point_name, _of_point),
        ("bolt", results.bolt_name, _of_bolt),
        ("contact", results.measured_contact_name, _of_contact),
        ("reaction", results.reaction_name, _of_reaction),
        ("link", results.link_name, _of_link),
        ("lining", results.lining_name, _of_lining),
        ("run", ("energy",), _of_energy),
        ("run", ("steps",), _of_steps),
    )
    lines = [
        line
        for kind, names, lines_of in kinds
        for one in dict.fromkeys((name, name.removeprefix(f"{kind}:")))
        if one in names
        for line in lines_of(results, one)
    ]
    if not lines:
        known = list(dict.fromkeys(one for _, names, _ in kinds for one in names))
        raise CaseError(
            f"there is no history '{name}'",
            where="history",
            remedy=spelling.advice(name, known, kind="history"),
        )
    return lines


def _of_point(results: Recording, name: str) -> list[_Line]:
    history = results.history(name)
    return [
        _Line("Displacement", "m", f"{name}, {part}", history.time, history.displacement[:, k])
        for part, k in COMPONENTS.items()
    ]


def _of_bolt(results: Recording, name: str) -> list[_Line]:
    history = results.bolt_history(name)
    return [_Line("Force", "N/m", name, history.time, history.force)]


def _of_contact(results: Recording, name: str) -> list[_Line]:
    history = results.measured_contact(name)
    return [
        _Line("Stress on joints", "Pa", f"{name}, normal", history.time, history["normal"]),
        _Line("Stress on joints", "Pa", f"{name}, shear", history.time, history["shear"]),
        _Line("Slip of joints", "m", name, history.time, history["slip"]),
        _Line("Opening of joints", "m", name, history.time, history["opening"]),
    ]


def _of_energy(results: Recording, name: str) -> list[_Line]:
    energy = results.energy
    return [
        _Line("Energy", "J/m", key.replace("_", " "), energy["time"], values)
        for key, values in energy.items()
        if key != "time" and np.any(values)
    ]


def _of_steps(results: Recording, name: str) -> list[_Line]:
    steps = results.steps
    return [
        _Line("Step", "s", "step", steps["time"], steps["step"]),
        _Line("Penetration", "m", "largest", steps["time"], steps["penetration"]),
        *_unbalanced(steps),
    ]


def _unbalanced(steps: Mapping[str, Any]) -> list[_Line]:
    """Return the unbalanced force of the steps of stages; an earlier clast did not keep it."""
    if "unbalanced" not in steps or not np.isfinite(steps["unbalanced"]).any():
        return []
    return [_Line("Unbalanced force", "", "of all forces", steps["time"], steps["unbalanced"])]


def _of_reaction(results: Recording, name: str) -> list[_Line]:
    reaction = results.reaction(name)
    return [
        *(
            _Line("Reaction", "N/m", f"{name}, {part}", reaction.time, reaction.force[:, k])
            for part, k in COMPONENTS.items()
        ),
        _Line("Moment of reactions", "N m/m", name, reaction.time, reaction.moment),
    ]


def _of_link(results: Recording, name: str) -> list[_Line]:
    link = results.link(name)
    return [
        _Line("Force of links", "N/m", f"{name}, {part}", link["time"], link.force[:, k])
        for k, part in enumerate(("along", "across"))
    ]


def _of_lining(results: Recording, name: str) -> list[_Line]:
    """Return the largest and the least of N, Q and M along a lining."""
    lining = results.lining(name)
    carries = (lining.state > 0) & (lining.state < LOST)
    found = []
    for quantity, unit, values in (
        ("N of linings", "N/m", lining.normal_force),
        ("Q of linings", "N/m", lining.shear_force),
        ("M of linings", "N m/m", lining.moment),
    ):
        held = np.where(carries, values, 0.0)
        for said, value in (("most", held.max(axis=1)), ("least", held.min(axis=1))):
            found.append(_Line(quantity, unit, f"{name}, {said}", lining.time, value))
    return found
