"""A hierarchy of boxes over a mesh's triangles, and whether the mesh is closed."""

import numpy as np

_PER_LEAF = 3


def tree_of(corners):
    """The hierarchy that `framework.grid_bvh_kernels` walks.

    Parameters
    ----------
    corners : (F, 3, 3) float64     of F >= 1 triangles

    Returns
    -------
    triangles (F, 3, 3), boxes (2 L, 6), dipoles (2 L, 7), float64, L a power of two
    """
    corners = corners[np.argsort(_morton(corners.mean(axis=1)), kind="stable")]
    leaves = 1 << max(len(corners) // _PER_LEAF, 1).bit_length() - 1
    first = np.arange(leaves) * len(corners) // leaves
    area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    weight = np.linalg.norm(area, axis=1)[:, None]
    low = _up(np.minimum, np.minimum.reduceat(corners.min(axis=1), first))
    high = _up(np.maximum, np.maximum.reduceat(corners.max(axis=1), first))
    sums = np.hstack([area, weight, weight * corners.mean(axis=1)])
    sums = _up(np.add, np.add.reduceat(sums, first))
    area, weight, moment = sums[:, :3], sums[:, 3:4], sums[:, 4:]
    middle = np.where(weight > 0, moment / np.where(weight > 0, weight, 1.0), 0.5 * (low + high))
    radius = np.linalg.norm(np.maximum(high - middle, middle - low), axis=1, keepdims=True)
    return np.ascontiguousarray(corners), np.hstack([low, high]), np.hstack([middle, area, radius])


def _up(join, leaves):
    """Values of all nodes, the root in row 1, from those of the leaves."""
    nodes = np.concatenate([np.zeros_like(leaves), leaves])
    level = len(leaves) // 2
    while level:
        nodes[level : 2 * level] = join(
            nodes[2 * level : 4 * level : 2], nodes[2 * level + 1 : 4 * level : 2]
        )
        level //= 2
    return nodes


def _morton(points):
    """Position along a curve that visits near points one after the other: the bits of x, y and z in turn."""
    low, extent = points.min(axis=0), np.ptp(points, axis=0).max()
    code = np.zeros(len(points), np.uint64)
    for axis in range(3):
        bits = ((points[:, axis] - low[axis]) / (extent or 1.0) * 0x1FFFFF).astype(np.uint64)
        for shift, mask in (
            (32, 0x1F00000000FFFF), (16, 0x1F0000FF0000FF), (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3), (2, 0x1249249249249249),
        ):  # fmt: skip
            bits = (bits | bits << np.uint64(shift)) & np.uint64(mask)
        code |= bits << np.uint64(axis)
    return code


def unmatched_edges(mesh):
    """How many edges are run along more often in one direction than in the other: 0 for a closed mesh.

    Vertices at the same place count as one. Only then do the triangles wind a whole number of times around
    every point.
    """
    _, merged = np.unique(mesh.vertices, axis=0, return_inverse=True)
    faces = merged.reshape(-1)[mesh.faces].astype(np.int64)
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    edge = np.minimum(start, end) * (len(mesh.vertices) + 1) + np.maximum(start, end)
    _, edge = np.unique(edge, return_inverse=True)
    return np.count_nonzero(np.bincount(edge.reshape(-1), np.sign(end - start)))
