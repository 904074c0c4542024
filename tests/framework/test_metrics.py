"""Metrics: values that can be had by hand, and what they refuse."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from framework import metrics

ONE, TWO = np.ones((4, 5, 3)), np.full((4, 5, 3), 3.0)


def test_values_by_hand():
    assert metrics.rmse(TWO, ONE) == 2
    assert_allclose(metrics.relmse(TWO, ONE), 4 / 1.01)
    assert metrics.maximum([1, 2, 7], [1, 1, 1]) == 6
    assert_allclose(metrics.percentile(np.arange(101.0), np.zeros(101), 90), 90)
    assert metrics.rmse(ONE, ONE) == metrics.relmse(ONE, ONE) == 0


def test_sums_are_made_in_float64():
    many = np.full(4_000_000, 0.1, dtype=np.float32)
    assert_allclose(metrics.rmse(many, np.zeros_like(many)), np.float64(np.float32(0.1)), rtol=1e-12)
    assert_allclose(metrics.rmse([1e200, 0], [0, 0]), 1e200 / np.sqrt(2))
    assert_allclose(metrics.rmse([1e-200, 0], [0, 0]), 1e-200 / np.sqrt(2))


@pytest.mark.parametrize("name", ["rmse", "relmse", "maximum", "flip"])
def test_what_is_not_finite_or_not_alike_is_refused(name):
    metric = getattr(metrics, name)
    bad = ONE.copy()
    bad[0, 0, 0] = np.nan
    for image, reference, why in ((bad, ONE, "image are not finite"), (ONE, bad, "reference are not finite"),
                                  (ONE, ONE[:2], "shape"), (ONE[:0], ONE[:0], "empty")):  # fmt: skip
        with pytest.raises(ValueError, match=why):
            metric(image, reference)


def test_flip_is_zero_for_equal_images_and_grows():
    pytest.importorskip("flip_evaluator", reason="flip-evaluator has no wheel for this system")
    rng = np.random.default_rng(0)
    image = rng.random((32, 32, 3))
    assert metrics.flip(image, image)[0] == 0
    means = [metrics.flip(image + s * rng.random(image.shape), image, hdr=True)[0] for s in (0.05, 0.5)]
    assert 0 < means[0] < means[1] <= 1
    assert metrics.flip(image, image[::-1], hdr=False)[1].shape == (32, 32)
