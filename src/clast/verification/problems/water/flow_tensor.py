"""Two sets of joints conduct water as their tensor: linear heads, and the flux of Snow."""

import numpy as np

from clast.actions.flow import water_at
from clast.rockmass import JointSet, cut
from clast.verification.fixtures import CUT, cut_rock, rectangle
from clast.verification.problems import Floats, Model, Trial, problem

SIDE, APERTURE, VISCOSITY, GRAVITY = 20.0, 2e-4, 1e-3, 9.81
SPACINGS, BETWEEN = (1.0, 1.3), 70.0
"""Spacings of the sets, m, and the angle between them, degrees."""
GRADIENT = np.array([0.01, -0.02])
"""Fall of the head by length."""
ANGLES = (0.0, 17.0, 45.0)
"""Directions of the first set, degrees."""


def rock(angle: float = 17.0) -> Model:
    """Return a square of rock with linear heads all round; ``angle`` of the first set, degrees."""
    sets = [
        JointSet(name=f"set {k}", angle=angle + k * BETWEEN, spacing=one, origin=(0.3, 0.4))
        for k, one in enumerate(SPACINGS)
    ]
    domain = rectangle(SIDE, SIDE, smallest_block=0.0, smallest_edge=0.0)
    builder = cut_rock("Two sets of joints", cut(domain, sets), aperture=APERTURE)
    builder.flow = {"viscosity": VISCOSITY, "confined": True}
    builder.flow_boundary("tight", side="left", impermeable=True)
    ends = builder.build().flow
    assert ends is not None and ends.network is not None
    network = ends.network
    builder = cut_rock("Two sets of joints", cut(domain, sets), aperture=APERTURE)
    builder.flow = {"viscosity": VISCOSITY, "confined": True}
    for at in network.at[network.outer]:
        line = [at - 1e-4, at + 1e-4]
        builder.flow_boundary(edges=[line], head=float(-at @ GRADIENT), presses=False)
    return builder.build()


def exact_flux(angle: float, intensity: Floats) -> Floats:
    """Return sum k P21 (I - n n) J, m/s, of sets with intensities, m/m2, shape (2,)."""
    conducts = 1000.0 * GRAVITY * APERTURE**3 / (12.0 * VISCOSITY)
    flux = np.zeros(2)
    for one, direction in zip(intensity, np.radians([angle, angle + BETWEEN]), strict=True):
        along = np.array([np.cos(direction), np.sin(direction)])
        flux += conducts * one * along * (along @ GRADIENT)
    return flux


@problem(set_up=rock, variants=(CUT,), quick=(CUT,))
def flow_tensor(trial: Trial) -> None:
    """Conductivity of two joint sets.

    Two sets 1.0 m and 1.3 m apart, 70 degrees to each other, through a square of 20 m at three
    angles; heads on its outline fall linearly. Compared are heads inside, and the mean flux with
    the lengths of joint by area that the cut has.

    Exact: h = -J x; v = sum (rho g a^3/12 mu) P21 (I - n n) J.
    Source: Snow (1969).
    Not run with: modified and open-close and convex: nothing moves.
    """
    reason = "corners of cut blocks are rounded"
    sizes = []
    for angle in ANGLES:
        model = rock(angle)
        water = water_at(model, 0.0)
        network, solved = water.network, water.solved
        head = -(network.at + model.origin) @ GRADIENT
        height = network.at[:, 1] + model.origin[1]
        missed = np.abs(solved.pressure / (1000.0 * GRAVITY) + height - head).max()
        quantity = f"largest error of heads, {angle:g} degrees"
        trial.absolute(quantity, "m", float(missed), 0.0, 1e-6, reason)
        line = network.at[network.node[:, 1]] - network.at[network.node[:, 0]]
        flux = (solved.flow[:, None] * line).sum(axis=0) / SIDE**2
        along = line / network.length[:, None]
        first = np.abs(along @ [np.cos(np.radians(angle)), np.sin(np.radians(angle))]) > 0.999
        lengths = np.array([network.length[first].sum(), network.length[~first].sum()])
        exact = exact_flux(angle, lengths / SIDE**2)
        for k, axis in enumerate("xy"):
            quantity = f"flux along {axis}, {angle:g} degrees"
            trial.relative(quantity, "m/s", float(flux[k]), float(exact[k]), 1e-5, reason)
        sizes.append(float(np.hypot(*flux)))
    fine = np.linspace(0.0, 90.0, 91)
    chart = trial.chart("mean flux", "direction of the first set, degrees", "flux, m/s")
    by_spacing = [np.hypot(*exact_flux(one, 1.0 / np.array(SPACINGS))) for one in fine]
    chart.exact("P₂₁ = 1/s", fine, by_spacing)
    chart.computed(ANGLES, sizes)
