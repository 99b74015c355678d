"""Measures of a run: functions of points, blocks, bolts and joints of its results.

Displacements in m, speeds in m/s, rotations in degrees, forces in N/m.  Of a point or a block they
are histories, of which an expression takes the last value.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clast.contact.contacts import SLIDE
from clast.errors import CaseError, shortened
from clast.model.model import Floats, Model
from clast.model.stage_records import FAILS
from clast.model.state import LEDGER_ENTRIES
from clast.results import Run
from clast.results.schema import ALL_JOINTS, BOLT_STATES, FLOWS, LINK_STATES, MEASURED_FLOWS
from clast.spelling import require_known
from clast.study.collapsing.trial import TOGETHER, moved
from clast.study.expressions import Expression

BEYOND = ("yielded", "broken", "lost")
QUANTITIES = {"normal": "Pa", "shear": "Pa", "opening": "m", "slip": "m", "sliding": ""}
"""Quantities of a measured contact -> their units."""
PARTS = ("x", "y")
"""Parts of a vector; without one its length is meant."""
MAY_LACK = ("part", "time")
"""Arguments that may be left out."""
FOS, STANDS_WITH = "factor_of_safety", "stands"
"""Measures that are found by trials, not by the run."""


@dataclass(frozen=True)
class RunResults:
    """The results of a run, as measures see them."""

    run: Run

    @cached_property
    def blocks(self) -> tuple[str, ...]:
        """Blocks that fail: those of the first mechanism, else those that have moved most."""
        named = [record.mechanism for record in self.run.stages if record.mechanism]
        if named:
            return named[0]
        distance = self.distance
        most = float(distance.max(initial=0.0))
        order = np.argsort(-distance, kind="stable")
        chosen = order[distance[order] >= TOGETHER * most] if most > 0.0 else order[:0]
        return tuple(self.run.model.block_name[k] for k in chosen)

    @cached_property
    def joints(self) -> tuple[str, ...]:
        """Joints along which blocks that fail slide on others at the end."""
        try:
            contacts = self.run.contacts(-1)
        except CaseError:
            return ()
        model = self.run.model
        fails = np.isin(model.block_name, self.blocks)
        first, second = (
            fails[np.searchsorted(model.block_start, contacts[end], side="right") - 1]
            for end in ("vertex", "edge")
        )
        chosen = contacts["joint"][(first != second) & (contacts["mode"] == SLIDE)]
        return tuple(model.joint_table.joints[k].name for k in np.unique(chosen))

    @cached_property
    def distance(self) -> Floats:
        """Distance that each block has moved since the start, m, shape (n,)."""
        model = self.run.model
        return moved(model, model.vertices, self.run.state.vertices)

    @property
    def fails(self) -> bool:
        """Whether a static run, or a static stage, has no equilibrium."""
        return any(event.kind == FAILS for event in self.run.events)

    def history(self, name: str) -> Any:
        """History of a measured point or a block; "block:crown" is a block in any case."""
        model = self.run.model
        if name in model.measured_points.name:
            return self.run.history(name)
        if name in model.block_name:
            return self.run.block(name)
        kind, _, rest = name.partition(":")
        return self.run.block(rest) if kind == "block" else self.run.history(rest)

    @property
    def bolts_failed(self) -> list[bool]:
        """Whether each bolt has yielded, broken or been lost at the end."""
        states = self.run.bolts(-1).state if len(self.run.model.bolts) else ()
        return [BOLT_STATES[int(one)] in BEYOND for one in states]

    def along(self, joint: str, column: str) -> Any:
        """A column of the last contacts along a joint."""
        contacts = self.run.contacts(-1)
        names = [one.name for one in self.run.model.joint_table.joints]
        return contacts[column][contacts["joint"] == names.index(joint)]


def _vectors(quantity: str) -> Callable[..., Floats]:
    """Return the measure of a vector of a point or a block, over time or at a time."""

    def measure(of: RunResults, name: str, part: str = "", time: str = "") -> Floats:
        history = of.history(name)
        return _at(history.time, _of_vector(getattr(history, quantity), part), time)

    return measure


def _lining_force(of: RunResults, name: str) -> Floats:
    """Normal force along a lining of the largest size, N/m, tension positive, over time."""
    normal = of.run.lining(name).normal_force
    largest = np.abs(normal).argmax(axis=1)
    return np.asarray(normal[np.arange(len(normal)), largest])


def _sliding(of: RunResults, joint: str) -> float:
    """Fraction of the normal force along a joint that sliding contacts carry at the end."""
    force, mode = of.along(joint, "normal_force"), of.along(joint, "mode")
    total = float(force.sum())
    return float(force[mode == SLIDE].sum()) / total if total > 0.0 else 0.0


@dataclass(frozen=True)
class Measure:
    """A function of measures."""

    unit: str
    """Its unit; "" of numbers, and where it depends on an argument."""
    arguments: tuple[str, ...]
    """Things that its arguments name; a part and a time may be left out."""
    value: Callable[..., Any]
    """Its value, of the results of a run and the arguments."""


def _convergence(of: RunResults, name: str, time: str = "") -> Floats:
    """Approach of two measured points, m, over time or at a time."""
    history = of.run.convergence(name)
    return _at(history.time, history.convergence, time)


MOTION = ("point or block", "part", "time")
MEASURES: dict[str, Measure] = {
    "displacement": Measure("m", MOTION, _vectors("displacement")),
    "speed": Measure("m/s", MOTION, _vectors("velocity")),
    "rotation": Measure(
        "degrees", MOTION[:1], lambda of, name: np.degrees(of.history(name).rotation)
    ),
    # positive where the points approach
    "convergence": Measure("m", ("convergence", "time"), _convergence),
    # tension positive
    "bolt_force": Measure("N/m", ("bolt",), lambda of, name: of.run.bolt_history(name).force),
    "bolt_yields": Measure(
        "", ("bolt",), lambda of, name: of.bolts_failed[list(of.run.model.bolts.name).index(name)]
    ),
    "bolts_failed": Measure("", (), lambda of: sum(of.bolts_failed)),
    "link_force": Measure("N/m", ("link",), lambda of, name: np.hypot(*of.run.link(name).force.T)),
    "links_failed": Measure(
        "",
        (),
        lambda of: sum(
            LINK_STATES[int(of.run.link(name)["state"][-1])] in BEYOND
            for name in of.run.model.links
        ),
    ),
    "reaction": Measure(
        "N/m",
        ("support", "part"),
        lambda of, name, part="": _of_vector(of.run.reaction(name).force, part),
    ),
    # the largest of all sections
    "lining_utilisation": Measure(
        "", ("lining",), lambda of, name: np.nan_to_num(of.run.lining(name).utilisation).max(axis=1)
    ),
    "lining_moment": Measure(
        "N m/m", ("lining",), lambda of, name: np.abs(of.run.lining(name).moment).max(axis=1)
    ),
    "lining_force": Measure("N/m", ("lining",), _lining_force),
    "contact": Measure(
        "",
        ("measured contact", "quantity"),
        lambda of, name, quantity: np.asarray(of.run.measured_contact(name)[quantity]),
    ),
    # out of the rock, of a boundary, well or opening
    "inflow": Measure("m2/s", ("flow",), lambda of, name: of.run.inflow(name).inflow),
    # the largest in joints
    "water_pressure": Measure("Pa", (), lambda of: of.run.inflow(ALL_JOINTS)["pressure"]),
    # of the water in joints on a block, at the end
    "uplift": Measure(
        "N/m",
        ("block",),
        lambda of, name: of.run.flow(-1).force_on(of.run.model.block_name.index(name))[1],
    ),
    # sums along a joint at the end, of the sizes of shear forces
    "normal_force": Measure(
        "N/m", ("joint",), lambda of, joint: float(of.along(joint, "normal_force").sum())
    ),
    "shear_force": Measure(
        "N/m", ("joint",), lambda of, joint: float(np.abs(of.along(joint, "shear_force")).sum())
    ),
    "sliding": Measure("", ("joint",), _sliding),
    # the largest at the end of a step
    "penetration": Measure("m", (), lambda of: of.run.report.largest_penetration),
    "energy": Measure("J/m", ("entry",), lambda of, entry: of.run.energy[entry]),
    "fails": Measure("", (), lambda of: of.fails),
    "failing": Measure("", (), lambda of: len(of.blocks) if of.fails else 0),
    # the largest displacement of a block since the start
    "farthest": Measure("m", (), lambda of: float(of.distance.max(initial=0.0))),
    "end": Measure("s", (), lambda of: float(of.run.state.time)),
    "steps": Measure("", (), lambda of: of.run.report.steps),
    FOS: Measure("", (), lambda of: of.factor),
    # whether the blocks stand with a factor: one trial in place of the ten of a factor
    STANDS_WITH: Measure("", ("factor",), lambda of, factor: of.stands(factor)),
}
"""Functions of measures by name; histories of points and blocks are over time."""


def unit_of(function: str, given: Sequence[str]) -> str:
    """Return the unit of a function of measures with its arguments; "" where it has none."""
    if function == "contact":
        return QUANTITIES.get(given[-1], "") if given else ""
    return MEASURES[function].unit


OF_FLOW = ("inflow", "water_pressure", "uplift")
"""Functions of measures of water that flows in joints."""
CONDITIONS = ("fails", "bolt_yields", STANDS_WITH)
"""Functions of measures that are true or false."""


def known_names(model: Model) -> dict[str, Sequence[str]]:
    """Return the possible arguments of measures in a model.

    A point goes before a block of its name, unless it is "block:crown".
    """
    points, blocks = model.measured_points.name, model.block_name
    of_both = [(kind, one) for one in sorted({*points} & {*blocks}) for kind in ("point", "block")]
    return {
        "point or block": (*points, *blocks, *(f"{kind}:{one}" for kind, one in of_both)),
        "part": PARTS,
        "bolt": model.bolts.name,
        "link": model.links,
        "support": model.reactions.name,
        "lining": model.lining_joints.linings,
        "convergence": model.convergences.name,
        "flow": (*FLOWS.names(model), *MEASURED_FLOWS.names(model)),
        "block": model.block_name,
        "measured contact": model.measured_contacts.name,
        "quantity": tuple(QUANTITIES),
        "joint": tuple(one.name for one in model.joint_table.joints),
        "entry": LEDGER_ENTRIES,
    }


def check(
    expression: Expression, known: Mapping[str, Sequence[str]], end: float = math.inf
) -> None:
    """Raise CaseError where an expression names something that a model does not have.

    Or a time after the end of the run, s.
    """
    for name, given in expression.calls():
        if name in OF_FLOW and not known["flow"]:
            what = f"{name} is of water that flows in joints, and there is none"
            raise CaseError(what, where=expression.where, remedy="give the case a [flow]")
        wanted = MEASURES[name].arguments
        least = len([one for one in wanted if one not in MAY_LACK])
        if not least <= len(given) <= len(wanted):
            raise CaseError(
                f"{name} is of {least or 'no'} name{'s' if least != 1 else ''}, not of "
                f"{len(given)}",
                where=expression.where,
                remedy=f"write {name}({', '.join(wanted)})",
            )
        for kind, one in zip(wanted, given, strict=False):
            if kind == "time":
                _check_time(one, expression.where, end)
            elif kind == "factor":
                _check_factor(one, expression.where)
            else:
                require_known(one, known[kind], kind=kind, where=expression.where)


def _check_factor(text: str, where: str) -> None:
    """Raise CaseError for a factor that is not a positive number."""
    try:
        factor = float(text)
    except ValueError:
        factor = math.nan
    if not (math.isfinite(factor) and factor > 0.0):
        what = f"there is no factor '{shortened(text)}'"
        raise CaseError(what, where=where, remedy="give a positive number, e.g. stands(1.3)")


def _check_time(text: str, where: str, end: float) -> float:
    """Return a time, s; raises CaseError where it is none, or after the end of the run, s."""
    try:
        time = float(text)
    except ValueError:
        time = math.nan
    if not (math.isfinite(time) and time >= 0.0):
        raise CaseError(
            f"there is no time '{shortened(text)}'", where=where, remedy="give seconds, from 0 on"
        )
    # By how much a time may be later than the end of a run, as a fraction of that
    if time > end * (1.0 + 1e-6):
        what = f"the run ends at {end:g} s, before {time:g} s"
        raise CaseError(what, where=where, remedy="raise time.end")
    return time


def _at(times: Floats, values: Floats, time: str) -> Floats:
    """Return a history (t,), or its value at a time, shape (1,)."""
    if not time:
        return values
    wanted = _check_time(time, "measure", float(times[-1]))
    return np.atleast_1d(np.interp(wanted, times, values))


def _of_vector(values: Floats, part: str) -> Floats:
    """Return a part of vectors (t, 2), or their lengths, shape (t,)."""
    return values[:, PARTS.index(part)] if part else np.hypot(*values.T)
