"""A contact law in plain NumPy, put into a method from outside."""

from dataclasses import dataclass

import numpy as np
import pytest

from clast.contact.contacts import ContactResponse
from clast.step.convex import Convex
from clast.step.modified import Modified
from scenes.systems import at_start, box, centroids, incline, march, method, slide, system

PROCESSES = {
    "lagged": Modified(),
    "three passes": Modified(passes=3),
    "convex": Convex(),
}
TIME, STEP = 0.3, 2e-3


@dataclass(frozen=True)
class Hardening:
    """N = p d + p2 d^2 for a penetration d > 0; Coulomb friction with a shear spring."""

    normal_stiffness: float = 1e8
    hardening: float = 1e12
    shear_stiffness: float = 2e9

    def respond(self, contacts, gap, slip):
        """Return forces and stiffnesses for gaps and slips at the end of the step."""
        depth = np.maximum(0.0, -gap)
        normal = self.normal_stiffness * depth + self.hardening * depth**2
        stiffness = np.where(depth > 0.0, self.normal_stiffness + 2.0 * self.hardening * depth, 0.0)
        pressing = np.where(np.isnan(contacts.friction_base), normal, contacts.friction_base)
        bound = pressing * contacts.friction
        trial = contacts.shear_force - self.shear_stiffness * slip
        shear = np.clip(trial, -bound, bound)
        sticks = (np.abs(trial) <= bound) & (bound > 0.0)
        slides = (depth > 0.0) & ~sticks
        own_bound = np.isnan(contacts.friction_base)
        return ContactResponse(
            normal_force=normal,
            shear_force=shear,
            normal_stiffness=stiffness,
            shear_stiffness=np.where(sticks, self.shear_stiffness, 0.0),
            coupling=np.where(slides & own_bound, np.sign(trial) * contacts.friction, 0.0),
            mode=np.where(sticks, 2, np.where(slides, 1, 0)),
            bonded=np.zeros(len(gap), np.bool_),
            energy=0.5 * self.normal_stiffness * depth**2
            + self.hardening * depth**3 / 3.0
            + 0.5 * shear**2 / self.shear_stiffness,
            dissipation=np.abs(shear) * np.abs(trial - shear) / self.shear_stiffness,
        )

    def depth(self, force):
        """Return the penetration, m, under a force, N/m."""
        half = 0.5 * self.normal_stiffness / self.hardening
        return np.sqrt(half**2 + force / self.hardening) - half


def moved(model, how, step=STEP, end=TIME):
    """Return how far the blocks move, m, and the last result."""
    last = march(model, how, step, end)[-1]
    return centroids(model, last.state) - centroids(model, at_start(model)), last


@pytest.mark.parametrize("angle", [0.0, 30.0])
@pytest.mark.parametrize("process", PROCESSES)
def test_hardening_law_drives_the_incline(process, angle):
    model = incline(angle)
    how = method(process=PROCESSES[process], contact_law=Hardening(), max_displacement=0.02)
    way, _ = moved(model, how)
    assert way[1] == pytest.approx([slide(angle, TIME), -slide(angle, TIME)], rel=0.02)


@pytest.mark.parametrize("process", PROCESSES)
def test_hardening_law_settles_at_its_own_penetration(process):
    model = system([box(-1, -1, 3.0), box(0, 0)], fixed=[0])
    how = method(process=PROCESSES[process], contact_law=Hardening(), dynamic_ratio=0.0)
    way, last = moved(model, how, step=2e-3, end=0.3)
    weight = model.mass[1] * 9.8
    assert last.penetration == pytest.approx(Hardening().depth(0.5 * weight), rel=1e-3)
    assert last.response.normal_force.sum() == pytest.approx(weight, rel=1e-3)
    assert way[1, 1] == pytest.approx(-last.penetration, rel=0.05)
