"""Designs for indices of sensitivity, and the indices of functions whose variance is known."""

from __future__ import annotations

import numpy as np
import pytest

import clast
from clast.errors import CaseError
from clast.study.description import MONTECARLO, Description, parameters_of, sampling_of
from clast.study.statistics import StudyResults, influences, probability, sensitivities

A, B = 7.0, 0.1


def described(sampling: str, n: int, **changes: object) -> Description:
    given: dict[str, object] = {
        "vary": parameters_of(
            {name: "uniform(-3.141592653589793, 3.141592653589793)" for name in "xyz"}
        ),
        "measure": {"u": "steps()"},
        "sampling": sampling_of(sampling, seed=3),
        "n": n,
        "kind": MONTECARLO,
    }
    return Description(**{**given, **changes}).checked()  # type: ignore[arg-type]


def results(study: Description, function: object, lost: tuple[int, ...] = ()) -> StudyResults:
    runs = [run for run in range(1, study.n + 1) if run not in lost]
    points = np.array([study.values(run) for run in runs], np.float64)
    return StudyResults(
        study=study,
        run=np.array(runs, np.float64),
        parameters=dict(zip((one.name for one in study.vary), points.T, strict=True)),
        measures={"u": function(*points.T)},  # type: ignore[operator]
        fails=np.zeros(0),
        blocks={},
        joints={},
        reasons={},
    )


def ishigami(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    return np.sin(x) + A * np.sin(y) ** 2 + B * z**4 * np.sin(x)


def test_sobol_indices_of_ishigamis_function() -> None:
    """V1 = (1 + b pi^4/5)^2/2, V2 = a^2/8, V13 = 8 b^2 pi^8/225 (Ishigami and Homma 1990)."""
    pytest.importorskip("SALib")
    study = described("saltelli", 5 * 512)
    found = results(study, lambda *x: 1e4 + ishigami(*x), lost=(7, 1000))
    v1, v2 = 0.5 * (1 + B * np.pi**4 / 5) ** 2, A**2 / 8
    v13 = 8 * B**2 * np.pi**8 / 225
    whole = v1 + v2 + v13
    exact = {"x": (v1, v1 + v13), "y": (v2, v2), "z": (0.0, v13)}
    indices = sensitivities(found, found.measures["u"])
    assert list(indices) == ["x", "y", "z"]
    for name, index in indices.items():
        first, total = (value / whole for value in exact[name])
        assert index["first"] == pytest.approx(first, abs=0.05)
        assert index["total"] == pytest.approx(total, abs=0.05)
        assert abs(index["total"] - total) < 1.5 * index["plus or minus of total"]
        assert abs(index["first"] - first) < 1.5 * index["plus or minus"]


def test_elementary_effects_of_a_plane_are_its_slopes() -> None:
    pytest.importorskip("SALib")
    study = described("morris", 4 * 10)
    found = results(study, lambda x, y, z: 3.0 * x - 5.0 * y + 0.0 * z)
    indices = sensitivities(found, found.measures["u"])
    reach = 0.98 * 2.0 * np.pi  # from probability 0.01 to 0.99
    assert list(indices) == ["y", "x", "z"]
    assert [one["mu"] / reach for one in indices.values()] == pytest.approx(
        [-5.0, 3.0, 0.0], abs=1e-9
    )
    assert [one["mu*"] / reach for one in indices.values()] == pytest.approx(
        [5.0, 3.0, 0.0], abs=1e-9
    )
    assert all(one["sigma"] < 1e-9 for one in indices.values())
    assert influences(found, found.measures["u"]) == []
    assert probability(found) is None


@pytest.mark.parametrize(("sampling", "size"), [("saltelli", 5), ("morris", 4)])
def test_each_run_of_a_group_changes_one_parameter(sampling: str, size: int) -> None:
    study = described(sampling, 16 * size)
    points = np.array([study.values(run) for run in range(1, study.n + 1)], np.float64)
    groups = points.reshape(16, size, 3)
    if sampling == "morris":
        changed = (np.diff(groups, axis=1) != 0.0).sum(axis=2)
        assert (changed == 1).all()
        ways = {tuple(np.abs(np.diff(one, axis=0)).argmax(axis=1)) for one in groups}
        assert len(ways) > 3
    else:
        for one in groups:
            for k in range(3):
                assert (one[k + 1] == np.where(np.arange(3) == k, one[-1], one[0])).all()
    # every parameter goes through all of its range
    assert (points.min(axis=0) < -2.5).all() and (points.max(axis=0) > 2.5).all()


def test_what_does_not_change_has_no_indices_and_too_few_runs_are_said() -> None:
    study = described("morris", 8)
    still = results(study, lambda x, y, z: 0.0 * x)
    assert sensitivities(still, still.measures["u"]) == {}
    few = results(study, lambda x, y, z: x, lost=(2,))
    with pytest.raises(CaseError, match="too few groups"):
        sensitivities(few, few.measures["u"])


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"n": 33}, "not a power of two times 5"),
        ({"n": 5}, "not a power of two times 5"),
        ({"sampling": "morris", "n": 10}, "not several paths of 4"),
        ({"correlate": (("x", "y", 0.5),)}, "none can be correlated"),
        ({"vary": parameters_of({"x": "numbered(1)", "y": clast.Uniform(0, 1)})}, "the run number"),
    ],
)
def test_designs_that_cannot_be_made_are_refused(changes: dict[str, object], what: str) -> None:
    with pytest.raises(CaseError, match=what):
        described(**{"sampling": "saltelli", "n": 40, **changes})  # type: ignore[arg-type]
