"""Contacts that are found deep inside in a dynamic step begin with no more force than there was.

Contact detection picks a vertex and an edge anew in every step.  On soft springs a contact can come
up, or pass to another edge, where the vertex has long been behind it: its spring would begin as
stretched as it had never been pulled, and the blocks would get that energy for nothing.  Such a
contact begins with the force that it, or the contact it takes over from within its pair of blocks,
ended the last step with; from there its spring follows the gap.  The spring's point of rest lies
behind the edge then, and comes back: with the vertex, and by a share of critdis in each step, so
that blocks lie in each other by no more than their forces explain.  Its work is part of the
energy that the time integration brings in.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.compute.jit import kernel
from clast.compute.reductions import is_any
from clast.contact.contacts import Contacts
from clast.contact.laws import has_multipliers, normal_stiffness_of
from clast.model.model import Floats, Model
from clast.model.state import State, contact_keys
from clast.step.method import Method

SLACK_CRITDIS = 0.02
"""Gaps may differ by so much from one step to the next unasked, in units of critdis: turning blocks
move on arcs, which the linear gap of a step does not know."""
COMES_BACK_CRITDIS = 0.005
"""How far a point of rest comes back to its edge in a step, in units of critdis: slowly, so that a
block that slides on to one that lies higher is not thrown."""


def relieved(model: Model, method: Method, state: State, contacts: Contacts) -> Contacts:
    """Return the contacts with multipliers (m,), N/m, below 0 where springs rest behind an edge.

    Of contacts that have no multipliers of their law.  An overlap at the start of a run is taken
    as it is.
    """
    law = method.contact_law
    if state.time == 0.0 or not len(contacts):
        return contacts
    known = contacts.normal_force, contacts.gap, contacts.multiplier, contacts.rest_force
    springs = contacts.normal_stiffness, contacts.spring_share, law.normal_stiffness
    if _rest_at_edges(known, springs, method.critdis):
        return contacts
    own = np.isnan(contacts.normal_stiffness) & has_multipliers(law)
    stiffness = normal_stiffness_of(contacts, law)
    slack = stiffness * SLACK_CRITDIS * method.critdis
    held, before = np.maximum(contacts.normal_force, 0.0), contacts.multiplier
    rest = held + stiffness * contacts.gap - contacts.rest_force
    sunk = rest < before - slack
    if model.joint_table.opens and method.dynamic_ratio == 0.0:
        # what has opened after a static step, and rough closure, begin the next with other forces
        sunk &= ~model.joint_table.dilates.take(contacts.joint)
    if is_any(sunk):
        taken_over = _left_over(model, state, contacts, sunk)
        more = np.hypot(held, taken_over) - held
        rest = np.where(sunk, rest + more, rest)
    # where a spring carries its point of rest comes back; where it is open that follows the vertex
    nearer = before + stiffness * COMES_BACK_CRITDIS * method.critdis
    follows = np.where(held > 0.0, nearer, np.maximum(rest, before))
    rest = np.minimum(np.where(sunk, rest, follows), 0.0)
    return replace(contacts, multiplier=np.where(own, contacts.multiplier, rest))


@kernel()
def _rest_at_edges(known, springs, critdis):
    """Return whether no contact begins too deep, and none has a multiplier already.

    ``known`` are N, gap, multiplier and rest force (m,), ``springs`` the stiffness that joints give
    (m,), the share of the law's that contacts have (m,), and that of the law.
    """
    normal, gap, multiplier, rest_force = known
    of_joint, share, of_law = springs
    for c in range(len(gap)):
        stiffness = share[c] * of_law if np.isnan(of_joint[c]) else of_joint[c]
        rest = max(normal[c], 0.0) + stiffness * gap[c] - rest_force[c]
        if multiplier[c] != 0.0 or rest < multiplier[c] - stiffness * SLACK_CRITDIS * critdis:
            return False
    return True


def _left_over(model: Model, state: State, contacts: Contacts, wanting: np.ndarray) -> Floats:
    """Return the force, N/m, that each of the contacts ``wanting`` (m,) takes over, (m,).

    That of contacts of the same pair of blocks that are no more; as much as keeps their energy.
    """
    memory, body, width = state.memory, model.body, model.block_count
    own, other = body[model.vertex_block[memory.vertex]], body[memory.block]
    carried, count = memory.normal_force > 0.0, len(model.vertices)
    # a vertex takes its force along to the next edge, a point inside a face does not
    into = body[contacts.edge_block]
    known = contact_keys(contacts.vertex, into, contacts.point, count)
    ended = carried & ~np.isin(contact_keys(memory.vertex, other, memory.point, count), known)
    taken: Floats = np.zeros(len(contacts))
    if not ended.any():
        return taken
    lower, higher = np.sort(body[contacts.pairs[contacts.pair]], axis=1).T
    of_contact = lower * width + higher
    of_memory = np.minimum(own, other) * width + np.maximum(own, other)
    for pair in np.unique(of_memory[ended]):
        heirs = wanting & (of_contact == pair)
        force = float(np.sum(memory.normal_force[ended & (of_memory == pair)] ** 2))
        taken[heirs] = np.sqrt(force / max(1, int(heirs.sum())))
    return taken
