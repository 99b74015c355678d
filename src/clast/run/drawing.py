"""Blocks that leave at drawpoints after a step: caving, hoppers."""

from __future__ import annotations

from collections.abc import Sequence

from clast.block import polygon
from clast.model.model import Model
from clast.model.stage_records import DRAWN, Event
from clast.model.state import State


def drawn(model: Model, state: State, events: Sequence[Event], stage: str) -> list[Event]:
    """Return the events of the blocks that leave in a state, by their numbers in ``block``.

    ``events`` are those before, whose drawn mass counts for the rate.
    """
    starts = {name: at for name, at in model.begun} | {"": 0.0}
    active = [one for one in model.drawpoints if one.stage in starts]
    if not active:
        return []
    before = polygon.moments(model.vertices, model.block_start)[1]
    now = polygon.moments(state.vertices, model.block_start)[1]
    gone = model.absent | model.fixed
    left: list[Event] = []
    for point in active:
        mass = sum(one.mass for one in events if one.kind == DRAWN and one.what == point.name)
        room = point.rate * (state.time - starts[point.stage]) - mass
        past = point.past(before, now)
        for block in past[~gone[past]].tolist():
            heavy = float(model.mass[block])
            if heavy > room or model.absent.sum() + len(left) == model.block_count - 1:
                continue  # the last block stays: a model has one
            gone[block], room = True, room - heavy
            text = f"block '{model.block_name[block]}' of {heavy:.6g} kg/m leaves at '{point.name}'"
            left.append(
                Event(
                    time=state.time,
                    stage=stage,
                    kind=DRAWN,
                    what=point.name,
                    text=text,
                    block=block,
                    mass=heavy,
                )
            )
    return left
