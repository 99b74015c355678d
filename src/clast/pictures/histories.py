"""Histories of a run: over time, or over a displacement, in pictures and on pages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import CaseError
from clast.model.model import Floats
from clast.pictures import canvas
from clast.pictures.canvas import LEGEND, TEXT
from clast.pictures.charts import Curve
from clast.pictures.fields import prefixed
from clast.pictures.linings import DIAGRAMS, carries
from clast.results import Recording
from clast.thumbnails import CURVE_COLOURS

DASHES = ("-", "--", ":")
WIDTH, PANEL = 6.4, 1.75
"""Width of the picture and height of a panel, inches."""
PANEL_LINES_MAX = 24
COMPONENTS = {"x": 0, "y": 1}
BOLT_MARKS = {2: ("yielded", "#8e24aa"), 3: ("broke", "#c0143c")}
"""State of a bolt -> its text in the history, and its colour."""


@dataclass(frozen=True)
class History:
    """A quantity of something over time."""

    title: str
    """Title of its chart on a page."""
    panel: str
    """Title of its panel beside others in a picture; "" where it has none."""
    unit: str
    time: Floats
    """s, shape (t,)."""
    lines: Mapping[str, Floats]
    """Part or component, "" where there is one alone -> its values, shape (t,)."""


def _of_bolt(results: Recording, name: str) -> Iterator[History]:
    bolt = results.bolt_history(name)
    yield History(f"Bolt {name}, force", "Force", "N/m", bolt.time, {"": bolt.force})


def _of_point(results: Recording, name: str) -> Iterator[History]:
    point = results.history(name)
    for quantity, unit in (("displacement", "m"), ("velocity", "m/s")):
        x, y = getattr(point, quantity).T
        panel, title = quantity.capitalize(), f"Point {name}, {quantity}"
        yield History(title, panel, unit, point.time, {"x": x, "y": y})


def _of_convergence(results: Recording, name: str) -> Iterator[History]:
    rows = results.convergence(name)
    lines = {"": rows.convergence}
    yield History(f"Convergence {name}", "Convergence", "m", rows.time, lines)


def _of_contact(results: Recording, name: str) -> Iterator[History]:
    rows = results.measured_contact(name)
    for quantity, unit, columns in (
        ("stress", "Pa", ("normal", "shear")),
        ("slip", "m", ("slip", "slip_least", "slip_most")),
        ("opening", "m", ("opening", "opening_least", "opening_most")),
    ):
        panel = f"{quantity} {'on' if quantity == 'stress' else 'of'} joints".capitalize()
        lines = {column: rows[column] for column in columns}
        yield History(f"Contact {name}, {quantity}", panel, unit, rows["time"], lines)


def _of_reaction(results: Recording, name: str) -> Iterator[History]:
    rows = results.reaction(name)
    force = {"x": rows.force[:, 0], "y": rows.force[:, 1]}
    yield History(f"Reaction {name}, force", "Reaction", "N/m", rows.time, force)
    moment = {"": rows.moment}
    title, panel = f"Reaction {name}, moment", "Moment of reactions"
    yield History(title, panel, "N m/m", rows.time, moment)


def _of_link(results: Recording, name: str) -> Iterator[History]:
    link = results.link(name)
    force = {"along": link.force[:, 0], "across": link.force[:, 1]}
    yield History(f"Link {name}, force", "Force of links", "N/m", link["time"], force)
    yield History(f"Link {name}, moment", "", "N m/m", link["time"], {"": link["moment"]})


def _of_lining(results: Recording, name: str) -> Iterator[History]:
    """Yield the largest and the least of N, Q and M along a lining."""
    lining = results.lining(name)
    for one in DIAGRAMS.values():
        values = np.where(carries(lining), np.nan_to_num(getattr(lining, one.column)), 0.0)
        lines = {"most": values.max(axis=1), "least": values.min(axis=1)}
        title, panel = f"Lining {name}, {one.letter}", f"{one.letter} of linings"
        yield History(title, panel, one.unit.removeprefix("k"), lining.time, lines)


def _of_energy(results: Recording, name: str) -> Iterator[History]:
    energy = results.energy
    parts = {key: values for key, values in energy.items() if key != "time" and np.any(values)}
    yield History("Energy", "Energy", "J/m", energy["time"], parts)


def _of_steps(results: Recording, name: str) -> Iterator[History]:
    steps = results.steps
    if not len(steps):
        return
    time = steps["time"]
    yield History("Step", "Step", "s", time, {"": steps["step"]})
    yield History("Deepest penetration", "Penetration", "m", time, {"": steps["penetration"]})
    yield History("Contacts", "", "", time, {"": steps["contacts"]})
    if np.isfinite(steps["unbalanced"]).any():
        ratio = {"of all forces": steps["unbalanced"]}
        yield History("Unbalanced force", "Unbalanced force", "", time, ratio)


RUN = ("energy", "steps")
"""Kinds that are of the run itself."""
KINDS: dict[
    str, tuple[Callable[[Recording], Sequence[str]], Callable[[Recording, str], Iterator[History]]]
] = {
    "point": (lambda results: results.point_name, _of_point),
    "convergence": (lambda results: results.convergence_name, _of_convergence),
    "bolt": (lambda results: results.bolt_name, _of_bolt),
    "contact": (lambda results: results.measured_contact_name, _of_contact),
    "reaction": (lambda results: results.reaction_name, _of_reaction),
    "link": (lambda results: results.link_name, _of_link),
    "lining": (lambda results: results.lining_name, _of_lining),
    "energy": (lambda _: RUN[:1], _of_energy),
    "steps": (lambda _: RUN[1:], _of_steps),
}
"""Kind of thing -> the names of those in a run, and the histories of one."""


def histories_of(results: Recording) -> Iterator[History]:
    """Yield all histories of a run."""
    for names, histories in KINDS.values():
        for name in names(results):
            yield from histories(results, name)


def plot_histories(
    results: Recording, path: Path | str, names: Sequence[str], against: str = "time"
) -> Path:
    """Draw histories over the same abscissa, a panel for each quantity; return the path.

    ``names`` are measured points, convergences, bolts, measured contacts, reactions, links,
    linings, "energy" or "steps": everything that is called so, or one kind of it, as
    "lining:crown".  ``against`` is "time", or a displacement of a measured point: "crown:y".
    Raises CaseError for names that do not exist.
    """
    panels: dict[tuple[str, str], list[Curve]] = {}
    label, abscissa = _abscissa(results, against)
    for name in names:
        for thing, one in _histories_called(results, name):
            # the velocity of a point is on its own picture
            if one.panel not in ("", "Velocity"):
                curves = panels.setdefault((one.panel, one.unit), [])
                curves += _curves(one, thing, abscissa(one.time))
    return canvas.save(_figure(results, panels, label, ""), Path(path))


def plot_history(results: Recording, path: Path | str, point: str) -> Path:
    """Draw displacement and velocity of a measured point against time; return the path."""
    results.history(point)  # refuses a name that is not there
    panels = {
        (one.panel, one.unit): _curves(one, "", one.time) for one in _of_point(results, point)
    }
    below = f"Measured point {canvas.literal(point)}"
    return canvas.save(_figure(results, panels, "Time (s)", below), Path(path))


def plot_bolt_history(results: Recording, path: Path | str, bolt: str) -> Path:
    """Draw force and elongation of a rock bolt against time; return the path.

    Where it yielded or broke is marked.  Raises CaseError for a bolt that does not exist.
    """
    history = results.bolt_history(bolt)
    panels = {
        ("Force", "N/m"): [Curve(label="", x=history.time, y=history.force)],
        ("Elongation", "m"): [Curve(label="", x=history.time, y=history.elongation)],
    }
    figure = _figure(results, panels, "Time (s)", f"Bolt {canvas.literal(bolt)}")
    for state, (event, colour) in BOLT_MARKS.items():
        for at in history.time[history.state == state][:1]:
            for axes in figure.axes:
                axes.axvline(at, color=colour, ls="--", lw=1.0, label=f"{event} at {at:.4g} s")
    if figure.axes[0].get_legend_handles_labels()[1]:
        figure.axes[0].legend(loc="best", **LEGEND)
    return canvas.save(figure, Path(path))


def _histories_called(results: Recording, name: str) -> list[tuple[str, History]]:
    """Return the histories of everything called so, or of one kind of it: "lining:crown"."""
    wanted, known = list[tuple[str, History]](), list[str]()
    for kind, (names, histories) in KINDS.items():
        known += names(results)
        of = "run" if kind in RUN else kind
        for one in dict.fromkeys((name, name.removeprefix(f"{of}:"))):
            if one in names(results):
                thing = "" if kind in RUN else one
                wanted += [(thing, history) for history in histories(results, one)]
    if not wanted:
        raise CaseError(
            f"there is no history '{name}'",
            where="history",
            remedy=spelling.advice(name, dict.fromkeys(known), kind="history"),
        )
    return wanted


def _curves(history: History, thing: str, x: Floats) -> list[Curve]:
    """Return the curves of a history of a thing, "" for the run."""
    curves = []
    for part, values in history.lines.items():
        if part.endswith(("_least", "_most")):
            continue  # extremes along a contact are on pages
        words = "" if part in ("slip", "opening") else part.replace("_", " ")
        label = ", ".join(filter(None, (thing, words))) or history.panel.lower()
        curves.append(Curve(label=label, x=x, y=values))
    return curves


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
    displacement = history.displacement[:, COMPONENTS[part]]
    factor, unit = prefixed(float(np.abs(displacement).max()), "m")
    label = f"Displacement of {canvas.literal(name)} in {part} ({unit})"
    return label, lambda time: np.asarray(factor * np.interp(time, history.time, displacement))


def _figure(
    results: Recording, panels: Mapping[tuple[str, str], list[Curve]], label: str, below: str
) -> Any:
    """Return a figure of panels (quantity, unit) above each other, with a line below the title."""
    title = canvas.wrapped(results.title or results.name, 6.0, canvas.TITLE_SIZE)
    # Height of a line of the legend, inches
    tall = [max(PANEL, 0.25 + 0.172 * min(len(one), PANEL_LINES_MAX)) for one in panels.values()]
    lines = len(title) + (1.0 if below else 0.5)
    high = canvas.BELOW + sum(tall) + 0.2 * len(tall) + 0.1 + canvas.LINE * lines
    figure = canvas.new_figure((WIDTH, high), 160)
    canvas.head(figure, 0.85, title, below)
    named = any(one.label for curves in panels.values() for one in curves)
    for place, ((quantity, unit), curves) in enumerate(panels.items()):
        up = canvas.BELOW + sum(tall[place + 1 :]) + 0.2 * (len(tall) - 1 - place)
        wide = (4.1 if named else 5.35) / WIDTH
        axes = figure.add_axes((0.85 / WIDTH, up / high, wide, tall[place] / high))
        largest = max(float(np.nanmax(np.abs(one.y), initial=0.0)) for one in curves)
        factor, unit_drawn = prefixed(largest, unit) if unit else (1.0, "")
        for k, one in enumerate(curves[:PANEL_LINES_MAX]):
            colour = CURVE_COLOURS[k % len(CURVE_COLOURS)]
            dashes = DASHES[k // len(CURVE_COLOURS) % len(DASHES)]
            text = canvas.literal(one.label)
            axes.plot(one.x, factor * one.y, dashes, color=colour, lw=1.2, label=text)
        axes.set_ylabel(f"{quantity} ({unit_drawn})" if unit_drawn else quantity, **TEXT)
        axes.grid(color="#e4e4e4", lw=0.6)
        axes.margins(x=0.01)
        if named:  # beside the lines, not on them
            axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), **LEGEND)
        canvas.style(axes)
        if place == len(panels) - 1:
            axes.set_xlabel(label, **TEXT)
        else:
            axes.tick_params(labelbottom=False)
    return figure
