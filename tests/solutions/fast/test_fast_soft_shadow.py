import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import framework as fw
from framework import sdf
from solutions import soft_shadows
from solutions.fast import soft_shadow

SCENE = sdf.union(
    sdf.sphere((0, 1, 0), 0.6),
    sdf.torus((1, 0.5, 0), 0.5, 0.2),
    sdf.plane((0, 1, 0), 0),
    sdf.smooth_union(sdf.sphere((0, 0.5, 1), 0.3), sdf.box((0.4, 0.5, 1), (0.2, 0.1, 0.3)), 0.2),
)
TO_LIGHT = fw.normalize([0.5, 0.8, 0.3])


def floor(count):
    x, z = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-2.5, 2.5, count)] * 2))
    return np.stack([x, np.full_like(x, 0.005), z], axis=-1)


@pytest.mark.parametrize("k", [2.0, 8.0, 64.0])
def test_the_twin_sees_what_the_reference_sees(k):
    # float32 is right to 1e-7 of the distance; k / t_min = 3200 times that at the very start of a ray.
    arguments = floor(70), TO_LIGHT, k, 0.02, 12.0, 512
    expected = soft_shadows.soft_shadow(SCENE, *arguments)
    assert 0.1 < np.mean(expected < 1) < 0.9
    assert_allclose(soft_shadow(SCENE, *arguments), expected, rtol=0, atol=1e-4)


def test_what_has_no_tree_is_marched_by_the_reference():
    arguments = floor(6), TO_LIGHT, 8.0, 0.02, 12.0, 64
    expected = soft_shadows.soft_shadow(SCENE, *arguments)
    assert_array_equal(soft_shadow(lambda p: SCENE(p), *arguments), expected)
    toward = np.broadcast_to(TO_LIGHT, (36, 3))
    assert_array_equal(soft_shadow(SCENE, floor(6), toward, 8.0, 0.02, 12.0, 64), expected)
    assert soft_shadow(SCENE, np.empty((0, 3)), *arguments[1:]).shape == (0,)
