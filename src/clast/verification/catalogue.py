"""All problems by groups, in the order of the table."""

from __future__ import annotations

from importlib import import_module

from clast.verification.problem import Problem

MODULES = {
    "blocks": "free_fall spin pendulum patch column floating",
    "contact": "penetration stiffness stack two_planes bounce restitution collision",
    "friction": (
        "incline decelerating_block slip_weakening stick_slip rough_joint seams "
        "direct_shear plane_of_weakness ladder open_joints dam submerged_block tilt_table "
    ),
    "slopes": (
        "slide_topple plane_failure wet_slope cohesive_slab block_train toppling "
        "active_passive bolted_block bolted_toppling "
    ),
    "underground": (
        "key_block roof_wedge slipping_ring jointed_rock excavated_stack relaxed_support "
        "two_bolts pull_test bolted_stages in_situ kirsch snap_through "
    ),
    "masonry": (
        "overhang kern bonded_beam arch arch_load arch_push arch_falls wall_push "
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
    "cutting": "persistent_lines random_spacing intensity cells apparent_dip chords",
    "method": "energy order convergence invariance resumed_run",
}
"""Folder -> its modules, from single blocks to the whole method."""


def _problems_of(group: str, names: str) -> tuple[Problem, ...]:
    """Return the problems of modules, in the order in which they stand there."""
    modules = [import_module(f"clast.verification.problems.{group}.{n}") for n in names.split()]
    return tuple(
        value
        for module in modules
        for value in vars(module).values()
        if isinstance(value, Problem) and value.examine.__module__ == module.__name__
    )


GROUPS = {group: _problems_of(group, names) for group, names in MODULES.items()}
"""Folder -> its problems: the subject of their tests."""

PROBLEMS = tuple(problem for group in GROUPS.values() for problem in group)
"""All problems."""
