"""A case in a notebook: its blocks, and its method."""

from __future__ import annotations

from typing import Any

from clast import thumbnails
from clast.errors import ClastError


def thumbnail_of(case: Any) -> str:
    """Return a case as HTML; one with faults lists them."""
    chosen = case.method_.chosen
    rows: list[tuple[str, object]] = [
        ("process", chosen("process").name),
        ("contact law", chosen("contact_law").name),
        ("step", f"{case.time.step:.6g} s"),
        ("end", f"{case.time.end:.6g} s"),
        ("stages", ", ".join(stage.name for stage in case.stage) or "none"),
    ]
    drawing = ""
    try:
        model = case.model()
        drawing = thumbnails.blocks(model.vertices, model.block_start, model.fixed)
        rows.insert(0, ("blocks", f"{model.block_count} ({int(model.fixed.sum())} fixed)"))
    except ClastError as error:
        rows.append(("cannot be built", str(error)))
    return thumbnails.side_by_side(case.title or case.name, drawing, rows)
