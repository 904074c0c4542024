"""Look-ups in an environment a second, by size of the batch: `python benchmarks/lookup.py`.

Seconds of processor time: both ways use one core, and other programs on the machine do not count.
"""

import statistics
import time

import numpy as np

import framework as fw
from framework.lookup import _bilinear


def median_seconds(run, repeats=7):
    """Median processor time of `repeats` runs after one to warm up."""
    run()
    times = []
    for _ in range(repeats):
        begun = time.process_time()
        run()
        times.append(time.process_time() - begun)
    return statistics.median(times)


def main():
    rng = np.random.default_rng(0)
    fw.skies.constant(1).radiance(np.ones((500_000, 3)))  # from here on the compiled look-up is there
    print(" rows     batch   NumPy M/s   compiled M/s")
    for height in (32, 256):
        env = fw.skies.gradient(height)
        for count in (10_000, 100_000, 1_000_000):
            d = rng.normal(size=(count, 3))
            plain = median_seconds(lambda e=env, d=d: _bilinear(e.pixels, d))
            compiled = median_seconds(lambda e=env, d=d: e.radiance(d))
            print(f"{height:5d} {count:9d}   {count / plain / 1e6:9.2f}   {count / compiled / 1e6:12.2f}")


if __name__ == "__main__":
    main()
