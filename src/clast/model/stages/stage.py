"""One stage of a run: changes at its start, the way it is simulated, and its end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

EQUILIBRIUM, TIME = "equilibrium", "time"
"""The conditions that may end a stage."""
BREAK, HOLD = "break", "hold"
"""The behaviour of bonds of joints in a stage."""
LOCK = "lock"
"""The behaviour of jacks at the start of a stage; or they hold."""
STRENGTHS = (
    "friction_angle",
    "cohesion",
    "tensile_strength",
    "residual_cohesion",
    "residual_friction_angle",
    "kinetic_friction_angle",
    "dilation_angle",
    "strength_reduction",
)
"""Numbers of a joint that a stage may change."""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """A part of a run; stages follow each other, and the state is carried from one to the next."""

    name: str
    """Name."""
    until: str = EQUILIBRIUM
    """When it ends: "equilibrium", or "time", when its time is over."""
    time: float | None = None
    """Length of the stage, s, for one until equilibrium at most; None: the end of the schedule."""
    damping: Any = None
    """Damping of the stage: an object of the method; None: as without stages."""
    dynamic_ratio: float | None = None
    """Share of velocity carried to the next step, 0 static, 1 dynamic; None: as without stages."""
    force_ratio: float = 1e-4
    """Largest unbalanced force on a block in equilibrium, as a share of all forces on it."""
    speed: float = 1e-6
    """Largest speed of a block in equilibrium, as a share of sqrt(g x its size)."""
    hold: int = 20
    """Consecutive steps in which that holds."""
    reset_displacement: bool = False
    """True: displacements are reset at the end of the stage; positions do not change."""
    step: float | None = None
    """Wanted length of a step, s; None: as without stages."""
    every: float | None = None
    """Time between frames, s; None: as without stages."""
    excavate: tuple[str, ...] = ()
    """Openings and blocks that are excavated at its start."""
    relax: float = 1.0
    """Share of the support forces of excavated blocks that is released at once."""
    relax_time: float = 0.0
    """Time over which the rest is released, s."""
    install: tuple[str, ...] = ()
    """Bolts that are installed at its start, by their names or kinds."""
    joints: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Strengths of joints from its start on: {"bedding": {"friction_angle": 25.0}}."""
    bonds: str = BREAK
    """"break" as forces reach their strength, or "hold" until the static stage is in balance; only
    then are they judged."""
    jacks: str = LOCK
    """"lock": the jacks of bolts come off at its start; "hold": they stay on."""
    loads: tuple[str, ...] = ()
    """Loads, pressures and tables that act from its start on, and none of them before."""
    ground_motion: bool = False
    """True: the ground moves in this stage, its record beginning with the stage."""
