"""Rock masses: joint sets, traces, openings and masonry, and the blocks that they cut."""

from clast.model.distributions import Distribution, Exponential, Lognormal, Normal, Uniform, Values
from clast.rockmass.cut_lines import CONSTRUCTION, WELDED
from clast.rockmass.cut_report import CutReport, Finding, SetReport, Sizes
from clast.rockmass.cutting import Cut, cut, lines
from clast.rockmass.domain import (
    Box,
    Circle,
    Domain,
    Horseshoe,
    Opening,
    Polygon,
    Region,
    Trace,
    profile_outline,
)
from clast.rockmass.joints.joint_models import (
    Baecher,
    CrossJointed,
    Parallel,
    PoissonLines,
    Veneziano,
    Voronoi,
)
from clast.rockmass.joints.joint_set import JointSet
from clast.rockmass.joints.masonry import BlockPattern, RunningBond, StackBond
from clast.rockmass.joints.plan import Fisher, VonMises, apparent
from clast.rockmass.joints.spacing_distributions import Fixed
from clast.rockmass.repair import BlockRepair, Repaired, RepairReport, repaired

__all__ = [
    "CONSTRUCTION",
    "WELDED",
    "Baecher",
    "BlockPattern",
    "BlockRepair",
    "Box",
    "Circle",
    "CrossJointed",
    "Cut",
    "CutReport",
    "Distribution",
    "Domain",
    "Exponential",
    "Finding",
    "Fisher",
    "Fixed",
    "Horseshoe",
    "JointSet",
    "Lognormal",
    "Normal",
    "Opening",
    "Parallel",
    "PoissonLines",
    "Polygon",
    "Region",
    "RepairReport",
    "Repaired",
    "RunningBond",
    "SetReport",
    "Sizes",
    "StackBond",
    "Trace",
    "Uniform",
    "Values",
    "Veneziano",
    "VonMises",
    "Voronoi",
    "apparent",
    "cut",
    "lines",
    "profile_outline",
    "repaired",
]
