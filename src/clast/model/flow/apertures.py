"""Apertures of channels, and how well these conduct water.

The mechanical aperture is that without stress, a0, with the gap and less the closure,
E = a0 + max(g, 0) - N/(k_n L); for a rough joint its closure is the hyperbola of Bandis.  The
hydraulic one follows from it by the law of the joint, and is linear between the two straight faces:
the conductance of a wedge is exact,

    q = C dp,    C = 2 a1^2 a2^2 / (a1 + a2) / (12 mu L).
"""

from __future__ import annotations

import numpy as np

from clast.model.arrays import Floats, Ints
from clast.model.flow.channels import Network, faces_at
from clast.model.joints import Joint
from clast.model.model import Model


def at_start(model: Model, network: Network) -> Floats:
    """Return the mechanical apertures of channels as blocks lie at the start, m, shape (k, 2).

    Closed by the stress in the rock, where joints have a stiffness and contacts carry it.
    """
    faces = faces_at(network, model.vertices, model.vertex_after)
    along = _along(faces)
    gap = gaps(network, model.vertices, model.vertex_after)
    pressed = np.zeros(gap.shape)
    if model.in_situ is not None:
        y = 0.5 * (faces[:, 0, :, 1] + faces[:, 1, :, 1]) + model.origin[1]
        xx, yy, xy = model.in_situ.at(y.ravel()).T.reshape(3, -1, 2)
        x, z = along[:, None, 1], -along[:, None, 0]
        pressed = -model.in_situ.in_contacts * (xx * x * x + yy * z * z + 2.0 * xy * x * z)
    return mechanical(model, network, gap, pressed)


def of_blocks(model: Model, network: Network, vertices: Floats) -> Floats:
    """Return the mechanical apertures with blocks at ``vertices`` (nv, 2), m, shape (k, 2).

    Springs of joints carry N by a closure of as much as N/(k_n L), so that faces have come nearer
    by it: the gap g, below 0 where they overlap, tells both.  Other springs close no joint.
    """
    after, joints = model.vertex_after, model.joint_table.joints
    at_first = np.maximum(gaps(network, model.vertices, after), 0.0)
    closes = [one.normal_stiffness is not None or one.roughness is not None for one in joints]
    gap = gaps(network, vertices, after)
    gap = np.where(np.array(closes)[network.joint, None], gap, np.maximum(gap, 0.0))
    return at_start(model, network) + (gap - at_first)


def gaps(network: Network, vertices: Floats, after: Ints) -> Floats:
    """Return the distance of the faces of channels at both ends, m, below 0 for overlap, (k, 2).

    Blocks are at ``vertices`` (nv, 2), m.
    """
    faces = faces_at(network, vertices, after)
    along, away = _along(faces), faces[:, 1] - faces[:, 0]
    # the second face lies to the right of the first
    return np.asarray(away[..., 0] * along[:, None, 1] - away[..., 1] * along[:, None, 0])


def _along(faces: Floats) -> Floats:
    """Return the unit vectors along the first faces (k, face, end, 2) of channels, (k, 2)."""
    line = faces[:, 0, 1] - faces[:, 0, 0]
    return np.asarray(line / np.hypot(*line.T)[:, None])


def mechanical(model: Model, network: Network, gap: Floats, pressed: Floats) -> Floats:
    """Return the mechanical apertures of channels, m, shape (k, 2).

    ``gap`` (k, 2), m, and normal stress ``pressed`` (k, 2), Pa, compression positive, are those at
    their ends.
    """
    aperture = np.maximum(gap, 0.0)
    stress = np.maximum(pressed, 0.0)
    for number, joint in enumerate(model.joint_table.joints):
        rows = network.joint == number
        if rows.any():
            aperture[rows] += joint.aperture_without_stress - _closure(joint, stress[rows])
    return aperture


def hydraulic(model: Model, network: Network, aperture: Floats) -> Floats:
    """Return the hydraulic apertures of mechanical ones (k, 2), m, by the laws of the joints."""
    result = np.zeros(aperture.shape)
    for number, joint in enumerate(model.joint_table.joints):
        rows = network.joint == number
        if rows.any() and joint.hydraulics is not None:
            result[rows] = joint.hydraulics.of(aperture[rows])
    return result


def conductance(aperture: Floats, length: Floats, viscosity: float) -> Floats:
    """Return the conductance of channels, m2/(s Pa), (k,), with hydraulic apertures (k, 2), m."""
    first, last = aperture.T
    cube = 2.0 * first**2 * last**2 / (first + last)
    return np.asarray(cube / (12.0 * viscosity * length))


def _closure(joint: Joint, stress: Floats) -> Floats:
    """Return by how much a normal stress closes a joint, m; nothing where it has no stiffness."""
    rough = joint.roughness
    if rough is not None:  # Bandis, Lumsden & Barton (1983)
        return np.asarray(stress * rough.closure / (rough.stiffness * rough.closure + stress))
    if joint.normal_stiffness is None:
        return np.zeros(stress.shape)
    return stress / joint.normal_stiffness
