"""What would never end or leaves nothing is refused at once; what is not read is named."""

from __future__ import annotations

import json
import time

import pytest

from clast.errors import CaseError, ModelError
from clast.rockmass import (
    BlockPattern,
    Box,
    CrossJointed,
    Domain,
    Exponential,
    JointSet,
    Opening,
    Polygon,
    cut,
)
from clast.rockmass.drawings.csv_lines import read_traces
from scenes.command_line import good

SQUARE = Domain(boundary=[(0, 0), (10, 0), (10, 10), (0, 10)])
WIDE = JointSet(name="w", angle=20.0, spacing=1.0)
DENSE = {
    "fixed": [JointSet(name="s", angle=63.0, spacing=1e-5)],
    "random": [JointSet(name="s", angle=63.0, spacing=Exponential(mean=1e-5))],
    "traces": [JointSet(name="s", angle=63.0, spacing=0.5, trace_length=1e-5, bridge_length=1e-5)],
    "crossings": [WIDE, JointSet(name="s", angle=90.0, spacing=1e-4)],
    "layers": [
        JointSet(name="w", angle=0.0, spacing=5e-5),
        JointSet(name="s", model=CrossJointed(), angle=90.0, spacing=1.0, terminates_at=["w"]),
    ],
}


@pytest.mark.parametrize("name", DENSE)
def test_millions_of_lines_are_refused_before_they_are_drawn(name):
    began = time.process_time()
    with pytest.raises(ModelError, match="blocks are expected, more than the 200000 allowed"):
        cut(SQUARE, DENSE[name])
    assert time.process_time() - began < 2.0


def test_millions_of_bricks_are_refused_before_they_are_drawn():
    pattern = BlockPattern(corner=(0, 0), size=(10, 10), brick=(1e-4, 1e-4))
    with pytest.raises(ModelError, match="brick: about 1e"):
        cut(SQUARE, patterns=[pattern])


@pytest.mark.parametrize(
    "shapes",
    [
        [Box(corner=(-1, -1), size=(20, 20))],
        [Box(corner=(0, 0), size=(10, 10))],
        [Polygon(points=[(-5, 5), (5, -6), (16, 5), (5, 16)])],
        [Box(corner=(-1, -1), size=(7, 20)), Box(corner=(5, -1), size=(7, 20))],
    ],
)
@pytest.mark.parametrize("sets", [[], [WIDE]])
def test_openings_that_leave_nothing_are_refused(shapes, sets):
    openings = [
        Opening(name=f"o{k}", shape=shape, excavated=True) for k, shape in enumerate(shapes)
    ]
    with pytest.raises(ModelError, match="nothing is left of the domain"):
        cut(SQUARE, sets, openings=openings)


def test_an_opening_for_later_may_be_all_of_the_domain():
    later = Opening(name="o", shape=Box(corner=(0, 0), size=(10, 10)))
    assert cut(SQUARE, openings=[later]).block_count == 1


PARTS = "id,part,x,y\n1,0,0.2,0\n1,0,0.2,2\n1,1,0.8,0\n1,1,0.8,2\n"
CASE = """
schema = 1
time = {step = 1e-3, end = 5e-3}
rock.r = {young = 2e10, poisson = 0.2, density = 2700.0}
joint.default = {friction_angle = 30.0}
[domain]
boundary = [[0, 0], [1, 0], [1, 2], [0, 2]]
[[trace]]
file = "lines.csv"
"""


def test_parts_of_one_id_are_lines_of_their_own(tmp_path):
    (tmp_path / "lines.csv").write_text(PARTS)
    (tmp_path / "case.toml").write_text(CASE)
    report = json.loads(good("cut", tmp_path / "case.toml", "--json"))
    assert report["blocks"] == 3
    swapped = "\n".join(PARTS.splitlines()[k] for k in (0, 1, 3, 2, 4))
    (tmp_path / "lines.csv").write_text(swapped)
    assert len(read_traces(tmp_path / "lines.csv")[0]) == 2


def test_columns_that_are_not_read_are_named(tmp_path):
    (tmp_path / "lines.csv").write_text("x1,y1,x2,y2,aperture,filling\n0.5,0,0.5,2,3.5,calcite\n")
    (tmp_path / "case.toml").write_text(CASE)
    notes = " ".join(json.loads(good("cut", tmp_path / "case.toml", "--json"))["notes"])
    assert "aperture" in notes
    assert "filling" in notes
    assert len(read_traces(tmp_path / "lines.csv")[1]) == 2


@pytest.mark.parametrize(
    "text", ["root:hunter2:0\n", "PASSWORD=hunter2\n1\n", "a,b=hunter2\n1,2\n"]
)
def test_nothing_of_a_foreign_file_is_repeated(tmp_path, text):
    (tmp_path / "lines.csv").write_text(text)
    with pytest.raises(CaseError) as error:
        read_traces(tmp_path / "lines.csv")
    assert "hunter2" not in str(error.value)
