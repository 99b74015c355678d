"""Restitution of a rock's centre over the angle of impact: the trend of tests.

R_n and R_t of the contact do not depend on the angle; ratios of the centre do.  On a rough face a
flat path meets slopes that face it, and is thrown up.  Spin scatters the tangential velocity by a
part of the whole speed, of which a steep path has little along the plane: speeds, which tests
measure, grow, while the mean with its sign stays (2 + R_t)/3, as of a disc.
"""

import numpy as np

from clast.trajectory import path
from clast.verification.problems import Floats, Trial, problem
from clast.verification.rocks import FLOOR, PATHS, blows_of, falling, picture, regular, rock_at

ANGLES = (20.0, 35.0, 50.0, 65.0, 80.0)
"""Angles of impact between path and plane, degrees."""
SPEED, CORNERS, ROCKS = 8.0, 12, 400
"""Speed, m/s, corners, and rocks for each angle."""
SURFACE = {"normal_restitution": 0.5, "tangential_restitution": 0.5, "friction_angle": 30.0}
ROUGHNESS = 15.0
QUANTITIES = {"R_n": -1.0, "R_t": 1.0, "R_E": -1.0}
"""Ratio after to before of the centre -> 1 where tests have it rise with the angle, or -1."""


def ratios(degrees: float, roughness: float) -> Floats:
    """Return R_n, R_t and R_E of the centre, and R_t with its sign, of rocks at an angle, (4,).

    R_t is the root of a mean square, the others are means.
    """
    angle, found = np.radians(degrees), []
    speed = SPEED * np.array([np.cos(angle), -np.sin(angle)])
    keys = {"velocity": speed.tolist(), "rocks": ROCKS, "corners": CORNERS, "elongation": 1.0}
    source = {**rock_at(regular(CORNERS), (-10.0, 0.6)), **keys}
    del source["shape"]
    surface = {**SURFACE, "roughness": roughness}
    rocks = falling(FLOOR, surface, source, 0.0, rockfall={"time_limit": 1.0})
    for number in range(1, ROCKS + 1):
        one = rocks.follow(number)
        blow = blows_of(one)[0]
        u, v, w = blow[path.AFTER : path.FACE]
        mass, inertia, _ = one.rock.numbers
        energy = (u * u + v * v + inertia / mass * w * w) / SPEED**2
        found.append([-v / speed[1], (u / speed[0]) ** 2, energy, u / speed[0]])
    mean = np.mean(found, axis=0)
    return np.array([mean[0], np.sqrt(mean[1]), *mean[2:]])


@problem(
    set_up=lambda: picture([(-2, 0), (2, 0)], regular(CORNERS), (0, 0.6)),
    variants=(PATHS,),
    quick=(PATHS,),
)
def rock_angle(trial: Trial) -> None:
    """Restitution over the angle of impact.

    400 random rocks of 12 corners strike a plane at 8 m/s without spin, at angles of 20 to 80
    degrees between path and plane; R_n = R_t = 0.5 and 30 degrees of friction at the contact, whose
    face is turned by 15 degrees (standard deviation). Compared is whether the ratios of the centre
    change from angle to angle as in tests with polyhedra of limestone on concrete: R_t of speeds,
    as the root of its mean square. On a smooth face, R_t with its sign is that of a disc.

    Exact: R_n and R_E fall and R_t rises with the angle, no numbers, for the tests are
    three-dimensional; (2 + R_t)/3 with its sign.
    Source: trend of the tests of Wang et al. 2018, Nat. Hazards Earth Syst. Sci. 18, 3045.
    """
    found = np.array([ratios(degrees, ROUGHNESS) for degrees in ANGLES])
    chart = trial.chart("ratios of the centre", "angle of impact, degrees", "after over before")
    for k, (name, sign) in enumerate(QUANTITIES.items()):
        right = float((sign * np.diff(found[:, k]) > 0.0).mean())
        word = "rises" if sign > 0.0 else "falls"
        trial.absolute(f"share of angles over which {name} {word}", "", right, 1.0, 0.0, "trend")
        chart.computed(ANGLES, found[:, k], name)
    disc = (2.0 + SURFACE["tangential_restitution"]) / 3.0
    for degrees in (ANGLES[0], ANGLES[3]):
        mean, quantity = ratios(degrees, 0.0)[3], f"mean R_t with its sign at {degrees:g} degrees"
        trial.absolute(quantity, "", mean, disc, 0.02, "corners beside a circle, and chance")
