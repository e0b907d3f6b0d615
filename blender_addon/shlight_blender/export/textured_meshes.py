# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose emission has a texture, as meshes of pieces that each shine evenly.

A triangle is quartered at the middles of its edges as often as its radiance asks for. Each piece shines with the mean
of the radiance over it; then pieces of similar means are given one radiance, their mean by area, because pieces of the
same radiance are one light to the core. Both steps keep the total light.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .corner_values import at_corners
from .emission import Input, VaryingEmission, divided, of_both_sides, share_of
from .materials import Surface
from .mesh_arrays import MeshArrays

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
Radiance = Callable[[Array], Array]  # of places (n, c), linear RGB (n, 3), or (n, 6) of two sides

# Error that the pieces, and then their colours, may have: root mean square ÷ that of the radiance.
TOLERANCE = 0.05
MOST_PIECES = 1024
MOST_COLORS = 12
# Quarterings into parts whose means are kept, at most, and how many more there are to the samples of each mean.
MOST_LEVELS = 7
FINER_LEVELS = 3
# Quarterings to the samples; samples, and parts whose means are kept, of all triangles together.
LEAST_SAMPLING_LEVELS = 8
MOST_SAMPLING_LEVELS = 11
SCRIPT_SAMPLING_LEVELS = 6  # at most, where a script is run for each sample
MOST_SAMPLES = 1 << 20
MOST_PARTS = 1 << 18
SAMPLES_AT_ONCE = 1 << 18


def _views(count: int) -> Array:
    """Directions (count, 3) around z, as dense as their cosine with it."""
    rank = (np.arange(count) + 0.5) / count
    azimuth = np.arange(count) * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack([np.sqrt(rank) * np.cos(azimuth), np.sqrt(rank) * np.sin(azimuth), np.sqrt(1.0 - rank)], axis=1)


# Directions in which a surface is looked at whose emission depends on them.
VIEWS = _views(8)

# Corners of a quarter, from those of the triangle; wound as it is.
QUARTERS = 0.5 * np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
    ]
)


class Pieces(NamedTuple):
    """Parts of triangles; `error` is their root mean square deviation, as a part of the radiance's own."""

    triangle: IntArray  # (n,) which triangle it is of
    corners: Array  # (n, 3, 3): row i are the barycentric coordinates of corner i
    radiance: Array  # (n, 3 or 6) linear RGB, the mean over the piece
    area: Array  # (n,)
    error: float


@lru_cache
def corners_at(level: int) -> Array:
    """Barycentric corners (4^level, 3, 3) of a triangle's parts; part i has the quarters 4 i … 4 i + 3."""
    corners = np.eye(3)[None]
    for _ in range(level):
        corners = np.einsum("qij,pjk->pqik", QUARTERS, corners).reshape(-1, 3, 3)
    return corners


@dataclass(frozen=True)
class _Pyramid:
    """Means (4^level, 3 or 6) and mean squares (4^level,) of a triangle's parts, for each level."""

    means: list[Array]
    squares: list[Array]

    def variance(self, level: int, part: int) -> float:
        return max(float(self.squares[level][part] - (self.means[level][part] ** 2).sum()), 0.0)


def sampling_levels(texels: Array) -> IntArray:
    """How often to quarter triangles (n, 3, 2), given in texels, for samples.

    They are an eighth of a texel apart or closer, unless all triangles together would have more than MOST_SAMPLES.
    """
    longest = np.linalg.norm(texels - np.roll(texels, 1, axis=1), axis=2).max(axis=1)
    levels = np.ceil(np.log2(np.maximum(8.0 * longest, 1.0)))
    levels = np.clip(levels, LEAST_SAMPLING_LEVELS, MOST_SAMPLING_LEVELS).astype(np.int64)
    while (4.0**levels).sum() > MOST_SAMPLES and levels.max() > 0:
        levels = np.minimum(levels, levels.max() - 1)
    return levels


def _sampled(radiance: Radiance, uvs: Array, kept: int, finer: int) -> tuple[Array, Array]:
    """Means (n, 4^kept, 3 or 6) and mean squares (n, 4^kept) of the parts of triangles (n, 3, c)."""
    parts = np.matmul(corners_at(kept), uvs[:, None]).reshape(-1, *uvs.shape[1:])
    centers = corners_at(finer).mean(axis=1)
    step = max(SAMPLES_AT_ONCE >> (2 * finer), 1)
    mean, square = [], []
    for first in range(0, len(parts), step):
        places = centers @ parts[first : first + step]
        found = radiance(places.reshape(-1, places.shape[-1])).reshape(*places.shape[:2], -1)
        mean.append(found.mean(axis=1))
        square.append((found**2).sum(axis=2).mean(axis=1))
    count, sides = len(uvs), mean[0].shape[1]
    return np.concatenate(mean).reshape(count, -1, sides), np.concatenate(square).reshape(count, -1)


def _pyramids(radiance: Radiance, uvs: Array, kept: int, finer: int) -> list[_Pyramid]:
    """The pyramids of triangles (n, 3, c), which are sampled together."""
    mean, square = _sampled(radiance, uvs, kept, finer)
    means, squares, (count, _, sides) = [mean], [square], mean.shape
    for _ in range(kept):
        means.insert(0, means[0].reshape(count, -1, 4, sides).mean(axis=2))
        squares.insert(0, squares[0].reshape(count, -1, 4).mean(axis=2))
    return [_Pyramid([level[i] for level in means], [level[i] for level in squares]) for i in range(count)]


def cut(radiance: Radiance, uvs: Array, levels: IntArray, area: Array, most: int = MOST_PIECES) -> Pieces:
    """Cuts triangles into pieces of even light, those first whose squared deviation times area is the largest.

    uvs: (n, 3, c), what `radiance` is a function of at the corners; levels: (n,), from `sampling_levels`; area: (n,).
    At most `most` pieces, or n if that is more.
    """
    if len(uvs) >= most:
        return _whole(radiance, uvs, levels, area)
    kept = np.clip(levels - FINER_LEVELS, 0, MOST_LEVELS)
    while (4.0**kept).sum() > MOST_PARTS and kept.max() > 0:
        kept = np.minimum(kept, kept.max() - 1)
    pyramids: dict[int, _Pyramid] = {}
    for keep, level in {*zip(kept.tolist(), levels.tolist(), strict=True)}:
        chosen = np.flatnonzero((kept == keep) & (levels == level))
        pyramids |= zip(chosen.tolist(), _pyramids(radiance, uvs[chosen], keep, level - keep), strict=True)

    def part(triangle: int, level: int, number: int) -> tuple[float, tuple[int, int, int]]:
        return area[triangle] / 4.0**level * pyramids[triangle].variance(level, number), (triangle, level, number)

    def quarters(place: tuple[int, int, int]) -> list[tuple[float, Any]]:
        triangle, level, number = place
        if level == kept[triangle]:
            return []
        return [part(triangle, level + 1, quarter) for quarter in range(4 * number, 4 * number + 4)]

    whole = sum(area[triangle] * float(pyramid.squares[0][0]) for triangle, pyramid in sorted(pyramids.items()))
    places, left = divided([part(triangle, 0, 0) for triangle in range(len(uvs))], quarters, TOLERANCE**2 * whole, most)
    return _gathered(places, pyramids, area, share_of(left, whole))


def _whole(radiance: Radiance, uvs: Array, levels: IntArray, area: Array) -> Pieces:
    """Triangles as pieces: there may be millions, so that none has an object of its own."""
    means, squares = np.zeros((0, 0)), np.zeros(len(uvs))
    for level in np.unique(levels).tolist():
        chosen = np.flatnonzero(levels == level)
        mean, square = _sampled(radiance, uvs[chosen], 0, level)
        means = means if means.size else np.zeros((len(uvs), mean.shape[2]))
        means[chosen], squares[chosen] = mean[:, 0], square[:, 0]
    left = area @ np.maximum(squares - (means**2).sum(axis=1), 0.0)
    corners = np.broadcast_to(np.eye(3), (len(uvs), 3, 3))
    return Pieces(np.arange(len(uvs)), corners, means, area, share_of(float(left), float(area @ squares)))


def _gathered(places: list[tuple[int, int, int]], pyramids: dict[int, _Pyramid], area: Array, error: float) -> Pieces:
    tables = [corners_at(level) for level in range(1 + max(level for _, level, _ in places))]
    triangles = np.array([triangle for triangle, _, _ in places], dtype=np.int64)
    return Pieces(
        triangles,
        np.array([tables[level][part] for _, level, part in places]),
        np.array([pyramids[triangle].means[level][part] for triangle, level, part in places]),
        area[triangles] / 4.0 ** np.array([level for _, level, _ in places]),
        error,
    )


class Colors(NamedTuple):
    """Few colours for many pieces; `error` as of Pieces, but only what the colours add to it."""

    color_of: IntArray  # (n,) which colour a piece has
    radiance: Array  # (k, 3 or 6) linear RGB, the mean by area over the pieces that have it
    error: float


def share_colors(radiance: Array, area: Array, most: int = MOST_COLORS) -> Colors:
    """Gives pieces of radiance (n, 3 or 6) and area (n,) at most `most` colours besides black, which stays black.

    The group that deviates most is cut in two across its longest axis; after each cut every piece goes to the colour
    that is nearest to it (Linde, Buzo & Gray 1980).
    """
    lit = radiance.any(axis=1) & (area > 0.0)
    values, weights = radiance[lit], area[lit]
    whole = float(weights @ (values**2).sum(axis=1))
    labels: IntArray = np.zeros(len(values), dtype=np.int64)
    colors = np.zeros((0, radiance.shape[1]))
    squares: NDArray[Any] = np.zeros(0)
    for _ in range(most if len(values) else 0):
        if len(squares):
            labels = _nearest(values, weights, _divided(values, weights, labels, int(squares.argmax())))
        colors = _means(values, weights, labels)
        squares = np.bincount(labels, weights * ((values - colors[labels]) ** 2).sum(axis=1))
        if squares.sum() <= TOLERANCE**2 * whole:
            break
    color_of = np.full(len(radiance), len(colors))
    color_of[lit] = labels
    black = np.zeros((0 if lit.all() else 1, radiance.shape[1]))
    return Colors(color_of, np.concatenate([colors, black]), share_of(float(squares.sum()), whole))


def _nearest(values: Array, weights: Array, labels: IntArray, rounds: int = 4) -> IntArray:
    for _ in range(rounds):
        colors = _means(values, weights, labels)
        nearest = ((colors**2).sum(axis=1) - 2.0 * values @ colors.T).argmin(axis=1)
        labels = np.unique(nearest, return_inverse=True)[1].reshape(-1).astype(np.int64)
    return labels


def _means(values: Array, weights: Array, labels: IntArray) -> Array:
    total = np.bincount(labels, weights)
    return np.stack([np.bincount(labels, weights * channel) / total for channel in values.T], axis=1)


def _divided(values: Array, weights: Array, labels: IntArray, which: int) -> IntArray:
    """The labels with the upper part of group `which`, along its longest axis, as a group of its own."""
    inside = labels == which
    deviation = values[inside] - np.average(values[inside], axis=0, weights=weights[inside])
    axis = np.linalg.eigh((weights[inside, None] * deviation).T @ deviation)[1][:, -1]
    divided = labels.copy()
    divided[np.flatnonzero(inside)[deviation @ axis > 0.0]] = labels.max() + 1
    return divided


FloatArray = NDArray[np.float32]
Remark = Callable[[str], None]


def shines_by_place(surface: Surface) -> bool:
    """Whether instances of a mesh with this surface may shine differently."""
    inputs = [] if surface.varying is None else surface.varying.inputs
    return any(source not in ("attribute", "barycentric", "backfacing") for source, _, _ in inputs)


def with_even_emission(
    arrays: MeshArrays, surfaces: list[Surface], to_world: Array, object_values: Sequence[float], remark: Remark
) -> tuple[MeshArrays, list[Surface]]:
    """The mesh with all varying emission in pieces of even light, and a surface for each colour of them.

    to_world, object_values: of the instance where emission that depends on the place or the object is looked up.
    """
    slots = np.clip(arrays.material_indices, 0, len(surfaces) - 1)
    varying = [slot for slot in np.unique(slots) if surfaces[slot].varying is not None]
    made, parts = list(surfaces), [arrays.chosen(~np.isin(slots, varying), slots)]
    for slot in varying:
        part = arrays.chosen(slots == slot, slots)
        pieces = _cut_surface(part, surfaces[slot].varying, to_world, object_values, MOST_PIECES // len(varying))
        colors = share_colors(pieces.radiance, pieces.area)
        if any(source == "height" for source, _, _ in getattr(surfaces[slot].varying, "inputs", ())):
            remark("a Wireframe in its emission is drawn coarsely, and so is the total of its light")
        else:
            _report_error(pieces, colors, remark)
        if any(source == "towards_viewer" for source, _, _ in getattr(surfaces[slot].varying, "inputs", ())):
            remark("its emission varies with the direction; it lights other surfaces by its mean over all")
        parts.append(_of_pieces(part, pieces, len(made) + colors.color_of))
        made += [replace(surfaces[slot], emission=of_both_sides(color), varying=None) for color in colors.radiance]
    return _joined(parts), made


def _report_error(pieces: Pieces, colors: Colors, remark: Remark) -> None:
    error = float(np.hypot(pieces.error, colors.error))
    if error > 1.5 * TOLERANCE:
        remark(
            f"the texture of its emission is drawn in {len(pieces.area)} pieces of even light, of"
            f" {len(colors.radiance)} colours, which differ from it by {100 * error:.0f} % (root mean square);"
            " the total is kept"
        )


def _cut_surface(
    part: MeshArrays, emission: VaryingEmission | None, to_world: Array, object_values: Sequence[float], most: int
) -> Pieces:
    assert emission is not None
    corners = part.vertices[part.triangles].astype(np.float64)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    inputs = dict.fromkeys(emission.inputs)
    turned = [entry for entry in inputs if entry[0] == "towards_viewer"]
    plain = [entry for entry in inputs if entry not in turned]
    views = list(VIEWS) if turned else [None]
    columns = [(entry, None) for entry in plain] + [(entry, view) for view in views for entry in turned]
    known = np.stack([at_corners(part, to_world, object_values, *column) for column in columns], axis=2)

    def seen(places: Array, view: int) -> dict[Input, Array]:
        first = len(plain) + view * len(turned)
        numbers = [*range(len(plain)), *range(first, first + len(turned))]
        return {entry: places[:, i] for entry, i in zip([*plain, *turned], numbers, strict=True)}

    texels = [
        places.reshape(-1, 3, 2)
        for places in emission.texels(seen(known.reshape(-1, len(columns)), 0), known[..., 0].size)
    ]
    differs = (known != known[:, :1]).any(axis=(1, 2))
    levels = np.zeros(len(corners), dtype=np.int64)
    for places in texels or [np.zeros((len(corners), 3, 2))]:
        levels[differs] = np.maximum(levels[differs], sampling_levels(places[differs]))
    if emission.runs_scripts:
        levels = np.minimum(levels, SCRIPT_SAMPLING_LEVELS)

    def radiance(places: Array) -> Array:
        by_view = [emission.of_sides(seen(places, view), len(places)) for view in range(len(views))]
        return np.mean(by_view, axis=0)

    return cut(radiance, known, levels, area, most)


def _of_pieces(part: MeshArrays, pieces: Pieces, slots: NDArray[Any]) -> MeshArrays:
    """The pieces as triangles; corners at the same place are one vertex, so that neighbours share an edge."""
    if len(pieces.triangle) == len(part.triangles):  # nothing is cut
        return replace(part, material_indices=slots[np.argsort(pieces.triangle)].astype(np.int32))
    places = pieces.corners @ part.vertices[part.triangles[pieces.triangle]].astype(np.float64)
    vertices, index = np.unique(places.astype(np.float32).reshape(-1, 3), axis=0, return_inverse=True)
    normals = None
    if part.normals is not None:
        normals = pieces.corners @ part.normals[pieces.triangle].astype(np.float64)
        length = np.linalg.norm(normals, axis=2, keepdims=True)
        normals = np.where(length > 1e-6, normals / np.maximum(length, 1e-6), part.normals[pieces.triangle])
        normals = normals.astype(np.float32)
    attributes = {
        name: (pieces.corners @ values[pieces.triangle].astype(np.float64)).astype(np.float32)
        for name, values in part.attributes.items()
    }
    return MeshArrays(vertices, index.reshape(-1, 3).astype(np.int32), normals, slots.astype(np.int32), attributes)


def _joined(parts: list[MeshArrays]) -> MeshArrays:
    starts = np.cumsum([0] + [len(part.vertices) for part in parts])
    triangles = [part.triangles + np.int32(start) for part, start in zip(parts, starts, strict=False)]
    normals = [part.normals for part in parts if part.normals is not None]
    return MeshArrays(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate(triangles),
        np.concatenate(normals) if normals else None,
        np.concatenate([part.material_indices for part in parts]),
        {name: np.concatenate([part.attributes[name] for part in parts]) for name in parts[0].attributes},
    )
