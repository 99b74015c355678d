"""Nothing depends on how blocks are numbered, or on where and which way round a case lies."""

import numpy as np
import pytest

from clast.case.case_file import Case
from clast.contact.joints.wear import after_slip
from clast.read_only import changed
from clast.results import Run
from clast.step import finish
from scenes.jittered import excavated, thrown
from scenes.parted import Placed
from scenes.views import Tables, View

FIRST = View()
VIEWS = {
    "numbers": View(order=7),
    "mirrored": View(place=Placed(flip=-1.0), order=-1),
    "turned": View(place=Placed(turn=np.radians(37.0))),
    "moved": View(place=Placed(at=(1e5, -1e5))),
}


def seen(case: Tables, view: View) -> tuple[np.ndarray, Run]:
    """Return how far the vertices of a case have moved, m, (k, 2), and its run."""
    run = Case.model_validate(view.seen(case)).run(warn=lambda text: None)
    return view.displacements(run, [one["name"] for one in case["block"]]), run


@pytest.mark.parametrize("seed", range(8))
def test_stages_do_not_depend_on_the_view(seed: int) -> None:
    """Rounding of coordinates and of springs of some GN/m2 leaves 1e-8 of the movement."""
    case = excavated(seed)
    moved, run = seen(case, FIRST)
    stages = [(one.name, one.outcome, one.steps) for one in run.report.stages]
    assert len(stages) == len(case["stage"])
    for name, view in VIEWS.items():
        if name == "turned" and "water" in case:
            continue  # its surface is level
        other, again = seen(case, view)
        assert np.abs(other - moved).max() < 1e-6 * np.abs(moved).max(), name
        assert [(one.name, one.outcome, one.steps) for one in again.report.stages] == stages


@pytest.mark.parametrize("seed", range(18))
def test_impacts_links_and_motions_do_not_depend_on_the_view(seed: int) -> None:
    """Moments of links are forces at arms so long that rounding is 1e-8 of a block.

    Of rough contacts it is judged when a step begins which slide and which open by it, so that
    rounding may decide: 7e-6 in one system of these.
    """
    case = thrown(seed)
    within = 1e-5 if "law" in case["joint"]["default"] else 1e-7
    moved, run = seen(case, FIRST)
    assert run.report.steps >= 8
    for name, view in VIEWS.items():
        other, _ = seen(case, view)
        assert np.abs(other - moved).max() < within, name


def test_a_rounding_error_is_no_force_at_the_beginning_of_a_step(monkeypatch) -> None:
    """Of rough contacts that land the angle is that of the force at the end of their step."""
    ends, landed = [], 0

    def noted(*given):
        ends.append(given)
        return after_slip(*given)

    monkeypatch.setattr(finish, "after_slip", noted)
    seen(thrown(3), FIRST)
    for asperities, contacts, response, *rest in ends:
        begun, lands = contacts.normal_force, (contacts.normal_force == 0.0) & (response.mode > 0)
        nearly = changed(contacts, normal_force=np.where(lands, 1e-11, begun))
        opened, other = (
            after_slip(asperities, one, response, *rest).wear.dilation for one in (contacts, nearly)
        )
        np.testing.assert_allclose(other, opened, rtol=0, atol=1e-12)
        landed += int((lands & (opened > 0.0)).sum())
    assert landed > 0
