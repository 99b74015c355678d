"""The consistency of a contact law: forces, stiffnesses, energies and friction belong together.

A law that is put in from a script may be wrong in ways that no run shows: friction bounded by
another normal force than its own, a stiffness that is not a derivative of its force, energies that
do not belong to the forces.  They are compared here with differences between neighbouring gaps and
slips.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from itertools import chain

import numpy as np

from clast.contact.contacts import SLIDE, ContactResponse, Contacts
from clast.contact.laws import ContactLaw, has_limits
from clast.model.model import Bools, Floats

DEPTHS = -8.0, -2.5
"""Powers of ten between which penetrations are drawn, m."""
CLOSE = 1e-3
"""Differences up to this share of the compared values are put down to rounding and curvature."""


def warnings_of(law: ContactLaw, contacts: Contacts) -> tuple[str, ...]:
    """Return a run's warnings about its contact law, tried on some of its contacts."""
    if has_limits(law):  # of one kernel, which has its own tests
        return ()
    name = type(law).__name__
    return tuple(f"contact law {name}: {fault}" for fault in faults_of(law, contacts))


def faults_of(law: ContactLaw, contacts: Contacts) -> tuple[str, ...]:
    """Return the faults of a contact law, tried on these contacts."""
    if not len(contacts):
        return ()
    trial = _trial(law, _spread(contacts, 300))
    malformed = tuple(_malformed(trial))
    if malformed:
        return malformed
    checks = (_friction_base, _within_strength, _normal_side, _shear_side)
    return tuple(chain.from_iterable(check(trial) for check in checks))


@dataclass(frozen=True)
class _Trial:
    """A law with contacts, gaps (m,) and slips (m,) to try it on, m."""

    law: ContactLaw
    contacts: Contacts
    gap: Floats
    slip: Floats

    def free(self, gap: Floats, slip: Floats) -> ContactResponse:
        """Return the answer where the law's own normal force bounds friction."""
        none = np.full(len(gap), np.nan)
        return self.law.respond(replace(self.contacts, friction_base=none), gap, slip)

    def bound(self, gap: Floats, slip: Floats) -> ContactResponse:
        """Return the answer where friction is bounded by the normal force at ``self.gap``."""
        base = self.free(self.gap, self.slip).normal_force
        return self.law.respond(replace(self.contacts, friction_base=base), gap, slip)


def _trial(law: ContactLaw, contacts: Contacts) -> _Trial:
    """Return contacts to try a law on: gaps and slips of many sizes, some shear force."""
    rng, count = np.random.default_rng(1), len(contacts)
    size = 10.0 ** rng.uniform(*DEPTHS, count)
    gap = np.where(rng.random(count) < 0.8, -size, size)
    slip = size * 10.0 ** rng.uniform(-1.5, 1.5, count) * rng.choice([-1.0, 1.0], count)
    # multipliers and tension shift energies by what no gap gives back
    zero = np.zeros(count)
    contacts = replace(contacts, multiplier=zero, tensile_strength=zero, shear_force=zero)
    normal = law.respond(contacts, gap, slip).normal_force
    if np.shape(normal) == (count,):
        remembered = rng.uniform(-0.5, 0.5, count) * contacts.friction * normal
        contacts = replace(contacts, shear_force=remembered)
    return _Trial(law, contacts, gap, slip)


def _malformed(trial: _Trial) -> Iterator[str]:
    """Yield responses that are not arrays of finite numbers, and arguments that were changed."""
    given = {f.name: getattr(trial.contacts, f.name) for f in fields(Contacts)}
    given |= {"gap given": trial.gap, "slip given": trial.slip}
    before = {name: np.copy(values) for name, values in given.items()}
    response = trial.free(trial.gap, trial.slip)
    for name, values in given.items():
        if not np.array_equal(values, before[name], equal_nan=values.dtype.kind == "f"):
            yield f"evaluating the law changes {name}; it must not change its arguments"
    count = len(trial.gap)
    for field in fields(ContactResponse):
        values = np.asarray(getattr(response, field.name))
        if values.shape != (count,):
            yield f"{field.name} has shape {values.shape}; it must be ({count},), as gap is"
        elif not np.isfinite(values).all():
            yield f"{field.name} is not finite everywhere"


def _friction_base(trial: _Trial) -> Iterator[str]:
    """Yield a fault where friction follows another normal force than the law's own."""
    free, bound = trial.free(trial.gap, trial.slip), trial.bound(trial.gap, trial.slip)
    bearing = free.normal_force > 0.0
    if (bearing & _differ(free.shear_force, bound.shear_force, free.normal_force)).any():
        most = bearing & (bound.shear_force != 0.0)
        ratio = np.abs(free.shear_force[most] / bound.shear_force[most])
        worst = ratio[np.argmax(np.abs(np.log(np.maximum(ratio, 1e-300))))]
        yield (
            "friction does not follow the law's own normal force: without friction_base the shear "
            f"force is {worst:.3g} times that with friction_base = normal_force. Bound it by the N "
            "that the law returns, as clast.contact.laws.with_friction does"
        )


def _within_strength(trial: _Trial) -> Iterator[str]:
    """Yield faults where contacts pull, or carry other forces than Coulomb's law gives."""
    response, contacts = trial.free(trial.gap, trial.slip), trial.contacts
    normal, shear = response.normal_force, np.abs(response.shear_force)
    if (normal < 0.0).any():
        yield "contacts without tensile strength pull: normal_force must be 0 or more"
    strength = np.maximum(0.0, normal * contacts.friction + contacts.cohesion * contacts.length)
    strength[normal <= 0.0] = 0.0
    beyond = shear > (1.0 + CLOSE) * strength + CLOSE * normal
    if beyond.any():
        share = float((shear - strength)[beyond].max())
        yield f"the shear force exceeds N tan(phi) + c L by up to {share:.3g} N/m"
    sliding = (response.mode == SLIDE) & (strength > 0.0)
    short = sliding & _differ(shear, strength, normal) & ~beyond
    if short.any():
        share = float((shear[short] / strength[short]).min())
        yield f"sliding contacts carry only {share:.3g} of N tan(phi) + c L"


def _normal_side(trial: _Trial) -> Iterator[str]:
    """Yield faults of N: its stiffness is -dN/dgap, N is -dE/dgap, the coupling dT/dN."""
    # without slip the energy is that of the normal force alone
    still = replace(trial.contacts, shear_force=np.zeros(len(trial.gap)))
    alone = replace(trial, contacts=still)
    here, rate, smooth = _rates(alone.bound, trial.gap, 0.0 * trial.slip, along_gap=True)
    normal, stiffness = here.normal_force, here.normal_stiffness
    size = np.abs(stiffness)
    if (smooth & _differ(-rate.normal_force, stiffness, size)).any():
        yield "normal_stiffness is not -dN/dgap"
    if (smooth & _differ(-(rate.energy + rate.dissipation), normal, np.abs(normal))).any():
        yield "energy is inconsistent with normal_force: N must be -dE/dgap"
    here, rate, smooth = _rates(trial.free, trial.gap, trial.slip, along_gap=True)
    size = np.abs(rate.normal_force)
    if (smooth & _differ(rate.shear_force, here.coupling * rate.normal_force, size)).any():
        yield (
            "coupling is not dT/dN: where a contact slides under its own N it is tan(phi) with the "
            "sign of T, else 0"
        )


def _shear_side(trial: _Trial) -> Iterator[str]:
    """Yield faults of T: its stiffness is -dT/dslip, T is -d(E + loss)/dslip, no loss below 0."""
    here, rate, smooth = _rates(trial.bound, trial.gap, trial.slip, along_gap=False)
    shear, stiffness = here.shear_force, here.shear_stiffness
    if (smooth & _differ(-rate.shear_force, stiffness, np.abs(stiffness))).any():
        yield "shear_stiffness is not -dT/dslip"
    size = np.abs(shear) + CLOSE * np.abs(here.normal_force)
    if (smooth & _differ(-(rate.energy + rate.dissipation), shear, size)).any():
        yield (
            "energy and dissipation are inconsistent with shear_force: T must be -d(energy + "
            "dissipation)/dslip"
        )
    if (here.dissipation < 0.0).any():
        yield "dissipation is negative: friction would create energy"


def _rates(
    respond: Callable[[Floats, Floats], ContactResponse],
    gap: Floats,
    slip: Floats,
    *,
    along_gap: bool,
) -> tuple[ContactResponse, ContactResponse, Bools]:
    """Return the answer, its rates by differences, and where no change of mode is near."""
    # Gaps and slips are changed by this share of themselves to measure the change of forces
    step = 1e-4 * np.abs(gap if along_gap else slip)
    shift = (step, 0.0 * step) if along_gap else (0.0 * step, step)
    here = respond(gap, slip)
    low, high = respond(gap - shift[0], slip - shift[1]), respond(gap + shift[0], slip + shift[1])
    names = ("normal_force", "shear_force", "energy", "dissipation")
    rates = {n: (getattr(high, n) - getattr(low, n)) / (2.0 * step) for n in names}
    return here, replace(here, **rates), (low.mode == here.mode) & (high.mode == here.mode)


def _differ(one: Floats, other: Floats, size: Floats) -> Bools:
    """Return where two numbers differ by more than a small share of ``size`` (m,) or themselves."""
    return np.abs(one - other) > CLOSE * np.maximum(size, np.maximum(np.abs(one), np.abs(other)))


def _spread(contacts: Contacts, count: int) -> Contacts:
    """Return ``count`` of the contacts, in their order; the pairs stay together."""
    which = np.linspace(0, len(contacts) - 1, count).astype(np.int64)
    rows = {f.name: getattr(contacts, f.name) for f in fields(Contacts) if f.name != "pairs"}
    return Contacts(**{name: values[which] for name, values in rows.items()}, pairs=contacts.pairs)
