"""[time], [method], [damping] and [output]: how to simulate, and results to keep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Self

import numpy as np
from pydantic import Field, StrictBool, model_validator

from clast.inputs.declaring.alternatives import Alternatives, Choice, Chosen, GivenObject, within
from clast.inputs.declaring.table import Fraction, Interval, Length, Positive, Table
from clast.inputs.declaring.validation_messages import refusal
from clast.model import ranges
from clast.model.model import Model

if TYPE_CHECKING:
    from clast.step.method import Method


PROCESSES = {
    "modified": "clast.step.modified:Modified",
    "convex": "clast.step.convex:Convex",
    "open-close": "clast.step.open_close:OpenClose",
}
CONTACT_LAWS = {
    "penalty": "clast.contact.laws:Penalty",
    "augmented-lagrangian": "clast.contact.laws:AugmentedLagrangian",
}
MULTIPLIERS = {"reset": "clast.contact.laws:Reset", "carried": "clast.contact.laws:Carried"}
CORNER_RULES = {
    "bisector": "clast.contact.corner_rules:Bisector",
    "shi": "clast.contact.corner_rules:EntranceLines",
}
ROTATIONS = {
    "exact": "clast.block.rotation:Exact",
    "sine": "clast.block.rotation:Sine",
    "linear": "clast.block.rotation:Linear",
}
INTEGRATORS = {
    "constant-acceleration": "clast.step.integration:ConstantAcceleration",
    "backward-euler": "clast.step.integration:BackwardEuler",
    "midpoint": "clast.step.integration:Midpoint",
}
SOLVERS = {
    "auto": "clast.linear.solvers:Automatic",
    "cholesky": "clast.linear.solvers:Direct",
    "pcg": "clast.linear.solvers:PCG",
}

ALTERNATIVES = Alternatives(
    classes={
        "process": PROCESSES,
        "contact_law": CONTACT_LAWS,
        "multipliers": MULTIPLIERS,
        "corner_rule": CORNER_RULES,
        "rotation": ROTATIONS,
        "integrator": INTEGRATORS,
        "solver": SOLVERS,
    },
    limits={
        "normal_stiffness": (Field(gt=0.0), within(ranges.STIFFNESS)),
        "shear_stiffness": (Field(gt=0.0), within(ranges.STIFFNESS)),
        "passes": (Field(ge=1, le=ranges.PASSES_MAX),),
        "tolerance": (Field(gt=0.0), within(ranges.TOLERANCE)),
        "iterations": (Field(ge=1, le=ranges.ITERATIONS_MAX),),
        "plain": (Field(ge=0, le=ranges.ITERATIONS_MAX),),
        "solves": (Field(ge=1, le=ranges.PASSES_MAX),),
        "penetration_tolerance": (Field(ge=0.0), within(ranges.LENGTH)),
        "friction_updates": (Field(ge=0, le=ranges.PASSES_MAX),),
        "restitution": (Field(ge=0.0, le=1.0),),
    },
    automatic=frozenset({"normal_stiffness"}),
    needs={
        "process": ("step", "advice", "stiffness"),
        "contact_law": ("respond", "normal_stiffness"),
        "multipliers": ("first", "carries"),
        "corner_rule": ("choose",),
        "rotation": ("angle", "gradient"),
        "integrator": ("theta",),
        "solver": ("factor",),
    },
)
"""Every key that offers a choice.  A class's own numbers are read from its dataclass."""

CRITDIS_SHARE = 0.005
"""Default critdis, as a share of the size (square root of area) of the smallest block."""
FIXED_POINT_FACTOR = 100.0
"""Fixed points are this many times stiffer than the contacts and the stiffest rock."""


class MethodTable(Table):
    """Numerical method: a name for each choice, or a table with the name and its parameters."""

    process: Annotated[Any, Choice("process", ALTERNATIVES)] = "convex"
    """Process of a step."""
    contact_law: Annotated[Any, Choice("contact_law", ALTERNATIVES)] = "penalty"
    """Forces from penetration and slip."""
    corner_rule: Annotated[Any, Choice("corner_rule", ALTERNATIVES)] = "bisector"
    """Edge through which a vertex enters at a corner."""
    rotation: Annotated[Any, Choice("rotation", ALTERNATIVES)] = "sine"
    """How points follow the rotation of their block."""
    integrator: Annotated[Any, Choice("integrator", ALTERNATIVES)] = "constant-acceleration"
    """Time integration: "constant-acceleration" damps vibrations by w h/4 of critical, "midpoint"
    not at all (for waves), "backward-euler" by w h/2."""
    solver: Annotated[Any, Choice("solver", ALTERNATIVES)] = "auto"
    """Solver of the equations of a step."""
    critdis: Length | None = None
    """Edges are lengthened by this in contact detection, m; 0.5 % of the smallest block's size
    (square root of its area) if absent."""
    fixed_point_stiffness: Annotated[Positive, within(ranges.STIFFNESS)] | None = None
    """Springs of fixed points, N/m per m; 100 times the stiffer of contact and rock if absent."""

    def chosen(self, key: str) -> Chosen | GivenObject:
        """Return the choice of a key."""
        value = getattr(self, key)
        return (
            value
            if isinstance(value, Chosen | GivenObject)
            else Choice(key, ALTERNATIVES).validate(value)
        )

    def build(self, key: str, **provided: Any) -> Any:
        """Return the object that a key chooses."""
        return self.chosen(key).build(**provided)

    def method(
        self, model: Model, *, step: float, max_displacement: float, dynamic_ratio: float = 1.0
    ) -> Method:
        """Return the method of the run; options left out of the table follow from the model."""
        from clast.contact.joints.along_joint import range_of_springs
        from clast.step.method import Method

        process = self.build("process")
        provided: dict[str, float] = {}
        notes: tuple[str, ...] = ()
        if self.chosen("contact_law").is_automatic("normal_stiffness"):
            stiffness, reason = process.stiffness(model, step)
            provided["normal_stiffness"] = stiffness
            notes = (f"normal_stiffness = {stiffness:.4g} N/m per m: {reason}",)
        contact_law = self.build("contact_law", **provided)
        stiffest = max(range_of_springs(model, contact_law.normal_stiffness)[1], model.stiffest)
        return Method(
            process=process,
            contact_law=contact_law,
            corner_rule=self.build("corner_rule"),
            rotation=self.build("rotation"),
            integrator=self.build("integrator"),
            solver=self.build("solver"),
            fixed_point_stiffness=self.fixed_point_stiffness or FIXED_POINT_FACTOR * stiffest,
            critdis=self.critdis or CRITDIS_SHARE * float(np.sqrt(model.smallest)),
            max_displacement=max_displacement,
            dynamic_ratio=dynamic_ratio,
            notes=notes,
        )


DAMPINGS = {
    "none": "clast.actions.damping:Undamped",
    "rayleigh": "clast.actions.damping:Rayleigh",
    "adaptive": "clast.actions.damping:Adaptive",
    "kinetic": "clast.actions.damping:Kinetic",
}
DAMPING_RATIO_MAX = 10.0
"""Largest damping ratio that is meant."""

DAMPING_ALTERNATIVES = Alternatives(
    classes={"damping": DAMPINGS},
    limits={
        "mass": (Field(ge=0.0), within(ranges.RATE)),
        "stiffness": (Field(ge=0.0), within(ranges.INTERVAL)),
        "ratio": (Field(gt=0.0, le=DAMPING_RATIO_MAX),),
    },
    needs={"damping": ("begin", "contribution", "finish")},
)
"""Kinds of damping; their numbers are read from their dataclasses."""
DAMPING = Choice("damping", DAMPING_ALTERNATIVES, usual="rayleigh")
"""A name, a table with its numbers, or an object of a script; Rayleigh damping without a name."""
Damping = Annotated[Any, DAMPING]


def chosen_damping(value: Any) -> Chosen | GivenObject:
    """Return the damping that a name, a table or an object makes."""
    return DAMPING.validate(value)


TRAVEL_SHARE = 0.05
"""Default max_displacement, as a share of the size (square root of area) of the smallest block."""
FRAMES = 100
"""Frames of a run that does not say how many it wants."""


class TimeTable(Table):
    """Duration and time step."""

    step: Interval
    """Length of a step, s; shorter steps are used where max_displacement requires them."""
    end: Positive
    """End of the run, s; with [[stage]] the time limit of stages that give none."""
    max_displacement: Length | None = None
    """Largest movement of a vertex in a step against blocks that it might touch, m; 5 % of the size
    (square root of the area) of the smallest block if absent."""
    dynamic_ratio: Fraction = 1.0
    """Share of velocity carried to the next step: 0 static, 1 dynamic."""
    smallest_step: Interval | None = None
    """The run stops where it would need a smaller step than this, s."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        steps = min(self.end / self.step, 1e300)
        if steps > ranges.STEPS_MAX:
            # Wall time of a step that none falls below, s
            what = (
                f"{self.end:g} s are {steps:.3g} steps of {self.step:g} s: more than "
                f"{steps * 1e-5 / 3600.0:.2g} hours"
            )
            raise refusal(what, "lower end, or raise step", "end")
        if self.step > self.end:
            what = f"{self.step:g} s is longer than the whole run of {self.end:g} s"
            raise refusal(what, "lower step, or raise end", "step")
        if self.smallest_step is not None and self.smallest_step > self.step:
            what = f"{self.smallest_step:g} s is longer than step, {self.step:g} s"
            raise refusal(what, "lower it below step, or leave it out", "smallest_step")
        return self

    def largest_movement(self, model: Model) -> float:
        """Return max_displacement, m, or its default for the blocks of a model."""
        return self.max_displacement or TRAVEL_SHARE * float(np.sqrt(model.smallest))


class OutputTable(Table):
    """Output of the run."""

    every: Interval | None = None
    """Time between frames, s; a hundredth of the run, or a step, if absent."""
    contacts: StrictBool = True
    """True: contact forces are kept in every frame."""
    checkpoint_every: Interval | None = None
    """Wall time between checkpoints, s, from which ``clast resume`` continues; if absent, one is
    written when a run ends early."""

    def interval(self, step: float, end: float) -> float:
        """Return the time between frames, s, of a run to ``end``, s, in steps of ``step``, s."""
        return self.every or max(step, end / FRAMES)
