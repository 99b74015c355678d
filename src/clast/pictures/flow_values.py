"""Numbers of water in joints: channels as lines, in pieces along which the number hardly changes.

Lines run as the water flows, and are as wide as the flow is large.  A channel with neither pressure
nor flow is dry: no field has a value there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from clast.errors import CaseError
from clast.model.model import Bools, Floats, Ints
from clast.pictures.faces import Faces
from clast.pictures.fields import Field
from clast.pictures.magnified import as_it_was
from clast.results import Recording

STILL = 1e-9
"""Share of the largest flow of a frame below which a flow comes of rounding."""
STEPS, PIECES_MAX = 16, 8
"""Steps of the range of values, of which a piece spans one, and pieces of a line at most."""
LITRES, LITRES_UNIT = 1e3 * 60.0 * 10.0, "l/min per 10 m"
"""Unit of flows on pictures, and how many of it are 1 m2/s."""


@dataclass(frozen=True, kw_only=True)
class Stretches:
    """Channels of a frame, as their water flows, those that are wet up to a level in two; s rows.

    Pressure (Pa), aperture (m), saturation and height y (m) have shape (s, 2), for both ends.
    """

    ends: Floats
    """Where they are drawn, m, shape (s, 2, 2)."""
    height: Floats
    pressure: Floats
    aperture: Floats
    saturation: Floats
    flow: Floats
    """Flow from the first to the second end, m2/s, not below 0, shape (s,)."""
    edge: Ints
    """The edge to the left of each channel, by its first vertex, shape (s,)."""
    weight: float
    """Weight of water, N/m3; 0 without gravity."""

    @property
    def dry(self) -> Bools:
        """Which have neither pressure nor flow, shape (s,)."""
        return np.asarray((self.pressure == 0.0).all(axis=1) & (self.flow == 0.0))

    @property
    def width(self) -> Floats:
        """Flow as a share of the largest, shape (s,)."""
        return np.asarray(self.flow / (self.flow.max(initial=0.0) or 1.0))


def stretches(results: Recording, frame: int) -> Stretches:
    """Return the channels of a frame; raises CaseError where no water flows in joints."""
    if not len(results.channels.edge):
        remedy = "give the case a [flow], or choose another field"
        raise CaseError("no water flows in the joints of this run", remedy=remedy)
    drawn, here = results.flow(frame), as_it_was(results).flow(frame)
    flow = np.abs(here.flow)
    flow[flow <= STILL * flow.max(initial=0.0)] = 0.0
    height = np.stack([here.start[:, 1], here.end[:, 1]], axis=1)
    numbers = np.stack([height, here.pressure, here.aperture, here.saturation], axis=2)
    ends = np.concatenate([np.stack([drawn.start, drawn.end], axis=1), numbers], axis=2)
    turned = here.flow < 0.0
    ends[turned] = ends[turned, ::-1]
    # a share that is wet counts from the end under pressure; at its other end is none
    cut = np.flatnonzero((here.wet > 0.0) & (here.wet < 1.0))
    share = np.where(ends[cut, 0, 3] > 0.0, here.wet[cut], 1.0 - here.wet[cut])[:, None]
    level = (1.0 - share) * ends[cut, 0] + share * ends[cut, 1]
    level[:, 3] = 0.0
    above = np.stack([level, ends[cut, 1]], axis=1)
    level[:, 5], above[:, 0, 5] = ends[cut, 0, 5], ends[cut, 1, 5]
    ends[cut, 1] = level
    ends = np.concatenate([ends, above])
    row = np.concatenate([np.arange(len(flow)), cut])
    height, pressure, aperture, saturation = np.moveaxis(ends[:, :, 2:], 2, 0)
    return Stretches(
        ends=ends[:, :, :2],
        height=height,
        pressure=pressure,
        aperture=aperture,
        saturation=saturation,
        flow=flow[row],
        edge=here.edge[row, 0],
        weight=results.channels.weight,
    )


def largest_flow(results: Recording, frame: int) -> float:
    """Return the largest flow in a channel of a frame, m2/s."""
    return float(stretches(results, frame).flow.max(initial=0.0))


def with_widest(faces: Faces, largest: float, widest: float) -> Faces:
    """Return channels of a frame whose largest flow is ``largest`` as wide as beside ``widest``."""
    width = None if faces.width is None else faces.width * (largest / (widest or 1.0))
    return replace(faces, width=width)


def dry_channels(results: Recording, frame: int) -> Faces:
    """Return the channels and parts of channels that are dry in a frame."""
    water = stretches(results, frame)
    dry = water.dry
    nothing = np.zeros(int(dry.sum()))
    return Faces(ends=water.ends[dry], value=nothing, edge=water.edge[dry], width=nothing)


def _pieces(values: Callable[[Stretches], Floats], results: Recording, frame: int) -> Faces:
    """Return the channels that are not dry, with values (s, 2) at both ends, in pieces."""
    water = stretches(results, frame)
    wet = np.flatnonzero(~water.dry)
    value, ends = values(water)[wet], water.ends[wet]
    step = float(np.ptp(value)) / STEPS if len(wet) else 0.0
    rise = value[:, 1] - value[:, 0]
    count = np.ceil(np.abs(rise) / (step or np.inf) - 1e-9)
    count = np.clip(count, 1, PIECES_MAX).astype(np.int64)
    of = np.repeat(np.arange(len(wet)), count)
    first = (np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)) / count[of]
    share = np.stack([first, first + 1.0 / count[of]], axis=1)[..., None]
    return Faces(
        ends=ends[of, :1] + share * (ends[of, 1:] - ends[of, :1]),
        value=value[of, 0] + share.mean(axis=(1, 2)) * rise[of],
        edge=water.edge[wet][of],
        width=water.width[wet][of],
    )


def _head(water: Stretches) -> Floats:
    if water.weight == 0.0:
        raise CaseError("without gravity there is no head", remedy='choose the field "pressure"')
    return np.asarray(water.height + water.pressure / water.weight)


FLOW_FIELDS = {
    "pressure": Field("Water pressure in joints", "Pa", partial(_pieces, lambda w: w.pressure)),
    "head": Field("Head in joints", "m", partial(_pieces, _head), from_zero=False),
    "flow": Field(
        "Flow in joints",
        LITRES_UNIT,
        partial(_pieces, lambda w: np.repeat(LITRES * w.flow[:, None], 2, axis=1)),
    ),
    "aperture": Field("Hydraulic aperture of joints", "m", partial(_pieces, lambda w: w.aperture)),
    "saturation": Field(
        "Saturation of joints", "%", partial(_pieces, lambda w: 100.0 * w.saturation)
    ),
}
"""Fields that colour the channels of water in joints."""
