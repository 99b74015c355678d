"""The report page of rockfall: where rocks ended, envelopes along the profile, barriers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np

from clast.model.model import Floats
from clast.pictures.study.rockfall_figures import draw_distribution, draw_envelopes, draw_paths
from clast.study.folder import StudyFolder, writing
from clast.study.report_page import Page, file_stem
from clast.study.rockfall.results import (
    BARRIER_HEADS,
    BLOCK_HEADS,
    COLLECTOR_HEADS,
    RockfallResults,
    told,
)
from clast.trajectory import path

PATHS_DRAWN = 300
"""Paths of the figure, at most: the first ones."""
BLOCKS_TOLD = 20
"""Blocks of the page, at most: those that are struck the hardest; blocks.csv has all."""
PER_FLIGHT = 12
"""Points of a drawn parabola."""
ENVELOPES = {
    "height": ("height of centroid above profile, m", 1.0),
    "energy": ("kinetic energy, kJ", 1e-3),
    "speed": ("speed, m/s", 1.0),
}
"""Quantities drawn along the profile: name, and unit as a share of that of the tables."""


def path_lines(results: RockfallResults) -> list[Floats]:
    """Return the first paths as lines (n, 2), m: parabolas in flight, straight on the ground."""
    gravity, lines = results.campaign.gravity, []
    for rows in islice(results.courses(), PATHS_DRAWN):
        flies = rows[:-1, path.KIND] != path.ON_GROUND
        span = np.where(flies, np.diff(rows[:, path.CLOCK]), 0.0)
        time = (span[:, None] * np.linspace(0.0, 1.0, PER_FLIGHT))[:, :, None]
        place, speed = (
            rows[:-1, None, path.X : path.Y + 1],
            rows[:-1, None, path.AFTER : path.AFTER + 2],
        )
        points = place + time * speed + 0.5 * time**2 * gravity
        points = np.concatenate([points.reshape(-1, 2), rows[-1:, path.X : path.Y + 1]])
        lines.append(points + results.campaign.origin)
    return lines


def write_report(folder: StudyFolder, results: RockfallResults) -> Path:
    """Write the page into the folder of a study; return its path."""
    with writing(folder.path):
        page = Page.of(folder, "rockfall")
        ends = Counter(results.paths["end"])
        how = ", ".join(f"{count} {name}" for name, count in sorted(ends.items()))
        page.say(f"{len(results)} paths: {how}.", "answer")
        page.remark(
            "rest: came to rest; out: left the profile; held: by a barrier; time: still moving at "
            "the time limit. Heights are those of centroids."
        )
        if len(results):
            page.figures(lambda: _wide(page, results), "figures wide")
            page.figures(lambda: _figures(page, results))
        rows = results.barriers()
        if rows:
            page.head("Barriers")
            page.table(list(BARRIER_HEADS.values()), told(rows, BARRIER_HEADS))
        page.head("Collectors")
        named = [row for row in results.stations() if row["name"]]
        if named:
            page.table(list(COLLECTOR_HEADS.values()), told(named, COLLECTOR_HEADS))
        else:
            page.remark("There is none: the table stations.csv has all places along the profile.")
        blocks = sorted(results.blocks(), key=lambda row: -float(row["translational_max"]))
        if blocks:
            page.head("Blocks that are struck")
            if remark := results.remark_on_blocks:
                page.remark(remark)
            page.table(list(BLOCK_HEADS.values()), told(blocks[:BLOCKS_TOLD], BLOCK_HEADS))
        return page.write()


def _wide(page: Page, results: RockfallResults) -> Iterator[tuple[Path, str]]:
    """Draw the paths over the profile."""
    campaign = results.campaign
    names = [campaign.surfaces[k] for k in campaign.ground.surface[: len(campaign.profile) - 1]]
    file = draw_paths(
        page.pictures / "paths.png",
        campaign.profile + campaign.origin,
        names,
        path_lines(results),
        campaign.barrier_lines + campaign.origin,
        [one + campaign.origin for one in campaign.blocks.outline] if campaign.blocks else (),
    )
    yield file, "paths over the profile"


def _figures(page: Page, results: RockfallResults) -> Iterator[tuple[Path, str]]:
    """Draw envelopes, end points and the energy at each barrier."""
    rows = results.stations()
    for key, (up, unit) in ENVELOPES.items():
        file = draw_envelopes(page.pictures / f"{key}.png", rows, key, up, unit)
        yield file, f"{up} along the profile"
    file = page.pictures / "ends.png"
    yield draw_distribution(file, results.ends, "x of end points, m"), "end points"
    for number, name in enumerate(results.campaign.barriers):
        energy = results.hits[results.hits[:, 1] == number, 4]
        if len(energy):
            file = page.pictures / f"barrier-{file_stem(name)}.png"
            caption = f"kinetic energy at {name}, kJ"
            yield draw_distribution(file, 1e-3 * energy, caption), caption
