"""UDEC's words for tables and keys of clast, for those who know them by heart."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

UDEC: Mapping[str, str] = MappingProxyType(
    {
        "jkn": "normal_stiffness",
        "jks": "shear_stiffness",
        "jfric": "friction_angle",
        "jfriction": "friction_angle",
        "jcoh": "cohesion",
        "jcohesion": "cohesion",
        "jten": "tensile_strength",
        "jtension": "tensile_strength",
        "jtens": "tensile_strength",
        "jdil": "dilation_angle",
        "jdilation": "dilation_angle",
        "rescoh": "residual_cohesion",
        "dens": "density",
        "jmat": "joint",
        "zone": "rock",
        "jset": "joint_set",
        "crack": "trace",
        "voronoi": "joint_set",
        "tunnel": "opening",
        "jregion": "region",
        "insitu": "in_situ",
        "xvisc": "viscous_boundary",
        "yvisc": "viscous_boundary",
        "xvel": "motion",
        "yvel": "motion",
        "bound": "fixed_sides",
        "bcond": "fixed_sides",
        "damp": "damping",
        "cycle": "stage",
        "solve": "stage",
        "delete": "excavate",
        "cable": "bolt",
        "reinforce": "bolt",
        "struct": "lining",
        "pfix": "water",
        "history": "measured_point",
        "hist": "measured_point",
    }
)
"""Table or key of clast by UDEC's word, lower-case: see docs/how-to/from-other-programs.md."""
