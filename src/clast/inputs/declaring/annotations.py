"""What else a declaration says of a key: its geometry, read from its type."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

Geometry = Literal["point", "polyline", "polygon"]


@dataclass(frozen=True)
class Drawn:
    """Annotation of a key that is somewhere in the section."""

    geometry: Geometry


def marks_of(field: FieldInfo) -> Iterator[Any]:
    """Give the annotations of a key, those of each of its types too; of items of lists none."""
    yield from field.metadata
    yield from _marks(field.annotation)


def _marks(annotation: Any) -> Iterator[Any]:
    origin = get_origin(annotation)
    if origin is Annotated:
        yield from annotation.__metadata__
    if origin in (Annotated, Union, UnionType):
        for part in get_args(annotation):
            yield from _marks(part)


def geometry_of(field: FieldInfo) -> Geometry | None:
    """Return how the section shows a key, None where it does not."""
    return next((one.geometry for one in marks_of(field) if isinstance(one, Drawn)), None)
