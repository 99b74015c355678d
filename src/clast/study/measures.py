"""Measures of a run: functions of points, blocks, bolts and joints of its results.

Displacements in m, speeds in m/s, rotations in degrees, forces in N/m.  Of a point or a block they
are histories, of which an expression takes the last value.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clast import spelling
from clast.contact.contacts import SLIDE
from clast.errors import CaseError, shortened
from clast.model.model import Floats, Model
from clast.model.stage_records import FAILS
from clast.model.state import LEDGER_ENTRIES
from clast.results import Run
from clast.results.schema import BOLT_STATES, LINK_STATES
from clast.study.collapsing.trial import TOGETHER, moved
from clast.study.expressions import Expression

BEYOND = ("yielded", "broken", "lost")
"""States of a bolt or a link that has failed."""
QUANTITIES = ("normal", "shear", "opening", "slip", "sliding")
"""Quantities of a measured contact."""
PARTS = ("x", "y")
"""Parts of a vector; without one its length is meant."""
MAY_LACK = ("part", "time")
"""Arguments that may be left out."""
LATE = 1e-6
"""By how much a time may be later than the end of a run, as a share of that."""
FOS = "factor_of_safety"
"""The measure that is a study of its own."""


@dataclass(frozen=True)
class RunResults:
    """The results of a run, as measures see them."""

    run: Run
    """The run."""

    def displacement(self, name: str, part: str = "", time: str = "") -> Floats:
        """Displacement of a measured point or a block, m, over time or at a time."""
        history = self._history(name)
        return _at(history.time, _of_vector(history.displacement, part), time)

    def speed(self, name: str, part: str = "", time: str = "") -> Floats:
        """Speed of a measured point or a block, m/s, over time or at a time."""
        history = self._history(name)
        return _at(history.time, _of_vector(history.velocity, part), time)

    def rotation(self, name: str) -> Floats:
        """Rotation of the block of a measured point, or of a block, degrees, over time."""
        return np.degrees(self._history(name).rotation)

    def bolt_force(self, name: str) -> Floats:
        """Force of a bolt, N/m, tension positive, over time."""
        return self.run.bolt_history(name).force

    def bolts_failed(self) -> int:
        """Number of bolts that have yielded, broken or been lost at the end."""
        if not len(self.run.model.bolts):
            return 0
        state = self.run.bolts(-1).state
        beyond = [BOLT_STATES.index(one) for one in BEYOND]
        return int(np.isin(state, beyond).sum())

    def bolt_yields(self, name: str) -> bool:
        """Whether a bolt has yielded, broken or been lost at the end."""
        names = list(self.run.model.bolts.name)
        return BOLT_STATES[int(self.run.bolts(-1).state[names.index(name)])] in BEYOND

    def link_force(self, name: str) -> Floats:
        """Size of the force of a link, N/m, over time."""
        return np.hypot(*self.run.link(name).force.T)

    def links_failed(self) -> int:
        """Number of links that have yielded or broken at the end."""
        last = [int(self.run.link(name)["state"][-1]) for name in self.run.model.links]
        return sum(LINK_STATES[state] in BEYOND for state in last)

    def reaction(self, name: str, part: str = "") -> Floats:
        """Reaction of a support, N/m, over time."""
        return _of_vector(self.run.reaction(name).force, part)

    def lining_utilisation(self, name: str) -> Floats:
        """Largest share of its strength that a section of a lining uses, over time."""
        return np.asarray(np.nan_to_num(self.run.lining(name).utilisation).max(axis=1))

    def lining_moment(self, name: str) -> Floats:
        """Largest size of the moment along a lining, N, over time."""
        return np.asarray(np.abs(self.run.lining(name).moment).max(axis=1))

    def lining_force(self, name: str) -> Floats:
        """Normal force along a lining of the largest size, N/m, tension positive, over time."""
        normal = self.run.lining(name).normal_force
        largest = np.abs(normal).argmax(axis=1)
        return np.asarray(normal[np.arange(len(normal)), largest])

    def contact(self, name: str, quantity: str) -> Floats:
        """A quantity of a measured contact over time: normal, shear, Pa; opening, slip, m."""
        return np.asarray(self.run.measured_contact(name)[quantity])

    def normal_force(self, joint: str) -> float:
        """Sum of the normal forces along a joint at the end, N/m."""
        return float(self._along(joint, "normal_force").sum())

    def shear_force(self, joint: str) -> float:
        """Sum of the sizes of shear forces along a joint at the end, N/m."""
        return float(np.abs(self._along(joint, "shear_force")).sum())

    def sliding(self, joint: str) -> float:
        """Share of the normal force along a joint that contacts carry which slide at the end."""
        force, mode = self._along(joint, "normal_force"), self._along(joint, "mode")
        total = float(force.sum())
        return float(force[mode == SLIDE].sum()) / total if total > 0.0 else 0.0

    def penetration(self) -> float:
        """Largest penetration at the end of a step, m."""
        return self.run.report.largest_penetration

    def energy(self, entry: str) -> Floats:
        """An entry of the energy ledger, J/m, over time."""
        return self.run.energy[entry]

    def fails(self) -> bool:
        """Whether a static run, or a static stage, has no equilibrium."""
        return any(event.kind == FAILS for event in self.run.events)

    def failing(self) -> int:
        """Number of blocks that move where it has none."""
        return len(self.blocks) if self.fails() else 0

    def farthest(self) -> float:
        """Largest displacement of a block since the start, m."""
        return float(self._far.max(initial=0.0))

    def end(self) -> float:
        """Time at the end, s."""
        return float(self.run.state.time)

    def steps(self) -> int:
        """Number of accepted steps."""
        return self.run.report.steps

    @cached_property
    def blocks(self) -> tuple[str, ...]:
        """Blocks that fail: those of the first mechanism, else those that have moved most."""
        named = [record.mechanism for record in self.run.stages if record.mechanism]
        if named:
            return named[0]
        most = float(self._far.max(initial=0.0))
        order = np.argsort(-self._far, kind="stable")
        chosen = order[self._far[order] >= TOGETHER * most] if most > 0.0 else order[:0]
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
    def _far(self) -> Floats:
        """How far each block has moved since the start, m, shape (n,)."""
        model = self.run.model
        return moved(model, model.vertices, self.run.state.vertices)

    def _history(self, name: str) -> Any:
        model = self.run.model
        if name in model.measured_points.name:
            return self.run.history(name)
        if name in model.block_name:
            return self.run.block(name)
        kind, _, own = name.partition(":")
        return self.run.block(own) if kind == "block" else self.run.history(own)

    def _along(self, joint: str, column: str) -> Any:
        """Return a column of the last contacts along a joint."""
        contacts = self.run.contacts(-1)
        names = [one.name for one in self.run.model.joint_table.joints]
        return contacts[column][contacts["joint"] == names.index(joint)]


ARGUMENTS: dict[str, tuple[str, ...]] = {
    "displacement": ("point or block", "part", "time"),
    "speed": ("point or block", "part", "time"),
    "rotation": ("point or block",),
    "bolt_force": ("bolt",),
    "bolt_yields": ("bolt",),
    "bolts_failed": (),
    "link_force": ("link",),
    "links_failed": (),
    "reaction": ("support", "part"),
    "lining_utilisation": ("lining",),
    "lining_moment": ("lining",),
    "lining_force": ("lining",),
    "contact": ("measured contact", "quantity"),
    "normal_force": ("joint",),
    "shear_force": ("joint",),
    "sliding": ("joint",),
    "penetration": (),
    "energy": ("entry",),
    "fails": (),
    "failing": (),
    "farthest": (),
    "end": (),
    "steps": (),
}
"""Functions of measures -> their arguments; a part and a time may be left out."""


UNITS = {
    "displacement": "m",
    "speed": "m/s",
    "rotation": "degrees",
    "bolt_force": "N/m",
    "link_force": "N/m",
    "reaction": "N/m",
    "lining_moment": "N",
    "lining_force": "N/m",
    "normal_force": "N/m",
    "shear_force": "N/m",
    "penetration": "m",
    "energy": "J/m",
    "farthest": "m",
    "end": "s",
}
"""Functions of measures -> their units; others are numbers, or contact."""
CONTACT_UNITS = {"normal": "Pa", "shear": "Pa", "opening": "m", "slip": "m"}
"""Quantities of a measured contact -> their units."""


def unit_of(function: str, given: Sequence[str]) -> str:
    """Return the unit of a function of measures with its arguments; "" where it has none."""
    if function == "contact":
        return CONTACT_UNITS.get(given[-1], "") if given else ""
    return UNITS.get(function, "")


CONDITIONS = ("fails", "bolt_yields")
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
        "measured contact": model.measured_contacts.name,
        "quantity": QUANTITIES,
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
        if name == FOS:
            wanted: tuple[str, ...] = ()
        else:
            wanted = ARGUMENTS[name]
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
            elif one not in known[kind]:
                raise CaseError(
                    f"there is no {kind} '{shortened(one)}'",
                    where=expression.where,
                    remedy=spelling.advice(one, known[kind], kind=kind),
                )


def _check_time(text: str, where: str, end: float) -> None:
    """Raise CaseError where a text is not a time, or one after the end of the run, s."""
    try:
        time = float(text)
    except ValueError:
        time = math.nan
    if not (math.isfinite(time) and time >= 0.0):
        raise CaseError(
            f"there is no time '{shortened(text)}'", where=where, remedy="give seconds, from 0 on"
        )
    if time > end * (1.0 + LATE):
        raise _too_late(time, end, where)


def _at(times: Floats, values: Floats, time: str) -> Floats:
    """Return a history (t,), or its value at a time, shape (1,).

    Raises CaseError for a time after its end.
    """
    if not time:
        return values
    wanted, end = float(time), float(times[-1])
    if wanted > end * (1.0 + LATE):
        raise _too_late(wanted, end, "measure")
    return np.atleast_1d(np.interp(wanted, times, values))


def _too_late(time: float, end: float, where: str) -> CaseError:
    """Return the error of a time after the end of a run, s."""
    return CaseError(
        f"the run ends at {end:g} s, before {time:g} s",
        where=where,
        remedy="raise time.end",
    )


def _of_vector(values: Floats, part: str) -> Floats:
    """Return a part of vectors (t, 2), or their lengths, shape (t,)."""
    return values[:, PARTS.index(part)] if part else np.hypot(*values.T)
