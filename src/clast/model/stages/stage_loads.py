"""Loads, water and tables that stages name.

They do not act before, and their time counts from there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from clast.model.factors import NO_FACTOR, Factor
from clast.model.model import Model
from clast.model.stages.stage import Stage
from clast.model.water.water import Water

KINDS = {"point_loads": "force", "line_loads": "traction", "pressures": "pressure"}
"""Loads of a model -> their values, which are 0 while they do not act."""


def load_names(model: Model) -> tuple[str, ...]:
    """Return the names of loads, pressures, water and tables that stages may name."""
    named = (*names_that_act(model), *(factor.name for factor in model.factors))
    return tuple(dict.fromkeys(named))


def names_that_act(model: Model) -> tuple[str, ...]:
    """Return the names of loads, pressures and water."""
    named = [name for kind in KINDS for name in getattr(model, kind).name if name]
    return *named, *(water.name for water in model.water if water.name)


def with_loads(
    model: Model, base: Model, stages: Sequence[Stage], starts: Sequence[float]
) -> Model:
    """Return a model with the loads that act when so many stages have begun at ``starts``, s.

    ``base`` has all of them.  The table of a load that a stage names begins with that stage, as a
    table does that it names itself.
    """
    begun = {
        name: starts[number] if number < len(starts) else None
        for number, stage in enumerate(stages)
        for name in stage.loads
    }
    factors = [_begun(factor, begun) for factor in base.factors]
    loads = {
        kind: _acting(getattr(base, kind), values, begun, base.factors, factors)
        for kind, values in KINDS.items()
    }
    water = tuple(standing(one, begun) for one in base.water)
    return replace(model, **loads, water=water, factors=tuple(factors))


def _begun(factor: Factor, begun: Mapping[str, float | None]) -> Factor:
    """Return a table as it is after the stages that have begun: 0 before that which names it."""
    if factor.name not in begun:
        return factor
    start = begun[factor.name]
    if start is None:
        return replace(factor, value=np.zeros_like(factor.value))
    return replace(factor, time=factor.time + start)


def standing(water: Water, begun: Mapping[str, float | None]) -> Water:
    """Return water as it stands: none before the stage that names it.

    ``begun`` has when the stages that name loads and tables have begun, s; None: not yet.
    """
    if water.name and water.name in begun:
        start = begun[water.name]
        if start is None:
            return replace(water, share=0.0, factor=None)
        if water.factor is not None:
            return replace(water, factor=replace(water.factor, time=water.factor.time + start))
    if water.factor is not None:
        return replace(water, factor=_begun(water.factor, begun))
    return water


def factors_in(model: Model) -> tuple[Factor, ...]:
    """Return the tables of all loads and waters."""
    return *model.factors, *(one.factor for one in model.water if one.factor is not None)


def _acting(
    loads: Any,
    values: str,
    begun: Mapping[str, float | None],
    tables: Sequence[Factor],
    factors: list[Factor],
) -> Any:
    """Return loads of one kind as they act; tables that begin later are put behind ``factors``."""
    size, number = getattr(loads, values).copy(), loads.factor.copy()
    own: dict[tuple[str, int], int] = {}
    for row, name in enumerate(loads.name):
        if name not in begun:
            continue
        start = begun[name]
        if start is None:
            size[row] = 0.0
        elif number[row] != NO_FACTOR:
            table = int(number[row])
            if (name, table) not in own:
                own[name, table] = len(factors)
                factors.append(replace(tables[table], time=tables[table].time + start))
            number[row] = own[name, table]
    return replace(loads, **{values: size}, factor=number)


def are_constant(factors: Sequence[Factor], time: float) -> bool:
    """Return whether no table changes any more after a time, s."""
    return all(
        time >= factor.time[-1]
        or bool((factor.value[np.searchsorted(factor.time, time) - 1 :] == factor.at(time)).all())
        for factor in factors
    )
