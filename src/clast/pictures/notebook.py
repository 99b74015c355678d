"""Runs in a notebook: their page and their pictures, shown where they are asked for."""

from __future__ import annotations

import json
from html import escape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from clast.pictures import canvas
from clast.pictures.figure_options import DEFAULT, Look
from clast.pictures.page.document import BUDGET, page_text, widget_script
from clast.pictures.page.scene import scene_of
from clast.pictures.plot import draw_on, draw_results
from clast.results import Recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class PageFrame:
    """The page in a frame of a notebook; it sees nothing of the notebook."""

    def __init__(self, scene: dict[str, Any]) -> None:
        self._text = page_text(scene)

    def _repr_html_(self) -> str:
        # scripts run, but as those of a page from elsewhere
        return (
            f'<iframe srcdoc="{escape(self._text)}" sandbox="allow-scripts allow-downloads" '
            'style="width:100%;height:640px;border:1px solid #ccc"></iframe>'
        )


def page_view(scene: dict[str, Any]) -> Any:
    """Return the view of a scene in a notebook: a widget where anywidget is there, else a frame."""
    try:
        from anywidget import AnyWidget
        from traitlets import Unicode
    except ImportError:
        return PageFrame(scene)

    class PageWidget(AnyWidget):  # type: ignore[misc]
        """The page as a widget."""

        _esm = widget_script()
        scene = Unicode("null").tag(sync=True)

        def _repr_mimebundle_(self, **kwargs: Any) -> Any:
            # a notebook that is saved, exported or printed has no widget any more
            data, about = super()._repr_mimebundle_(**kwargs)
            return {**data, "text/html": PageFrame(scene)._repr_html_()}, about

    return PageWidget(scene=json.dumps(scene, allow_nan=False, separators=(",", ":")))


class Picture:
    """A picture of a frame, which a notebook shows; ``save`` writes it as .png, .pdf or .svg."""

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        """The figure of matplotlib."""

    def save(self, path: Path | str) -> Path:
        """Write it in the format that the name's ending says; return the path."""
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
    contacts: bool | None = None,
    look: Look = DEFAULT,
    ax: Axes | None = None,
) -> Picture:
    """Return the picture of a frame, as ``plot_results`` draws it; on ``ax`` without arrows."""
    if ax is not None:
        draw_on(ax, results, frame=frame, field=field, look=look)
        return Picture(cast("Figure", ax.get_figure()))
    return Picture(draw_results(results, frame=frame, field=field, contacts=contacts, look=look))


def page(results: Recording, *, budget: float = BUDGET) -> Any:
    """Return the page of a run for a notebook: a widget where anywidget is there, else a frame."""
    return page_view(scene_of(results, budget))
