"""How a run was made (process, law, parameters, rocks) and how it went."""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from clast.model.model import Model
from clast.model.stage_records import Event, StageRecord, events_from, records_from
from clast.model.state import Ledger, Overlap
from clast.model.surcharge import Surcharge
from clast.results.checkpoints.encode import fits
from clast.step.method import Method


@dataclass(frozen=True, kw_only=True, repr=False)
class Report:
    """How a run went."""

    finished: bool
    """True where the run reached its end."""
    outcome: str
    """How the run ended, in words, with advice where it could not go on."""
    steps: int = 0
    """Accepted steps."""
    passes: int = 0
    """Assemblies and solves in the accepted steps."""
    cut_steps: int = 0
    """Steps that were tried again with a smaller step."""
    largest_contacts: int = 0
    """Largest number of contacts in a step."""
    largest_penetration: float = 0.0
    """Largest penetration at the end of a step, m."""
    ledger: Ledger
    """Energy ledger at the end."""
    wall_seconds: float = 0.0
    """Time that the run took, s of wall clock, without the time in which kernels were compiled."""
    seconds: Mapping[str, float] = field(default_factory=dict)
    """Wall clock per stage of the step, s; and "compilation", where kernels were compiled."""
    warnings: tuple[str, ...] = ()
    """Warnings given before the run, and those based on its results."""
    overlaps: tuple[Overlap, ...] = ()
    """Blocks that overlapped in a frame deeper than their contacts knew, each pair's worst."""
    notes: tuple[str, ...] = ()
    """Automatic choices, with their reasons."""
    counts: Mapping[str, int] = field(default_factory=dict)
    """Sums over the accepted steps of the counts of the process: passes, line searches, ..."""
    stages: tuple[StageRecord, ...] = ()
    """How each stage went; none where the run has no stages."""
    events: tuple[Event, ...] = ()
    """Events of the run."""

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain numbers and texts, ready for JSON."""
        plain: dict[str, Any] = json.loads(json.dumps(dataclasses.asdict(self), default=float))
        return plain

    def __repr__(self) -> str:
        lines = [
            f"Report: {self.outcome.partition(':')[0]}",
            f"  {self.steps} steps ({self.cut_steps} cut), {self.passes} passes, at most "
            f"{self.largest_contacts} contacts, {self.wall_seconds:.3g} s of wall time",
            f"  penetration at most {self.largest_penetration:.3g} m; kinetic "
            f"{self.ledger.kinetic:.4g}, friction {self.ledger.friction:.4g}, impacts "
            f"{self.ledger.impacts:.4g}, numerical {self.ledger.numerical:.4g}, "
            f"unaccounted {self.ledger.unaccounted:.2g} J/m",
        ]
        lines += [f"  {stage}" for stage in self.stages]
        if self.warnings:
            lines.append(f"  {len(self.warnings)} warnings: .warnings")
        return "\n".join(lines)


def report_from_dict(plain: Mapping[str, Any]) -> Report:
    """Return the report that ``Report.as_dict`` gave."""
    known = {f.name for f in dataclasses.fields(Report)}
    entries = {name: value for name, value in plain.items() if name in known}
    ledger = {f.name for f in dataclasses.fields(Ledger)}
    entries["ledger"] = Ledger(**{k: v for k, v in plain["ledger"].items() if k in ledger})
    entries["warnings"], entries["notes"] = tuple(plain["warnings"]), tuple(plain["notes"])
    entries["overlaps"] = tuple(
        Overlap(**{**one, "blocks": tuple(one["blocks"])}) for one in plain["overlaps"]
    )
    entries["stages"], entries["events"] = (
        records_from(plain["stages"]),
        events_from(plain["events"]),
    )
    return Report(**entries)


PARTS = ("process", "contact_law", "corner_rule", "integrator", "solver", "damping")
"""Parts of a method that are recorded by name, each with its parameters."""
MOST_ROCKS = 8
"""Rocks that a table lists, at most."""
PARAMETERS = ("fixed_point_stiffness", "critdis", "max_displacement", "dynamic_ratio")
"""Parameters of the method itself."""


def version_of(package: str) -> str:
    """Return the version of an installed package, "unknown" where it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"


def about_method(method: Method, step: float, end: float) -> dict[str, Any]:
    """Return how a run is simulated, ready for JSON; ``step`` and ``end`` in s."""
    parts = {name: _part(getattr(method, name)) for name in PARTS}
    numbers = {name: getattr(method, name) for name in PARAMETERS}
    return {**parts, "step": float(step), "end": float(end), **numbers}


def about_model(model: Model) -> dict[str, Any]:
    """Return the materials of a model, fill and axles, ready for JSON."""
    surcharge = model.surcharge.plain()
    return {
        **({"surcharge": surcharge} if surcharge else {}),
        "rocks": [dataclasses.asdict(rock) for rock in model.rocks],
        "joints": [dataclasses.asdict(joint) for joint in model.joint_table.joints],
    }


def _is_part(part: Any) -> bool:
    return isinstance(part, dict) and isinstance(part.get("name"), str)


def _is_surcharge(given: Any) -> bool:
    try:
        Surcharge.of_plain(given)
    except (KeyError, TypeError, ValueError):
        return False
    return True


def _is_rock(rock: Any) -> bool:
    numbers = ("young", "poisson", "density")
    return _is_part(rock) and all(isinstance(rock.get(key), int | float) for key in numbers)


CHECKS: dict[str, Callable[[Any], bool]] = {
    "process": _is_part,
    "contact_law": _is_part,
    "rocks": lambda rocks: isinstance(rocks, list) and all(map(_is_rock, rocks)),
    "surcharge": _is_surcharge,
    "stages": lambda names: fits(names, list[str]),
    "begins": lambda names: fits(names, dict[str, str]),
    "step": lambda time: isinstance(time, float),
    "end": lambda time: isinstance(time, float),
}
"""Checks of the entries that readers rely on."""


def main_parameters(about: dict[str, Any]) -> dict[str, Any]:
    """Return process, law, p, h and E by plain keys; None where an older file lacks them."""
    law = about.get("contact_law", {})
    return {
        "process": about.get("process", {}).get("name"),
        "contact_law": law.get("name"),
        "normal_stiffness": law.get("normal_stiffness"),
        "step": about.get("step"),
        "end": about.get("end"),
        "young": {rock["name"]: rock["young"] for rock in about.get("rocks", ())},
    }


def texts(about: dict[str, Any]) -> dict[str, str]:
    """Return the parameters in words, one table row each; none where an older file lacks them."""
    if not {"process", "contact_law", "step", "end", "rocks"} <= set(about):
        return {}
    stiffness = about["contact_law"].get("normal_stiffness")
    rocks = (
        f"{rock['name']}: E = {rock['young']:.4g} Pa, nu = {rock['poisson']:g}, "
        f"rho = {rock['density']:g} kg/m3"
        for rock in about["rocks"][:MOST_ROCKS]
    )
    left = len(about["rocks"]) - MOST_ROCKS
    return {
        "process": _numbers_text(about["process"]),
        "contact law": _numbers_text(about["contact_law"]),
        "p": f"{stiffness:.4g} N/m per m" if isinstance(stiffness, int | float) else "? N/m per m",
        "h": f"{about['step']:g} s, to {about['end']:g} s",
        **({"stages": ", ".join(about["stages"])} if about.get("stages") else {}),
        "rocks": "\n".join((*rocks, *([f"and {left} more"] if left > 0 else []))),
    }


def _numbers_text(part: dict[str, Any]) -> str:
    """Return the name of a part and its numbers: ``convex (tolerance 1e-07)``."""
    numbers = ", ".join(
        f"{key} {value:.6g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in part.items()
        if key != "name"
    )
    return f"{part['name']} ({numbers})" if numbers else part["name"]


def _part(part: Any) -> dict[str, Any]:
    """Return the name of a part, as in case files where it is clast's own, and its numbers."""
    kind = type(part)
    name = kind.__name__
    if kind.__module__.startswith("clast."):
        name = re.sub(r"(?<=[a-z])(?=[A-Z])", "-", name).lower()
    if not dataclasses.is_dataclass(part):
        return {"name": name}
    values = ((field.name, getattr(part, field.name)) for field in dataclasses.fields(part))
    inner = {
        key: _part(value)["name"] if dataclasses.is_dataclass(value) else value
        for key, value in values
    }
    plain = {key: value for key, value in inner.items() if isinstance(value, int | float | str)}
    return {**plain, "name": name}
