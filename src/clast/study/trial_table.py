"""The table of a study, rebuilt from the result of each run, in the order of their numbers.

Nothing in it depends on time, machine or who made which run: the same study gives the same bytes.
Rows go through one at a time, so that a table may be of any length.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import Any

from clast.errors import CaseError
from clast.rockmass.drawings.drawing_files import replaced, write_rows
from clast.study.description import COLLAPSE, Description
from clast.study.folder import StudyFolder

CSV, PARQUET = "results.csv", "results.parquet"
OF_TRIALS = ("factor", "verdict", "displacement", "steps")


def columns(study: Description) -> list[str]:
    """Return the names of the columns: run, status, parameters, measures, fails, reason.

    Those of a search for the factor of safety are of its trials.
    """
    if study.kind == COLLAPSE:
        return list(OF_TRIALS)
    varied = [one.name for one in study.vary]
    measures = [f"measure.{name}" if name in varied else name for name in study.measure]
    fails = ["fails"] if study.fail else []
    return ["run", "status", *varied, *measures, *fails, "reason"]


def row(study: Description, result: Mapping[str, Any]) -> list[Any]:
    """Return the row of a result; None where it has no value, also where a measure is nan."""
    if study.kind == COLLAPSE:
        return [result["trial"][name] for name in OF_TRIALS]
    varied = [result["parameters"].get(one.name) for one in study.vary]
    measures = [result.get("measures", {}).get(name) for name in study.measure]
    measures = [None if one != one else one for one in measures]
    fails = [result.get("fails")] if study.fail else []
    return [result["run"], result["status"], *varied, *measures, *fails, result.get("reason", "")]


def write_csv(folder: StudyFolder, path: Path) -> int:
    """Write the table as CSV; return the number of rows."""
    study = folder.study
    rows = (map(_written, row(study, result)) for result in folder.results())
    return write_rows(path, chain([columns(study)], rows)) - 1


def _written(value: Any) -> str:
    """Return a value as CSV has it; floats keep every digit."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)


def write_parquet(folder: StudyFolder, path: Path) -> int:
    """Write the table as Parquet; return the number of rows.

    Raises CaseError where pyarrow is not installed.
    """
    pyarrow = pyarrow_for(path)
    study, names, count = folder.study, columns(folder.study), 0
    texts = {
        one.name
        for one in study.vary
        if any(isinstance(value, str | tuple) for value in getattr(one.drawn, "values", ()))
    }
    kinds = {"run": pyarrow.int64(), "fails": pyarrow.bool_()}
    kinds |= dict.fromkeys(("status", "reason", *texts), pyarrow.string())
    schema = pyarrow.schema([(name, kinds.get(name, pyarrow.float64())) for name in names])

    def plain(name: str, value: Any) -> Any:
        if value is None or name in ("run", "fails"):
            return value
        return str(value) if name in kinds else float(value)

    with replaced(path) as file, pyarrow.parquet.ParquetWriter(file, schema) as writer:
        rows = (row(study, one) for one in folder.results())
        while batch := list(islice(rows, 10_000)):
            parts = [
                pyarrow.array([plain(name, value) for value in column], schema.field(name).type)
                for name, column in zip(names, zip(*batch, strict=True), strict=True)
            ]
            writer.write_table(pyarrow.Table.from_arrays(parts, schema=schema))
            count += len(batch)
    return count


def pyarrow_for(path: Path) -> Any:
    """Return pyarrow; raises CaseError, which names the file to be written, where there is none."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise CaseError(
            "Parquet needs pyarrow, which is not installed",
            where=str(path),
            remedy="install it: pip install 'clast[parquet]', or take the CSV",
        ) from None
    return pyarrow


class TrialTable(dict[str, list[Any]]):
    """The results of a study: column name -> values, in the order of the runs.

    ``to_pandas`` makes a data frame of it.
    """

    def __init__(self, names: Sequence[str], rows: Iterable[Sequence[Any]], folder: Path) -> None:
        super().__init__({name: [] for name in names})
        self.folder = folder
        for one in rows:
            for name, value in zip(names, one, strict=True):
                self[name].append(value)

    def to_pandas(self) -> Any:
        """Return it as a data frame, a row for each run; values that are missing are NaN.

        Raises CaseError where pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise CaseError(
                "a data frame needs pandas, which is not installed",
                where=str(self.folder),
                remedy="install it: pip install 'clast[pandas]'",
            ) from None
        return pandas.DataFrame(dict(self)).set_index("run")

    def __len__(self) -> int:
        return len(self["run"])

    def __repr__(self) -> str:
        return f"Table({len(self)} runs in {self.folder}: {', '.join(self)})"


def table_of(folder: StudyFolder) -> TrialTable:
    """Return the table of a study in memory."""
    rows = (row(folder.study, one) for one in folder.results())
    return TrialTable(columns(folder.study), rows, folder.path)
