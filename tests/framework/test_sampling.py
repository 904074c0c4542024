"""Low-discrepancy points, and half vectors of GGX."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import framework as fw
from framework.sampling import van_der_corput


def test_van_der_corput_mirrors_the_bits():
    assert_allclose(van_der_corput(np.arange(8)), [0, 1 / 2, 1 / 4, 3 / 4, 1 / 8, 5 / 8, 3 / 8, 7 / 8])
    assert_allclose(van_der_corput([2**16, 2**31, 2**32 - 1]), [2.0**-17, 2.0**-32, 1 - 2.0**-32], rtol=1e-15)
    for index in (-1, 2**32, 0.5):
        with pytest.raises(ValueError, match="whole numbers"):
            van_der_corput(index)


def test_every_elementary_interval_of_hammersley_has_its_point():
    points = fw.hammersley(256)
    for bits in range(9):
        cells = np.floor(points * [2**bits, 2 ** (8 - bits)]).astype(int)
        assert len(np.unique(cells, axis=0)) == 256
    shifted = fw.hammersley(64, (0.3, 0.999999))
    assert shifted.min() >= 0 and shifted.max() < 1


@pytest.mark.parametrize("alpha", [1e-4, 1e-2, 0.25, 1.0])
def test_half_vectors_of_ggx_have_their_closed_distribution(alpha):
    """The projected density D cos has the cumulative u(tan^2) = tan^2 / (tan^2 + alpha^2): Walter et al. 2007."""
    xi = np.random.default_rng(1).random((40000, 2))
    h = fw.sample_ggx(xi, alpha)
    assert_allclose(np.linalg.norm(h, axis=1), 1, atol=1e-12)
    tan2 = (h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2
    u = np.sort(tan2 / (tan2 + alpha**2))
    # Kolmogorov-Smirnov: 1.95 / sqrt(N) is exceeded once in a thousand
    assert np.abs(u - (np.arange(40000) + 0.5) / 40000).max() < 1.95 / np.sqrt(40000)
    azimuth = np.sort(np.arctan2(h[:, 1], h[:, 0]) / (2 * np.pi) + 0.5)
    assert np.abs(azimuth - (np.arange(40000) + 0.5) / 40000).max() < 1.95 / np.sqrt(40000)


@pytest.mark.parametrize(
    ("xi", "alpha"), [(np.zeros((4, 3)), 0.5), (np.ones((4, 2)), 0.5), (np.zeros((4, 2)), 0.0)]
)
def test_points_and_widths_out_of_range_are_refused(xi, alpha):
    with pytest.raises(ValueError, match="sample_ggx"):
        fw.sample_ggx(xi, alpha)
