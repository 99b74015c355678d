"""The section of a case that is checked: its blocks as a page draws runs, and the file's own lines.

A case without faults is drawn as the first frame of its run would be, by the page of runs, with a
frame more for each stage: what is there by then, where nothing has moved.  Where there are faults,
the outlines, lines and points that the file gives stand for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from clast.actions.bolts import Bolting
from clast.actions.linings import linings_of
from clast.actions.relaxation import no_forces
from clast.case.case_file import Case
from clast.case.checking import Checked
from clast.errors import Place
from clast.inputs.declaring.annotations import geometry_of
from clast.inputs.declaring.places import points_of
from clast.inputs.declaring.validation_messages import field_at
from clast.model.model import Model
from clast.model.stages import Stage, flowing
from clast.model.state import State, initial_state
from clast.model.surroundings import blocks_called
from clast.pictures.page.scene import scene_of
from clast.results import Report, RunRecorder


def section_of(checked: Checked) -> dict[str, Any]:
    """Return the content of a window: faults and notes of a case, its scene, its own lines.

    ``scene`` is that of a page, None where there are no blocks; ``lines`` have place, geometry and
    points, m.
    """
    case, model = checked.case, checked.model
    stages = tuple(table.stage() for table in case.stage) if case is not None else ()
    return {
        **checked.as_dict(),
        "title": case.title if case is not None else "",
        "scene": scene_of_stages(model, stages) if model is not None else None,
        "lines": list(lines_of(checked.content)),
    }


def scene_of_stages(model: Model, stages: Sequence[Stage]) -> dict[str, Any]:
    """Return the content of the page of a run that has not moved: its start, and each stage."""
    recorder, start = RunRecorder(model), initial_state(model)
    start = replace(start, actions=(*start.actions, *_water(model, stages, 0)))
    begins = {name: stage.name for stage in stages for name in stage.loads}
    recorder.start(start, {"stages": [stage.name for stage in stages], "begins": begins})
    for number, state in enumerate(states_of_stages(model, start, stages)):
        recorder.enter(number, None)
        recorder.instant(state)
        recorder.frame(state)
    report = Report(finished=False, outcome="not run", ledger=start.ledger)
    return scene_of(recorder.finish(report), budget=0.0)


def states_of_stages(model: Model, start: State, stages: Sequence[Stage]) -> Iterator[State]:
    """Give a state for each stage in which nothing has moved, with bolts and blocks as they are."""
    bolts = model.bolts.without([name for stage in stages for name in stage.install])
    absent, (linings, _) = model.absent, linings_of(model)
    water = _water(model, stages, 0)
    behind = tuple(one.begin(model) for one in model.actions)
    for number, stage in enumerate(stages):
        bolts = bolts.at_stage(stage.name, stage.install)
        absent = absent.copy()
        absent[blocks_called(stage.excavate, model.openings, model.block_name)] = True
        for one in linings.each if linings is not None else ():
            if one.stage == stage.name:
                absent[one.segments] = False
        if model.flow is not None and model.flow.state != "transient":
            water = _water(replace(model, absent=absent), stages, number + 1)
        own = Bolting().begin(replace(model, bolts=bolts)), no_forces(absent), *water, *behind
        yield replace(start, time=number + 1.0, actions=own)


def _water(model: Model, stages: Sequence[Stage], begun: int) -> tuple[Any, ...]:
    """Return the water in joints when so many stages have begun; nothing where none flows."""
    if model.flow is None:
        return ()
    from clast.actions.flow import water_at  # few cases need it

    flow = flowing(model.flow, stages, [0.0] * begun)
    return (water_at(replace(model, flow=flow), 0.0),)


def lines_of(content: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Give the points, lines and outlines of a case file, with their places."""

    def inside(value: Any, place: Place) -> Iterator[dict[str, Any]]:
        known = field_at(Case, place) if place and isinstance(place[-1], str) else None
        points = points_of(value)
        if known is not None and points and (geometry := geometry_of(known)):
            yield {"place": list(place), "geometry": geometry, "points": points}
        elif isinstance(value, dict):
            for key, inner in value.items():
                yield from inside(inner, (*place, key))
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for number, inner in enumerate(value):
                yield from inside(inner, (*place, number))

    return inside(content, ())
