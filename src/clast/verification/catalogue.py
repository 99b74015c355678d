"""All problems by groups, in the order of the table, and the selection of those that are run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from importlib import import_module

from clast import spelling
from clast.errors import CaseError
from clast.inputs.method import CONTACT_LAWS, PROCESSES
from clast.verification.problem import Problem

MODULES = {
    "blocks": "free_fall spin pendulum patch column floating",
    "contact": "at_rest stiffness bounce restitution collision",
    "friction": (
        "incline decelerating_block slip_weakening stick_slip rough_joint seams "
        "direct_shear plane_of_weakness ladder open_joints dam submerged_block tilt_table "
    ),
    "slopes": (
        "slide_topple plane_failure wet_slope cohesive_slab block_train toppling "
        "active_passive bolted_block bolted_toppling "
    ),
    "underground": (
        "key_block roof_wedge slipping_ring jointed_rock excavation "
        "two_bolts pull_test bolted_stages in_situ kirsch snap_through "
    ),
    "masonry": (
        "overhang kern bonded_beam arch arch_push arch_falls wall_push "
        "wall_buckling three_hinges rocking "
    ),
    "supports": (
        "drawn_block settling_pier servo_press slow_press hinges slider yielding_beam "
        "lining_beam lining_ring lining_confinement "
    ),
    "waves": (
        "chain damped_block wave newmark moving_base viscous_end sinking_block oblique_wave "
        "incoming_wave layer damped_layer rocking_spectrum "
    ),
    "water": (
        "flow_channels flow_rest flow_rain flow_crest flow_dam flow_tensor flow_tunnel flow_wells "
        "flow_uplift flow_slip flow_pulse flow_follows "
        "flow_coupled flow_drawdown "
    ),
    "rockfall": (
        "rock_impact rock_blows rock_rest rock_slide rock_roll rock_barrier rock_moved "
        "rock_spread rock_angle "
    ),
    "cutting": "persistent_lines random_spacing intensity cells apparent_dip chords",
    "method": "energy order convergence invariance resumed_run",
}
"""Folder -> its modules, from single blocks to the whole method."""


GROUPS = {
    group: tuple(
        value
        for module in (
            import_module(f"clast.verification.problems.{group}.{name}") for name in names.split()
        )
        for value in vars(module).values()
        if isinstance(value, Problem) and value.examine.__module__ == module.__name__
    )
    for group, names in MODULES.items()
}
"""Folder -> its problems: the subject of their tests."""

PROBLEMS = tuple(problem for group in GROUPS.values() for problem in group)
"""All problems."""


Choose = Callable[[Problem], Problem]
"""Returns a problem with the variants to run."""


def every(problem: Problem) -> Problem:
    """Choose all of a problem."""
    return problem


def quick(problem: Problem) -> Problem:
    """Choose the part of all problems that together takes less than a minute."""
    return problem.brief()


def problems(names: Iterable[str] = ()) -> list[Problem]:
    """Return the named problems, and those of named groups; all if none is named.

    Raises CaseError for a name unknown.
    """
    known = {**GROUPS, **{problem.name: (problem,) for problem in PROBLEMS}}
    wanted = list(names)
    _check("problem", wanted, known, "verification problem")
    return list(dict.fromkeys(each for name in wanted for each in known[name])) or list(PROBLEMS)


def narrowed(choose: Choose, processes: Sequence[str] = (), laws: Sequence[str] = ()) -> Choose:
    """Restrict a selector to the variants with these processes and laws.

    Nothing named means any.  Raises CaseError for an unknown name.
    """
    _check("process", processes, PROCESSES)
    _check("contact law", laws, CONTACT_LAWS)

    def chosen(problem: Problem) -> Problem:
        whole = choose(problem)
        kept = tuple(
            variant
            for variant in whole.variants
            if (not processes or variant.process["name"] in processes)
            and (not laws or variant.contact_law["name"] in laws)
        )
        return replace(whole, variants=kept)

    return chosen


def _check(kind: str, names: Iterable[str], known: Iterable[str], called: str = "") -> None:
    listed = list(known)
    for name in names:
        if name not in listed:
            raise CaseError(
                f"there is no {called or kind} '{name}'",
                remedy=spelling.advice(name, listed, kind=kind),
            )
