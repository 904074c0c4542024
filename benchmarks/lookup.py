"""Look-ups in an environment a second, by size of the batch: `python benchmarks/lookup.py`."""

import statistics
import time

import numpy as np

import framework as fw
from framework.lookup import _bilinear


def median_seconds(run, repeats=7):
    """Median of `repeats` runs after one to warm up."""
    run()
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        run()
        times.append(time.perf_counter() - begun)
    return statistics.median(times)


def main():
    rng = np.random.default_rng(0)
    env = fw.skies.sun_and_sky(256)
    print("batch      NumPy M/s   as chosen M/s")
    for count in (1_000, 10_000, 100_000, 1_000_000):
        d = rng.normal(size=(count, 3))
        plain, chosen = (median_seconds(f) for f in (lambda d=d: _bilinear(env.pixels, d), lambda d=d: env.radiance(d)))
        print(f"{count:9d}  {count / plain / 1e6:9.2f}   {count / chosen / 1e6:9.2f}")


if __name__ == "__main__":
    main()
