"""What is drawn in a picture."""

from __future__ import annotations

import re
from pathlib import Path


def text_of(path: Path) -> str:
    """All words of an SVG picture, in the order in which they are drawn."""
    return " ".join(re.findall(r"<text[^>]*>(?:<tspan[^>]*>)*([^<]*)<", path.read_text()))
