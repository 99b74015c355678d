"""The settings of a benchmark, checked before anything slow begins."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from clast import spelling
from clast.errors import CaseError
from clast.inputs.method import SOLVERS, MethodTable
from clast.inputs.time_and_output import TRAVEL_SHARE
from clast.model.model import Model
from clast.run.schedule import Schedule
from clast.step.method import Method
from clast.studies.bench.cuts import CUT_SIZE, CUTS, CutScene
from clast.studies.bench.scenes import LARGEST, SCENES, SMALLEST, Scene
from clast.studies.bench.whole_scenes import WHOLE_SCENES, WHOLE_SIZE, WholeScene

SIZES = (100, 1000)
"""Numbers of blocks by default."""
STEPS = 50
"""Steps by default, where no end is given either."""
CUT = "cut"
"""Name of all networks that are only cut."""
WHOLE = "whole"
"""Name of all scenes that are simulated from beginning to end."""


@dataclass(frozen=True, kw_only=True)
class BenchSettings:
    """Scenes, sizes and how they are simulated."""

    scenes: tuple[str, ...] = tuple(SCENES)
    """Names of the scenes; "cut": all networks that are only cut, "whole": all scenes that are
    simulated from beginning to end."""
    sizes: tuple[int, ...] | None = None
    """Blocks of each; None: SIZES, of networks that are only cut CUT_SIZE, of whole scenes
    WHOLE_SIZE."""
    step: float = 1e-3
    """Length of a step, s."""
    steps: int | None = None
    """Steps; STEPS where there is no end either."""
    end: float | None = None
    """Simulated time, s, instead of a number of steps."""
    settle: int = 0
    """Steps at the start that are not counted: blocks at rest settle under their weight."""
    share: float = 1.0
    """Normal stiffness as a share of Young's modulus."""
    solver: str = "auto"
    """Solver by its name in case files."""
    results: Path | None = None
    """Folder that gets a result file of every run, with its first and its last frame."""

    def __post_init__(self) -> None:
        """Raise CaseError where something cannot be used."""
        known = (*SCENES, CUT, *CUTS, WHOLE, *WHOLE_SCENES)
        for name in self.scenes:
            if name not in known:
                raise CaseError(
                    f"there is no scene '{name}'",
                    remedy=spelling.advice(name, known, kind="scene"),
                )
        if self.sizes is not None:
            _check_sizes(self.sizes)
        _check_positive(self.step, "--step", "give the length of a step in s, e.g. 1e-3")
        _check_positive(self.share, "--stiffness", "give p/E, a share of Young's modulus, e.g. 1")
        if self.steps is not None and self.end is not None:
            raise CaseError("both are given", where="--steps and --end", remedy="give one of them")
        if self.steps is not None and self.steps < 1:
            raise CaseError(
                f"{self.steps} is not a valid number of steps",
                where="--steps",
                remedy="give 1 or more",
            )
        if self.settle < 0:
            raise CaseError(
                f"{self.settle} is not a valid number of steps",
                where="--settle",
                remedy="give 0 or more",
            )
        if self.end is not None:
            _check_positive(self.end, "--end", "give the end of the runs in s")
        if self.solver not in SOLVERS:
            raise CaseError(
                f"there is no solver '{self.solver}'",
                where="--solver",
                remedy=spelling.advice(self.solver, SOLVERS, kind="solver"),
            )
        if self.results is not None and not self.results.is_dir():
            raise CaseError("is not a folder", where=str(self.results), remedy="create it first")

    @property
    def models(self) -> tuple[Scene, ...]:
        """Scenes that are simulated, in the order wanted."""
        return tuple(SCENES[name] for name in self.scenes if name in SCENES)

    @property
    def cuts(self) -> tuple[CutScene, ...]:
        """Networks that are cut, in the order wanted."""
        return tuple(CUTS[name] for name in self._named(CUT, CUTS))

    @property
    def wholes(self) -> tuple[WholeScene, ...]:
        """Scenes that are simulated from beginning to end, in the order wanted."""
        return tuple(WHOLE_SCENES[name] for name in self._named(WHOLE, WHOLE_SCENES))

    def _named(self, all_of_them: str, known: Collection[str]) -> dict[str, None]:
        """Return the requested names of a kind, each once; one name stands for all of them."""
        listed = [(known if name == all_of_them else (name,)) for name in self.scenes]
        return dict.fromkeys(name for some in listed for name in some if name in known)

    @property
    def model_sizes(self) -> tuple[int, ...]:
        """Blocks of each scene that is simulated."""
        return SIZES if self.sizes is None else self.sizes

    @property
    def whole_sizes(self) -> tuple[int, ...]:
        """Blocks of each scene that is simulated from beginning to end."""
        return (WHOLE_SIZE,) if self.sizes is None else self.sizes

    @property
    def cut_sizes(self) -> tuple[int, ...]:
        """Blocks of each network that is cut."""
        return (CUT_SIZE,) if self.sizes is None else self.sizes

    def file_of(self, scene: str, size: int) -> Path | None:
        """Return the result file of a run, or None where results are not kept."""
        return None if self.results is None else self.results / f"{scene}-{size}.vtkhdf"

    def as_dict(self) -> dict[str, Any]:
        """Return them as plain numbers and texts, ready for JSON."""
        return {
            "scenes": list(self.scenes),
            "sizes": list(self.model_sizes),
            "cut_sizes": list(self.cut_sizes),
            "whole_sizes": list(self.whole_sizes),
            "step": self.step,
            "end": schedule_of(self).end,
            "settle": self.settle,
            "stiffness": self.share,
            "solver": self.solver,
        }


def sizes_in(listed: str) -> tuple[int, ...]:
    """Return the sizes of a list such as "100,1e5"; raises CaseError for an invalid one."""
    sizes = []
    for word in filter(None, (word.strip() for word in listed.split(","))):
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if not number.is_integer():
            raise CaseError(
                f"'{word}' is not a valid number of blocks",
                where="--size",
                remedy="give whole numbers separated by commas, e.g. 100,1000,1e5",
            )
        sizes.append(int(number))
    return tuple(sizes)


def method_for(model: Model, settings: BenchSettings) -> Method:
    """Return the convex process with the stiffness and the solver of the settings."""
    law = {"name": "penalty", "normal_stiffness": settings.share * model.stiffest}
    table = MethodTable(process="convex", contact_law=law, solver=settings.solver)
    smallest = float(np.sqrt(model.area.min()))
    return table.method(model, step=settings.step, max_displacement=TRAVEL_SHARE * smallest)


def schedule_of(settings: BenchSettings) -> Schedule:
    """Return the schedule of a run; only the first and the last state are frames."""
    end = settings.end
    if end is None:
        end = settings.step * (STEPS if settings.steps is None else settings.steps)
    end += settings.settle * settings.step
    return Schedule(step=settings.step, end=end, every=end)


def _check_sizes(sizes: Sequence[int]) -> None:
    if not sizes:
        raise CaseError("there is no size", where="--size", remedy="give one, e.g. 1000")
    for size in sizes:
        if not SMALLEST <= size <= LARGEST:
            raise CaseError(
                f"{size} is not a valid size of a scene",
                where="--size",
                remedy=f"give a number of blocks from {SMALLEST} to {LARGEST:,}",
            )


def _check_positive(value: float, where: str, remedy: str) -> None:
    if not 0.0 < value < math.inf:
        raise CaseError(f"{value:g} must be above 0 and finite", where=where, remedy=remedy)
