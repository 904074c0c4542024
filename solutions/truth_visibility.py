"""Independent truths of shadows from an environment: rays cast in closed form, no distance field is marched."""

from dataclasses import dataclass

import numpy as np

import framework as fw
from solutions.truth import reflected_radiance
from solutions.truth_maps import bilinear, sphere_grid

# Rays start on surfaces: a hit nearer than this is the start itself.
_START = 1e-7


@dataclass(frozen=True)
class Solids:
    """Spheres, boxes and the ground, as distance field and as closed-form ray casts.

    Attributes
    ----------
    spheres : tuple of (center, radius)
    boxes : tuple of (center, half_size)
    ground : float or None      height of a floor without end
    """

    spheres: tuple = ()
    boxes: tuple = ()
    ground: float | None = 0.0

    def sdf(self):
        """The same solids as a `framework.sdf` field."""
        floor = () if self.ground is None else (fw.sdf.plane((0, 1, 0), self.ground),)
        return fw.sdf.union(
            *floor, *(fw.sdf.sphere(*one) for one in self.spheres), *(fw.sdf.box(*one) for one in self.boxes)
        )

    def blocked(self, origin, direction, t_max):
        """Whether something lies on each ray, (M, 3), (M, 3) -> (M,) bool."""
        hit = np.zeros(np.broadcast_shapes(origin.shape, direction.shape)[:-1], dtype=bool)
        if self.ground is not None:
            # A level ray never arrives; the quotient of such a tiny slope lies beyond any t_max.
            down = np.minimum(direction[..., 1], -1e-300)
            t = (self.ground - origin[..., 1]) / down
            hit |= (direction[..., 1] < 0) & (t > _START) & (t <= t_max)
        for center, radius in self.spheres:
            away = origin - center
            b, c = (away * direction).sum(axis=-1), (away * away).sum(axis=-1) - radius**2
            root = np.sqrt(np.maximum(b * b - c, 0.0))
            hit |= (
                (b * b > c)
                & (-b + root > _START)
                & (-b - root <= t_max)
                & ((-b - root > _START) | (c < -1e-9))
            )
        for center, half_size in self.boxes:
            safe = np.where(np.abs(direction) < 1e-300, 1e-300, direction)
            near, far = np.sort(
                [(s * np.asarray(half_size) - (origin - center)) / safe for s in (-1, 1)], axis=0
            )
            enter, leave = near.max(axis=-1), far.min(axis=-1)
            hit |= (leave > np.maximum(enter, _START)) & (enter <= t_max) & (leave > _START)
        return hit


def ambient_visibility(solids, p, normal, t_max, count=2048):
    """Unoccluded fraction of the cosine-weighted hemisphere, (N,): rays through an even grid on the disc below it.

    The standard error is below 0.5 / sqrt(count); the points are spread evenly, so that the error is smaller.
    """
    i = np.arange(count)
    radius, phi = np.sqrt((i + 0.5) / count), i * np.pi * (3.0 - np.sqrt(5.0))
    local = np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1.0 - radius**2)], axis=-1)
    result = np.empty(len(p))
    for j in range(len(p)):
        direction = local @ _frame(normal[j])
        result[j] = 1.0 - solids.blocked(p[j], direction, t_max).mean()
    return result


def diffuse_radiance(solids, env, p, normal, albedo, t_max, oversample=4, shadows=True):
    """albedo / pi times the integral of L (n.l) V, (N, 3): a sum over all parts of all pixels.

    Each pixel of the map is cut in `oversample` x `oversample` parts with bilinear radiance, one ray each.
    """
    direction, solid_angle = sphere_grid(env.height * oversample)
    light = bilinear(env.pixels, direction) * solid_angle[..., None]
    direction, light = direction.reshape(-1, 3), light.reshape(-1, 3)
    result = np.empty((len(p), 3))
    for j in range(len(p)):
        cosine = direction @ normal[j]
        up = cosine > 0
        weight = cosine[up]
        if shadows:
            weight = weight * ~solids.blocked(p[j], direction[up], t_max)
        result[j] = weight @ light[up]
    return result * np.asarray(albedo) / np.pi


def specular_radiance(solids, env, p, normal, view, r0, roughness, t_max, rows=48, columns=96, shadows=True):
    """The rough mirror's part of the rendering equation with visibility, (N, 3), by quadrature over half vectors."""
    alpha = np.broadcast_to(np.square(roughness), len(p))
    r0 = np.broadcast_to(r0, (len(p), 3))

    def seen_from(point):
        def radiance(direction):
            value = bilinear(env.pixels, direction)
            return value * ~solids.blocked(point, direction, t_max)[:, None] if shadows else value

        return radiance

    each = zip(p, normal, view, r0, alpha, strict=True)
    return np.array(
        [reflected_radiance(seen_from(x), n, v, f, a, rows, columns)[0] for x, n, v, f, a in each]
    )


def surface_points(solids, camera, width, height, t_max=100.0):
    """What a camera sees of the solids, found by bisection along each ray: position, normal, view, (N, 3) each."""
    origin, direction = (a.reshape(-1, 3) for a in camera.rays(width, height))
    ahead = solids.blocked(origin, direction, t_max)
    origin, direction = origin[ahead], direction[ahead]
    low, high = np.zeros(len(origin)), np.full(len(origin), t_max)
    for _ in range(60):
        middle = 0.5 * (low + high)
        before = solids.blocked(origin, direction, middle)
        low, high = np.where(before, low, middle), np.where(before, middle, high)
    p = origin + high[:, None] * direction
    sdf, step = solids.sdf(), 1e-5 * np.eye(3)
    normal = fw.normalize(np.stack([sdf(p + s) - sdf(p - s) for s in step], axis=-1))
    return p + 1e-6 * normal, normal, -direction


def _frame(normal):
    tangent = np.cross(np.eye(3)[np.argmin(np.abs(normal))], normal)
    tangent /= np.linalg.norm(tangent)
    return np.stack([tangent, np.cross(normal, tangent), normal])
