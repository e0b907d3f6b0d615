# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers on an evaluated mesh that shader programs read by name."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

# Prefix of the tangents of a UV map: xyz and the sign of the bitangent, per corner.
TANGENT = "tangent:"


def mesh_attributes(mesh: Any, names: Iterable[str]) -> dict[str, Array]:
    """Those of these names that the mesh has, per triangle's corner (k, 3, c); its triangles must be calculated.

    "" is the UV map for rendering.
    """
    loops = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get("loops", loops)
    found = {}
    for name in names:
        values = _uvs(mesh, name)
        if values is not None:
            found[name] = np.ascontiguousarray(values[loops].reshape(-1, 3, values.shape[1]))
    return found


def _uvs(mesh: Any, name: str) -> Array | None:
    layer = mesh.uv_layers.get(name) if name else next((map_ for map_ in mesh.uv_layers if map_.active_render), None)
    if layer is None:
        return None
    uvs = np.empty(len(mesh.loops) * 2, dtype=np.float32)
    layer.data.foreach_get("uv", uvs)
    return np.nan_to_num(uvs, posinf=0.0, neginf=0.0).reshape(-1, 2)
