"""Flow in joints that follows equilibria: ``coupling = "steady"``.

Where blocks are in equilibrium apertures are found as they are there, and pressures with them, and
the blocks come to equilibrium again: a fixed point of the apertures, x = g(x).  The second guess is
g(x), as Picard's method has it; later ones combine the last, as Aitken's does for one unknown
(Anderson 1965), in logarithms, for the flow goes with the cube of an aperture.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clast.actions.flow import JointWater, solved_in
from clast.linear.guesses import Guesses
from clast.model.flow.apertures import conductance, hydraulic, of_blocks
from clast.model.flow.given import STEADY, Flow
from clast.model.model import Floats, Model
from clast.model.state import State

PASSES_MAX = 20
"""Equilibria after which the flow is found again at most, in a stage."""


def followed(model: Model, state: State, agrees: float) -> State | None:
    """Return an equilibrium with the flow in its own apertures; None where none has to follow.

    The new flow tells by its ``passes`` that it has been found again, and blocks have to come to
    equilibrium once more; with as many as before, its apertures have changed by less than
    ``agrees``, as a share, or too often.
    """
    flow = model.flow
    row = next((k for k, one in enumerate(state.actions) if isinstance(one, JointWater)), None)
    if flow is None or row is None or flow.coupling != STEADY:
        return None
    water: JointWater = state.actions[row]
    came = hydraulic(model, water.network, of_blocks(model, water.network, state.vertices))
    taken, answer = np.log(water.aperture).ravel(), np.log(came).ravel()
    left = float(np.abs(np.expm1(answer - taken)).max(initial=0.0))
    water = replace(water, left=left)
    if left > agrees and water.passes < PASSES_MAX:
        guesses = Guesses(water.taken, water.came).with_one(taken, answer)
        water = replace(water, taken=guesses.given, came=guesses.answers, passes=water.passes + 1)
        aperture = np.exp(guesses.next_guess()).reshape(water.aperture.shape)
        water = _with_apertures(model, flow, water, aperture)
    actions = (*state.actions[:row], water, *state.actions[row + 1 :])
    return replace(state, actions=actions)


def _with_apertures(model: Model, flow: Flow, water: JointWater, aperture: Floats) -> JointWater:
    """Return water in hydraulic apertures (k, 2), m."""
    length = water.network.length
    flows = conductance(aperture, length, flow.viscosity)
    water = replace(water, aperture=aperture, conductance=flows)
    return replace(water, solved=solved_in(model, water, flow.state, water.solved))


def agreement(state: State) -> tuple[int, float]:
    """Return how often flow and blocks followed each other in this stage, and the change left."""
    water = next(one for one in state.actions if isinstance(one, JointWater))
    return water.passes, water.left
