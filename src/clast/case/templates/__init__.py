"""Cases to begin with, the TOML files beside this one: ``clast new NAME --template wall``."""

from __future__ import annotations

from pathlib import Path

NAMES = (
    "incline",
    "slope",
    "dam",
    "tunnel",
    "lined-tunnel",
    "key-block",
    "wall",
    "shaken-wall",
    "settling-wall",
    "arch",
    "spreading-arch",
    "arch-bridge",
    "column",
    "dominoes",
    "shear-box",
    "heap",
    "rockfall",
)
FOLDER = Path(__file__).parent
TEMPLATES = {name: (FOLDER / f"{name}.toml").read_text(encoding="utf-8") for name in NAMES}
"""Name -> text of a case file."""
INCLINE = TEMPLATES["incline"]
