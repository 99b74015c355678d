"""A case with every table of a rock mass, written as a text and read again, is the same case."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.inputs.joint_sets import JointSetTable
from clast.inputs.rock_mass import (
    BlockPatternTable,
    DomainTable,
    OpeningTable,
    RegionTable,
    TraceTable,
)

HEAD = """schema = 1
title = "Everything"
time = {step = 1e-3, end = 1e-3}
[rock]
granite = {young = 1e9, poisson = 0.2, density = 2700.0}
shale = {young = 1e9, poisson = 0.2, density = 2400.0}
[joint]
bed = {friction_angle = 20.0}
fault = {friction_angle = 15.0, cohesion = 1e3}
mortar = {friction_angle = 35.0}
[domain]
boundary = [[0, 0], [20, 0], [20, 12], [0, 12]]
rock = "granite"
section_azimuth = 90.0
tolerance = 1e-6
smallest_edge = 0.02
smallest_block = 1e-3
most_blocks = 5000
seed = 7
fixed_sides = ["bottom", "left"]
"""
SETS = """[[joint_set]]
name = "bedding"
joint = "bed"
angle = 10.0
spacing = {distribution = "lognormal", mean = 2.0, sd = 0.3}
trace_length = {distribution = "uniform", low = 4.0, high = 8.0}
bridge_length = 0.5
origin = [0.5, 0.5]
stagger = 0.5
within = "shale bed"
seed = 3
[[joint_set]]
name = "cross"
model = "cross-jointed"
angle = 95.0
spacing = {distribution = "values", values = [2.5, 3.0]}
terminates_at = ["J1", "bedding"]
[[joint_set]]
name = "space"
dip = 60.0
dip_direction = 120.0
spacing = 4.0
spacing_is = "true"
fisher_kappa = 400.0
within = [[10, 6], [20, 6], [20, 12], [10, 12]]
[[joint_set]]
name = "cracks"
model = "baecher"
angle = 45.0
intensity = 0.3
trace_length = 2.0
angle_spread = {distribution = "von-mises", kappa = 60.0}
[[joint_set]]
name = "cells"
model = {name = "voronoi", count = 20, rounds = 2}
within = [[0, 8], [6, 8], [6, 12], [0, 12]]
"""
TRACES = """[[trace]]
points = [[0, 6], [9, 6.5], [20, 6]]
joint = "fault"
set = "J1"
[[trace]]
file = "traces.csv"
joint = "fault"
set = "J2"
"""
PLACES = """[[region]]
name = "shale bed"
polygon = [[0, 0], [20, 0], [20, 5], [0, 5]]
rock = "shale"
joint = "bed"
[[region]]
name = "boulder"
polygon = [[12, 7], [13, 7], [13, 8], [12, 8]]
one_block = true
[[opening]]
name = "heading"
shape = "horseshoe"
center = [15, 2]
width = 2.0
wall_height = 1.0
chords = 8
[[opening]]
name = "shaft"
shape = "box"
corner = [4, 9]
size = [1.0, 2.0]
excavated = true
[[opening]]
name = "adit"
shape = "polygon"
points = [[17, 8], [19, 8], [18, 10]]
construction_joint = false
[[opening]]
name = "pipe"
shape = "circle"
center = [8, 3]
radius = 0.6
[[block_pattern]]
name = "lining"
pattern = "running-bond"
corner = [9, 9]
size = [2.0, 2.0]
brick = [0.5, 0.5]
joint = "mortar"
head_joint = "mortar"
"""
EVERYTHING = HEAD + SETS + TRACES + PLACES


@pytest.fixture
def case(tmp_path: Path) -> Case:
    (tmp_path / "traces.csv").write_text("x1,y1,x2,y2,joint,set\n3,0,4,8,bed,\n0,7,9,7,,J3\n")
    (tmp_path / "case.toml").write_text(EVERYTHING)
    return Case.from_toml(tmp_path / "case.toml")


def test_every_rock_mass_table_survives_being_written_and_read(case, tmp_path):
    text = case.to_toml()
    (tmp_path / "again.toml").write_text(text)
    again = Case.from_toml(tmp_path / "again.toml")
    assert tomllib.loads(text) == tomllib.loads(EVERYTHING)
    assert again.model_dump() == case.model_dump()
    assert again.to_toml() == text
    one, other = case.cut().cut, again.cut().cut
    np.testing.assert_array_equal(one.vertices, other.vertices)
    np.testing.assert_array_equal(one.edge_joint, other.edge_joint)
    assert one.report.as_dict() == other.report.as_dict()
    assert {"J1", "J2", "J3"} <= {found.name for found in one.report.sets}


def test_every_key_of_the_tables_is_among_them(case):
    """Keys of files are left out that are of DXF drawings, or in the place of a shape."""
    content = tomllib.loads(EVERYTHING)
    tables = {
        "joint_set": JointSetTable,
        "trace": TraceTable,
        "region": RegionTable,
        "opening": OpeningTable,
        "block_pattern": BlockPatternTable,
    }
    of_drawings = {"layer", "unit"}
    in_place_of_shapes = {"file", "blocks", "weld"}
    given = {name: set().union(*content[name]) for name in tables}
    assert set(DomainTable.model_fields) == set(content["domain"])
    for name, table in tables.items():
        left = set(table.model_fields) - given[name] - of_drawings
        assert left == (in_place_of_shapes if name == "opening" else set()), name
