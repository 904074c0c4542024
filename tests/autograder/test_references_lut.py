"""What the table of 4.6 asks for is within reach of the textbook's way, at the textbook's 1024 samples."""

import numpy as np
import pytest

import framework as fw
from autograder import checks
from autograder.judge import run_check, seed_of
from autograder.student import InMemory
from solutions import split_sum

SECRETS = (b"north", b"east", b"south", b"west")


def by_normals(size, samples):
    """As the notebook says it: half vectors of D (n.h), Hammersley's points, 1024 of them whatever the budget."""
    center = (np.arange(size) + 0.5) / size
    lut = np.empty((size, size, 2))
    for row, roughness in enumerate(center):
        h = fw.sample_ggx(fw.hammersley(1024), roughness**2)
        for column, mu in enumerate(center):
            v_h = np.clip(h @ [np.sqrt(1 - mu * mu), 0, mu], 0, 1)
            g = split_sum.masking_shadowing(2 * v_h * h[:, 2] - mu, mu, roughness**2)
            weight, schlick = g * v_h / (mu * h[:, 2]), (1 - v_h) ** 5
            lut[row, column] = np.mean(weight * (1 - schlick)), np.mean(weight * schlick)
    return lut


@pytest.mark.parametrize("secret", [None, *SECRETS])
def test_plain_sampling_of_normals_at_1024_samples_keeps_full_marks(secret):
    task = checks.assignment("split_sum").find("brdf_lut")
    public = secret is None
    seed = seed_of(secret or b"", "split_sum", task.id, public)
    judged = run_check(task, InMemory({"brdf_lut": by_normals}, task).call, split_sum, seed, public)
    assert judged.failure is None
    assert [measure.name for measure in judged.measures if measure.credit < 1] == []
    assert round(judged.fraction, 9) == 1.0
