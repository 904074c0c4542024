"""The sweeps at a tenth of their points hold; what is broken is found, named, and costs the exit code."""

import re

import numpy as np
import pytest

from autograder.cli import main
from solutions import soft_shadows, split_sum, stress


@pytest.mark.parametrize("name", stress.SWEEPS)
def test_a_tenth_of_the_points_finds_nothing_beyond_its_bounds(name):
    rows = list(stress.sweep(name, 0.1))
    assert [f"{row.function}, {row.claim}: {row.worst}, {row.nonfinite} not finite" for row in rows if not row.holds] == []
    assert all(row.points > 0 and row.reason for row in rows)


def test_cancellation_at_the_peak_of_a_narrow_lobe_is_found_and_costs_the_exit_code(monkeypatch, capsys):
    def naive(cos_h, alpha):
        alpha = np.maximum(alpha, 1e-4)
        return np.where(np.greater(cos_h, 0), alpha**2 / (np.pi * (1 + np.square(cos_h) * (alpha**2 - 1)) ** 2), 0)

    sweep = stress.sweep
    monkeypatch.setattr(stress, "sweep", lambda name: sweep(name, 0.02))
    monkeypatch.setattr(split_sum, "ndf_ggx", naive)
    assert main(["stress", "microfacets"]) == 1
    assert "\n  ndf_ggx, relative error: " in capsys.readouterr().out


def test_values_that_are_not_finite_break_a_row_whatever_its_bound(monkeypatch):
    def naive(distance, travelled, k):
        with np.errstate(all="ignore"):
            return np.clip(k * np.asarray(distance) / travelled, 0, 1)

    monkeypatch.setattr(soft_shadows, "penumbra", naive)
    rows = stress.sweep("shadows", 0.01)
    assert next(row for row in rows if row.function == "penumbra").nonfinite > 0


def test_an_unknown_sweep_is_refused_with_the_known_ones(capsys):
    assert main(["stress", "no"]) == 2
    assert "there is no sweep 'no'; there are" in capsys.readouterr().err


@pytest.mark.drill
def test_a_million_points_and_more_hold(capsys):
    assert main(["stress"]) == 0
    (points,) = re.findall(r"^([\d,]+) points, ", capsys.readouterr().out, re.MULTILINE)
    assert int(points.replace(",", "")) > 1_000_000
