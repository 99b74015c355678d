"""Measures of a point and a block with the same name."""

from functools import partial

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.study.expressions import read
from clast.study.measures import MEASURES, RunResults, check, known_names


@pytest.fixture(scope="module")
def turning():
    """Return the run of a block "crown" that turns, and of a point "crown" on its corner."""
    builder = clast.ModelBuilder(gravity=(0.0, 0.0))
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    builder.block(vertices=corners, name="crown", velocity=(1.0, 0.0, 1.0))
    builder.block(vertices=[(x + 5, y) for x, y in corners], name="block:only")
    builder.measured_point("crown", (1.0, 1.0), block="crown")
    return clast.simulate(builder, end=0.1, step=1e-2)


def value(run, text):
    expression = read(text, "measure", [], MEASURES)
    check(expression, known_names(run.model))
    results = RunResults(run)
    return expression.value({}, {k: partial(one.value, results) for k, one in MEASURES.items()})


def test_a_point_and_a_block_of_one_name_are_both_measured(turning):
    point = turning.history("crown").displacement[-1]
    block = turning.block("crown").displacement[-1]
    assert abs(point[1]) < abs(point[0]) and np.abs(point - block).max() > 1e-2
    for name, moved in (("crown", point), ('"point:crown"', point), ('"block:crown"', block)):
        for k, part in enumerate("xy"):
            assert value(turning, f"displacement({name}, {part})") == pytest.approx(moved[k])
    assert value(turning, 'rotation("block:crown")') == pytest.approx(np.degrees(0.1), rel=1e-3)
    assert value(turning, 'displacement("block:only")') == 0.0
    with pytest.raises(CaseError, match="there is no point or block 'bolt:crown'"):
        value(turning, 'displacement("bolt:crown")')
