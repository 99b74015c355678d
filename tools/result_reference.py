"""Write the reference of the result file, docs/reference/result-file.md, from its schema.

    python tools/result_reference.py            # writes the page
    python tools/result_reference.py -          # prints it

The schema, clast.results.schema, is what files are written, checked and read by.  A test compares
the page with what this writes.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from clast.inputs.declaring.field_docs import field_docstrings
from clast.model.state import Ledger
from clast.results import schema
from clast.results.schema import Column, Per, TableSchema

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "result-file.md"

HEAD = """\
# The result file

Written by `make reference` from the schema by which clast writes, checks and reads result files. A
file is HDF5; its group `/VTKHDF` is a temporal VTKHDF grid that ParaView opens. Units are SI per
metre of thickness, stresses tension-positive in the order xx, yy, xy. Datasets of supports are only
there where a model has these supports.

In Python `run.table("energy")` is a table with a row per instant or step, `run.table("history",
"A")` that of a measured point; `run.field("stress")` is a field, `run.contacts(5)` are the contacts
of a frame. All are columns that pandas takes. `clast export FILE --to csv` writes the same tables.

"""


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table as Markdown."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(one)} |" for one in lines) + "\n"


def of_columns(columns: Iterable[Column], meanings: dict[str, str]) -> str:
    """Return the table of some columns; ``meanings`` say more of some."""
    return table(
        ("column", "type", "unit", "meaning"),
        [
            (
                f"`{one.name}`",
                one.kind + (f" ({', '.join(one.parts)})" if one.parts else ""),
                one.unit or "-",
                _meaning(one, meanings.get(one.name, "")),
            )
            for one in columns
        ],
    )


def _meaning(column: Column, more: str) -> str:
    words = ", ".join(f"{k} {word}" for k, word in enumerate(column.words))
    parts = (column.meaning, more[:1].lower() + more[1:].rstrip("."), words)
    return ": ".join(part for part in parts if part)


def of_table(one: TableSchema) -> str:
    """Return the section of a table."""
    meanings = field_docstrings(Ledger) if one is schema.ENERGY else {}
    place = f"{one.of.path}/NAME" if one.of is not None and one.of.path else one.name
    rows = "any number of rows per frame" if one.per is Per.FRAME else f"a row per {one.per.value}"
    return f"## /{place}\n\n{one.meaning} Table, {rows}.\n\n{of_columns(one.timed, meanings)}"


def page() -> str:
    """Return the page as Markdown."""
    fields = table(
        ("array", "row of", "components", "meaning", "written"),
        [
            (
                f"`{one.place}`",
                "block" if one.of_blocks else "vertex",
                ", ".join(one.parts) or "-",
                one.about,
                "once" if one.per is Per.RUN else "each frame",
            )
            for one in schema.FIELDS
        ],
    )
    model = table(("dataset", "meaning"), [(f"`{one.name}`", one.meaning) for one in schema.MODEL])
    parts = [
        f"## /VTKHDF\n\nArrays of all frames, one frame after the other.\n\n{fields}",
        f"## /frames\n\nA row per frame.\n\n{of_columns(schema.FRAMES, {})}",
        *map(of_table, schema.TABLES),
        "## /model\n\nWhat was simulated, beside its text (`case`), how (`about`), and its water."
        f"\n\n{model}",
    ]
    return HEAD + "\n".join(parts)


if __name__ == "__main__":
    if sys.argv[1:] == ["-"]:
        sys.stdout.write(page())
    else:
        PAGE.write_text(page(), encoding="utf-8")
