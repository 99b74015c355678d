"""Names that have changed work for one version more, and say by which name to call them."""

import importlib
import warnings

import numpy as np
import pytest

from clast import rockmass
from clast.actions.action import ActionResult
from clast.case.api import ModelBuilder
from clast.contact.clipped_spring import clipped_from, table
from clast.model.state import Ledger
from clast.rockmass import BlockRepair

EARLIER = [
    ("clast.rockmass", "Mender", "BlockRepair"),
    ("clast.rockmass", "Report", "CutReport"),
    ("clast.inputs.builder", "ModelBuilder", "InputBuilder"),
    ("clast.actions.action", "Share", "Contribution"),
    ("clast.actions.action", "Done", "ActionResult"),
    ("clast.actions.action", "Telling", "ReportsEvents"),
]


@pytest.mark.parametrize(("module", "earlier", "name"), EARLIER)
def test_an_earlier_name_gives_the_object_and_warns(module: str, earlier: str, name: str):
    home = importlib.import_module(module)
    with pytest.warns(DeprecationWarning, match=f"is called {name} now"):
        assert getattr(home, earlier) is getattr(home, name)


def test_a_name_that_never_was_is_an_attribute_error():
    with pytest.raises(AttributeError, match="has no attribute 'Menders'"):
        rockmass.Menders  # noqa: B018


def test_a_builder_takes_mending_as_repair():
    with pytest.warns(DeprecationWarning, match="mending is called repair now"):
        builder = ModelBuilder(mending={"tolerance": 2e-3})
    assert builder.repair == BlockRepair(tolerance=2e-3)
    with pytest.warns(DeprecationWarning):
        builder.mending = {"tolerance": 3e-3}
    with pytest.warns(DeprecationWarning):
        assert builder.mending == BlockRepair(tolerance=3e-3)


def test_a_builder_without_earlier_names_warns_of_nothing():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        builder = ModelBuilder(repair={"tolerance": 2e-3})
        assert "mending" not in repr(builder)
        assert builder == builder


def test_arms_of_springs_and_states_of_actions_are_known_by_their_earlier_names():
    one = np.ones(1)
    given = {
        "vertex_block": np.array([0]),
        "edge_block": np.array([1]),
        "gap": one,
        "slip": one,
        "normal": clipped_from(one, one, -one, one),
        "shear": clipped_from(one, one, -one, one),
    }
    with pytest.warns(DeprecationWarning, match="levers is called arms now"):
        springs, _ = table(levers=np.ones((1, 6)), **given)
    with pytest.warns(DeprecationWarning, match="levers is called arms now"):
        assert springs.levers is springs.arms
    with pytest.warns(DeprecationWarning, match="own is called state now"):
        assert ActionResult(work=0.0, ledger=Ledger(), own=7).state == 7
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table(arms=np.ones((1, 6)), **given)
        ActionResult(work=0.0, ledger=Ledger(), state=7)
    with pytest.raises(TypeError, match="lacks arms"):
        table(**given)


def test_absent_blocks_are_known_as_gone_to_scripts():
    builder = ModelBuilder()
    builder.add_rock("stone", young=1e9, poisson=0.2, density=2500.0)
    builder.add_joint(friction_angle=30.0)
    builder.block(name="brick", vertices=[(0, 0), (1, 0), (1, 1)])
    model = builder.build()
    with pytest.warns(DeprecationWarning, match="gone is called absent now"):
        assert model.gone is model.absent
