"""Runs in a notebook: their page and their pictures, shown where they are asked for."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clast.pictures import canvas
from clast.pictures.figure_options import DEFAULT, Look
from clast.pictures.notebook.view import page_view
from clast.pictures.page.document import BUDGET
from clast.pictures.page.scene import scene_of
from clast.pictures.plot import draw_results
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Picture:
    """A picture of a frame, which a notebook shows; ``save`` writes it as .png, .pdf or .svg."""

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        """The figure of matplotlib."""

    def save(self, path: Path | str) -> Path:
        """Write it in the format that the name's ending says; return the path.

        Raises CaseError where it cannot be written.
        """
        return canvas.save(self.figure, Path(path))

    def _repr_png_(self) -> bytes:
        written = BytesIO()
        self.figure.savefig(written, format="png")
        return written.getvalue()


def plot(
    results: Recording,
    *,
    frame: int = -1,
    field: str = "displacement",
    contacts: bool = True,
    look: Look = DEFAULT,
) -> Picture:
    """Return the picture of a frame, as ``plot_results`` draws it."""
    return Picture(draw_results(results, frame=frame, field=field, contacts=contacts, look=look))


def page(results: Recording, *, budget: float = BUDGET) -> Any:
    """Return the page of a run for a notebook: a widget where anywidget is there, else a frame."""
    return page_view(scene_of(results, budget))
