"""Surcharge as pictures show it: fill that rests on blocks, and axles of load trains.

Their forces are among the point loads of the model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clast.model.arrays import Floats, no_floats


@dataclass(frozen=True, kw_only=True)
class Surcharge:
    """Fill and axles; coordinates are relative to the model's origin."""

    fill: tuple[Floats, ...] = ()
    """Outlines of fill above blocks, m, (c, 2) each."""
    fill_name: tuple[str, ...] = ()
    """Name of the fill of each outline, "" for none."""
    axle: Floats = no_floats(3, 2)
    """Wheel of each axle that stands over blocks, and both ends of its footprint, m, (k, 3, 2)."""
    load: Floats = no_floats()
    """Load of each axle, downwards, N per metre of thickness, shape (k,)."""
    axle_name: tuple[str, ...] = ()
    """Name of the train of each axle, "" for none."""
    names: tuple[str, ...] = ()
    """Names of all fills and trains, those without any load included."""

    def plain(self) -> dict[str, Any]:
        """Return it as plain values, nothing where there is neither fill nor an axle."""
        if not self.fill and not len(self.axle):
            return {}
        return {
            "fill": [one.tolist() for one in self.fill],
            "fill_name": list(self.fill_name),
            "axle": self.axle.tolist(),
            "load": self.load.tolist(),
            "axle_name": list(self.axle_name),
        }

    @classmethod
    def of_plain(cls, given: Any) -> Surcharge:
        """Return it from plain values; raises ValueError, TypeError or KeyError for others."""
        if not given:
            return cls()
        axle, load = np.array(given["axle"], np.float64), np.array(given["load"], np.float64)
        one = cls(
            fill=tuple(np.array(ring, np.float64).reshape(-1, 2) for ring in given["fill"]),
            fill_name=tuple(map(str, given["fill_name"])),
            axle=axle.reshape(-1, 3, 2),
            load=load.reshape(-1),
            axle_name=tuple(map(str, given["axle_name"])),
        )
        if len({len(one.axle), len(one.load), len(one.axle_name)}) > 1:
            raise ValueError("the axles of a surcharge do not match their loads")
        if len(one.fill) != len(one.fill_name):
            raise ValueError("the fills of a surcharge do not match their names")
        return one
