# SPDX-License-Identifier: MIT
"""What rays through a scene meet, and the frames of points in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shlight._arrays import broadcast, check_finite, check_last, check_rows, checked_array, given_type

# A tangent whose part at right angles to the normal is shorter than this, of length 1, has no direction.
_LEAST_TANGENT = 1e-6

Floats = NDArray[Any]


@dataclass(frozen=True, eq=False, repr=False)
class Hits:
    """The surfaces that n rays meet, as Scene.intersect returns them; each array has a row of each ray.

    Rows of rays that meet nothing hold the distance inf, -1 as mesh, instance and triangle, and zeros otherwise.

    >>> scene = shlight.Scene()
    >>> floor = scene.add_mesh([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> hits = scene.intersect([[0.5, 0.5, 1], [3, 3, 1]], (0, 0, -1))
    >>> hits.distance
    array([ 1., inf])
    >>> hits.position[hits.valid].round(6)
    array([[0.5, 0.5, 0. ]])
    """

    distance: Floats
    """(n,), from the ray's origin to the surface [m]."""
    position: Floats
    """(n, 3), in the world."""
    normal: Floats
    """(n, 3), unit, of the triangle, turned to the ray's origin."""
    shading_normal: Floats
    """(n, 3), unit, as the mesh's normals have it, turned likewise; on flat meshes the same as `normal`."""
    uv: Floats
    """(n, 2), the mesh's first texture coordinates; 0 where it has none."""
    mesh: NDArray[np.int64]
    """(n,), SceneMesh.index of the mesh."""
    instance: NDArray[np.int64]
    """(n,), index of the mesh's transforms."""
    triangle: NDArray[np.int64]
    """(n,), index of the mesh's triangles."""

    @property
    def valid(self) -> NDArray[np.bool_]:
        """(n,), whether the ray meets anything."""
        return self.mesh >= 0

    def __len__(self) -> int:
        return len(self.mesh)

    def __repr__(self) -> str:
        return f"Hits({len(self)} rays, {np.count_nonzero(self.valid)} of which meet a surface)"


def shading_frames(normals: ArrayLike, tangents: ArrayLike | None = None) -> Floats:
    """The frames of surface points, as Scene.light_coefficients uses them.

    normals, tangents: (..., 3), of any length > 0; leading axes broadcast. The x axis is the part of the tangent at
        right angles to the normal. None: the frame is the world's, turned by the shortest way that takes its z axis to
        the normal, which is continuous but for the normal -z.

    Returns (..., 3, 3): the columns are the axes x, y and z, the normal, in the world: orthonormal and right-handed.
    `frames @ v` takes a vector to the world, `np.swapaxes(frames, -1, -2) @ w` back. float32 if all arrays are,
    otherwise float64.
    Raises ValueError naming the argument and its row.

    >>> shlight.shading_frames([0, 0, 2], tangents=[0, 1, 1])
    array([[ 0., -1.,  0.],
           [ 1.,  0.,  0.],
           [ 0.,  0.,  1.]])
    """
    kind = given_type(normals, *([] if tangents is None else [tangents]))
    z = _units("normals", normals)
    if tangents is None:
        x = _turned_x(z)
    else:
        tangent = _units("tangents", tangents)
        broadcast(normals=z.shape[:-1], tangents=tangent.shape[:-1])
        x = tangent - np.sum(tangent * z, axis=-1, keepdims=True) * z
        length = np.linalg.norm(x, axis=-1, keepdims=True)
        check_rows("tangents", length[..., 0] > _LEAST_TANGENT, "is parallel to its normal")
        x /= length
    x, z = np.broadcast_arrays(x, z)
    return np.stack([x, np.cross(z, x), z], axis=-1).astype(kind, copy=False)


def _turned_x(z: Floats) -> Floats:
    """The x axis turned by the shortest way from the world's z axis to z (Frisvad 2012)."""
    # 1 + z is a difference below the horizon, where x² + y² = (1 + z) (1 - z) has all digits.
    square = z[..., 0] ** 2 + z[..., 1] ** 2
    above = z[..., 2] >= 0
    length = np.where(above, 1 + z[..., 2], square / np.where(above, 1, 1 - z[..., 2]))
    share = np.divide(z[..., 0], length, out=np.zeros_like(length), where=length > 0)
    x = np.stack([1 - z[..., 0] * share, -z[..., 1] * share, -z[..., 0]], axis=-1)
    return np.where((length > 0)[..., None], x, [-1.0, 0, 0])


def _units(name: str, value: ArrayLike) -> Floats:
    vectors = checked_array(name, value, np.float64, core_axes=1)
    check_last(name, vectors, 3)
    check_finite(name, vectors, core_axes=1)
    largest = np.abs(vectors).max(axis=-1, keepdims=True, initial=0)
    check_rows(name, largest[..., 0] > 0, "has length 0")
    scaled = vectors / largest
    return scaled / np.linalg.norm(scaled, axis=-1, keepdims=True)
