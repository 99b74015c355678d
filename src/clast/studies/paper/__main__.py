"""``python -m clast.studies.paper FOLDER PAGE``: the cases in a folder become a page."""

from __future__ import annotations

import sys
from pathlib import Path

from clast.studies.paper import reproduce

if __name__ == "__main__":
    reproduce(*(Path(argument) for argument in sys.argv[1:3]))
