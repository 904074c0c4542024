import math

import numpy as np
import pytest

import framework as fw
from benchmarks import grid, shadow_maps

POINTS = shadow_maps.points(48, 36)
CAMERA = fw.Camera(shadow_maps.LIGHT, (0.0, 0.5, 0.0), (0.0, 1.0, 0.0), 2 * math.atan(3.0 / 45.0))


@pytest.fixture(scope="module")
def shadow_map():
    mesh = shadow_maps._joined([*shadow_maps.objects(), fw.mesh.plane(9.0)])
    return shadow_maps.ShadowMap.drawn(mesh, CAMERA, 512)


def test_a_lit_point_of_the_floor_falls_on_the_pixel_that_shows_it(shadow_map):
    floor = (POINTS[:, 1] < 1.01 * shadow_maps.LIFT) & (np.abs(POINTS) < 2).all(axis=1)
    lit = POINTS[floor & (shadow_maps.ray_sampled(POINTS, 64) == 1)]
    assert len(lit) > 300
    column, row, depth = shadow_map.project(lit)
    assert np.abs(shadow_map.at(column, row) - depth).max() < 2 * shadow_maps.LIFT


def test_one_look_up_agrees_with_the_ray_to_the_middle_where_no_edge_is_near(shadow_map):
    seen = shadow_maps.ray_sampled(POINTS, 64)
    sure = (seen == 0) | (seen == 1)
    hard = shadow_maps.pcf(shadow_map, POINTS, 0.0, 1, 0.03)
    assert 20 < (seen[sure] == 0).sum() and (hard[sure] == seen[sure]).mean() > 0.99


def test_filtering_as_wide_as_the_half_shade_is_nearer_the_truth_than_one_look_up(shadow_map):
    truth = shadow_maps.ray_sampled(POINTS, 256)
    hard = shadow_maps.pcf(shadow_map, POINTS, 0.0, 1, 0.03)
    soft = shadow_maps.pcss(shadow_map, POINTS, shadow_maps.LIGHT_RADIUS, 64, 0.03)
    rmse = [np.sqrt(((estimate - truth) ** 2).mean()) for estimate in (hard, soft)]
    assert rmse[1] < 0.5 * rmse[0]


def test_without_a_blocker_all_of_the_light_is_seen(shadow_map):
    above = POINTS + [0, 3.0, 0]
    assert (shadow_maps.pcss(shadow_map, above, shadow_maps.LIGHT_RADIUS, 16, 0.03) == 1).all()
    assert (shadow_maps.ray_sampled(above, 16) == 1).all()


def test_the_tables_have_a_row_for_each_setting():
    found = shadow_maps.contenders(12, 9, map_sizes=(64,), resolutions=(8,), rays=16)
    assert [c.method for c in found] == [
        "one look-up", "PCF, 64 look-ups", "PCSS, 16 look-ups", "PCSS, 64 look-ups", "k d / t, formula",
        "signed angle, formula", "signed angle, grid", "signed angle, grid built anew", "rays", "rays",
    ]  # fmt: skip
    assert all(0 <= c.error(c.run()) < 0.5 for c in found)
    found = grid.contenders((16, 48), 500)
    made = [c.run() for c in found]
    assert [c.method for c in found] == ["built whole", "brought up to date"] * 2
    errors, sizes = ([of(grid) for of, grid in zip(many, made, strict=True)]
                     for many in ([c.error for c in found], [c.work for c in found]))  # fmt: skip
    assert errors[1::2] == pytest.approx(errors[::2], rel=0.02) and errors[0] > errors[2] and sizes[0] < sizes[2]
    table = grid.rows((12, 48), (32,), 400)
    assert [(row["name"], row["size"]) for row in table] == [("grid", 12), ("grid", 48), ("shadow map", 32)]
    assert table[1]["mean_error"] < table[0]["mean_error"]
    assert len({tuple(row) for row in table[:2]}) == 1 and set(table[2]) == set(table[0])
