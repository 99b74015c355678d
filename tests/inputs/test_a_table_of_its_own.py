"""A table with an action, declared here: nothing else of clast has to know of it.

In the package the class would be in `inputs/`, its action in `actions/`, the key in `Case` and the
method in `ModelBuilder`: four files.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import pytest
from pydantic import Field, StrictStr

import clast
from clast.actions.action import ActionResult, Contribution, energy_of_springs
from clast.block import polygon
from clast.block.displacement import movements
from clast.case.api import ModelBuilder
from clast.contact.clipped_spring import Clipped, table
from clast.errors import CaseError, ModelError
from clast.inputs.declaring.alternatives import within
from clast.inputs.declaring.builder_methods import gives
from clast.inputs.declaring.table import Point, Positive, Table
from clast.model import ranges
from clast.model.state import Ledger


@dataclass(frozen=True, kw_only=True, eq=False)
class LinearSprings:
    """Springs f = -k (l - l0) between two points each."""

    block: Any
    at: Any
    stiffness: Any

    def begin(self, model):
        return self.at

    def contribution(self, start, state):
        way = state[:, 0] - state[:, 1]
        length = np.hypot(*way.T)
        before = np.hypot(*(self.at[:, 0] - self.at[:, 1]).T)
        zero = np.zeros(len(length))
        offset = state - start.frames.centroid[self.block]
        springs, _ = table(
            vertex_block=self.block[:, 0],
            edge_block=self.block[:, 1],
            arms=np.hstack([way / length[:, None], offset[:, 0], offset[:, 1]]),
            gap=length - before,
            slip=zero,
            normal=Clipped(
                at_zero=zero, stiffness=self.stiffness, low=zero - np.inf, high=zero + np.inf
            ),
            shear=Clipped(at_zero=zero, stiffness=zero, low=zero, high=zero),
        )
        return Contribution(springs=springs)

    def finish(self, start, state, contribution, solution):
        work, stored = energy_of_springs(contribution.springs, solution)
        block, at = self.block.ravel(), state.reshape(-1, 2)
        offset = polygon.offsets(at, block, start.frames.centroid)
        moved = movements(start.rotation, offset, solution.displacement, block)
        return ActionResult(
            work=work, ledger=Ledger(actions=stored), state=(at + moved).reshape(-1, 2, 2)
        )


class Spring(Table):
    """A linear spring between two points, which move with their blocks."""

    start: Point
    """One end [x, y], in a block or on its face, m."""
    end: Point
    """Other end [x, y], in another block, m."""
    blocks: tuple[StrictStr, StrictStr] | None = None
    """Blocks of both ends; needed only where blocks touch."""
    stiffness: Annotated[Positive, within(ranges.STIFFNESS)]
    """Force per elongation, N/m per m."""

    @classmethod
    def actions(cls, records: Sequence[Any], ground: Any) -> Iterable[Any]:
        """Return the action of all springs."""
        lines = [np.array([one.start, one.end]) - ground.outlines.origin for one in records]
        blocks = [
            ground.blocks_of_ends(f"spring {k}", line, one.blocks)
            for k, (line, one) in enumerate(zip(lines, records, strict=True), 1)
        ]
        stiffness = np.array([one.stiffness for one in records])
        yield LinearSprings(block=np.array(blocks), at=np.array(lines), stiffness=stiffness)


class Builder(ModelBuilder):
    spring = gives("spring", Spring, "start", "end")


class Case(clast.Case):
    spring: list[Spring] = Field([])
    """Linear springs between blocks."""


def hanging(shift: float = 0.0) -> Builder:
    builder = Builder(title="A stone on a spring")
    builder.add_rock("stone", young=5e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    box = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    builder.block(name="beam", vertices=3 * box + np.array([shift, 5.0]), fixed=True)
    builder.block(name="stone", vertices=box + np.array([shift, 0.0]))
    return builder


@pytest.mark.parametrize("shift", [0.0, 1e5])
def test_its_records_act_from_a_script_and_from_a_file(shift: float):
    builder = hanging(shift)
    builder.spring((shift + 0.5, 1.0), (shift + 0.5, 5.0), stiffness=1e6)
    keys: dict[str, Any] = {"end": 2.0, "step": 0.1, "dynamic_ratio": 0.0}
    run = clast.simulate(builder.build(), **keys)
    sag = -run.block("stone").displacement[-1, 1]
    assert sag == pytest.approx(2500.0 * 9.8 / 1e6, rel=1e-4)
    plain = hanging(shift).to_toml(**keys)
    ends = f"start = [{shift + 0.5}, 1.0]\nend = [{shift + 0.5}, 5.0]\n"
    again = Case.from_toml(f"{plain}\n[[spring]]\n{ends}stiffness = 1e6\n")
    assert -again.run().block("stone").displacement[-1, 1] == sag
    assert Case.from_toml(again.to_toml()).spring == again.spring


def test_it_is_refused_in_the_same_words_from_both():
    plain = hanging().to_toml()
    with pytest.raises(CaseError, match=r"\[\[spring\]\] 1 stifness: there is no such key") as said:
        Case.from_toml(plain + "\n[[spring]]\nstart = [0, 1]\nend = [0, 5]\nstifness = 1\n")
    assert "did you mean 'stiffness'" in str(said.value)
    with pytest.raises(ModelError, match=r"\[\[spring\]\] 1 stifness: there is no such key"):
        hanging().spring((0, 1), (0, 5), stifness=1)
    builder = hanging()
    builder.spring((9, 9), (0.5, 5.0), stiffness=1e6)
    with pytest.raises(ModelError, match=r"spring 1, start at \(9, 9\): lies outside every block"):
        builder.build()
    assert "spring" in Case.model_json_schema()["properties"]
