"""[method]: how to simulate.  The only place where methods are chosen by name.

Adding an alternative takes its class and one line in the dictionary of names.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from clast.inputs.declaring.alternatives import Alternatives, Choice, Chosen, GivenObject, within
from clast.inputs.declaring.table import Length, Positive, Table
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
MULTIPLIERS = {
    "reset": "clast.contact.laws:Reset",
    "carried": "clast.contact.laws:Carried",
}
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
        "passes": (Field(ge=1, le=ranges.MOST_PASSES),),
        "tolerance": (Field(gt=0.0), within(ranges.TOLERANCE)),
        "iterations": (Field(ge=1, le=ranges.MOST_ITERATIONS),),
        "plain": (Field(ge=0, le=ranges.MOST_ITERATIONS),),
        "solves": (Field(ge=1, le=ranges.MOST_PASSES),),
        "penetration_tolerance": (Field(ge=0.0), within(ranges.LENGTH)),
        "friction_updates": (Field(ge=0, le=ranges.MOST_PASSES),),
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
