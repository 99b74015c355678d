"""All problems by groups, in the order of the table."""

from __future__ import annotations

from clast.verification.problem import Problem
from clast.verification.problems.blocks import column, floating, free_fall, patch, pendulum, spin
from clast.verification.problems.contact import (
    bounce,
    collision,
    penetration,
    restitution,
    stack,
    stiffness,
    two_planes,
)
from clast.verification.problems.cutting import (
    apparent_dip,
    cells,
    chords,
    intensity,
    persistent_lines,
    random_spacing,
)
from clast.verification.problems.friction import (
    dam,
    decelerating_block,
    direct_shear,
    friction_lag,
    incline,
    ladder,
    seams,
    submerged_block,
    tilt_table,
)
from clast.verification.problems.masonry import (
    arch,
    arch_load,
    arch_push,
    arch_spread,
    bonded_beam,
    kern,
    overhang,
    rocking,
    three_hinges,
    wall_push,
)
from clast.verification.problems.method import energy, invariance, order, resume, staged_views
from clast.verification.problems.slopes import (
    active_passive,
    bolted_block,
    bolted_toppling,
    cohesive_slab,
    drained_slope,
    plane_failure,
    slide_topple,
    toppling,
    wet_slope,
)
from clast.verification.problems.underground import (
    bolted_stages,
    excavated_stack,
    in_situ,
    jointed_rock,
    key_block,
    kirsch,
    relaxed_support,
    roof_wedge,
    snap_through,
    two_bolts,
)
from clast.verification.problems.waves import (
    chain,
    damped_block,
    damped_layer,
    free_surface,
    incoming_wave,
    layer,
    layer_peaks,
    moving_base,
    newmark,
    oblique_wave,
    rocking_spectrum,
    sinking_block,
    viscous_end,
    wave,
)

GROUPS: dict[str, tuple[Problem, ...]] = {
    "blocks": (
        free_fall.PROBLEM,
        spin.PROBLEM,
        pendulum.PROBLEM,
        patch.PROBLEM,
        column.PROBLEM,
        floating.PROBLEM,
    ),
    "contact": (
        penetration.PROBLEM,
        stiffness.PROBLEM,
        stack.PROBLEM,
        two_planes.PROBLEM,
        bounce.PROBLEM,
        restitution.PROBLEM,
        collision.PROBLEM,
    ),
    "friction": (
        incline.PROBLEM,
        friction_lag.PROBLEM,
        decelerating_block.PROBLEM,
        seams.PROBLEM,
        direct_shear.PROBLEM,
        ladder.PROBLEM,
        dam.PROBLEM,
        submerged_block.PROBLEM,
        tilt_table.PROBLEM,
    ),
    "slopes": (
        slide_topple.PROBLEM,
        plane_failure.PROBLEM,
        wet_slope.PROBLEM,
        drained_slope.PROBLEM,
        cohesive_slab.PROBLEM,
        toppling.PROBLEM,
        active_passive.PROBLEM,
        bolted_block.PROBLEM,
        bolted_toppling.PROBLEM,
    ),
    "underground": (
        key_block.PROBLEM,
        roof_wedge.PROBLEM,
        jointed_rock.PROBLEM,
        excavated_stack.PROBLEM,
        relaxed_support.PROBLEM,
        two_bolts.PROBLEM,
        bolted_stages.PROBLEM,
        in_situ.PROBLEM,
        kirsch.PROBLEM,
        snap_through.PROBLEM,
    ),
    "masonry": (
        overhang.PROBLEM,
        kern.PROBLEM,
        bonded_beam.PROBLEM,
        arch.PROBLEM,
        arch_load.PROBLEM,
        arch_push.PROBLEM,
        arch_spread.PROBLEM,
        wall_push.PROBLEM,
        three_hinges.PROBLEM,
        rocking.PROBLEM,
    ),
    "waves": (
        chain.PROBLEM,
        damped_block.PROBLEM,
        wave.PROBLEM,
        newmark.PROBLEM,
        moving_base.PROBLEM,
        viscous_end.PROBLEM,
        sinking_block.PROBLEM,
        oblique_wave.PROBLEM,
        free_surface.PROBLEM,
        incoming_wave.PROBLEM,
        layer.PROBLEM,
        layer_peaks.PROBLEM,
        damped_layer.PROBLEM,
        rocking_spectrum.PROBLEM,
    ),
    "cutting": (
        persistent_lines.PROBLEM,
        random_spacing.PROBLEM,
        intensity.PROBLEM,
        cells.PROBLEM,
        apparent_dip.PROBLEM,
        chords.PROBLEM,
    ),
    "method": (
        energy.PROBLEM,
        order.PROBLEM,
        invariance.PROBLEM,
        staged_views.PROBLEM,
        resume.PROBLEM,
    ),
}
"""Folder -> its problems: what they test, from single blocks to the method as a whole."""

PROBLEMS: tuple[Problem, ...] = tuple(problem for group in GROUPS.values() for problem in group)
"""All problems."""
