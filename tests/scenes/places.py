"""Where tests and cases are."""

from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
ROOT = TESTS.parent
CASES = ROOT / "src" / "clast" / "case" / "templates"
