"""Tractions of in-situ stress are those of Cauchy: sigma n."""

from __future__ import annotations

import numpy as np

from clast.actions.in_situ import tractions


def test_tractions_are_stress_times_normal():
    random = np.random.default_rng(3)
    stress = random.normal(size=(20, 3))
    angle = random.uniform(0.0, 2.0 * np.pi, 20)
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    exact = [
        np.array([[xx, xy], [xy, yy]]) @ n for (xx, yy, xy), n in zip(stress, normal, strict=True)
    ]
    np.testing.assert_allclose(tractions(stress, normal), exact, rtol=1e-14)


def test_compression_pushes_on_a_face_and_tension_pulls():
    right = np.array([[1.0, 0.0]])
    assert tractions(np.array([[-2e6, 0.0, 0.0]]), right)[0].tolist() == [-2e6, 0.0]
    assert tractions(np.array([[0.0, 0.0, 3e5]]), right)[0].tolist() == [0.0, 3e5]
