"""Results of rockfall: tables of paths and of blows, and statistics along the profile.

    results = clast.rockfall("slope.toml", "out", workers=2)
    results.paths["end_x"]
    results.barriers()[0]["share_held"]

Heights are those of centroids above the profile, m; energies in J, speeds in m/s.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from clast.case.api import case_of
from clast.case.case_file import Case
from clast.errors import shortened
from clast.model.model import Floats
from clast.rockmass.drawings.drawing_files import replaced, write_rows
from clast.study import study_api
from clast.study.folder import ARRAYS, BLOWS, StudyFolder, writing
from clast.study.rockfall.hand_over import hand_over
from clast.study.rockfall.portions import BLOW_COLUMNS, blow_rows, study_of
from clast.study.study_api import HowMade
from clast.study.trial_table import pyarrow_for
from clast.trajectory import path
from clast.trajectory.campaign import PATH_COLUMNS, Campaign, joined

QUANTITIES = ("height", "translational", "rotational", "energy", "speed")
"""Measured at stations, in the order of their columns."""
SHARES = {"p50": 50.0, "p95": 95.0, "p99": 99.0}
"""Percentiles of all quantities."""
Row = dict[str, Any]
BARRIER_HEADS = {
    "name": "barrier",
    "came": "rocks",
    "held": "held",
    "height_p95": "height P95, m",
    "height_max": "largest, m",
    "energy_p95": "energy P95, kJ",
    "energy_max": "largest, kJ",
}
"""Columns of barriers shown to readers, and their headings; the tables have the rest."""
BLOCK_HEADS = {
    "block": "block",
    "rocks": "rocks",
    "blows": "blows",
    "translational_p95": "energy P95, kJ",
    "translational_max": "largest, kJ",
    "lost_max": "most lost in a blow, kJ",
}
"""Columns of blocks shown to readers, and their headings."""
COLLECTOR_HEADS = {
    "name": "collector",
    "count": "rocks",
    "height_p95": "height P95, m",
    "height_max": "largest, m",
    "energy_p95": "energy P95, kJ",
    "energy_max": "largest, kJ",
    "speed_p95": "speed P95, m/s",
    "speed_max": "largest, m/s",
}
"""Columns of collectors shown to readers, and their headings."""


def told(rows: Sequence[Row], heads: Mapping[str, str]) -> list[list[Any]]:
    """Return the columns of rows that have ``heads``, in their order; kJ from J."""

    def value(row: Row, key: str) -> Any:
        known = row[key]
        return known / 1e3 if heads[key].endswith("kJ") and known is not None else known

    return [[value(row, key) for key in heads] for row in rows]


def summary_of(values: Floats) -> Row:
    """Return mean, percentiles and largest of values (n,); None of none."""
    names = ("mean", *SHARES, "max")
    if not len(values):
        return dict.fromkeys(names)
    shares = np.percentile(values, list(SHARES.values()))
    found = (values.mean(), *shares, values.max())
    return dict(zip(names, map(float, found), strict=True))


@dataclass(frozen=True)
class RockfallResults:
    """Paths of rocks, as far as they have been followed."""

    folder: Path
    campaign: Campaign
    paths: Mapping[str, list[Any]]
    """Column -> values, a row for each path: the rock, where it ended and its largest values."""
    passed: Floats
    """Path, station and largest values of each passage, (q, 7)."""
    hits: Floats
    """Path, barrier, time, height, energy, speed and whether it held, (h, 7)."""
    portions: tuple[Path, ...]
    """Folders of the portions of paths."""

    @classmethod
    def of(cls, folder: StudyFolder) -> RockfallResults:
        """Return the finished paths of a study."""
        rows, portions = list[list[Any]](), list[Path]()
        parts: dict[str, list[Floats]] = {"passed": [], "hits": []}
        for result in folder.results():
            if "rows" in result:
                rows += result["rows"]
                portions.append(folder.place(result["run"]))
                for name, arrays in parts.items():
                    arrays.append(_array(portions[-1], name))
        columns = {name: [row[k] for row in rows] for k, name in enumerate(PATH_COLUMNS)}
        campaign = folder.base.campaign()
        return cls(folder.path, campaign, columns, portions=tuple(portions), **joined(parts))

    def __len__(self) -> int:
        return len(self.paths["path"])

    @cached_property
    def ends(self) -> Floats:
        """Place x of the end of each path, m."""
        return np.array(self.paths["end_x"], np.float64)

    @cached_property
    def records(self) -> Floats:
        """Starts, blows, stretches on the ground and ends of all paths, (r, 15)."""
        return joined({"records": [_array(one, "records") for one in self.portions]})["records"]

    def courses(self) -> Iterator[Floats]:
        """Give the records of each path, (r, 14), in the order of the table of paths."""
        for portion in self.portions:
            records = _array(portion, "records")
            yield from np.split(records[:, 1:], np.flatnonzero(np.diff(records[:, 0])) + 1)

    def blows(self) -> Iterator[list[Any]]:
        """Give the rows of the table of blows, in the order of paths and times."""
        return blow_rows(self.campaign, self.records)

    def stations(self) -> list[Row]:
        """Return the statistics of passages along the profile, a row for each station.

        Of each path the largest value at a station counts.
        """
        rows = []
        for number, name in enumerate(self.campaign.stations):
            here = self.passed[self.passed[:, 1] == number, 2:]
            x = float(self.campaign.ground.stations[number] + self.campaign.origin[0])
            row: Row = {"x": x, "name": name, "count": len(here)}
            for k, quantity in enumerate(QUANTITIES):
                found = summary_of(here[:, k][~np.isnan(here[:, k])])
                row |= {f"{quantity}_{key}": value for key, value in found.items()}
            rows.append(row)
        return rows

    def barriers(self) -> list[Row]:
        """Return the rocks that came to each barrier, their hits, and the share that was held."""
        rows = []
        for number, name in enumerate(self.campaign.barriers):
            station = self.campaign.stations.index(name)
            hits = self.hits[self.hits[:, 1] == number]
            over = self.passed[self.passed[:, 1] == station, 0]
            came = len({*hits[:, 0].tolist(), *over.tolist()})
            held = sum(one == name for one in self.paths["held_by"])
            row: Row = {"name": name, "came": came, "hits": len(hits), "held": held}
            row["share_held"] = held / came if came else None
            for key, column in (("height", 3), ("energy", 4), ("speed", 5)):
                found = summary_of(hits[:, column])
                row |= {f"{key}_{part}": value for part, value in found.items()}
            rows.append(row)
        return rows

    def blocks(self) -> list[Row]:
        """Return the blows on each block: translational energy before, lost energy, J, speed."""
        campaign, blocks = self.campaign, self.campaign.blocks
        if blocks is None:
            return []
        blows = self.records[self.records[:, 1 + path.KIND] == path.BLOW]
        face = blows[:, 1 + path.FACE].astype(np.int64)
        struck = np.where(face >= 0, campaign.face_block[face], -1)
        masses = dict(zip(self.paths["path"], self.paths["mass"], strict=True))
        mass = np.array([masses[int(number)] for number in blows[:, 0]])
        speed = np.hypot(*blows[:, [1 + path.BEFORE, 2 + path.BEFORE]].T)
        rows = []
        for number in np.unique(struck[struck >= 0]).tolist():
            here = struck == number
            row: Row = {
                "block": blocks.name[number],
                "fixed": bool(blocks.fixed[number]),
                "rocks": len(np.unique(blows[here, 0])),
                "blows": int(here.sum()),
            }
            found = {
                "translational": 0.5 * mass[here] * speed[here] ** 2,
                "lost": blows[here, 1 + path.LOST],
                "speed": speed[here],
            }
            for name, values in found.items():
                row |= {f"{name}_{key}": value for key, value in summary_of(values).items()}
            rows.append(row)
        return rows

    @property
    def remark_on_blocks(self) -> str:
        """Warning that paths strike blocks that could move; "" where none does."""
        free = [row for row in self.blocks() if not row["fixed"]]
        if not free:
            return ""
        worst = max(free, key=lambda row: float(row["lost_max"]))
        return (
            f"{len(free)} free block(s) were struck, '{shortened(worst['block'])}' the hardest "
            f"({worst['lost_max'] / 1e3:.3g} kJ lost in a blow): paths take them as fixed; "
            "clast study hand-over writes the run in which they move"
        )

    def hand_over(self, number: int) -> Path:
        """Write the case of blocks that a path's rock strikes (``hand_over``); return its file."""
        return hand_over(self.folder, number)

    def write(self) -> list[Path]:
        """Write paths.csv, blows.csv, stations.csv, barriers.csv, blocks.csv; return their paths.

        The last two only where there are such.
        """
        tables: dict[str, Iterable[Iterable[Any]]] = {
            "paths": [PATH_COLUMNS, *zip(*self.paths.values(), strict=True)]
        }
        for name in ("stations", "barriers", "blocks"):
            found = getattr(self, name)()
            if found:
                tables[name] = [list(found[0]), *(row.values() for row in found)]
        files = []
        with writing(self.folder):
            for name, rows in tables.items():
                files.append(self.folder / f"{name}.csv")
                write_rows(files[-1], rows)
            files.insert(1, self.folder / BLOWS)
            with replaced(files[1]) as file:
                file.write(f"{','.join(BLOW_COLUMNS)}\n".encode())
                for portion in self.portions:
                    file.write((portion / BLOWS).read_bytes())
        return files

    def write_parquet(self) -> list[Path]:
        """Write paths.parquet and blows.parquet; CaseError where pyarrow is not installed."""
        files = []
        for name, columns, rows in (
            ("paths", PATH_COLUMNS, [*zip(*self.paths.values(), strict=True)]),
            ("blows", BLOW_COLUMNS, [*self.blows()]),
        ):
            file = self.folder / f"{name}.parquet"
            pyarrow = pyarrow_for(file)
            values = {key: [row[k] for row in rows] for k, key in enumerate(columns)}
            with writing(self.folder):
                pyarrow.parquet.write_table(pyarrow.table(values), file)
            files.append(file)
        return files


def _array(portion: Path, name: str) -> Floats:
    """Return an array of a portion of paths."""
    with np.load(portion / ARRAYS) as kept:
        array: Floats = kept[name]
    return array


def rockfall(
    case: Case | str | Path, folder: str | Path, how: HowMade | None = None, **given: Any
) -> RockfallResults:
    """Follow all rocks of a case with [rockfall] that have not been followed in a folder.

    ``how`` says who follows them; its fields may also be given one by one: ``workers``,
    ``executor``, ``scheduler``, ``array``.  Tables are written into the folder.  Raises CaseError
    for a case without [rockfall], and where another study is in the folder.
    """
    loaded = case_of(case)
    known = {one.name for one in fields(HowMade)}
    if not given.keys() <= known:
        raise TypeError(f"rockfall() takes {', '.join(sorted(known))}")
    there = StudyFolder.made(Path(folder), loaded, study_of(loaded.campaign()))
    study_api.make(there, how or HowMade(**given))
    results = RockfallResults.of(there)
    if (how or HowMade(**given)).array is None:
        results.write()
    return results
