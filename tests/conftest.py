"""What tests share: where the data is, and notebooks as students hand them in."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def isolation():
    """The strongest isolation that this machine starts."""
    from autograder.sandbox import strongest_level

    return strongest_level()


@pytest.fixture(scope="session")
def pool(isolation):
    """Sandboxes of the strongest isolation, with the limits that are the default."""
    from autograder.sandbox import Limits, Pool

    with Pool(isolation, Limits()) as pool:
        yield pool
