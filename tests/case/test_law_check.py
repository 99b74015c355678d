"""Laws that are none are found, laws that are pass, and a run says which it had."""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest

from clast.case.law_trials import check_law
from clast.contact.laws import AugmentedLagrangian, Carried, Penalty, with_friction
from clast.run.schedule import Schedule
from clast.run.simulate import simulate
from scenes.systems import incline, method


@dataclass(frozen=True)
class Quadratic:
    """N = q d^2 with friction; each fault is a field of the answer that is multiplied."""

    normal_stiffness: float = 1e9
    faults: tuple[tuple[str, float], ...] = ()

    def respond(self, contacts, gap, slip):
        depth = np.maximum(0.0, -gap)
        q = 1e3 * self.normal_stiffness
        response = with_friction(
            contacts,
            slip,
            normal_force=q * depth**2,
            normal_stiffness=2.0 * q * depth,
            energy=q * depth**3 / 3.0,
            shear_stiffness=self.normal_stiffness,
        )
        return replace(response, **{name: f * getattr(response, name) for name, f in self.faults})


@dataclass(frozen=True)
class WithFrictionOfPenalty:
    """Adds to the penalty law's normal force and forgets its friction."""

    normal_stiffness: float = 1e9

    def respond(self, contacts, gap, slip):
        base = Penalty(self.normal_stiffness).respond(contacts, gap, slip)
        depth = np.maximum(0.0, -gap)
        return replace(
            base,
            normal_force=base.normal_force + 1e12 * depth**2,
            normal_stiffness=base.normal_stiffness + 2e12 * depth,
            energy=base.energy + 1e12 * depth**3 / 3.0,
        )


@dataclass(frozen=True)
class Forgetful(Quadratic):
    """Edits the memory it was handed."""

    def respond(self, contacts, gap, slip):
        contacts.shear_force[:] = 0.0
        return super().respond(contacts, gap, slip)


@dataclass(frozen=True)
class OfOneNumber(Quadratic):
    """Gives one number where there is one for each contact."""

    def respond(self, contacts, gap, slip):
        return replace(super().respond(contacts, gap, slip), energy=0.0)


@pytest.mark.parametrize(
    "law",
    [
        Penalty(),
        Penalty(1e8, 3e7),
        AugmentedLagrangian(),
        AugmentedLagrangian(multipliers=Carried()),
        Quadratic(),
        Quadratic(1e6),
    ],
    ids=str,
)
def test_laws_that_hold(law):
    assert check_law(law) == ()


@pytest.mark.parametrize(
    ("field", "factor", "said"),
    [
        ("normal_stiffness", 0.5, "normal_stiffness is not"),
        ("normal_stiffness", -1.0, "normal_stiffness is not"),
        ("shear_stiffness", 2.0, "shear_stiffness is not"),
        ("energy", 0.9, "energy is inconsistent with normal_force"),
        ("normal_force", -1.0, "pull"),
        ("shear_force", 1.1, "exceeds N tan"),
        ("shear_force", 0.9, r"carry only 0\.9 of N tan"),
        ("shear_force", -1.0, "T must be"),
        ("dissipation", 0.0, "T must be"),
        ("dissipation", -1.0, "friction would create energy"),
        ("coupling", 0.0, "coupling is not"),
        ("energy", np.nan, "energy is not finite"),
    ],
)
def test_each_fault_is_found(field, factor, said):
    found = check_law(Quadratic(faults=((field, factor),)))
    assert [text for text in found if re.search(said, text)], found


def test_friction_of_another_normal_force():
    found = check_law(WithFrictionOfPenalty())
    assert found[0].startswith("friction does not follow the law's own normal force")
    assert "with_friction" in found[0]


def test_memory_that_is_changed():
    assert "changes shear_force" in check_law(Forgetful())[0]


def test_answers_of_the_wrong_shape():
    assert check_law(OfOneNumber())[0].startswith("energy has shape ()")


@pytest.mark.parametrize(
    ("law", "warned"), [(WithFrictionOfPenalty(), True), (Quadratic(), False), (Penalty(), False)]
)
def test_a_run_says_what_is_wrong_with_its_law(law, warned):
    model = incline(20.0)
    run = simulate(model, method(contact_law=law), Schedule(step=1e-3, end=0.01, every=0.01))
    said = [text for text in run.report.warnings if "own normal force" in text]
    assert bool(said) == warned
    assert all(text.startswith("contact law WithFrictionOfPenalty: ") for text in said)
