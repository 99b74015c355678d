"""Sums over regions, whether threads share them or not."""

import numpy as np
import pytest

from clast.compute.chunks import MANY, SHARED
from clast.minimise import island_sums as region_sums


@pytest.mark.parametrize("regions", [1, 5, 500])
@pytest.mark.parametrize("blocks", [30, SHARED - 1, SHARED, 5 * SHARED + 17])
def test_sums_of_blocks(regions, blocks):
    rng = np.random.default_rng(blocks + regions)
    region = rng.integers(0, regions, blocks)
    a, b = rng.normal(size=(2, blocks, 6))
    matrices = rng.normal(size=(blocks, 6, 6))
    matrices += matrices.transpose(0, 2, 1)

    if blocks % 2:
        region.sort()  # runs as long as can be

    def total(values):
        return np.bincount(region, values, regions)

    forms = np.einsum("ni,nij,nj->n", a, matrices, a)
    scale = np.abs(forms).sum()
    assert region_sums.forms(matrices, a, region, regions) == pytest.approx(
        total(forms), abs=1e-14 * scale
    )
    assert region_sums.products(a, b, region, regions) == pytest.approx(
        total((a * b).sum(axis=1)), abs=1e-12 * blocks
    )
    length = rng.normal(size=regions)
    assert region_sums.advanced(a, b, length, region) == pytest.approx(
        a + length[region][:, None] * b, rel=1e-14, abs=1e-14
    )


@pytest.mark.parametrize("regions", [1, 3, 70])
@pytest.mark.parametrize("contacts", [0, 10, MANY, 3 * MANY + 5])
def test_works_of_contacts(regions, contacts):
    rng = np.random.default_rng(contacts + regions)
    region = rng.integers(0, regions, contacts)
    normal, opening, shear, slip = rng.normal(size=(4, contacts))
    if contacts % 2:
        region.sort()
    wanted = np.bincount(region, normal * opening + shear * slip, regions)
    found = region_sums.works(normal, opening, shear, slip, region, regions)
    assert found == pytest.approx(wanted, abs=1e-12 * (contacts + 1))
    assert region_sums.sums(normal, region, regions) == pytest.approx(
        np.bincount(region, normal, regions), abs=1e-12 * (contacts + 1)
    )
