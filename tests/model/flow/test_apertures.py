"""Apertures of channels: gap, closure by stress, hydraulic laws, and the conductance of a wedge."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.model.flow.apertures import at_start, conductance, hydraulic
from clast.model.flow.network import network_of
from clast.model.joints import Hydraulics
from clast.model.model import Model
from scenes import wet_rock


def test_the_conductance_of_a_wedge_is_its_integral():
    """L / int ds/a^3, by Gauss' points."""
    aperture = np.array([[1e-4, 3e-4], [2e-4, 2e-4], [5e-4, 1e-5]])
    at, weight = np.polynomial.legendre.leggauss(200)
    t = 0.5 * (1.0 + at)
    a = aperture[:, :1] + t * (aperture[:, 1:] - aperture[:, :1])
    exact = 1.0 / (12e-3 * 2.5 * (0.5 * weight / a**3).sum(axis=1))
    np.testing.assert_allclose(conductance(aperture, np.full(3, 2.5), 1e-3), exact, rtol=1e-10)


def of(law: str, aperture: float, **numbers: float) -> float:
    water = Hydraulics(aperture=2e-4, residual=1e-5, maximum=1e-3, law=law, **numbers)
    return float(water.of(np.array([aperture]))[0])


def test_hydraulic_laws_by_hand():
    assert of("cubic", 2e-4) == 2e-4
    assert of("cubic", 2e-4, flow_factor=1.331) == pytest.approx(2e-4 / 1.1, rel=1e-12)
    # 100 micrometres and JRC 4: 100^2/32 micrometres; wider than JRC^2.5 it is the mechanical one
    assert of("barton", 1e-4, jrc=1.0 * 16**0.4) == pytest.approx(1e-4, rel=1e-12)
    assert of("barton", 2e-5, jrc=4.0) == pytest.approx(20.0**2 / 32.0 * 1e-6, rel=1e-12)
    assert of("barton", 5e-4, jrc=4.0) == 5e-4
    assert of("louis", 2e-4, relative_roughness=0.25) == pytest.approx(2e-4 / 2.1 ** (1 / 3))
    # bounds
    assert of("cubic", -1e-3) == 1e-5
    assert of("cubic", 5e-3) == 1e-3


def pressed(**joint: object) -> Model:
    """Return two blocks about a joint at 30 degrees, under stress at depth."""
    builder = clast.ModelBuilder(gravity=(0.0, -9.81))
    builder.add_rock("stone", young=50e9, poisson=0.2, density=2600.0)
    builder.add_joint(**joint)
    x = np.sqrt(3.0)
    builder.block(vertices=[(0, 0), (x, 1), (x, -1)])
    builder.block(vertices=[(0, 0), (0, 2), (x, 1)])
    builder.in_situ = {"stress": [-2e6, -3e6, 0.5e6], "gradient": [0.0, -2e4, 0.0], "datum": 1.0}
    return builder.build()


def aperture_of(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Return the apertures of its channel from left to right, and the normal stress there, Pa."""
    network = network_of(model)
    assert len(network.length) == 1
    aperture = hydraulic(model, network, at_start(model, network))[0]
    at = network.at[network.node[0]]
    order = np.argsort(at[:, 0])
    yy = -3e6 - 2e4 * (1.0 - at[order, 1])
    sine, cosine = 0.5, np.sqrt(0.75)
    normal = -2e6 * sine**2 + yy * cosine**2 - 2.0 * 0.5e6 * sine * cosine
    return aperture[order], -normal


def test_stress_closes_a_joint_by_its_stiffness():
    aperture, stress = aperture_of(
        pressed(friction_angle=30.0, normal_stiffness=4e10, aperture=2e-4)
    )
    np.testing.assert_allclose(aperture, 2e-4 - stress / 4e10, rtol=1e-9)
    aperture, _ = aperture_of(pressed(friction_angle=30.0, aperture=2e-4))
    np.testing.assert_allclose(aperture, 2e-4, rtol=1e-9)
    # all but closed: the residual one
    aperture, _ = aperture_of(pressed(friction_angle=30.0, normal_stiffness=1e10, aperture=2e-4))
    np.testing.assert_allclose(aperture, 2e-5, rtol=1e-9)


def test_a_rough_joint_closes_along_the_hyperbola_of_bandis():
    keys = {"jrc": 8.0, "jcs": 80e6, "residual_friction_angle": 28.0, "initial_aperture": 3e-4}
    model = pressed(law="barton-bandis", **keys)
    aperture, stress = aperture_of(model)
    rough = model.joint_table.joints[0].roughness
    closed = stress / (rough.stiffness + stress / rough.closure)
    np.testing.assert_allclose(aperture, 3e-4 - closed, rtol=1e-9)


def test_a_gap_adds_to_the_aperture():
    model = wet_rock.rock_of(
        [
            np.array(one, float)
            for one in ([(0, -1), (2, -1), (2, 0), (0, 0)], [(0, 1e-4), (2, 3e-4), (2, 1), (0, 1)])
        ],
        maximum_aperture=1e-2,
    )
    network = network_of(model)
    x = network.at[network.node[0], 0] + model.origin[0]
    aperture = hydraulic(model, network, at_start(model, network))[0]
    np.testing.assert_allclose(aperture, 3e-4 + 1e-4 * x, rtol=1e-7)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"aperture": 0.2}, "0.2 m is too large for the aperture"),
        ({"aperture": 1e-8}, "1e-08 m is too small for the aperture"),
        ({"aperture": 1e-4, "residual_aperture": 2e-4}, "is more than the aperture"),
        ({"aperture": 1e-4, "maximum_aperture": 5e-5}, "is less than the aperture"),
        ({"residual_aperture": 2e-5}, "belongs to a joint with an aperture"),
        ({"aperture": 1e-4, "hydraulic_law": "barton"}, 'hydraulic_law = "barton" needs it'),
        ({"aperture": 1e-4, "hydraulic_law": "louis"}, 'hydraulic_law = "louis" needs it'),
        ({"aperture": 1e-4, "relative_roughness": 0.2}, "belongs to a joint with hydraulic_law"),
        (
            {"aperture": 1e-4, "hydraulic_law": "louis", "relative_roughness": 0.02},
            "hydraulically smooth",
        ),
    ],
)
def test_broken_joints_are_refused(keys, said):
    builder = clast.ModelBuilder()
    with pytest.raises(clast.errors.ClastError, match=said):
        builder.add_joint(**keys)
