"""Opening by slip: a joint dilates within the step in which it slides, at the cost of its shear.

A contact that slides by s opens by kappa s.  Its springs keep the rest of its motion,

    N = N_0 - p (x_n - kappa s),    T = T_0 - k (x_t - s)

x_n and x_t being by how much it opens and slips in the step.  What lifts blocks against N is taken
from T: friction acts on T_s = T + kappa N, and loses T_s s,

    |T_s - kappa N_b| <= N_b tan(phi) + c L,        so that |T| <= N tan(phi) + c L where N = N_b

to either side, with N_b the N that bounds friction.  kappa is tan(psi) away from where the slide
began, and the same back again.  Without s this is the potential of two clipped springs in conjugate
directions, one that does not slide and one that does,

    flank     along n - kappa t                    stiffness k p/K      K = k + kappa^2 p
    slider    along (kappa p n + k t)/K            stiffness K          force T_s

    N = flank + kappa p T_s/K,    T = T_s - kappa N

It is convex, whatever p, k and kappa are (the flank is that of an asperity: Patton 1966).  Where a
contact lands, or its friction would not last until it opens, it opens by all of its slip in the
step: its flank has p, and its slider k along t.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clast.contact.clipped_spring import Clipped, Rows, Springs, no_springs, table
from clast.contact.contacts import ContactResponse, Contacts
from clast.contact.joints.barton_bandis import mobilised, rough_contacts, stress_on
from clast.contact.laws import SpringLaw, clipped
from clast.model.joints import JointTable
from clast.model.model import Bools, Floats, Ints
from clast.read_only import changed

BACK = 1e-12
"""Share of its energy that a chord of the rising strength may give back."""


@dataclass(frozen=True, kw_only=True)
class Pair:
    """The flanks and the sliders of contacts, (k,) each."""

    flank: Clipped
    """Of the force along n - kappa t, against x_n - kappa x_t."""
    slider: Clipped
    """Of T_s, against (kappa p x_n + k x_t)/K."""
    lifts: Floats
    """kappa p/K, N by T_s."""
    slips: Floats
    """k/K."""
    keeps: Bools
    """True where springs keep what is no slide; else the contact opens by all of its slip."""


@dataclass(frozen=True, kw_only=True)
class Slides:
    """How contacts with a slope slide in a step, (k,) each."""

    normal: Floats
    """N, N/m."""
    friction: Floats
    """T_s, N/m."""
    begun: Floats
    """T_s when the step begins, N/m."""
    unbound: Floats
    """T_s of a contact that would not slide, N/m."""
    rubbed: Floats
    """Slide against friction, m."""
    slid: Floats
    """s, by which they have opened, m."""
    keeps: Bools
    """As Pair.keeps."""


@dataclass(frozen=True, kw_only=True)
class Asperities:
    """The law of contacts of which some open by their slip within the step."""

    law: SpringLaw
    joints: JointTable
    slope: Floats
    """kappa, opening by slide, 0 where a contact opens by nothing, shape (m,)."""
    elastic: Floats
    """Stiffness with which shear springs give back, N/m per m, shape (m,)."""
    lets_go: Bools
    """True where a contact that slides back is about to open, shape (m,)."""
    flanks: Rows = field(default_factory=lambda: slice(0))
    """Where the flanks are in the table of springs, shape (k,)."""
    sliders: Rows = field(default_factory=lambda: slice(0))
    """Where the sliders are, likewise."""

    @property
    def normal_stiffness(self) -> float:
        """Normal contact stiffness p of the law, N/m per m."""
        return self.law.normal_stiffness

    @cached_property
    def rows(self) -> Ints:
        """The contacts with a slope, shape (k,)."""
        return np.flatnonzero(self.slope)

    def pair(self, both: tuple[Clipped, Clipped], contacts: Contacts) -> Pair:
        """Return flanks and sliders of the contacts' normal and shear springs, ``both`` (m,)."""
        rows, kappa = self.rows, self.slope[self.rows]
        n, p, low, _ = (one[rows] for one in both[0].arrays)
        t, k, least, most = (one[rows] for one in both[1].arrays)
        n = n - p * contacts.gap[rows]
        shift = kappa * contacts.friction_base[rows]
        least, most = least + shift, most + shift
        side, whole = np.where(kappa > 0.0, least, most), k + kappa**2 * p
        # where the friction of a slide lasts until the contact opens
        keeps = (n > low) & ~contacts.mobilises[rows] & ~self.lets_go[rows]
        keeps &= n - low >= kappa * p / whole * (t + kappa * n - side)
        whole = np.where(keeps, whole, k)
        lifts = np.where(keeps, kappa * p / whole, 0.0)
        begun = t + kappa * np.maximum(n, 0.0)
        begun = np.where(keeps, t + kappa * n, np.clip(begun, -np.abs(t), np.abs(t)))
        return Pair(
            flank=Clipped(
                n - lifts * begun, k * p / whole, low - lifts * side, np.full(len(rows), np.inf)
            ),
            slider=Clipped(begun, whole, least, most),
            lifts=lifts,
            slips=k / whole,
            keeps=keeps,
        )

    # --- in the table of springs

    def links(self, contacts: Contacts) -> Springs:
        """Return links for flanks or for sliders (k,), without springs yet."""
        nothing = no_springs(len(self.rows))
        links, _ = table(
            vertex_block=contacts.vertex_block[self.rows],
            edge_block=contacts.edge_block[self.rows],
            arms=contacts.arms[self.rows],
            gap=nothing.at_zero,
            slip=nothing.at_zero,
            normal=nothing,
            shear=nothing,
        )
        return links

    def put(
        self, springs: Springs, among: Rows, both: tuple[Clipped, Clipped], contacts: Contacts
    ) -> Springs:
        """Return the table with the springs of the contacts, which are at ``among``, in it.

        ``both`` are normal and shear springs (m,).
        """
        rows, kappa, pair = self.rows, self.slope[self.rows, None], self.pair(both, contacts)
        nothing = no_springs(len(rows))
        normal = contacts.arms[rows, :2]
        along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
        flank = normal - kappa * along
        slider = pair.lifts[:, None] * normal + pair.slips[:, None] * along
        # the shear spring of a link acts to the left of its normal
        across = np.stack([slider[:, 1], -slider[:, 0]], axis=1)
        long, wide = np.hypot(*flank.T), np.hypot(*slider.T)
        arms = springs.arms.copy()
        arms[self.flanks, :2] = flank / long[:, None]
        arms[self.sliders, :2] = across / wide[:, None]
        # what prescribed motions add to the stretches of contacts they add to these
        gap, slip = springs.gap.copy(), springs.slip.copy()
        opened, slipped = gap[among][rows] - contacts.gap[rows], slip[among][rows]
        gap[self.flanks] = (opened - kappa[:, 0] * slipped) / long
        slip[self.sliders] = (pair.lifts * opened + pair.slips * slipped) / wide
        springs = changed(springs, arms=arms, gap=gap, slip=slip)
        springs = springs.put(among, both[0].put(rows, nothing), both[1].put(rows, nothing))
        springs = springs.put(self.flanks, _along(pair.flank, long), nothing)
        return springs.put(self.sliders, nothing, _along(pair.slider, wide))

    def normal_forces(
        self, among: Rows, forces: tuple[Floats, Floats], contacts: Contacts
    ) -> Floats:
        """Return N of the contacts, N/m, (m,), from N and T of the whole table."""
        rows, pair = self.rows, self.pair(clipped(self.law, contacts), contacts)
        flank = forces[0][self.flanks] / np.hypot(1.0, self.slope[rows])
        slider = forces[1][self.sliders] / np.hypot(pair.lifts, pair.slips)
        normal = forces[0][among].copy()
        normal[rows] = flank + pair.lifts * slider
        return normal

    # --- the law

    def slides(self, contacts: Contacts, gap: Floats, slip: Floats) -> Slides:
        """Return how contacts with a slope slide to gaps and slips (m,), m."""
        rows, kappa = self.rows, self.slope[self.rows]
        pair = self.pair(clipped(self.law, contacts), contacts)
        opened, slipped = gap[rows] - contacts.gap[rows], slip[rows]
        stretch = opened - kappa * slipped
        flank = np.maximum(pair.flank.at_zero - pair.flank.stiffness * stretch, pair.flank.low)
        stretch = pair.lifts * opened + pair.slips * slipped
        unbound = pair.slider.at_zero - pair.slider.stiffness * stretch
        friction = np.clip(unbound, pair.slider.low, pair.slider.high)
        rubbed = (friction - unbound) / pair.slider.stiffness
        return Slides(
            normal=flank + pair.lifts * friction,
            friction=friction,
            begun=pair.slider.at_zero,
            unbound=unbound,
            rubbed=rubbed,
            slid=np.where(pair.keeps, rubbed, slipped),
            keeps=pair.keeps,
        )

    def respond(self, contacts: Contacts, gap: Floats, slip: Floats) -> ContactResponse:
        """Return N and T at gaps and slips (m,) of the end of the step, m, and their energies."""
        rows, kappa = self.rows, self.slope[self.rows]
        slides, (normal, shear) = self.slides(contacts, gap, slip), clipped(self.law, contacts)
        # bonds, modes and energies are those that the law gives to these forces
        remembered, gap, slip = contacts.shear_force.copy(), gap.copy(), slip.copy()
        at_rest = (normal.at_zero[rows] - slides.normal) / normal.stiffness[rows]
        gap[rows] = np.where(slides.normal > normal.low[rows], at_rest, at_rest + 1.0)
        remembered[rows] = slides.unbound - kappa * contacts.friction_base[rows]
        slip[rows] = 0.0
        answer = self.law.respond(changed(contacts, shear_force=remembered), gap, slip)
        force, t, lost = (
            one.copy() for one in (answer.normal_force, answer.shear_force, answer.dissipation)
        )
        of_normal = answer.energy - 0.5 * t**2 / shear.stiffness
        force[rows], t[rows] = slides.normal, slides.friction - kappa * slides.normal
        lost[rows] = -slides.friction * slides.rubbed
        # a chord of the rising strength is softer than the spring that gives back
        softer = 1.0 / shear.stiffness - 1.0 / self.elastic
        own, begun = t.copy(), contacts.shear_force.copy()
        own[rows] = np.where(slides.keeps, own[rows], slides.friction)
        begun[rows] = np.where(slides.keeps, begun[rows], slides.begun)
        lost += 0.5 * (own**2 - begun**2) * softer
        lost += 0.5 * (contacts.shear_force**2 - begun**2) / self.elastic
        rough = rough_contacts(self.joints, contacts.joint)
        if rough is not None:
            length = contacts.spring_length[rough.rows]
            of_normal[rough.rows] = length * rough.energy(stress_on(force[rough.rows], length))
        return changed(
            answer,
            normal_force=force,
            shear_force=t,
            energy=of_normal + 0.5 * own**2 / self.elastic,
            dissipation=lost,
        )

    def given_back(self, contacts: Contacts, response: ContactResponse) -> Bools:
        """Return which contacts are unloaded along a chord of the rising strength, (m,)."""
        least = -BACK * contacts.shear_force**2 / self.elastic
        return np.asarray(contacts.mobilises & (response.dissipation < least))

    def without_chords(self, contacts: Contacts, these: Bools) -> Contacts:
        """Return the contacts with the springs that give back in place of chords."""
        return changed(
            contacts,
            mobilises=contacts.mobilises & ~these,
            shear_stiffness=np.where(these, self.elastic, contacts.shear_stiffness),
        )


def _along(spring: Clipped, size: Floats) -> Clipped:
    """Return a spring along unit vectors that acts along others of a ``size`` (k,)."""
    at_zero, stiffness, low, high = spring.arrays
    return Clipped(size * at_zero, size**2 * stiffness, size * low, size * high)


def as_pressed(joints: JointTable, contacts: Contacts) -> Contacts:
    """Return contacts whose rough springs begin with the forces of the last step.

    The tangents of closure meet there, whatever the gap is: what it has beyond the hyperbola is
    where work has been lacking.
    """
    rough = rough_contacts(joints, contacts.joint)
    if rough is None:
        return contacts
    is_rough = joints.rough.take(contacts.joint) & contacts.known
    is_rough &= (contacts.normal_force > 0.0) | (contacts.gap < 0.0)
    normal = np.maximum(contacts.normal_force, 0.0)
    begins = (contacts.rest_force - normal) / contacts.normal_stiffness
    gap = np.where(is_rough, begins, contacts.gap)
    return changed(
        contacts,
        gap=gap,
        rest_gap=contacts.rest_gap + contacts.gap - gap,
        multiplier=np.where(is_rough, 0.0, contacts.multiplier),
    )


def _slopes_of(joints: JointTable, contacts: Contacts) -> Floats:
    """Return the opening of contacts by slide along t from where they are, (m,)."""
    tangent, until = (one.take(contacts.joint) for one in joints.dilation)
    away = np.abs(contacts.slide)
    slope = np.where(away < until, tangent, 0.0)
    rough = rough_contacts(joints, contacts.joint)
    if rough is not None:
        rows = rough.rows
        stress = stress_on(contacts.normal_force[rows], contacts.spring_length[rows])
        share = mobilised(away[rows] / rough.peak_slip)
        slope[rows] = np.tan(0.5 * share * rough.roughness_angle(stress))
    return np.asarray(slope * np.sign(contacts.slide))


def over_asperities(
    joints: JointTable, law: SpringLaw, contacts: Contacts, motion: tuple[Floats, Floats]
) -> tuple[Contacts, Asperities]:
    """Return the contacts of a step, and their law.

    ``motion`` is by how much velocities open and slip them, m, (m,) each: only those that slide by
    it have a slope, and those that have not slid yet take its direction from it.
    """
    own = joints.stiffnesses[1].take(contacts.joint) * contacts.spring_length
    rough = joints.rough.take(contacts.joint)
    held = changed(
        contacts,
        friction_base=np.maximum(contacts.normal_force, 0.0),
        shear_stiffness=np.where(rough, own, contacts.shear_stiffness),
    )
    limits, (opened, slipped) = law.limits(held), motion
    elastic = limits.shear_stiffness
    trial = contacts.shear_force - elastic * slipped
    first = -np.sign(trial) * joints.dilation[0].take(contacts.joint)
    slope = np.where((contacts.slide == 0.0) & ~rough, first, _slopes_of(joints, contacts))
    slides = contacts.mobilises | (np.abs(trial) > limits.strength)
    slope = np.where(slides, slope, 0.0)
    # a chord is no stiffer than the spring that gives back
    chords = contacts.mobilises & (contacts.shear_stiffness < elastic)
    stiffness = np.where(contacts.mobilises & ~chords, elastic, contacts.shear_stiffness)
    contacts = changed(contacts, mobilises=chords, shear_stiffness=stiffness)
    slope = np.clip(slope, -contacts.friction, contacts.friction)
    normal, _ = clipped(law, held)
    ahead = normal.at_zero - normal.stiffness * (contacts.gap + opened)
    lets_go = (slope * trial > 0.0) & (ahead <= normal.low)
    return contacts, Asperities(
        law=law, joints=joints, slope=slope, elastic=elastic, lets_go=lets_go
    )
