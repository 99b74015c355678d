"""[domain] profile: the ground below an open line, from the case, a table, a drawing, a script."""

from __future__ import annotations

import ezdxf
import numpy as np
import pytest

import clast
from clast.case.case_file import Case
from clast.errors import CaseError, ModelError
from clast.model.arrays import areas

PROFILE = [[0, 0], [20, 0], [32, 18], [32.5, 18], [40, 18]]
OVERHANG = [[0, 0], [20, 0], [18, 5], [30, 10], [40, 10]]
HEAD = """schema = 1
time = {step = 1e-3, end = 1e-2}
rock.a = {young = 1e9, poisson = 0.2, density = 2e3}
joint.default = {friction_angle = 30}
joint_set = [{name = "a", spacing = 5.0, angle = 0.0, origin = [0, 1]}]
"""


def case(domain: str, folder=None) -> Case:
    text = HEAD + f'[domain]\nfixed_sides = ["left", "bottom", "right"]\n{domain}'
    if folder is None:
        return Case.from_toml(text)
    (folder / "a.toml").write_text(text, encoding="utf-8")
    return Case.from_toml(folder / "a.toml")


def below(profile, depth: float, sides=(0.0, 0.0)) -> float:
    """Return the area below a profile by the trapezoidal rule, m2."""
    (x, y), (left, right) = np.transpose(profile).astype(float), sides
    bottom = y.min() - depth
    ends = left * (y[0] - bottom) + right * (y[-1] - bottom)
    return float(np.trapezoid(y - bottom, x) + ends)


@pytest.mark.parametrize("profile", [PROFILE, OVERHANG, PROFILE[::-1]])
@pytest.mark.parametrize("sides", [(0.0, 0.0), (12.0, 30.0)])
def test_the_ground_below_a_profile(profile, sides):
    given = f"profile = {profile}\ndepth = 10\nsides = {list(sides)}"
    cut = case(given).cut()
    area = float(areas(cut.cut.vertices, cut.cut.block_start).sum())
    rising = profile if profile[0][0] == 0 else profile[::-1]
    assert area == pytest.approx(below(rising, 10.0, sides), rel=1e-9)
    low, high = cut.cut.vertices.min(axis=0), cut.cut.vertices.max(axis=0)
    assert low.tolist() == [-sides[0], -10.0] and high[0] == 40.0 + sides[1]
    # as the closed outline that a user would draw
    corners = clast.rockmass.profile_outline(profile, 10.0, sides)
    same = case(f"boundary = {corners.tolist()}").cut()
    np.testing.assert_array_equal(same.cut.vertices, cut.cut.vertices)
    np.testing.assert_array_equal(same.fixed, cut.fixed)


def test_a_profile_of_a_file(tmp_path):
    whole = case(f"profile = {PROFILE}\ndepth = 10").cut().cut.vertices
    rows = "".join(f"{x},{y}\n" for x, y in PROFILE)
    (tmp_path / "p.csv").write_text(f"x,y\n{rows}")
    document = ezdxf.new("R2010", units=6)
    sheet = document.modelspace()
    sheet.add_lwpolyline(PROFILE[2:], dxfattribs={"layer": "GROUND"})
    sheet.add_lwpolyline(PROFILE[2::-1], dxfattribs={"layer": "GROUND"})
    sheet.add_line((0, 0), (1, 1), dxfattribs={"layer": "TWO"})
    sheet.add_line((2, 2), (3, 3), dxfattribs={"layer": "TWO"})
    document.saveas(tmp_path / "p.dxf")
    for source in ('file = "p.csv"', 'file = "p.dxf", layer = "ground"'):
        found = case(f"profile = {{{source}}}\ndepth = 10", tmp_path).cut().cut.vertices
        np.testing.assert_array_equal(found, whole)
    with pytest.raises(ModelError, match="the layer two has 2 lines that do not join"):
        case('profile = {file = "p.dxf", layer = "two"}\ndepth = 10', tmp_path).cut()
    (tmp_path / "p.csv").write_text("x1,y1,x2,y2\n0,0,1,1\n")
    with pytest.raises(ModelError, match="is not a profile"):
        case('profile = {file = "p.csv"}\ndepth = 10', tmp_path).cut()


@pytest.mark.parametrize(
    ("domain", "said"),
    [
        ("depth = 10", "has neither boundary nor profile"),
        (f"profile = {PROFILE}\nboundary = {PROFILE}\ndepth = 1", "has boundary and profile"),
        (f"profile = {PROFILE}", r"\[domain\] depth: is missing beside profile"),
        (f"boundary = {PROFILE}\nsides = [1, 1]", "goes with a profile, not a boundary"),
        (f"profile = {PROFILE}\ndepth = 0", "depth"),
        ("profile = [[0, 0], [-3, 5], [40, 10]]\ndepth = 5", r"\(-3, 5\) lies beyond the sides"),
        ("profile = [[0, 0], [9, 9], [9, 0], [0, 5], [20, 5]]\ndepth = 5", "crosses"),
    ],
)
def test_profiles_that_are_none(domain, said):
    with pytest.raises(CaseError, match=f"(?s){said}"):
        case(domain).cut()
