"""Names that the problems are written with: ``from clast.verification.problems import ...``."""

from __future__ import annotations

from clast.inputs.builder import InputBuilder
from clast.model.model import Floats, Model, Plane, PlaneStrain, PlaneStress, Rock
from clast.model.state import State, initial_state
from clast.results import PointHistory, Run
from clast.verification.collapse_load import AT_REST, StaticRun, limit
from clast.verification.fixtures import BONDED, box, new_model
from clast.verification.problem import Bracket, KnownFailure, Trial, problem

__all__ = [
    "AT_REST",
    "BONDED",
    "Bracket",
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
    "box",
    "initial_state",
    "limit",
    "new_model",
    "problem",
]
