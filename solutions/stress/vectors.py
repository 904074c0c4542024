"""Vectors, frames, sequences, measures of error, and cameras."""

import numpy as np

import framework as fw
from solutions.stress import SCALES, measured, relative


def rows(share):
    rng = np.random.default_rng(34)
    count = int(30_000 * share)
    yield from _arrays(rng, count)
    yield from _sequences(count)
    yield from _metrics(rng, count)
    yield from _cameras(rng)


def _arrays(rng, count):
    v = rng.normal(size=(count, 3)) * 10.0 ** rng.uniform(-300, 300, (count, 1))
    v = np.concatenate([np.eye(3), -np.eye(3), np.zeros((1, 3)), [[1e-320, 0, 0]], v])
    unit = fw.normalize(v)
    length = np.sqrt((unit**2).sum(1))
    wanted = np.where(v.any(axis=1), 1.0, 0.0)
    yield measured("normalize", "length off 1, or off 0 for 0", unit, np.abs(length - wanted), 5e-16, "three roundings")
    n = unit[v.any(axis=1)]
    n = np.concatenate([n, fw.normalize([[1e-9, 0, -1.0], [-1e-17, 1e-17, -1.0], [0.0, 0.0, -1.0]])])
    tangent, bitangent = fw.orthonormal_frame(n)
    frame = np.stack([tangent, bitangent, n], axis=1)
    away = np.abs(frame @ frame.swapaxes(1, 2) - np.eye(3))
    yield measured("orthonormal_frame", "off orthonormal", frame, away, 5e-15,
                   "Duff et al. 2017: the denominator is at least 1")  # fmt: skip
    yield measured("orthonormal_frame", "determinant off 1", frame, np.abs(np.linalg.det(frame) - 1), 5e-15, "right-handed")
    other = n[rng.permutation(len(n))]
    back = fw.reflect(fw.reflect(other, n), n)
    yield measured("reflect", "twice is not once", back, np.abs(back - other), 5e-15, "an involution")


def _sequences(count):
    found, apart = [], []
    for n in (1, 2, 7, 4096, max(count, 8)):
        for shift in ((0.0, 0.0), (1 - 2.0**-53, 0.3)):
            points = fw.hammersley(n, shift)
            found.append(np.maximum(-points, points - np.nextafter(1.0, 0.0)).ravel())
            rows = np.sort(points[:, 0])
            apart.append(np.abs(np.diff(rows) - 1 / n))
    beyond = np.concatenate(found)
    yield measured("hammersley", "outside [0, 1)", beyond, beyond, 0, "also when shifted by the largest number below 1")
    yield measured("hammersley", "unevenly spaced", beyond, np.concatenate(apart), 1e-15, "i / n; one rounding")


def _metrics(rng, count):
    reference = rng.uniform(0, 1, (count, 3))
    image = reference + rng.normal(0, 0.1, reference.shape)
    wide = (image.astype(np.longdouble) - reference) ** 2
    found, errors = [], []
    for scale in (*SCALES, 1e-200, 1e200):
        a, b = image * scale, reference * scale
        found += [fw.metrics.rmse(a, b), fw.metrics.maximum(a, b), fw.metrics.percentile(a, b, 90)]
        errors += [relative(found[-3] / scale, np.sqrt(wide.mean())), relative(found[-2] / scale, np.sqrt(wide.max()))]
    exact = (wide / (reference.astype(np.longdouble) ** 2 + 1e-2)).mean()
    errors.append(relative(fw.metrics.relmse(image, reference), exact))
    yield measured("metrics", "relative error at scales to 1e200", found, np.array(errors), 1e-12, "sums in float64",
                   points=image.size * (len(SCALES) + 2))  # fmt: skip


def _cameras(rng):
    rays, units, projected, turned = [], [], [], []
    for scale in (*SCALES, 1e-150, 1e150):
        for width, height in ((1, 1), (7, 5), (64, 33)):
            for fov in (1e-4, 0.7, 3.1):
                position, target = scale * np.array([3.0, 2.0, -1.0]), scale * np.array([3.5, -1.0, 0.0])
                camera = fw.Camera(position, target, (0.1, 1, 0), fov)
                origin, direction = camera.rays(width, height)
                rays.append(direction.ravel())
                units.append(np.abs(np.linalg.norm(direction, axis=-1) - 1).ravel())
                # A pixel's ray projects to the pixel's centre, in units of pixels.
                clip = np.einsum("ij,hwj->hwi", camera.view_projection(width, height)[:, :3], direction)
                column = 0.5 * width * (clip[..., 0] / clip[..., 3] + 1) - 0.5 - np.arange(width)
                row = 0.5 * height * (1 - clip[..., 1] / clip[..., 3]) - 0.5 - np.arange(height)[:, None]
                spread = max(width, height) * (np.tan(fov / 2) + 1 / np.tan(fov / 2))
                projected += [np.abs(column).ravel() / spread, np.abs(row).ravel() / spread]
                side = fw.Camera(np.roll(position, 1), np.roll(target, 1), (0, 0.1, 1), fov)
                turned.append(np.abs(np.roll(direction, 1, axis=-1) - side.rays(width, height)[1]).ravel())
    flat = np.concatenate(rays)
    yield measured("Camera.rays", "length off 1", flat, np.concatenate(units), 5e-16, "three roundings")
    yield measured("Camera.rays", "off its pixel, over width (tan + cot)", flat, np.concatenate(projected), 1e-14,
                   "an ulp of a unit vector, in narrow and in wide views")  # fmt: skip
    yield measured("Camera.rays", "changed by a third of a turn", flat, np.concatenate(turned), 1e-15,
                   "the same products, summed anew")  # fmt: skip
