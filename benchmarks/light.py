"""What an environment light costs at its full size: `python -m benchmarks.light [MAP]`. Medians of seven runs."""

import sys

import numpy as np

import framework as fw
from benchmarks.prefilter import filtered_sampling
from framework.plane import medians
from solutions import fast

ROUGHNESS = tuple(np.arange(7) / 6)
HEIGHTS = (256, 128, 64, 64, 32, 32, 32)
PIXELS = 1_000_000


def main():
    env = fw.Environment.load(sys.argv[1]) if len(sys.argv) > 1 else fw.skies.studio(512)
    light = fast.environment_light(env)
    rng = np.random.default_rng(0)
    normal = fw.normalize(rng.normal(size=(PIXELS, 3)))
    view = fw.normalize(rng.normal(size=(PIXELS, 3)) + normal)
    r0, roughness = rng.random((PIXELS, 3)), rng.random(PIXELS)
    runs = {
        f"seven levels of {env!r}": lambda: fast.prefilter_chain(env, ROUGHNESS, HEIGHTS),
        "irradiance, 32 rows": lambda: fast.irradiance(env, 32),
        "table of 128 x 128": lambda: fast.brdf_lut(128),
        "environment_light": lambda: fast.environment_light(env),
        "split sum of 1 M pixels": lambda: fast.shade_split_sum(normal, view, r0, roughness, light.prefiltered, light.lut),
    }
    for name, seconds in zip(runs, medians(list(runs.values())), strict=True):
        print(f"{1e3 * seconds:8.1f} ms  {name}")
    # The sampler's own error is above the exact filter's at 1024 samples: its time is a lower bound at equal error.
    exact = lambda: fast.prefilter_chain(env, [0.5], [32])  # noqa: E731
    sampled = lambda: filtered_sampling([env], 0.25, 32, 1024)  # noqa: E731
    fastest, slowest = medians([exact, sampled], 3)
    difference = float(np.sqrt(np.mean(((sampled() - exact()[0]) / (exact()[0] + 1e-2)) ** 2)))
    print(f"exact {1e3 * fastest:.1f} ms, 1024 samples {1e3 * slowest:.1f} ms (off by {difference:.1e}): "
          f"at least {slowest / fastest:.0f} times faster, roughness 0.5, 32 rows")  # fmt: skip


if __name__ == "__main__":
    main()
