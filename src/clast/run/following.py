"""The flow in joints follows the equilibrium of a stage, or of a static run, which then goes on."""

from __future__ import annotations

from dataclasses import replace

from clast.actions.following import agreement, followed
from clast.model.model import Model
from clast.model.stage_records import Event
from clast.model.stages import Stage
from clast.run.run_state import RunState
from clast.run.stages.stage_position import EquilibriumStreak, Judgement


def after_equilibrium(model: Model, now: RunState, stage: Stage) -> RunState:
    """Return a run in equilibrium with the flow in its apertures.

    Blocks have to come to equilibrium again where these have changed by more than the force_ratio
    of the stage; else an event says how well they agree.
    """
    state = followed(model, now.state, stage.force_ratio)
    if state is None:
        return now
    passes, left = agreement(state)
    if passes == agreement(now.state)[0]:
        many = "an equilibrium" if passes == 0 else f"{passes + 1} equilibria"
        text = f"flow and apertures agree to {left:.2g} after {many}"
        event = Event(time=state.time, stage=stage.name, kind="flow agrees", what="", text=text)
        return replace(now, state=state, events=(*now.events, event))
    now = replace(now, state=state)
    if now.position is not None:
        now = replace(now, position=replace(now.position, held=EquilibriumStreak()))
    if now.path is not None:
        path = replace(now.path, steps=0, balanced=False, judged=Judgement())
        now = replace(now, path=path)
    return now
