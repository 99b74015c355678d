"""Frames as drawings: blocks on the layers of their rocks, joints, contact forces."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from pathlib import Path

import numpy as np

from clast.exports.targets import check_ending, check_free, edge_joints, frames_in, numbered
from clast.pictures.fields import round_below
from clast.results import Recording
from clast.results.frames import absent_in_frame
from clast.rockmass.drawings.blocks_out import Extras, write_blocks_dxf


def write_dxf(
    results: Recording, path: Path | str, frames: Sequence[int] | None = (-1,)
) -> list[Path]:
    """Write frames to DXF files, in metres, and return their paths; the last frame alone if absent.

    A block is a closed LWPOLYLINE on the layer of its rock, edges with a joint are LINEs on the
    layer JOINTS_name, contact forces LINEs on CONTACTS: in the direction of the force, as long as
    it is large, the contact in the middle; the layer's description gives the scale of 1 m.  Blocks
    that have been excavated are left out.  For several frames (None: all) ``path`` out.dxf becomes
    out-0000.dxf and so on, of one scale.  Raises CaseError for files that exist already or cannot
    be written, and where ezdxf is not installed.
    """
    path = Path(path)
    check_ending(path, ".dxf", "a drawing")
    chosen = frames_in(results, frames)
    paths = [path] if len(chosen) == 1 else numbered(path, chosen, ".dxf")
    check_free(paths)
    rocks = [results.rock_name[k] for k in results.field("rock", 0)]
    # names of layers have no colons
    joints = [name.replace(":", "-") for name in edge_joints(results)]
    length = _length_of_forces(results, chosen)
    for frame, file in zip(chosen, paths, strict=True):
        contacts = results.contacts(frame)
        half = 0.5 * length * contacts.force
        lines = np.stack([contacts.position - half, contacts.position + half], axis=1)
        left = ~absent_in_frame(results, frame)
        counts = np.diff(results.block_start)
        edge = np.repeat(left, counts)
        about = f"contact forces, 1 m for {1.0 / length:g} N/m; t = {results.times[frame]:.6g} s"
        write_blocks_dxf(
            file,
            results.vertices(frame)[edge],
            np.cumsum([0, *counts[left]]),
            list(compress(rocks, left)),
            list(compress(joints, edge)),
            Extras(layer="CONTACTS", about=about, lines=lines),
        )
    return paths


def _length_of_forces(results: Recording, frames: Sequence[int]) -> float:
    """Return how long the line of a force of 1 N/m is, m: 1, 2 or 5 times a power of ten."""
    largest = 0.0
    for frame in frames:
        largest = max(largest, float(np.hypot(*results.contacts(frame).force.T).max(initial=0.0)))
    size = float(np.hypot(*np.ptp(results.vertices(0), axis=0)))
    # Length of the largest force as a share of the size of all blocks, at most
    return round_below(0.05 * size / largest) if largest > 0.0 else 1.0
