# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers on an evaluated mesh that shader programs read: its attributes, and what its shape gives."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import ANGLES_TURN, Triangles, uv_coordinates, values_of
from ..names import is_utf8, with_name
from .object_values import hashed, share
from .triangle_geometry import triangle_tangents, unit

Array = NDArray[np.float64]
Index = NDArray[np.int64]


def _edges(mesh: Any) -> Index:
    return values_of(mesh.edges, "vertices", np.int32, 2).astype(np.int64)


def _vectors(collection: Any, name: str) -> Array:
    return values_of(collection, name, np.float32, 3).astype(np.float64)


def pointiness(mesh: Any) -> Array:
    """Per vertex how far its edges lean towards its normal: 0.5 where it is flat, more on crests, less in grooves.

    Vertices in the same place count as one; each takes the mean of itself and its neighbours.
    """
    places, one_of = np.unique(_vectors(mesh.vertices, "co"), axis=0, return_inverse=True)
    one_of = one_of.reshape(-1)
    count = len(places)
    normals = np.zeros((count, 3))
    np.add.at(normals, one_of, _vectors(mesh.vertices, "normal"))
    edges = np.unique(np.sort(one_of[_edges(mesh)], axis=1), axis=0)
    edges = edges[edges[:, 0] != edges[:, 1]]
    both = np.concatenate([edges, edges[:, ::-1]])
    degree = np.bincount(both[:, 0], minlength=count)
    leaning = np.zeros((count, 3))
    np.add.at(leaning, both[:, 0], unit(places[both[:, 1]] - places[both[:, 0]], 0.0))
    leaning /= np.maximum(degree, 1)[:, None]
    cosine = np.clip((unit(normals, 0.0) * leaning).sum(axis=1), -1.0, 1.0)
    raw = np.where(degree > 0, np.arccos(cosine) / np.pi, 0.0)
    smooth = (raw + np.bincount(both[:, 0], weights=raw[both[:, 1]], minlength=count)) / (degree + 1)
    found: Array = smooth[one_of]
    return found


def random_per_island(mesh: Any) -> Array:
    """Per vertex a random number that all vertices joined by edges share.

    It is that of the vertex on which a union of sets by rank, edge by edge, settles.
    """
    parent = list(range(len(mesh.vertices)))
    rank = [0] * len(parent)

    def root(i: int) -> int:
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for a, b in _edges(mesh).tolist():
        first, second = root(a), root(b)
        if first == second:
            continue
        if rank[first] < rank[second]:
            first, second = second, first
        parent[second] = first
        rank[first] += rank[first] == rank[second]
    roots = [root(i) for i in range(len(parent))]
    numbers = {i: share(hashed(i)) for i in set(roots)}
    return np.array([numbers[i] for i in roots])


FloatArray = NDArray[np.float32]

# The UV map for rendering.
UV = ""
# Names of what is no attribute of the mesh begin with what no name in Blender holds.
# Prefix of the tangents of a UV map: xyz and the sign of the bitangent, per corner.
TANGENT = "\0tangent:"
# Prefix of a colour attribute; without a name, the one for rendering.
COLOR = "\0color:"
# Prefix of a vertex's position in the mesh's texture space.
GENERATED = "\0generated:"
# A vertex's position in the frame of the mesh, before any displacement.
UNDISPLACED = "\0undisplaced:"
# The normal there that a bump of the displacement bends.
UNDISPLACED_NORMAL = "\0undisplaced normal:"

# Numbers that the mesh's shape gives.
POINTINESS, RANDOM_PER_ISLAND = "\0pointiness:", "\0random per island:"
SHAPES: dict[str, Callable[[Any], Array]] = {POINTINESS: pointiness, RANDOM_PER_ISLAND: random_per_island}

# Numbers of hair, which are 0 on all else.
IS_CURVE, CURVE_INTERCEPT, CURVE_LENGTH = "\0is curve:", "\0curve intercept:", "\0curve length:"
CURVE_RANDOM, CURVE_THICKNESS = "\0curve random:", "\0curve thickness:"
OF_CURVES = (IS_CURVE, CURVE_INTERCEPT, CURVE_LENGTH, CURVE_RANDOM, CURVE_THICKNESS)

# Names of values and numbers of components by types of attributes.
TYPES = {
    **dict.fromkeys(("FLOAT", "INT", "INT8", "BOOLEAN"), ("value", 1)),
    **{"FLOAT2": ("vector", 2), "FLOAT_VECTOR": ("vector", 3)},
    **dict.fromkeys(("FLOAT_COLOR", "BYTE_COLOR"), ("color", 4)),
}


def mesh_attributes(
    mesh: Any, triangles: Triangles, normals: FloatArray | None, names: Iterable[str]
) -> dict[str, FloatArray]:
    """The mesh's attributes with these names, per corner of its triangles (k, 3, c).

    UV is the UV map for rendering; the prefixes above name what is made of a mesh. normals: as of `triangle_tangents`.
    """
    found = {name: _attribute(mesh, triangles, normals, name) for name in names}
    return {
        name: np.ascontiguousarray(values, dtype=np.float32) for name, values in found.items() if values is not None
    }


def _attribute(mesh: Any, triangles: Triangles, normals: FloatArray | None, name: str) -> FloatArray | None:
    if name.startswith(TANGENT):
        return _tangents(mesh, triangles, normals, name.removeprefix(TANGENT))
    if name.startswith(COLOR):
        return _layer(triangles, _color_layer(mesh.color_attributes, name.removeprefix(COLOR)))
    if name == GENERATED:
        return _generated(mesh, triangles)
    if name == UNDISPLACED:
        return triangles.vertices[triangles.corner_vertices]
    if name in SHAPES:
        return SHAPES[name](mesh).astype(np.float32)[triangles.corner_vertices][..., None]
    uvs = _uv_layer(mesh, name)
    if uvs is not None:
        return _uvs(uvs)[triangles.corners]
    return _layer(triangles, with_name(mesh.attributes, name) if name else None)


def _uv_layer(mesh: Any, name: str) -> Any:
    layers = mesh.uv_layers
    return with_name(layers, name) if name else next((layer for layer in layers if layer.active_render), None)


def _uvs(layer: Any) -> FloatArray:
    return np.nan_to_num(uv_coordinates(layer), posinf=0.0, neginf=0.0)


def _color_layer(layers: Any, name: str) -> Any:
    index = layers.render_color_index
    return with_name(layers, name) if name else layers[index] if 0 <= index < len(layers) else None


def _tangents(mesh: Any, triangles: Triangles, normals: FloatArray | None, name: str) -> FloatArray | None:
    """The tangents of a UV map. A mesh without maps has that of directions from its origin.

    Blender computes them faster, and the same where all faces are triangles: else it takes theirs, and Cycles those of
    the triangles that they are cut into. Python has to be able to say the map's name.
    """
    layer = _uv_layer(mesh, name)
    if layer is None and name != UV:
        return None
    is_cut = np.bincount(triangles.polygons).max() > 1
    if layer is None or is_cut or not is_utf8(layer):
        uvs = _on_sphere(triangles.vertices) if layer is None else _uvs(layer)
        corners = triangles.corner_vertices if layer is None else triangles.corners
        turns = layer is None and ANGLES_TURN
        return triangle_tangents(triangles.vertices, triangles.corner_vertices, normals, uvs[corners], u_turns=turns)
    mesh.calc_tangents(uvmap=layer.name)
    tangents = values_of(mesh.loops, "tangent", np.float32, 3)
    signs = values_of(mesh.loops, "bitangent_sign", np.float32)
    mesh.free_tangents()
    return np.concatenate([tangents, signs[:, None]], axis=1)[triangles.corners]


def _on_sphere(places: FloatArray) -> FloatArray:
    x, y, z = np.moveaxis(unit(places.astype(np.float64), 0.0), -1, 0)
    u = np.where((x == 0.0) & (y == 0.0), 0.0, 0.5 - np.arctan2(x, y) / (2.0 * np.pi))
    return np.stack([u, 1.0 - np.arccos(np.clip(z, -1.0, 1.0)) / np.pi], axis=-1).astype(np.float32)


def _layer(triangles: Triangles, layer: Any) -> FloatArray | None:
    """Any attribute; colours of bytes are linear light here, as Blender gives them."""
    if layer is None or layer.data_type not in TYPES:
        return None
    field, count = TYPES[layer.data_type]
    values = np.nan_to_num(values_of(layer.data, field, np.float32, count)).reshape(-1, count)
    if layer.domain == "FACE":
        return np.repeat(values[triangles.polygons][:, None], 3, axis=1)
    places = {"CORNER": triangles.corners, "POINT": triangles.corner_vertices}.get(layer.domain)
    return None if places is None else values[places]


def _generated(mesh: Any, triangles: Triangles) -> FloatArray:
    middle, size = np.array(mesh.texspace_location), np.array(mesh.texspace_size)
    size = np.where(size != 0.0, size, 1.0)
    unit = (_vectors(mesh.vertices, "undeformed_co") - middle + size) / (2.0 * size)
    return unit.astype(np.float32)[triangles.corner_vertices]


def attribute_component(values: FloatArray, component: int) -> FloatArray:
    """A component of numbers (…, c) as programs read it: RGBA, and the mean of RGB; one number is a grey."""
    count = values.shape[-1]
    if component == 4:
        return values[..., 0] if count == 1 else values[..., :3].sum(axis=-1) / 3.0
    if component < count:
        return values[..., component]
    grey = count == 1 and component < 3
    return values[..., 0] if grey else np.full(values.shape[:-1], float(component == 3), dtype=np.float32)
