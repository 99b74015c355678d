"""Names that the problems are written with: ``from clast.verification.problems import ...``."""

from __future__ import annotations

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model, Plane, PlaneStrain, PlaneStress, Rock
from clast.model.state import State, initial_state
from clast.results import PointHistory, Run
from clast.verification.collapse_load import AT_REST, StaticRun, limit
from clast.verification.problem import (
    Bracket,
    Comparison,
    KnownFailure,
    Trial,
    absolute,
    problem,
    relative,
)

__all__ = [
    "AT_REST",
    "Bracket",
    "Comparison",
    "Floats",
    "InputBuilder",
    "KnownFailure",
    "Model",
    "Plane",
    "PlaneStrain",
    "PlaneStress",
    "PointHistory",
    "Rock",
    "Run",
    "State",
    "StaticRun",
    "Trial",
    "absolute",
    "initial_state",
    "limit",
    "problem",
    "relative",
]
