"""The section of a case that is checked: its blocks as a page draws runs, and the file's own lines.

A case without faults is drawn as the first frame of its run would be, by the page of runs; where
there are faults, the outlines, lines and points that the file gives stand for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from clast.case.case_file import Case
from clast.editor.checking import Checked
from clast.errors import Place
from clast.inputs.declaring.annotations import geometry_of
from clast.inputs.declaring.places import points_of
from clast.inputs.declaring.validation_messages import field_at
from clast.model.model import Model
from clast.model.state import initial_state
from clast.pictures.page.scene import scene_of
from clast.results import Report, RunRecorder


def section_of(checked: Checked) -> dict[str, Any]:
    """Return the content of a window: faults and notes of a case, its scene, its own lines.

    ``scene`` is that of a page, None where there are no blocks; ``lines`` have place, geometry and
    points, m.
    """
    scene = scene_at_start(checked.model) if checked.model is not None else None
    return {
        **checked.as_dict(),
        "title": checked.case.title if checked.case else "",
        "scene": scene,
        "lines": list(lines_of(checked.content)),
    }


def scene_at_start(model: Model) -> dict[str, Any]:
    """Return the content of the page of a run that has not taken a step."""
    recorder, start = RunRecorder(model), initial_state(model)
    recorder.start(start)
    report = Report(
        finished=False,
        outcome="not run",
        steps=0,
        passes=0,
        cut_steps=0,
        largest_contacts=0,
        largest_penetration=0.0,
        ledger=start.ledger,
        wall_seconds=0.0,
    )
    return scene_of(recorder.finish(report), budget=0.0)


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
