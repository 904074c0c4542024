"""The signed distance of a mesh as a grid: bricks of samples near the surface, a coarse field beyond.

Interpolated samples of a distance may be larger than the distance. So each sample has a margin beside it, by
which the interpolated value is brought towards zero: `framework.grid_build_kernels` says how small it may be.
"""

import warnings
from dataclasses import dataclass, field, replace

import numpy as np

from framework.grid_bvh import tree_of, unmatched_edges
from framework.mesh import Mesh
from framework.sdf_primitives import Node

_FINEST = 1024
_CELLS = 8  # along a brick
_STEP = 4  # cells along a coarse one
_BAND = 3.0  # cells to each side of the surface that bricks cover


@dataclass(frozen=True, eq=False)
class _Samples:
    """Samples before they are made 1-Lipschitz, as `framework.grid_build_kernels` has them."""

    places: np.ndarray  # (B, 3) int32
    index: np.ndarray  # (X, Y, Z) int32
    f: np.ndarray  # (B, n, n, n) float32
    e: np.ndarray  # (B, n, n, n) float32


@dataclass(frozen=True, eq=False)
class Grid(Node):
    """The distance to a mesh, from a grid. `framework.sdf.from_mesh` makes it.

    The value is never larger than the distance to the mesh, and its sign is right or it is 0: a march by it never
    passes through the surface. Where `closed` is false there is no inside, and it is positive on both sides.

    Attributes
    ----------
    mesh : Mesh
    resolution : int        cells along the longest side of the mesh's box
    cell : float            side of a cell, scene units
    closed : bool           whether the mesh has an inside, and the sign a meaning
    error : float           points of value 0 are at most this far from the mesh, scene units
    lipschitz : float       the value's largest gradient, at least 1: trilinear interpolation is too steep beside
                            edges and where two parts of the surface are equally near
    sampled : int           bricks that were sampled to make it, 729 distances each
    """

    mesh: Mesh
    resolution: int
    cell: float
    closed: bool
    error: float
    lipschitz: float
    sampled: int
    _frame: np.ndarray = field(repr=False)
    _index: np.ndarray = field(repr=False)
    _bricks: np.ndarray = field(repr=False)
    _coarse: np.ndarray = field(repr=False)
    _samples: _Samples = field(repr=False)

    def arrays(self):
        """`(frame, index, bricks, coarse)`: what `framework.grid_kernel.grid_value` reads beside the point."""
        return self._frame, self._index, self._bricks, self._coarse

    @property
    def nbytes(self):
        """Bytes of these arrays."""
        return sum(array.nbytes for array in self.arrays())

    def updated(self, mesh):
        """The grid of a mesh of which some vertices have moved.

        Parameters
        ----------
        mesh : Mesh         the same faces; vertices that stayed have the same coordinates to the last bit

        Returns
        -------
        Grid                as `from_mesh` would make it with cells of this size in this place. Only bricks that
                            what moved may touch, before or after, are sampled again

        Notes
        -----
        A mesh that leaves the grid's box, or has other faces, is sampled anew. An object that moves as a whole
        and has a grid of its own needs none of this: `sdf.translate` and `sdf.rotate` move the query instead.
        """
        frame = self._frame
        low, high = frame[:3], frame[:3] + frame[3:6] / frame[6]
        new_low, new_high = _extent(mesh, "updated")
        if not np.array_equal(mesh.faces, self.mesh.faces) or not (
            (new_low >= low + self.cell).all() and (new_high <= high - self.cell).all()
        ):
            return build(mesh, self.resolution)
        return _build(mesh, self.resolution, self.cell, low, self._index.shape, self)

    def _value(self, x, y, z):
        from framework.grid_kernel import grid_values

        return grid_values(*(np.ascontiguousarray(axis, float) for axis in (x, y, z)), *self.arrays())

    def bounds_of_level(self, level):
        return self._frame[8:11] - level, self._frame[11:14] + level


def build(mesh, resolution):
    """`framework.sdf.from_mesh`."""
    if not isinstance(resolution, int | np.integer) or not 1 <= resolution <= _FINEST:
        raise ValueError(
            f"from_mesh: resolution is {resolution!r}; a whole number of cells from 1 to {_FINEST} is wanted"
        )
    low, high = _extent(mesh, "from_mesh")
    # Triangles that are all one point get a cell all the same.
    longest = (high - low).max() or max(1e-6 * np.abs(high).max(), 1e-6)
    cell = longest / resolution
    size = np.ceil((high - low + 4.0 * cell) / (_CELLS * cell)).astype(int)
    return _build(mesh, int(resolution), cell, 0.5 * (low + high - _CELLS * cell * size), tuple(size), None)


def _extent(mesh, name):
    if not isinstance(mesh, Mesh):
        raise ValueError(f"{name}: mesh is a {type(mesh).__name__}; a framework.Mesh is wanted")
    if not len(mesh.faces):
        raise ValueError(f"{name}: mesh has no triangles; at least one is wanted")
    corners = mesh.vertices[mesh.faces]
    return corners.min(axis=(0, 1)), corners.max(axis=(0, 1))


def _build(mesh, resolution, cell, low, shape, old):
    """Samples of every brick near the surface, of those that did not change from `old`, and what is made of them."""
    unmatched = unmatched_edges(mesh)
    if unmatched and old is None:
        warnings.warn(
            f"from_mesh: the mesh is open, or faces of it are turned over: {unmatched} edges have no counterpart. "
            "Its distance is positive everywhere",
            stacklevel=4,
        )
    solid = (tree_of(mesh.vertices[mesh.faces]), not unmatched)
    places = np.argwhere(np.ones(shape, bool)).astype(np.int32)
    index = np.arange(len(places), dtype=np.int32).reshape(shape)
    wide, _ = _sample(places, index, low, _STEP * cell, _CELLS // _STEP + 1, *solid, None)
    middle = wide.f[:, 1, 1, 1]
    # No point of a brick is farther from a sample than half a coarse diagonal.
    reach = _BAND + 1.0 + 0.5 * np.sqrt(3.0) * _STEP
    near = np.abs(wide.f).min(axis=(1, 2, 3)) <= reach * cell
    index = np.where(near, np.cumsum(near) - 1, np.where(middle > 0, -1, -2)).astype(np.int32).reshape(shape)
    known = old is not None and old.closed != bool(unmatched)
    kept = (old._samples, _untouched(old, mesh, places[near])) if known else None
    fine, sampled = _sample(places[near], index, low, cell, _CELLS + 1, *solid, kept)

    samples, wide, fine = fine, _share(wide), _share(fine)
    coarse = np.empty((*(2 * size + 1 for size in shape), 2), np.float32)
    blocks = np.stack([wide.f, wide.e], -1).reshape(*shape, 3, 3, 3, 2)
    for a, b, c in np.ndindex(3, 3, 3):
        coarse[a : a + 2 * shape[0] : 2, b : b + 2 * shape[1] : 2, c : c + 2 * shape[2] : 2] = blocks[
            ..., a, b, c, :
        ]
    size = np.abs(fine.f) - fine.e
    # The band must end where bricks do.
    rims = (size[rows[beside < 0], *face].min(initial=np.inf) for rows, beside, face, _ in _sides(fine))
    band = min(_BAND * cell, *rims)
    needed = size.min(axis=(1, 2, 3)) < band
    row = np.where(needed, np.cumsum(needed) - 1, np.where(fine.f[:, 0, 0, 0] > 0, -1, -2)).astype(np.int32)
    frame = np.concatenate([low, np.multiply(_CELLS, shape), [1.0 / cell, band], *_extent(mesh, "from_mesh")])
    return Grid(
        mesh=mesh,
        resolution=resolution,
        cell=cell,
        closed=not unmatched,
        error=2.0 * float(fine.e[np.abs(fine.f) <= np.sqrt(3.0) * cell].max()),
        lipschitz=max(1.0, _steepest(fine, cell), _steepest(wide, _STEP * cell)),
        sampled=sampled,
        _frame=frame,
        _index=np.where(index >= 0, row[index], index),
        _bricks=np.stack([fine.f[needed], fine.e[needed]], -1),
        _coarse=coarse,
        _samples=samples,
    )


def _sample(places, index, low, spacing, n, tree, signed, kept):
    """Distances and margins of the blocks; `kept` has those of `places` that are known already."""
    from framework.grid_build_kernels import sample

    f, e = (np.empty((len(places), n, n, n), np.float32) for _ in range(2))
    new = np.ones(len(places), bool)
    if kept is not None:
        samples, rows = kept
        new = rows < 0
        f[~new], e[~new] = samples.f[rows[~new]], samples.e[rows[~new]]
    sampled_f, sampled_e = np.empty_like(f[new]), np.empty_like(f[new])
    sample(places[new], low, spacing, tree, signed, sampled_f, sampled_e)
    f[new], e[new] = sampled_f, sampled_e
    return _Samples(places, index, f, e), len(sampled_f)


def _untouched(old, mesh, places):
    """The row of the old samples at each place (B,); -1 where there are none, or what moved is within their reach."""
    rows = old._samples.index[tuple(places.T)]
    moved = (old.mesh.vertices != mesh.vertices).any(axis=1)[mesh.faces].any(axis=1)
    if not moved.any():
        return rows
    corners = np.concatenate([part.vertices[mesh.faces[moved]].reshape(-1, 3) for part in (old.mesh, mesh)])
    brick = _CELLS * old.cell
    low = old._frame[:3] + brick * places
    gap = np.maximum(np.maximum(corners.min(axis=0) - (low + brick), low - corners.max(axis=0)), 0.0)
    # A sample knows its nearest triangle; a margin, those 2.6 cells further (1.5 diagonals).
    reach = np.abs(old._samples.f).max(axis=(1, 2, 3)) + 3.0 * old.cell
    return np.where(np.linalg.norm(gap, axis=1) > reach[rows], rows, -1)


def _share(samples):
    """`samples` with the largest margin of all blocks that have the same sample: one value on either side."""
    e = samples.e.copy()
    for rows, beside, face, opposite in _sides(samples):
        rows, beside = rows[beside >= 0], beside[beside >= 0]
        e[rows, *face] = np.maximum(e[rows, *face], samples.e[beside, *opposite])
    return replace(samples, e=e)


def _sides(samples):
    """For each of 26 directions: blocks that do not end the grid there, what `index` has beside them, and the samples
    that both share, as slices of the one and of the other.
    """
    n = samples.f.shape[1]
    shared = {-1: slice(0, 1), 0: slice(None), 1: slice(n - 1, None)}
    for corner in np.ndindex(3, 3, 3):
        step = np.subtract(corner, 1)
        if step.any():
            to = samples.places + step
            rows = np.flatnonzero(((to >= 0) & (to < samples.index.shape)).all(axis=1))
            beside = samples.index[tuple(to[rows].T)]
            yield rows, beside, [shared[a] for a in step], [shared[-a] for a in step]


def _steepest(samples, spacing, chunk=512):
    """The largest gradient of the value: that of a trilinear function is largest at a corner of a cell.

    Squared, it is convex along each axis.
    """
    most = 0.0
    for first in range(0, len(samples.f), chunk):
        f, e = samples.f[first : first + chunk], samples.e[first : first + chunk]
        for value in (f - e, -f - e):
            corner = [slice(None, -1), slice(1, None)]
            some = np.max([value[:, i, j, k] for i in corner for j in corner for k in corner], axis=0) > 0
            x, y, z = (np.diff(value, axis=axis) ** 2 for axis in (1, 2, 3))
            for i, j, k in np.ndindex(2, 2, 2):
                i, j, k = corner[i], corner[j], corner[k]
                most = max(most, np.where(some, x[:, :, j, k] + y[:, i, :, k] + z[:, i, j, :], 0.0).max())
    return float(np.sqrt(most)) / spacing
