# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers on an evaluated mesh and its instances that shader programs read."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .mesh_shape import pointiness, random_per_island

Array = NDArray[np.float32]

# Prefix of the tangents of a UV map: xyz and the sign of the bitangent, per corner.
TANGENT = "tangent:"
# Prefix of a colour attribute; without a name, the one for rendering.
COLOR = "color:"
# Where a vertex lies in the mesh's texture space.
GENERATED = "generated:"

# Numbers that the mesh's shape gives.
SHAPES: dict[str, Callable[[Any], NDArray[np.float64]]] = {
    "pointiness:": pointiness,
    "random per island:": random_per_island,
}

COMPONENTS = {
    "FLOAT": 1,
    "INT": 1,
    "INT8": 1,
    "BOOLEAN": 1,
    "FLOAT2": 2,
    "FLOAT_VECTOR": 3,
    "FLOAT_COLOR": 4,
    "BYTE_COLOR": 4,
}


def mesh_attributes(mesh: Any, names: Iterable[str]) -> dict[str, Array]:
    """Those of these names that the mesh has, per triangle's corner (k, 3, c); its triangles must be calculated.

    "" is the UV map for rendering; the prefixes above name what is made of a mesh.
    """
    found = {}
    for name in names:
        values = _attribute(mesh, name)
        if values is not None:
            found[name] = np.ascontiguousarray(values, dtype=np.float32)
    return found


def _attribute(mesh: Any, name: str) -> Array | None:
    if name.startswith(TANGENT):
        return _tangents(mesh, name.removeprefix(TANGENT))
    if name.startswith(COLOR):
        return _color(mesh, name.removeprefix(COLOR))
    if name == GENERATED:
        return _generated(mesh)
    if name in SHAPES:
        return SHAPES[name](mesh).astype(np.float32)[_corners(mesh, "vertices")][..., None]
    uvs = _uvs(mesh, name)
    if uvs is not None:
        return uvs
    layer = mesh.attributes.get(name) if name else None
    return None if layer is None else _layer(mesh, layer)


def _corners(mesh: Any, what: str = "loops") -> NDArray[np.int32]:
    """Of each triangle's corner the number of its loop or vertex, (k, 3)."""
    numbers = np.empty(len(mesh.loop_triangles) * 3, dtype=np.int32)
    mesh.loop_triangles.foreach_get(what, numbers)
    return numbers.reshape(-1, 3)


def _uv_layer(mesh: Any, name: str) -> Any:
    return mesh.uv_layers.get(name) if name else next((map_ for map_ in mesh.uv_layers if map_.active_render), None)


def _uvs(mesh: Any, name: str) -> Array | None:
    layer = _uv_layer(mesh, name)
    if layer is None:
        return None
    uvs = np.empty(len(mesh.loops) * 2, dtype=np.float32)
    layer.data.foreach_get("uv", uvs)
    return np.nan_to_num(uvs, posinf=0.0, neginf=0.0).reshape(-1, 2)[_corners(mesh)]


def _tangents(mesh: Any, name: str) -> Array | None:
    layer = _uv_layer(mesh, name)
    if layer is None:
        return None
    try:
        mesh.calc_tangents(uvmap=layer.name)
    except RuntimeError:  # faces of more than four corners; they have none
        return None
    count = len(mesh.loops)
    tangents, signs = np.empty(count * 3, dtype=np.float32), np.empty(count, dtype=np.float32)
    mesh.loops.foreach_get("tangent", tangents)
    mesh.loops.foreach_get("bitangent_sign", signs)
    mesh.free_tangents()
    return np.concatenate([tangents.reshape(-1, 3), signs[:, None]], axis=1)[_corners(mesh)]


def _color(mesh: Any, name: str) -> Array | None:
    layers = mesh.color_attributes
    index = layers.render_color_index
    layer = layers.get(name) if name else layers[index] if 0 <= index < len(layers) else None
    return None if layer is None else _layer(mesh, layer)


def _layer(mesh: Any, layer: Any) -> Array | None:
    """Any attribute; colours of bytes are linear light here, as Blender gives them."""
    count = COMPONENTS.get(layer.data_type)
    if count is None:
        return None
    flat = np.empty(len(layer.data) * count, dtype=np.float32)
    field = {"FLOAT2": "vector", "FLOAT_VECTOR": "vector"}.get(layer.data_type, "color" if count == 4 else "value")
    layer.data.foreach_get(field, flat)
    values = np.nan_to_num(flat).reshape(-1, count)
    if layer.domain == "CORNER":
        return values[_corners(mesh)]
    if layer.domain == "POINT":
        return values[_corners(mesh, "vertices")]
    if layer.domain == "FACE":
        faces = np.empty(len(mesh.loop_triangles), dtype=np.int32)
        mesh.loop_triangles.foreach_get("polygon_index", faces)
        return np.repeat(values[faces][:, None], 3, axis=1)
    return None


def _generated(mesh: Any) -> Array:
    places = np.empty(len(mesh.vertices) * 3, dtype=np.float32)
    mesh.vertices.foreach_get("co", places)
    middle, size = np.array(mesh.texspace_location), np.array(mesh.texspace_size)
    size = np.where(size != 0.0, size, 1.0)
    unit = (places.reshape(-1, 3) - middle + size) / (2.0 * size)
    return unit.astype(np.float32)[_corners(mesh, "vertices")]


def attribute_component(values: Array, component: int) -> Array:
    """A component of numbers (…, c) as programs read it: RGBA, and the mean of RGB; one number is a grey."""
    count = values.shape[-1]
    if component == 4:
        return values[..., 0] if count == 1 else values[..., :3].sum(axis=-1) / 3.0
    if component < count:
        return values[..., component]
    grey = count == 1 and component < 3
    return values[..., 0] if grey else np.full(values.shape[:-1], float(component == 3), dtype=np.float32)
