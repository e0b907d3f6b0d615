# SPDX-License-Identifier: MIT
"""What rays through a scene meet, and the frames of points in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]


@dataclass(frozen=True, eq=False, repr=False)
class Hits:
    """What n rays meet, as Scene.intersect returns it; each array has a row of each ray.

    Rows of rays that meet nothing hold the distance inf, -1 as mesh, instance and triangle, and zeros otherwise.
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
