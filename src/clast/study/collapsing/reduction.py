"""The quantity of a factor: the strengths of joints, gravity, a load, or a push on all blocks.

Each makes of the content of a case that of a trial.  The blocks first come to rest in the stages of
the case and one of ours, ``settle``; the trial is a stage after it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from clast.errors import CaseError, shortened
from clast.model.stages import STRENGTHS
from clast.spelling import advice, require_known
from clast.study.parameters import Content

SETTLE, TRIAL = "settle", "trial"
ANGLES = tuple(key for key in STRENGTHS if key.endswith("friction_angle"))
"""Friction angles of a joint, whose tangents are divided."""
DILATION = "dilation_angle"
"""Angle at which a joint opens as it slides."""
ROUGH = "strength_reduction"
"""Key of a rough joint: divisor of the tangent of its mobilised friction angle."""
FORCES = tuple(key for key in STRENGTHS if key not in (*ANGLES, DILATION, ROUGH))
"""Strengths of a joint that are forces, cohesion and the like: they are divided themselves."""
SEISMIC = "seismic_coefficient"
"""Key of a push that lasts."""
LOADS = {"point_load": "force", "line_load": "traction", "pressure": "value", "load_train": "loads"}
"""Tables of loads, and the keys of their values."""
OF_SEVERAL: dict[str, Callable[..., float]] = {
    "pressure": max,
    "load_train": lambda *loads: math.fsum(loads),
}
"""Tables whose values are no vectors -> the size of several: the larger pressure, all axles."""
ALONG_LINES = ("line_load", "pressure")
"""Tables whose values are by length."""
STATIC_STEPS_MIN = 300
"""Steps of a stage, at least, where a process does not carry steps of any length."""


class Reduction:
    """The quantity that a factor multiplies or divides; each kind has its own."""

    SYMBOL: ClassVar[str]
    TITLE: ClassVar[str]
    DIVIDES: ClassVar[bool] = False
    """Whether blocks may come to rest with more strength where they do not at a factor of 1."""
    START: ClassVar[float] = 1.0
    """First factor that is tried."""
    GROWTH: ClassVar[float] = 2.0
    """By how much the next ones are larger, until one fails."""

    def check(self, content: Content) -> None:
        """Raise CaseError where the case has nothing that the factor could change."""

    def base(self, content: Content, factor: float) -> Content:
        """Return the case in which blocks come to rest: without load or push."""
        return content

    def trial(self, content: Content, factor: float) -> tuple[Content, Mapping[str, Any]]:
        """Return the case of a trial, and the loads that its stage has beside those of all."""
        raise NotImplementedError


@dataclass(frozen=True, kw_only=True)
class ScaledStrength(Reduction):
    """The strengths of joints are divided by the factor: cohesion, tension, tan(phi).

    The case of a trial is the same for all factors: its stage alone has other strengths.
    """

    SYMBOL: ClassVar[str] = "F"
    TITLE: ClassVar[str] = "factor of safety"
    DIVIDES: ClassVar[bool] = True
    GROWTH: ClassVar[float] = 1.25
    joints: tuple[str, ...] = ()

    def check(self, content: Content) -> None:
        """Raise CaseError where there is nothing to reduce."""
        known = content.get("joint", {})
        for name in self.joints:
            require_known(name, known, kind="joint", where="joints")
        if not any(
            ROUGH in table or any(table.get(key, 0.0) > 0.0 for key in ("friction_angle", *FORCES))
            for table in self._last(content).values()
        ):
            raise CaseError(
                "no joint has a friction angle or another strength that could be reduced",
                where="joints",
                remedy="give [joint.default] with a friction_angle, or name other joints",
            )

    def base(self, content: Content, factor: float) -> Content:
        """Return the case with its strengths divided."""
        if factor == 1.0:
            return content
        joints = {
            name: {**table, **divide({ROUGH: 1.0, **table} if _is_rough(table) else table, factor)}
            if self._is_meant(name)
            else table
            for name, table in content.get("joint", {}).items()
        }
        stages = [
            {**stage, "joint": self._divided(stage["joint"], factor)} if "joint" in stage else stage
            for stage in content.get("stage", [])
        ]
        return {**content, "joint": joints, **({"stage": stages} if stages else {})}

    def trial(self, content: Content, factor: float) -> tuple[Content, Mapping[str, Any]]:
        """Return the case, and the strengths of the stage of the trial."""
        return content, {"joint": self._divided(self._last(content), factor)}

    def _divided(self, joints: Content, factor: float) -> dict[str, Any]:
        return {
            name: divide(table, factor) if self._is_meant(name) else dict(table)
            for name, table in joints.items()
        }

    def _last(self, content: Content) -> dict[str, dict[str, float]]:
        """Return the strengths of the joints that are meant after the stages of the case."""
        strengths: dict[str, dict[str, float]] = {}
        for name, table in content.get("joint", {}).items():
            if self._is_meant(name):
                usual = {ROUGH: 1.0} if _is_rough(table) else {"friction_angle": 0.0}
                strengths[name] = {**usual, **{k: table[k] for k in STRENGTHS if k in table}}
        for stage in content.get("stage", []):
            for name, table in stage.get("joint", {}).items():
                if name in strengths:
                    strengths[name].update(table)
        return strengths

    def _is_meant(self, name: str) -> bool:
        return not self.joints or name in self.joints


@dataclass(frozen=True, kw_only=True)
class ScaledGravity(Reduction):
    """Gravity is multiplied by the factor."""

    SYMBOL: ClassVar[str] = "factor of gravity"
    TITLE: ClassVar[str] = "factor of gravity at collapse"
    DIVIDES: ClassVar[bool] = True
    GROWTH: ClassVar[float] = 1.25

    def check(self, content: Content) -> None:
        """Raise CaseError where there is no gravity."""
        _check_weight(content)

    def base(self, content: Content, factor: float) -> Content:
        """Return the case with its gravity multiplied."""
        x, y = content.get("gravity", GRAVITY)
        return {**content, "gravity": [factor * x, factor * y]}

    def trial(self, content: Content, factor: float) -> tuple[Content, Mapping[str, Any]]:
        """Return the case of a trial."""
        return self.base(content, factor), {}


@dataclass(frozen=True, kw_only=True)
class Push(Reduction):
    """All blocks are pushed sideways by the factor times their weight: the critical acceleration.

    The push of an earthquake that lasts, as in limit analysis of walls and arches.
    """

    SYMBOL: ClassVar[str] = "push over weight"
    TITLE: ClassVar[str] = "push over weight at collapse"
    START: ClassVar[float] = 0.1
    sign: float = 1.0
    """1: to the right, -1: to the left."""

    def check(self, content: Content) -> None:
        """Raise CaseError where there is no gravity, or a push already."""
        _check_weight(content)
        if SEISMIC in content:
            raise CaseError(
                "the case already has a seismic coefficient, which excludes finding another one",
                where=SEISMIC,
                remedy=f"leave {SEISMIC} out",
            )

    def trial(self, content: Content, factor: float) -> tuple[Content, Mapping[str, Any]]:
        """Return the case with the push."""
        x, y = content.get("gravity", GRAVITY)
        # across gravity: to its left where it points down, which is +x
        push = self.sign * factor / math.hypot(x, y)
        return {**content, SEISMIC: [-push * y, push * x]}, {}


@dataclass(frozen=True, kw_only=True)
class Load(Reduction):
    """Loads of a name are multiplied by the factor; they act in trials only."""

    SYMBOL: ClassVar[str] = "factor of load"
    TITLE: ClassVar[str] = "factor of load at collapse"
    name: str

    def check(self, content: Content) -> None:
        """Raise CaseError where there is no such load, or where a stage of the case has it."""
        named = [one.get("name") for key in LOADS for one in content.get(key, [])]
        if self.name not in named:
            known = [one for one in named if one is not None]
            remedy = "give a [[point_load]], [[line_load]], [[pressure]] or [[load_train]] a name"
            remedy = advice(self.name, known, kind="load") if known else remedy
            what = f"there is no load '{shortened(self.name)}'"
            raise CaseError(what, where="by", remedy=remedy)
        for stage in content.get("stage", []):
            if self.name in stage.get("loads", []):
                raise CaseError(
                    f"load '{self.name}' begins with stage '{stage.get('name')}'",
                    where="by",
                    remedy="remove it from the stages: the study starts it",
                )

    def over_weight(self, content: Content, weight: float) -> float:
        """Return the sum of the sizes of the loads over a weight, N/m; 0 where there is none."""
        sizes = [
            OF_SEVERAL.get(key, math.hypot)(*map(abs, np.atleast_1d(one[value]).tolist()), 0.0)
            * (math.dist(one["start"], one["end"]) if key in ALONG_LINES else 1.0)
            for key, value in LOADS.items()
            for one in content.get(key, [])
            if one.get("name") == self.name
        ]
        return math.fsum(sizes) / weight if weight > 0.0 else 0.0

    def base(self, content: Content, factor: float) -> Content:
        """Return the case in which blocks come to rest: without the load."""
        return self._with(content, 0.0)

    def trial(self, content: Content, factor: float) -> tuple[Content, Mapping[str, Any]]:
        """Return the case with the load, which begins with the stage of the trial."""
        return self._with(content, factor), {"loads": [self.name]}

    def _with(self, content: Content, factor: float) -> Content:
        """Return the case with the load multiplied by a factor."""

        def multiplied(load: Content, key: str) -> Content:
            if load.get("name") != self.name:
                return load
            value = load[key]
            product = [factor * one for one in value] if isinstance(value, list) else factor * value
            return {**load, key: product}

        changed = {
            key: [multiplied(one, value) for one in content[key]]
            for key, value in LOADS.items()
            if key in content
        }
        return {**content, **changed}


GRAVITY = (0.0, -9.8)
"""Gravity of a case that does not say it, m/s2."""


def reduction(by: str, joints: Sequence[str] = ()) -> Reduction:
    """Return a reduction by its name; raises CaseError for an unknown one.

    "strength", "gravity", "load NAME", "pga" (to the right), "pga left".
    """
    word, _, rest = by.strip().partition(" ")
    rest = rest.strip()
    if joints and word != "strength":
        raise CaseError(
            "joints is for strength reduction only",
            where="joints",
            remedy=f"leave them out with by = '{shortened(by)}'",
        )
    if word == "strength" and not rest:
        return ScaledStrength(joints=tuple(joints))
    if word == "gravity" and not rest:
        return ScaledGravity()
    if word == "load" and rest:
        return Load(name=rest)
    if word == "pga" and rest in ("", "right", "left"):
        return Push(sign=-1.0 if rest == "left" else 1.0)
    raise CaseError(
        f"a factor cannot be applied to '{shortened(by)}'",
        where="by",
        remedy='give strength, gravity, "load NAME", pga or "pga left"',
    )


def staged(
    content: Content, trial: Mapping[str, Any] | None = None, parts: int = 1
) -> dict[str, Any]:
    """Return a case with a stage in which its blocks come to rest, and those of a trial.

    ``trial`` are the loads that the first of its ``parts`` has beside those of all; None: none.
    """
    stages = list(content.get("stage", []))
    taken = {stage.get("name") for stage in stages}
    step = content["time"]["step"]
    time = max(float(content["time"]["end"]), STATIC_STEPS_MIN * step)
    usual = {"dynamic_ratio": 0.0, "until": "equilibrium", "step": step, "time": time}
    usual["jacks"] = "hold"  # they hold the force that the case says, whatever moves
    settle = {**usual, "name": _free(SETTLE, taken), "reset_displacement": True}
    if trial is None:
        return {**content, "stage": [*stages, settle]}
    names = [_free(f"{TRIAL} {k + 1}" if k else TRIAL, taken) for k in range(parts)]
    trials = [{**usual, "name": name} for name in names]
    trials[0].update(trial)
    return {**content, "stage": [*stages, settle, *trials]}


def _free(name: str, taken: set[Any]) -> str:
    """Return a name that no stage of the case has."""
    return name if name not in taken else _free(f"{name} of the study", taken)


def divide(table: Mapping[str, float], factor: float) -> dict[str, float]:
    """Return the strengths of a joint divided by a factor.

    Of a rough joint it is the mobilised friction angle whose tangent is divided, and nothing else;
    a dilation angle stays as it is, up to the friction angle.
    """
    if ROUGH in table:
        kept = {key: table[key] for key in ANGLES if key in table}
        return {**kept, ROUGH: table[ROUGH] * factor}
    divided = {key: table[key] / factor for key in FORCES if key in table}
    angles = {key: math.radians(table[key]) for key in ANGLES if key in table}
    for key, angle in angles.items():
        divided[key] = math.degrees(math.atan(math.tan(angle) / factor))
    if table.get(DILATION, 0.0) > 0.0:
        divided[DILATION] = min(table[DILATION], *(divided[key] for key in angles))
    return divided


def _is_rough(table: Mapping[str, Any]) -> bool:
    return table.get("law") == "barton-bandis"


def _check_weight(content: Content) -> None:
    """Raise CaseError where blocks have no weight."""
    if math.hypot(*content.get("gravity", GRAVITY)) == 0.0:
        raise CaseError(
            "there is no gravity", where="gravity", remedy="give the case a gravity, or another by"
        )
    if "gravity_amplitude" in content:
        raise CaseError(
            "gravity follows an amplitude, so its factor cannot be found",
            where="gravity_amplitude",
            remedy="leave gravity_amplitude out",
        )
