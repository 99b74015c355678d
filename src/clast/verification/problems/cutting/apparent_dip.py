"""Joint planes as a section shows them: apparent dip and spacing."""

from dataclasses import dataclass

import numpy as np

from clast.rockmass import Domain, JointSet, apparent, cut
from clast.verification.fixtures import CUT, drawing_of, lines_of
from clast.verification.problems import Model, Trial, box, problem

SIDE, SPACING = 40.0, 0.8
"""Side of the section and spacing in space, m."""
DIPS = (30.0, 60.0, 85.0)
"""Dips of the curves, degrees."""
ROUND_OFF = "round-off"


@dataclass(frozen=True)
class JointPlane:
    """A joint plane and the section that it is seen in, degrees."""

    dip: float
    direction: float
    azimuth: float

    def __str__(self) -> str:
        return f"{self.dip:g}/{self.direction:g} in a section along {self.azimuth:g}"

    def angle(self) -> float:
        """Return the angle of the trace, degrees in (-90, 90]."""
        if self.dip == 90.0:
            return 90.0
        d, off = np.radians(self.dip), np.radians(self.direction - self.azimuth)
        return float(-np.degrees(np.arctan(np.tan(d) * np.cos(off))))

    def factor(self) -> float:
        """Return the spacing in the section over that in space."""
        d, off = np.radians(self.dip), np.radians(self.direction - self.azimuth)
        return float(1.0 / np.hypot(np.sin(d) * np.cos(off), np.cos(d)))


PLANES = (
    JointPlane(60, 90, 90),
    JointPlane(60, 270, 90),
    JointPlane(60, 130, 90),
    JointPlane(35, 150, 90),
    JointPlane(75, 10, 90),
    JointPlane(60, 0, 90),
    JointPlane(90, 45, 90),
    JointPlane(5, 200, 120),
)


def section(azimuth: float) -> Domain:
    """Return a square section along an azimuth, degrees."""
    return Domain(boundary=box(0, 0, SIDE, SIDE), section_azimuth=azimuth)


def joints(plane: JointPlane) -> JointSet:
    """Return the joints along a plane at their spacing in space."""
    return JointSet(
        name=str(plane),
        dip=plane.dip,
        dip_direction=plane.direction,
        spacing=SPACING,
        spacing_is="true",
    )


def measured(plane: JointPlane) -> tuple[float, float]:
    """Return angle, degrees in (-90, 90], and spacing, m, of the lines that a section shows."""
    ends = lines_of(joints(plane), section(plane.azimuth))
    displacement = ends[:, 1] - ends[:, 0]
    longest = displacement[np.hypot(*displacement.T).argmax()]
    angle = 90.0 - (90.0 - np.degrees(np.arctan2(longest[1], longest[0]))) % 180.0
    normal = np.array([-longest[1], longest[0]]) / np.hypot(*longest)
    return float(angle), float(np.median(np.diff(np.sort(ends[:, 0] @ normal))))


def _drawing() -> Model:
    corners = box(0, 0, 12, 8)
    sets = [joints(plane) for plane in PLANES[2:5]]
    return drawing_of(
        cut(Domain(boundary=corners, section_azimuth=90.0), sets), "Three planes in a section"
    )


@problem(set_up=_drawing, variants=(CUT,), quick=(CUT,))
def apparent_dip(trial: Trial) -> None:
    """Joint planes in a section.

    Eight joint planes, given by dip and dip direction, at a true spacing of 0.8 m, cut a section;
    angle and spacing of the lines that it shows. The picture has three of them.

    Exact: tan b = -tan d cos(D - a); spacing s/sqrt(sin2 d cos2(D - a) + cos2 d).
    Source: normals of planes; Priest (1993), Discontinuity analysis for rock engineering.
    """
    for plane in PLANES:
        angle, spacing = measured(plane)
        trial.absolute(f"angle of {plane}", "degrees", angle, plane.angle(), 1e-9, ROUND_OFF)
        exact = SPACING * plane.factor()
        trial.relative(f"spacing of {plane}", "m", spacing, exact, 1e-9, ROUND_OFF)
    fine, marks = np.linspace(0.0, 180.0, 181), np.arange(0.0, 181.0, 20.0)
    labels = "dip direction less azimuth of the section, degrees", "angle in the section, degrees"
    chart = trial.chart("apparent dip", *labels)
    for dip in DIPS:
        exact_angles = [JointPlane(dip, one, 0.0).angle() for one in fine]
        chart.exact(f"dip {dip:g} degrees", fine, exact_angles)
    seen = [apparent(dip, float(one), 0.0)[0] for dip in DIPS for one in marks]
    chart.computed(np.tile(marks, len(DIPS)), seen)
