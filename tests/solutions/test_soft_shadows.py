"""The reference of soft_shadows against closed forms, hand-made marches, and light sampled ray by ray."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from solutions.soft_shadows import area_light_shadow, needs_shadow_ray, penumbra, safe_angle, soft_shadow
from solutions.sphere_tracing import sdf_box, sdf_sphere

UP = np.array([0.0, 1.0, 0.0])


def ball_above(p):
    return sdf_sphere(p, (0, 3, 0), 1.0)


def test_a_safe_angle_is_that_of_the_tangent_to_the_safe_ball():
    angle = np.linspace(0, np.pi / 2, 20)
    assert_allclose(safe_angle(3.0 * np.sin(angle), 3.0), angle, atol=1e-7)


@pytest.mark.parametrize(
    ("distance", "travelled", "expected"),
    [(0, 1, 0), (-1, 1, 0), (0, 0, 0), (-1, -2, 0), (2, 1, np.pi / 2), (1, 1, np.pi / 2), (1, 0, np.pi / 2)]
    + [(1, -1, np.pi / 2), (1e-308, 1e308, 0), (np.inf, 1, np.pi / 2)],
)
def test_a_safe_angle_is_defined_everywhere(distance, travelled, expected):
    assert safe_angle(distance, travelled) == expected
    assert_array_equal(safe_angle(np.array([distance, 1.0]), travelled)[0], expected)


@pytest.mark.parametrize(
    ("distance", "travelled", "expected"),
    [(0, 1, 0), (-1, 1, 0), (0, 0, 0), (-1, -2, 0), (0.05, 1, 0.4), (0.125, 1, 1), (5, 1, 1), (1e-300, 0, 1)]
    + [(1, -1, 1), (np.inf, 1, 1)],
)
def test_a_penumbra_is_k_times_the_ratio_clamped_and_defined_everywhere(distance, travelled, expected):
    assert_allclose(penumbra(distance, travelled, 8.0), expected, rtol=1e-15)


@pytest.mark.parametrize("function", [safe_angle, lambda d, t: penumbra(d, t, 8.0)])
def test_arguments_broadcast_and_may_be_empty(function):
    assert function(np.ones((3, 1)), np.ones(4)).shape == (3, 4)
    assert function(np.zeros(0), 1.0).shape == (0,)


def test_a_point_needs_a_ray_only_where_the_light_is_above_its_horizon():
    normal = np.array([[0, 1, 0], [0, -1, 0], [1, 0, 0], [0.6, 0.8, 0]])
    assert_array_equal(needs_shadow_ray(normal, UP), [True, False, False, True])
    assert_array_equal(needs_shadow_ray(normal, normal), True)
    assert needs_shadow_ray(np.zeros((0, 3)), UP).shape == (0,)


def shadow(origin, k=8.0, sdf=ball_above, t_min=0.02, t_max=12.0, max_steps=256):
    return soft_shadow(sdf, np.atleast_2d(origin).astype(float), UP, k, t_min, t_max, max_steps)


def test_a_shadow_is_the_smallest_penumbra_of_the_visited_points():
    t, expected = 0.02, 1.0
    while t <= 12.0:
        distance = ball_above(np.array([1.3, t, 0.0]))
        expected, t = min(expected, 8.0 * distance / t), t + distance
    assert 0 < expected < 1
    assert_allclose(shadow([1.3, 0, 0]), [expected], rtol=1e-12)


def test_a_ray_that_hits_is_dark_and_one_far_away_is_lit():
    assert_array_equal(shadow([[0, 0, 0], [0.99, 0, 0], [5, 0, 0]]), [0, 0, 1])


def test_a_ray_is_blocked_below_a_ten_thousandth_and_not_above():
    for gap, expected in ((0.9e-4, 0.0), (1.1e-4, 1.0)):
        wall = lambda p, gap=gap: np.where(p[:, 1] < 0.5, 0.5, gap)  # noqa: E731
        assert shadow([0, 0, 0], k=1e9, sdf=wall, max_steps=3)[0] == expected


def test_a_ray_out_of_steps_keeps_what_it_has():
    before_the_last = shadow([1.3, 0, 0], max_steps=2)
    assert shadow([1.3, 0, 0], max_steps=3) <= before_the_last
    assert_array_equal(
        shadow([0, 0, 0], max_steps=1), penumbra(ball_above(np.array([[0, 0.02, 0]])), 0.02, 8.0)
    )
    assert_array_equal(shadow([0, 0, 0], max_steps=0), 1)


def test_what_lies_beyond_t_max_casts_no_shadow():
    assert shadow([0, 0, 0], k=1e9, t_max=1.9) == 1
    assert shadow([0, 0, 0], k=1e9, t_max=2.1) == 0


def test_harder_light_gives_less_penumbra():
    line = np.stack([np.linspace(0, 3, 200), np.zeros(200), np.zeros(200)], axis=-1)
    soft, medium, hard = (shadow(line, k=k) for k in (2, 8, 32))
    assert np.all(soft <= medium) and np.all(medium <= hard)
    assert np.mean((soft > 0) & (soft < 1)) > 3 * np.mean((hard > 0) & (hard < 1))


def test_only_rays_that_still_march_are_evaluated():
    seen = []

    def counted(p):
        seen.append(len(p))
        return ball_above(p)

    shadow([[0, 0, 0], [1.3, 0, 0], [40, 0, 0]], sdf=counted)
    assert seen[0] == 3 and seen[1] == 2 and min(seen) >= 1


@pytest.mark.parametrize(("function", "size"), [(soft_shadow, 10.0), (area_light_shadow, 0.1)])
def test_no_points_and_a_light_for_each_point_are_fine(function, size):
    assert function(ball_above, np.zeros((0, 3)), UP, size, 0.02, 12.0, 64).shape == (0,)
    origin = np.array([[0.0, 0, 0], [0, 0, 0]])
    seen = function(ball_above, origin, np.stack([UP, -UP]), size, 0.02, 12.0, 64)
    assert_array_equal(seen, [0, 1])


@pytest.mark.parametrize("offset", [-0.8, -0.3, 0.0, 0.3, 0.8])
def test_a_straight_edge_hides_the_exact_part_of_the_disc(offset):
    # An edge 4 above the point, `offset` light radii aside: what is seen is a segment of the disc. Where the
    # ray is inside the slab, that is as thick as the light is wide, or the inside were never deep enough.
    radius, half_thickness = 0.05, 0.5 if offset < 0 else 1e-3
    center = (5 + 4 * np.tan(offset * radius), 4 + half_thickness, 0)
    seen = area_light_shadow(
        lambda p: sdf_box(p, center, (5, half_thickness, 5)), np.zeros((1, 3)), UP, radius, 0.02, 12.0, 512
    )
    exact = 0.5 + (offset * np.sqrt(1 - offset**2) + np.arcsin(offset)) / np.pi
    assert_allclose(seen, exact, atol=0.03)


def test_an_area_light_is_all_seen_far_from_everything_and_hidden_behind_it():
    origin = np.array([[0.0, 0, 0], [5, 0, 0]])
    assert_array_equal(area_light_shadow(ball_above, origin, UP, 0.1, 0.02, 12.0, 256), [0, 1])


# The truth about a round light: how many of the rays to its disc get past the occluder.

BALL_CENTER, BALL_RADIUS, HALF_SIZE = np.array([0.0, 1.5, 0.0]), 0.7, np.array([0.7, 0.5, 0.6])


def disc(to_light, angular_radius, count):
    """Unit vectors to points spread evenly over the disc, by the golden angle."""
    i = np.arange(count)
    r, angle = np.tan(angular_radius) * np.sqrt((i + 0.5) / count), i * np.pi * (3 - np.sqrt(5))
    side = np.cross(to_light, [0.3, 0.2, 0.9])
    side /= np.linalg.norm(side)
    direction = to_light + r[:, None] * (
        np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * np.cross(to_light, side)
    )
    return direction / np.linalg.norm(direction, axis=1, keepdims=True)


def ball_hides(origin, direction):
    o = origin - BALL_CENTER
    b, c = o @ direction.T, np.sum(o * o, axis=1)[:, None] - BALL_RADIUS**2
    return (b * b > c) & (b < 0)


def box_hides(origin, direction):
    ends = [((BALL_CENTER + side * HALF_SIZE - origin)[:, None] / direction) for side in (-1, 1)]
    near, far = np.minimum(*ends).max(axis=-1), np.maximum(*ends).min(axis=-1)
    return far > np.maximum(near, 0)


def half_lit_points(hides, to_light, angular_radius, count):
    """Points of the floor with a visible fraction between 0.02 and 0.98, and that fraction."""
    below = (BALL_CENTER - BALL_CENTER[1] / to_light[1] * to_light)[[0, 2]]
    origin = np.zeros((40000, 3))
    origin[:, [0, 2]] = below + np.random.default_rng(7).uniform(-2.2, 2.2, (40000, 2))
    for samples in (12, 500):
        truth = 1 - hides(origin, disc(to_light, angular_radius, samples)).mean(axis=1)
        between = (truth > 0.02) & (truth < 0.98)
        origin, truth = origin[between][:count], truth[between][:count]
    return origin, truth


OCCLUDERS = {
    "ball": (lambda p: sdf_sphere(p, BALL_CENTER, BALL_RADIUS), ball_hides),
    "box": (lambda p: sdf_box(p, BALL_CENTER, HALF_SIZE), box_hides),
}


@pytest.mark.parametrize(("sdf", "hides"), OCCLUDERS.values(), ids=OCCLUDERS)
@pytest.mark.parametrize("k", [8, 32])
@pytest.mark.parametrize("to_light", [(0.01, 1, 0.02), (0.5, 1, 0.2)])
def test_the_signed_form_has_at_most_a_quarter_of_the_lectures_error(sdf, hides, k, to_light):
    to_light = np.array(to_light) / np.linalg.norm(to_light)
    angular_radius = np.arcsin(1 / k)
    origin, truth = half_lit_points(hides, to_light, angular_radius, 400)
    march = {"t_min": 0.02, "t_max": 12.0, "max_steps": 256}
    lecture = np.abs(soft_shadow(sdf, origin, to_light, k, **march) - truth).mean()
    signed = np.abs(area_light_shadow(sdf, origin, to_light, angular_radius, **march) - truth).mean()
    print(
        f"{len(origin)} points, k = {k}: lecture {lecture:.4f}, signed {signed:.4f}, {signed / lecture:.3f}"
    )
    assert len(origin) > 100
    assert lecture > 0.2  # half at the edge, a quarter on average: the bias that the notebook teaches
    assert signed < lecture / 4
