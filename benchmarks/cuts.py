"""The cost of cutting: networks of joints of any size, timed by stage.

Both networks are two sets in a square.  Lines of length P_i per area at the angles t_i make, by
Euler's formula,

    F = 1 + w sum P_i (|cos t_i| + |sin t_i|) + w2 (X - T)

blocks in a square of w m, with X crossings and T traces per area; the second term is half of the
ends at the rim.  The square is that of the number of blocks wanted.
"""

from __future__ import annotations

import gc
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Any

from benchmarks.machine import forget_peak, peak_memory
from clast.compute.compilation import Stages
from clast.rockmass import (
    Baecher,
    Domain,
    Exponential,
    JointSet,
    Lognormal,
    VonMises,
    cut,
)

CUT_SIZE = 100_000
"""Blocks by default."""
ANGLES = (20.0, 105.0)
"""Angles of both sets, degrees."""
SPACINGS = (1.0, 0.8)
"""Mean spacings of persistent sets, m, with a deviation of SPREAD of it."""
SPREAD = 0.3
INTENSITY = 1.2
"""P21 of each set of traces, m/m2."""
TRACE = 8.0
"""Mean of their lengths, which are exponential, m."""
KAPPA = 60.0
"""Von Mises' concentration of their directions."""
SEED = 1

Network = tuple[Domain, Sequence[JointSet]]


@dataclass(frozen=True, kw_only=True)
class CutScene:
    """A network of joints that can be made with any number of blocks."""

    name: str
    """Name on the command line."""
    title: str
    """The title."""
    network: Callable[[int], Network]
    """Returns domain and sets for about so many blocks."""


def persistent(size: int) -> Network:
    """Return two sets of endless joints that cut about ``size`` blocks."""
    intensities = [1.0 / spacing for spacing in SPACINGS]
    crossings = math.prod(intensities) * math.sin(math.radians(ANGLES[1] - ANGLES[0]))
    sets = [
        JointSet(
            name=f"set at {angle:g}",
            angle=angle,
            spacing=Lognormal(mean=spacing, sd=SPREAD * spacing),
        )
        for angle, spacing in zip(ANGLES, SPACINGS, strict=True)
    ]
    return _square(size, intensities, crossings), sets


def traces(size: int) -> Network:
    """Return two sets of Baecher's traces that cut about ``size`` blocks."""
    # Angles between traces of two sets, and of one, have a deviation of about sqrt(2/kappa).
    between = math.sin(math.radians(ANGLES[1] - ANGLES[0])) * math.exp(-1.0 / KAPPA)
    within = 2.0 / math.sqrt(math.pi * KAPPA)
    crossings = INTENSITY**2 * (between + within)
    sets = [
        JointSet(
            name=f"set at {angle:g}",
            model=Baecher(),
            angle=angle,
            intensity=INTENSITY,
            trace_length=Exponential(mean=TRACE),
            angle_spread=VonMises(kappa=KAPPA),
        )
        for angle in ANGLES
    ]
    intensities = [INTENSITY] * len(ANGLES)
    return _square(size, intensities, crossings - sum(intensities) / TRACE), sets


def _square(size: int, intensities: Sequence[float], per_area: float) -> Domain:
    """Return the square that F of the formula above is ``size`` for; ``per_area`` is X - T."""
    turned = [math.radians(angle) for angle in ANGLES]
    rim = sum(
        p * (abs(math.cos(t)) + abs(math.sin(t))) for p, t in zip(intensities, turned, strict=True)
    )
    w = (math.sqrt(rim**2 + 4.0 * per_area * (size - 1)) - rim) / (2.0 * per_area)
    return Domain(boundary=[(0, 0), (w, 0), (w, w), (0, w)], most_blocks=10 * size + 1000)


CUTS = {
    scene.name: scene
    for scene in (
        CutScene(name="persistent", title="cut by persistent sets", network=persistent),
        CutScene(name="baecher", title="cut by Baecher traces", network=traces),
    )
}
"""All networks by name."""


def measure_cut(scene: CutScene, size: int) -> dict[str, Any]:
    """Cut a network and return the cost, ready for JSON.

    Seconds by stage are wall time: lines drawn and clipped, nodes where they meet, faces, short
    edges and small blocks tidied, vertices, rocks and joints of the blocks, report.  The error of
    the sum of areas is relative.
    """
    domain, sets = scene.network(size)
    gc.collect()
    forget_peak()
    stages, start = Stages(), process_time()
    rock_mass = cut(domain, sets, seed=SEED, stages=stages)
    return {
        "scene": scene.name,
        "title": scene.title,
        "wanted": size,
        "blocks": rock_mass.block_count,
        "wall_seconds": sum(stages.seconds.values()),
        "processor_seconds": process_time() - start,
        "seconds_by_stage": stages.seconds,
        "area_error": rock_mass.report.area_error,
        "peak_memory": peak_memory(),
    }
