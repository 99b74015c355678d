"""Discontinuous deformation analysis of rock and masonry blocks in two dimensions.

    import clast

    run = clast.load("incline.toml").run()
    run.history("A").displacement[-1]

Units are SI per metre of thickness, angles are degrees; stress and strain are tension-positive in
the order xx, yy, xy; a gap below zero is penetration, a normal contact force above it compression.
Whatever is wrong with a case or a model is raised as ClastError, which says where and what to do.

Every public name has one import path, here; it is loaded when it is first used, so that the
command line starts at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from clast import studies as studies
    from clast.actions.damping import Adaptive as Adaptive
    from clast.actions.damping import Kinetic as Kinetic
    from clast.actions.damping import Rayleigh as Rayleigh
    from clast.actions.damping import Undamped as Undamped
    from clast.case.case_file import Case as Case
    from clast.case.case_file import load as load
    from clast.case.law_trials import check_law as check_law
    from clast.case.resume import resume as resume
    from clast.case.script import ModelBuilder as ModelBuilder
    from clast.case.script import Stage as Stage
    from clast.case.script import simulate as simulate
    from clast.errors import CaseError as CaseError
    from clast.errors import ClastError as ClastError
    from clast.errors import ModelError as ModelError
    from clast.errors import RunStopped as RunStopped
    from clast.errors import RunWarning as RunWarning
    from clast.inputs.in_situ import Overburden as Overburden
    from clast.model.distributions import Beta as Beta
    from clast.model.distributions import Discrete as Discrete
    from clast.model.distributions import Lognormal as Lognormal
    from clast.model.distributions import Normal as Normal
    from clast.model.distributions import Triangular as Triangular
    from clast.model.distributions import Uniform as Uniform
    from clast.model.distributions import Values as Values
    from clast.model.ground_motion import Accelerogram as Accelerogram
    from clast.model.ground_motion import IncomingWave as IncomingWave
    from clast.model.ground_motion import InertialForce as InertialForce
    from clast.model.ground_motion import MovingBase as MovingBase
    from clast.model.joints import Joint as Joint
    from clast.model.model import Model as Model
    from clast.model.model import PlaneStrain as PlaneStrain
    from clast.model.model import PlaneStress as PlaneStress
    from clast.model.model import Rock as Rock
    from clast.model.state import State as State
    from clast.model.surroundings import InSituStress as InSituStress
    from clast.pictures.figure_options import Look as Look
    from clast.pictures.linings import plot_interaction as plot_interaction
    from clast.pictures.plot import plot_bolt_history as plot_bolt_history
    from clast.pictures.plot import plot_history as plot_history
    from clast.pictures.plot import plot_results as plot_results
    from clast.results import Run as Run
    from clast.results import RunRecorder as RunRecorder
    from clast.results import read as read
    from clast.results import read_results as read_results
    from clast.run.excavation import excavated as excavated
    from clast.run.schedule import Schedule as Schedule
    from clast.step.method import Method as Method
    from clast.study.collapsing.collapse import Collapse as Collapse
    from clast.study.collapsing.collapse import collapse_load as collapse_load
    from clast.study.collapsing.collapse import factor_of_safety as factor_of_safety
    from clast.study.collapsing.search import FactorSettings as FactorSettings
    from clast.study.distributions import Between as Between
    from clast.study.distributions import Numbered as Numbered
    from clast.study.distributions import Range as Range
    from clast.study.distributions import Times as Times
    from clast.study.fitting.fit import fit as fit
    from clast.study.fitting.fitting import Fit as Fit
    from clast.study.fitting.observations import FitSettings as FitSettings
    from clast.study.rockfall.results import RockfallResults as RockfallResults
    from clast.study.rockfall.results import rockfall as rockfall
    from clast.study.study_api import HowMade as HowMade
    from clast.study.study_api import Study as Study
    from clast.study.targeting.target import Target as Target
    from clast.study.targeting.target import target as target

    __version__: str

NAMES = {
    "clast.case.case_file": "Case load",
    "clast.case.resume": "resume",
    "clast.case.law_trials": "check_law",
    "clast.run.excavation": "excavated",
    "clast.errors": "CaseError ClastError ModelError RunStopped RunWarning",
    "clast.model.ground_motion": "Accelerogram IncomingWave InertialForce MovingBase",
    "clast.actions.damping": "Adaptive Kinetic Rayleigh Undamped",
    "clast.step.method": "Method",
    "clast.model.surroundings": "InSituStress",
    "clast.inputs.in_situ": "Overburden",
    "clast.model.joints": "Joint",
    "clast.model.model": "Model PlaneStrain PlaneStress Rock",
    "clast.case.script": "ModelBuilder Stage simulate",
    "clast.pictures.figure_options": "Look",
    "clast.pictures.plot": "plot_bolt_history plot_history plot_results",
    "clast.pictures.linings": "plot_interaction",
    "clast.results": "Run RunRecorder read read_results",
    "clast.run.schedule": "Schedule",
    "clast.model.state": "State",
    "clast.study.study_api": "HowMade Study",
    "clast.study.fitting.fitting": "Fit",
    "clast.study.fitting.observations": "FitSettings",
    "clast.study.fitting.fit": "fit",
    "clast.study.collapsing.collapse": "Collapse collapse_load factor_of_safety",
    "clast.study.collapsing.search": "FactorSettings",
    "clast.model.distributions": "Beta Discrete Lognormal Normal Triangular Uniform Values",
    "clast.study.targeting.target": "Target target",
    "clast.study.rockfall.results": "RockfallResults rockfall",
    "clast.study.distributions": "Between Numbered Range Times",
}
"""Module -> public names that it defines."""
HOME = {name: module for module, names in NAMES.items() for name in names.split()}
"""Public name -> module that defines it."""

PARTS = ("studies",)
"""Parts of the package that are asked for under their own names: ``clast.studies.compare``."""

__all__ = [*HOME, *PARTS, "__version__"]


def __getattr__(name: str) -> Any:
    """Load a public name from its module."""
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            value: Any = version("clast")
        except PackageNotFoundError:
            value = "0+uninstalled"
    elif name in HOME:
        value = getattr(import_module(HOME[name]), name)
    elif name in PARTS:
        value = import_module(f"clast.{name}")
    else:
        raise AttributeError(f"module 'clast' has no attribute '{name}'")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
