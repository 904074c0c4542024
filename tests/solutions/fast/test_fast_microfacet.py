import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from solutions import split_sum
from solutions.fast import microfacet_brdf

rng = np.random.default_rng(0)
NORMAL, VIEW = (fw.normalize(rng.normal(size=(4000, 3))) for _ in range(2))
TO_LIGHT = fw.normalize([1, 2, -0.5])


@pytest.mark.parametrize("alpha", [1e-4, 0.01, 0.3, 1.0])
def test_the_twin_reflects_what_the_reference_reflects(alpha):
    half = fw.normalize(VIEW + TO_LIGHT)
    near = fw.normalize(half + alpha * rng.normal(size=half.shape))  # where the narrow lobes are
    for normal in (NORMAL, near):
        expected = split_sum.microfacet_brdf(normal, VIEW, TO_LIGHT, (0.9, 0.5, 0.04), alpha)
        found = microfacet_brdf(normal, VIEW, TO_LIGHT, (0.9, 0.5, 0.04), alpha)
        assert (expected > 0).any()
        assert_allclose(found, expected, rtol=1e-6)


def test_whatever_else_the_contract_allows_is_left_to_the_reference():
    alpha = rng.uniform(0.1, 1, len(NORMAL))
    expected = split_sum.microfacet_brdf(NORMAL, VIEW, TO_LIGHT, 0.5, alpha)
    assert_array_equal(microfacet_brdf(NORMAL, VIEW, TO_LIGHT, 0.5, alpha), expected)
    assert microfacet_brdf(np.empty((0, 3)), np.empty((0, 3)), TO_LIGHT, 0.5, 0.5).shape == (0, 3)


@pytest.mark.parametrize("alpha", [0.0, 1e-8, 1e-4, 1.0])
def test_mirrors_and_directions_opposed_at_the_horizon_stay_finite(alpha):
    view = fw.normalize([[1.0, 0.0, 1e-170], [1.0, 0.0, 1e-9], [0.0, 0.0, 1.0]])
    up = np.broadcast_to([0.0, 0.0, 1.0], view.shape)
    for light in view * [-1, 1, 1]:
        found = microfacet_brdf(up, view, light, 0.5, alpha)
        assert np.isfinite(found).all()
        assert_allclose(found[1:], split_sum.microfacet_brdf(up, view, light, 0.5, alpha)[1:], rtol=1e-6, atol=1e-25)
