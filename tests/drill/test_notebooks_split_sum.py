"""What the notebook of the split sum says about its errors, in the notebook's cells and in the table beside it."""

import csv

import pytest

import framework as fw
from autograder.goal_pictures import run_cells
from solutions.split_sum_error import PHOTOGRAPHS, SAMPLES, TABLE, ball, maps, measure, truth

pytestmark = pytest.mark.drill

def _table():
    with open(TABLE, newline="", encoding="ascii") as file:
        return {(row["map"], float(row["roughness"]), float(row["r0"])): row for row in csv.DictReader(file)}


def test_the_four_parts_of_the_split_sums_error_add_up_to_the_whole():
    # Parts by even points, the whole by random ones: what is left is noise, 8 % at most when this was written.
    parts = run_cells("split_sum")["parts"]
    for roughness in (0.25, 0.45, 0.7, 0.9):
        for r0 in (0.04, 0.5, 1.0):
            shares, whole = parts(roughness, r0)
            assert whole > 1e-3
            assert sum(shares) == pytest.approx(whole, rel=0.2), (roughness, r0)
            assert abs(shares[2]) + abs(shares[3]) < 0.15 * whole  # levels and table are innocent
            assert roughness < 0.5 or shares[1] > 1.5 * abs(shares[0])  # n = v = r on rough surfaces


def test_the_regimes_are_those_that_the_table_shows():
    flip = {key: float(row["flip"]) for key, row in _table().items()}
    names, rough, r0s = (sorted({key[i] for key in flip}) for i in range(3))
    assert len(flip) == len(names) * len(rough) * len(r0s) == 5 * 6 * 3
    skies = ("photo: sky with sun", "made: sun and sky", "made: overcast")
    assert max(flip[name, r, r0] for name in skies for r in (0.1, 0.2) for r0 in r0s) < 0.06
    assert max(flip["made: overcast", 0.4, r0] for r0 in r0s) < 0.075
    assert max(flip["made: overcast", r, r0] for r in rough for r0 in r0s) < 0.13
    assert all(0.1 < flip[name, 0.4, r0] < 0.2 and 0.28 < flip[name, 1.0, r0] < 0.42 for name in skies[:2] for r0 in r0s)
    assert min(flip[name, r, r0] for name in ("photo: studio", "made: softboxes") for r in rough for r0 in r0s) > 0.06


@pytest.mark.skipif(not PHOTOGRAPHS.is_dir(), reason="the photographs are not here")
@pytest.mark.parametrize("name", ("photo: sky with sun", "photo: studio", "made: overcast"))
def test_the_table_comes_from_the_maps_that_it_names(name):
    rows = list(measure({name: maps()[name]}, roughness=(0.4,)))
    assert [row["r0"] for row in rows] == [0.04, 0.5, 1.0]
    for row in rows:
        recorded = _table()[name, 0.4, row["r0"]]
        assert row["relmse"] == pytest.approx(float(recorded["relmse"]), rel=0.01)
        assert row["flip"] == "" or row["flip"] == pytest.approx(float(recorded["flip"]), abs=5e-4)


@pytest.mark.skipif(not PHOTOGRAPHS.is_dir(), reason="the photographs are not here")
def test_noise_is_a_small_part_of_what_the_table_calls_error():
    env, (_, normal, view) = maps()["photo: studio"], ball()
    some = slice(None, None, 8)
    usual = truth(env, normal[some], view[some], 0.16)[1]
    patient = truth(env, normal[some], view[some], 0.16, 8 * SAMPLES)[1]
    noise = fw.metrics.relmse(usual / patient.mean(), patient / patient.mean())
    assert noise < 0.1 * float(_table()["photo: studio", 0.4, 1.0]["relmse"])
