"""The page of a run within a notebook: by anywidget, or in a frame of its own."""

from __future__ import annotations

import json
from html import escape
from typing import Any

from clast.pictures.page.document import page_text, widget_script

HEIGHT = 640
"""Height of a page in a notebook, pixels."""


class PageFrame:
    """The page in a frame of a notebook; it sees nothing of the notebook."""

    def __init__(self, scene: dict[str, Any]) -> None:
        self._text = page_text(scene)

    def _repr_html_(self) -> str:
        # scripts run, but as those of a page from elsewhere
        return (
            f'<iframe srcdoc="{escape(self._text)}" sandbox="allow-scripts allow-downloads" '
            f'style="width:100%;height:{HEIGHT}px;border:1px solid #ccc"></iframe>'
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
