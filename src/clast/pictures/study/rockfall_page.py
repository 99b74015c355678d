"""The page of rockfall: all paths over the profile, and one that is played; it asks no network."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from clast.pictures.page.document import closed_page, file, write_html

HERE = "clast.pictures.study"


def write_rocks(scene: dict[str, Any], path: Path) -> Path:
    """Write the page of a scene of paths (title, gravity, lines and paths); return its path."""
    # a closing tag within the data would end it
    data = json.dumps(scene, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    body = [
        file("rocks.html", HERE),
        f'<script type="application/json" id="scene">{data}</script>',
    ]
    script = f"(() => {{\n{file('script/rocks.js', HERE)}\n}})();"
    text = closed_page(scene["title"], body, file("rocks.css", HERE), [script], "'none'")
    return write_html(text, path)
