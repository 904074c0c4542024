"""A pinhole camera: rays through the centres of pixels, and the matrix that a rasteriser needs."""

from dataclasses import dataclass

import numpy as np

from framework.arrays import as_number, as_positive, as_vector, normalize


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera in a right-handed world.

    Parameters
    ----------
    position : (3,) float       where the camera stands, scene units
    target : (3,) float         a point in the middle of the picture, scene units
    up : (3,) float             a direction that points upwards in the picture, of any length
    fov_y : float               angle of view over the full height of the image, radians, in (0, pi)

    Raises
    ------
    ValueError                  where position and target coincide, `up` is zero or along the line between
                                them, or `fov_y` is not between 0 and pi
    """

    position: np.ndarray
    target: np.ndarray
    up: np.ndarray
    fov_y: float

    def __post_init__(self):
        for name in ("position", "target", "up"):
            vector = as_vector(getattr(self, name), f"Camera: {name}")
            vector.flags.writeable = False
            object.__setattr__(self, name, vector)
        object.__setattr__(self, "fov_y", as_number(self.fov_y, "Camera: fov_y"))
        if not 0 < self.fov_y < np.pi:
            raise ValueError(
                f"Camera: fov_y is {self.fov_y:g}; an angle between 0 and pi, in radians, is wanted"
            )
        if np.array_equal(self.position, self.target):
            raise ValueError(
                f"Camera: target equals position, {self.position}; a point in front of it is wanted"
            )
        if np.linalg.norm(np.cross(self.axis, normalize(self.up))) < 1e-8:
            raise ValueError(
                f"Camera: up is {self.up}, zero or along the line of sight; another direction is wanted"
            )

    @property
    def axis(self):
        """Unit direction that the camera looks along, `(3,)`: depth is `(point - position) . axis`."""
        return normalize(self.target - self.position)

    @property
    def basis(self):
        """Rows right, up and backward, `(3, 3)`: a rotation that takes world to view directions."""
        right = normalize(np.cross(self.axis, normalize(self.up)))
        return np.stack([right, np.cross(right, self.axis), -self.axis])

    def rays(self, width, height):
        """A ray through the centre of each pixel.

        Parameters
        ----------
        width, height : int         size of the image in pixels

        Returns
        -------
        origin : (height, width, 3) float64     the camera's position, scene units
        direction : (height, width, 3) float64  unit; row 0 is the top, column 0 the left as it sees them
        """
        half_width, half_height = self._image_plane(width, height)
        x = half_width * ((2.0 * np.arange(width) + 1.0) / width - 1.0)
        y = half_height * (1.0 - (2.0 * np.arange(height) + 1.0) / height)
        right, up, backward = self.basis
        direction = normalize(x[None, :, None] * right + y[:, None, None] * up - backward)
        return np.broadcast_to(self.position, direction.shape).copy(), direction

    def view_projection(self, width, height, near=0.01):
        """The matrix that takes world points, as columns `(x, y, z, 1)`, to clip space.

        View space has x to the right, y up, and the camera looks along -z. In clip space `w` is the depth
        along the camera's axis, `x / w` runs from -1 at the left edge to 1 at the right, `y / w` from -1
        at the bottom to 1 at the top, `z / w` from -1 at the near plane to 1 at infinity (OpenGL's
        convention, the far plane infinitely far): a point is drawn where `-w <= x, y, z <= w`.

        Parameters
        ----------
        width, height : int         size of the image in pixels
        near : float                depth of the near plane, scene units

        Returns
        -------
        (4, 4) float64
        """
        half_width, half_height = self._image_plane(width, height)
        near = as_positive(near, "view_projection: near")
        view = np.eye(4)
        view[:3, :3] = self.basis
        view[:3, 3] = -self.basis @ self.position
        projection = np.zeros((4, 4))
        projection[0, 0] = 1.0 / half_width
        projection[1, 1] = 1.0 / half_height
        projection[2, 2:] = -1.0, -2.0 * near
        projection[3, 2] = -1.0
        return projection @ view

    def _image_plane(self, width, height):
        """Half the width and the height of the image at depth 1."""
        for name, size in (("width", width), ("height", height)):
            if not isinstance(size, int | np.integer) or size < 1:
                raise ValueError(
                    f"Camera: {name} is {size!r}; a whole number of pixels, at least 1, is wanted"
                )
        half_height = np.tan(self.fov_y / 2.0)
        return half_height * width / height, half_height
