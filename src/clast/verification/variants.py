"""The ways of computing that problems are run with, written as in the [method] table of a case."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from clast.inputs.method import FIXED_POINT_FACTOR, MethodTable
from clast.model.model import Model
from clast.model.stages import Stage
from clast.results import Run
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from clast.step.method import Method


@dataclass(frozen=True, kw_only=True)
class Variant:
    """One process with its friction, law, integrator and rotation rule; keys as in case files."""

    name: str
    """Short name in tables."""
    process: Mapping[str, Any] = field(hash=False)
    """Process of a step, with its numbers."""
    contact_law: Mapping[str, Any] = field(
        hash=False, default_factory=lambda: MappingProxyType({"name": "penalty"})
    )
    """Contact law; the problem adds its normal stiffness."""
    integrator: str = "constant-acceleration"
    """Time integration."""
    rotation: str = "sine"
    """Rotation rule."""

    def method(
        self,
        model: Model,
        *,
        p: float,
        max_displacement: float,
        dynamic_ratio: float = 1.0,
        **others: Any,
    ) -> Method:
        """Return the method with the numbers of a problem: ``p`` in N/m per m, lengths in m.

        critdis is half of ``max_displacement``, as in the paper; fixed points are, as in case
        files, 100 times stiffer than the contacts and the stiffest rock; ``others`` as of Method.
        """
        table = MethodTable.model_validate(
            {
                "process": dict(self.process),
                "contact_law": {**self.contact_law, "normal_stiffness": p},
                "integrator": self.integrator,
                "rotation": self.rotation,
            }
        )
        parts = ("process", "contact_law", "corner_rule", "rotation", "integrator", "solver")
        stiffest = max([p, *(rock.young for rock in model.rocks)])
        return Method(
            **{**{part: table.build(part) for part in parts}, **others},
            fixed_point_stiffness=FIXED_POINT_FACTOR * stiffest,
            critdis=0.5 * max_displacement,
            max_displacement=max_displacement,
            dynamic_ratio=dynamic_ratio,
        )

    def run(
        self,
        model: Model,
        *,
        step: float,
        end: float,
        every: float | None = None,
        stages: tuple[Stage, ...] = (),
        **numbers: Any,
    ) -> Run:
        """Run a model to ``end``, s, with ``numbers`` of method(); one frame by default."""
        every = end if every is None else every
        schedule = Schedule(step=step, end=end, every=every, stages=stages)
        return simulate(model, self.method(model, **numbers), schedule)

    def static(self, model: Model, **numbers: Any) -> Run:
        """Run a model as ``run`` does, every step beginning at rest."""
        return self.run(model, **numbers, dynamic_ratio=0.0)


LAGGED = Variant(name="modified, lagged friction", process={"name": "modified"})
"""The paper's process: one pass, sliding friction as a known force."""

PASSES = Variant(name="modified, 4 passes", process={"name": "modified", "passes": 4})
"""Up to four assemblies and solves a step, until the modes of the contacts agree."""

EULER = Variant(
    name="modified, backward Euler", process={"name": "modified"}, integrator="backward-euler"
)
"""The dissipative time scheme."""

CONVEX = Variant(name="convex", process={"name": "convex"})
"""Newton's method on the incremental potential; friction follows the normal force of the step."""

CONVEX_LAGGED = Variant(
    name="convex, lagged friction", process={"name": "convex", "friction_updates": 0}
)
"""The same with the friction bound of the step before."""

OPEN_CLOSE = Variant(name="open-close", process={"name": "open-close"})
"""Shi's open-close iteration."""

MIDPOINT = Variant(name="convex, midpoint", process={"name": "convex"}, integrator="midpoint")
"""The convex process with forces half way through the step."""

MIDPOINT_PASSES = Variant(
    name="modified, 4 passes, midpoint",
    process={"name": "modified", "passes": 4},
    integrator="midpoint",
)
"""The paper's process with passes, likewise."""

MIDPOINT_OPEN_CLOSE = Variant(
    name="open-close, midpoint", process={"name": "open-close"}, integrator="midpoint"
)
"""Shi's process, likewise."""

EACH_PROCESS = (LAGGED, OPEN_CLOSE, CONVEX)
"""The three processes."""
WITH_EULER = (LAGGED, EULER, OPEN_CLOSE, CONVEX)
"""The same, and the dissipative time scheme."""
HALF_WAY = (MIDPOINT, MIDPOINT_PASSES, MIDPOINT_OPEN_CLOSE)
"""The three processes with forces half way through the step."""

FOUR_SOLVES = {"name": "augmented-lagrangian", "solves": 4}
"""Multipliers that start anew in every step, renewed in four solves (the paper's law)."""

MULTIPLIERS = Variant(
    name="modified, augmented Lagrangian", process={"name": "modified"}, contact_law=FOUR_SOLVES
)
"""The paper's process with its augmented Lagrangian law."""

CONVEX_MULTIPLIERS = Variant(
    name="convex, augmented Lagrangian", process={"name": "convex"}, contact_law=FOUR_SOLVES
)
"""The convex process with the same law."""

BOTH_LAWS = (*WITH_EULER, MULTIPLIERS, CONVEX_MULTIPLIERS)
"""Processes and time schemes with the penalty law, and processes with the paper's."""

CHATTERS = (
    "four solves a step make the contact four times as stiff while friction stays one step old: "
    "it chatters between stick and slide; with friction inside the solve the error is 0.02 %"
)
"""Why multipliers disturb lagged friction."""
