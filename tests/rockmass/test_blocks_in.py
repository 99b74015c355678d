"""Finished blocks in: archives, tables, drawings; which way they run, which joints they have."""

from __future__ import annotations

import ezdxf
import numpy as np
import pytest

from clast.errors import CaseError
from clast.rockmass.drawings.block_arrays import blocks_with, counter_clockwise, crossed_blocks
from clast.rockmass.drawings.blocks_out import write_blocks_csv, write_blocks_dxf, write_blocks_npz
from clast.rockmass.drawings.dxf import DxfReading
from clast.rockmass.readers import BlockReading, has_blocks, read_blocks

CORNER = np.array([1e6 / 3.0, 0.1])
VERTICES = CORNER + np.array([(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (2, 0), (1, 1)])
START = np.array([0, 4, 7])
ROCK = ("granite", "shale")
EDGE_JOINT = ("", "bedding", "", "", "", "", "bedding")
SYSTEM = (VERTICES, START, ROCK, EDGE_JOINT)
WRITERS = {".npz": write_blocks_npz, ".csv": write_blocks_csv, ".dxf": write_blocks_dxf}


@pytest.mark.parametrize("ending", WRITERS)
def test_what_is_written_is_read_again(tmp_path, ending):
    path = tmp_path / f"blocks{ending}"
    WRITERS[ending](path, *SYSTEM)
    found = read_blocks(path)
    np.testing.assert_array_equal(found.vertices, VERTICES)
    np.testing.assert_array_equal(found.block_start, START)
    assert (found.rock, found.edge_joint) == (ROCK, EDGE_JOINT)
    assert not found.left_out
    assert has_blocks(path) == (ending != ".dxf")


@pytest.mark.parametrize("ending", WRITERS)
def test_clockwise_blocks_are_turned_and_said(tmp_path, ending):
    """Edge 1 of the first block runs from corner 1 to 2; turned round it begins at corner 2."""
    vertices, joints = VERTICES.copy(), list(EDGE_JOINT)
    vertices[:4] = vertices[[0, 3, 2, 1]]
    joints[:4] = ["", "", "bedding", ""]
    path = tmp_path / f"blocks{ending}"
    WRITERS[ending](path, vertices, START, ROCK, joints)
    found = read_blocks(path)
    np.testing.assert_array_equal(found.vertices, VERTICES)
    assert found.edge_joint == EDGE_JOINT
    assert "1 blocks ran clockwise and were reversed: 1" in found.notes
    assert counter_clockwise(found) is found


def test_a_table_by_hand(tmp_path):
    path = tmp_path / "hand.csv"
    path.write_text(
        "y;block;x;colour\n0,5;a;0;red\n0;a;1;red\n1;a;1;red\n1;b;1;red\n2;b;2;\n2;b;1;\n"
    )
    found = read_blocks(path)
    assert found.polygon(0).tolist() == [[0, 0.5], [1, 0], [1, 1]]
    assert found.rock == ("rock", "rock") and set(found.edge_joint) == {""}
    assert found.name == ("a", "b")
    assert found.notes == ("decimal commas were read as points",)
    assert "column colour" in str(found.left_out[0])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("block,x\n1,0\n", "has no column y"),
        ("block,x,y\n1,0,0\n1,1,0\n", "line 2, column block: block 1 has 2 vertices"),
        ("block,x,y\n,0,0\n,1,0\n,1,1\n", "line 2, column block: names no block"),
        (
            "block,x,y\n1,0,0\n1,1,0\n1,1,1\n2,5,5\n2,6,5\n2,6,6\n1,0,1\n",
            "line 8, column block: goes on with block 1",
        ),
        ("block,x,y\n1,0,0\n1,1,0\n1,1,one\n", "line 4, column y: 'one' is not a number"),
    ],
)
def test_tables_that_are_none(tmp_path, text, said):
    path = tmp_path / "blocks.csv"
    path.write_text(text)
    with pytest.raises(CaseError) as caught:
        read_blocks(path)
    assert said in str(caught.value)


def drawn(path, change=None) -> None:
    """A drawing in millimetres: two blocks, a joint that is a little off, a text."""
    document = ezdxf.new("R2010", units=4)
    sheet = document.modelspace()
    one, other = VERTICES[:4] - VERTICES[0], VERTICES[4:] - VERTICES[0]
    for loop, layer in ((one, "granite"), (np.vstack([other, other[:1]]), "shale")):
        sheet.add_lwpolyline(1e3 * loop, close=layer == "granite", dxfattribs={"layer": layer})
    sheet.add_line((1000.2, -50), (1000.2, 1050), dxfattribs={"layer": "Joints_bedding"})
    sheet.add_text("Section", dxfattribs={"layer": "TITLE"})
    if change:
        change(sheet)
    document.saveas(path)


def test_a_drawing_of_closed_lines(tmp_path):
    path = tmp_path / "site.dxf"
    drawn(path)
    found = read_blocks(path, BlockReading(near=1e-3))
    np.testing.assert_allclose(found.vertices, VERTICES - VERTICES[0], atol=1e-9)
    assert (found.rock, found.edge_joint) == (ROCK, EDGE_JOINT)
    assert found.notes[0] == "$INSUNITS 4: millimetres"
    assert "TITLE" in str(found.left_out[0])
    # nearer than a millionth of the drawing nothing lies along the joint
    assert set(read_blocks(path).edge_joint) == {""}
    assert found.name == found.layer == ROCK
    layer = read_blocks(path, BlockReading(layer="SHALE", dxf=DxfReading(unit="m")))
    assert layer.count == 1 and layer.rock == ("rock",) and layer.vertices.max() == 2000.0


def test_drawings_without_blocks(tmp_path):
    path = tmp_path / "site.dxf"
    drawn(path, lambda sheet: sheet.add_lwpolyline([(0, 0), (9, 0)], dxfattribs={"layer": "A"}))
    assert any("closed line" in str(one) for one in read_blocks(path).left_out)
    with pytest.raises(CaseError, match="no closed line on the layer B"):
        read_blocks(path, BlockReading(layer="B"))


def test_what_cannot_be_a_block_is_named(tmp_path):
    document = ezdxf.new("R2010", units=6)
    sheet = document.modelspace()
    sheet.add_hatch(dxfattribs={"layer": "A"})
    for y in (0, 1):
        sheet.add_line((0, y), (1, y), dxfattribs={"layer": "A"})
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(CaseError, match="has no closed line, but 2 LINE, 1 HATCH") as caught:
        read_blocks(tmp_path / "a.dxf")
    assert "closed polyline, SOLID or 3DFACE; the layers are: A" in str(caught.value)


@pytest.mark.parametrize("turn", [0.0, 33.0])
@pytest.mark.parametrize("shift", [0, 1, 3])
@pytest.mark.parametrize("way", [1, -1])
def test_an_outline_drawn_again_is_one_block(tmp_path, turn, shift, way):
    """Whichever corner it begins at, whichever way it runs, with a corner more on an edge."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    loop = np.array([(0, 0), (2, 0), (2, 1), (0, 1)]) @ np.array([[c, s], [-s, c]]) + 1e4
    again = np.insert(np.roll(loop, shift, axis=0), 1, 0, axis=0)
    again[1] = 0.5 * (again[0] + again[2])
    document = ezdxf.new("R2010", units=6)
    sheet = document.modelspace()
    places = []
    for points, layer in ((loop, "wall"), (again[::way], "wall"), (loop + 5.0, "wall")):
        line = sheet.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
        places.append(f"LWPOLYLINE {line.dxf.handle} on layer {layer}")
    document.saveas(tmp_path / "a.dxf")
    found = read_blocks(tmp_path / "a.dxf")
    assert found.count == 2 and found.name == ("wall-1", "wall-2")
    said = f"outlines drawn again were taken once: {places[1]} (as {places[0]})"
    assert said in found.notes
    np.testing.assert_allclose(found.polygon(1), loop + 5.0)


COLUMNS, ROWS = 4, 3
CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
ROW = np.vstack([CORNERS + np.array([c, r]) for r in range(ROWS) for c in range(COLUMNS)])
ROW_START = np.arange(0, 4 * COLUMNS * ROWS + 1, 4)


@pytest.mark.parametrize(
    ("ends", "crossed", "middles"),
    [
        ([(-1, 0.25), (9, 0.25)], [0, 1, 2, 3], [(0.5 + k, 0.25) for k in range(4)]),
        # along the base: the lowest row
        ([(0.5, 0), (3.5, 0)], [0, 1, 2, 3], [(0.75, 0), (1.5, 0), (2.5, 0), (3.25, 0)]),
        # the diagonal passes corners
        ([(0, 0), (3, 3)], [0, 5, 10], [(0.5, 0.5), (1.5, 1.5), (2.5, 2.5)]),
        ([(-2, -2), (-1, 5)], [], np.zeros((0, 2))),
    ],
)
def test_blocks_that_a_line_crosses(ends, crossed, middles):
    blocks, points = crossed_blocks(ends, ROW, ROW_START)
    assert blocks.tolist() == crossed
    np.testing.assert_allclose(points, middles)


@pytest.mark.parametrize("seed", range(5))
def test_lines_at_random_against_sampling(seed):
    random = np.random.default_rng(seed)
    ends = random.uniform(-1, 5, (2, 2))
    blocks, points = crossed_blocks(ends, ROW, ROW_START)
    sampled = ends[0] + np.linspace(0, 1, 20001)[:, None] * (ends[1] - ends[0])
    cells = np.floor(sampled).astype(int)
    inside = ((cells >= 0) & (cells < (COLUMNS, ROWS))).all(axis=1)
    assert set(blocks) == {c + COLUMNS * r for c, r in cells[inside]}
    assert [int(x) + COLUMNS * int(y) for x, y in points] == blocks.tolist()


def test_points_lie_in_blocks_or_in_none():
    found = blocks_with([(0.5, 0.5), (3.5, 2.5), (9, 9), (1.0, 0.5)], ROW, ROW_START)
    assert found.tolist() == [0, 11, -1, 0]
    assert blocks_with(np.zeros((0, 2)), ROW, ROW_START).shape == (0,)
