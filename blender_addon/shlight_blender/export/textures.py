# SPDX-License-Identifier: GPL-3.0-or-later
"""Image Texture nodes: which picture is looked up, where, and the values that Cycles finds there.

On an area lamp (u, v) is (0, 0) … (1, 1) along its own x and y: what Cycles gives there as Parametric and, if
`LAMPS.area_has_uvs`, as the default UV map. Any other map is (0, 0), as those that a mesh lacks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from mathutils import Euler
from numpy.typing import NDArray

from ..compat import LAMPS
from ..report import Effect, ExportReport
from .nodes import REC709_LUMINANCE, ConstantReader, Origin, origin
from .pictures import linear_from_srgb, stored_pixels

Array = NDArray[np.float64]
UvOwner = Literal["mesh", "area lamp"]
# Colour spaces whose bytes are read right; images of floats are linear in any.
COLOR_SPACES = {"sRGB", "Non-Color", "Raw", "Linear", "Linear Rec.709"}
INTERPOLATIONS = {"Linear", "Closest"}
EXTENSIONS = {"REPEAT", "EXTEND", "CLIP", "MIRROR"}


@dataclass(frozen=True)
class ImageTexture:
    """A picture over texture coordinates (u, v), and how a UV map becomes these."""

    pixels: NDArray[np.float32]  # (height, width, 3), row 0 at v = 0, encoded where `is_srgb`
    is_srgb: bool = False
    interpolation: str = "Linear"  # or "Closest"
    extension: str = "REPEAT"  # or "EXTEND", "CLIP", "MIRROR"
    uv_map: str = ""  # "": a mesh's map for rendering, a lamp's own coordinates
    matrix: Array | None = None  # (2, 3): (u, v, 1) of the map to texture coordinates; None: they are the same
    is_number: bool = False  # its luminance counts, as where a number is asked for

    def coordinates(self, uvs: Array) -> Array:
        """Texture coordinates (..., 2) of places (..., 2) in the UV map."""
        return uvs if self.matrix is None else uvs @ self.matrix[:, :2].T + self.matrix[:, 2]

    def texels(self, uvs: Array) -> Array:
        """Texture coordinates (..., 2) in units of texels."""
        height, width = self.pixels.shape[:2]
        return self.coordinates(uvs) * (width, height)

    def sample(self, uvs: Array) -> Array:
        """Linear RGB (n, 3) at places (n, 2) in the UV map; encoded values are interpolated, as in Cycles."""
        x, y = self.texels(uvs).T
        if self.interpolation == "Closest":
            found = self._texel(np.floor(x), np.floor(y))
        else:
            left, below = np.floor(x - 0.5), np.floor(y - 0.5)
            s, t = (x - 0.5 - left)[:, None], (y - 0.5 - below)[:, None]
            lower = (1 - s) * self._texel(left, below) + s * self._texel(left + 1, below)
            upper = (1 - s) * self._texel(left, below + 1) + s * self._texel(left + 1, below + 1)
            found = (1 - t) * lower + t * upper
        if self.is_srgb:
            found = linear_from_srgb(found)
        return np.repeat(found @ REC709_LUMINANCE[:, None], 3, axis=1) if self.is_number else found

    def _texel(self, column: Array, row: Array) -> Array:
        height, width = self.pixels.shape[:2]
        found = self.pixels[self._wrapped(row, height), self._wrapped(column, width)].astype(np.float64)
        if self.extension == "CLIP":
            found[(column < 0) | (column >= width) | (row < 0) | (row >= height)] = 0.0
        return found

    def _wrapped(self, index: Array, count: int) -> NDArray[np.int64]:
        if self.extension == "REPEAT":
            index = np.mod(index, count)
        elif self.extension == "MIRROR":
            index = np.mod(index, 2 * count)
            index = np.minimum(index, 2 * count - 1 - index)
        return np.clip(index, 0, count - 1).astype(np.int64)


def read_image_texture(reader: ConstantReader, source: Origin, owner: UvOwner, is_number: bool) -> ImageTexture | None:
    """The texture that `source` looks up, None if it is no such texture; `reader` reports what is not as in Cycles.

    owner: what has the UV maps.
    """
    node = source.node
    if node is None or node.type != "TEX_IMAGE" or source.output.name != "Color" or node.projection != "FLAT":
        return None
    if node.image is not None and node.image.source == "TILED":
        return None
    placed = _placed(reader, origin(node.inputs["Vector"], source.groups), owner)
    if placed is None:
        return None
    uv_map, to_texture = placed
    report, place = reader.report, reader.at(node)
    _report_differences(report, place, node)
    stored = None if node.image is None else stored_pixels(node.image)
    if stored is None:
        report.add(place, "it has no image, or its file is missing; black is used", Effect.LIGHT)
    return ImageTexture(
        pixels=np.zeros((1, 1, 3), dtype=np.float32) if stored is None else stored.values,
        is_srgb=stored is not None and stored.is_srgb,
        interpolation=node.interpolation if node.interpolation in INTERPOLATIONS else "Linear",
        extension=node.extension if node.extension in EXTENSIONS else "REPEAT",
        uv_map=uv_map,
        matrix=to_texture[:2][:, [0, 1, 3]],
        is_number=is_number,
    )


def _report_differences(report: ExportReport, place: str, node: Any) -> None:
    if node.interpolation not in INTERPOLATIONS:
        report.add(place, f"interpolation {node.interpolation} is not supported; Linear is used")
    if node.extension not in EXTENSIONS:
        report.add(place, f"extension {node.extension} is not supported; REPEAT is used")
    image = node.image
    if image is None:
        return
    if image.source not in {"FILE", "GENERATED"}:
        report.add(place, f"images of the kind {image.source} are not supported; one picture is used")
    if not image.is_float and image.colorspace_settings.name not in COLOR_SPACES:
        report.add(place, f"colour space {image.colorspace_settings.name} is not supported; taken for linear")


def _placed(reader: ConstantReader, source: Origin, owner: UvOwner) -> tuple[str, Array] | None:
    """The UV map that a Vector comes from, and what Mapping nodes (4, 4) do with it; None: it is something else."""
    node, name = source.node, _uv_map(source)
    if name is not None:
        if owner == "mesh" or (LAMPS.area_has_uvs and not name):
            return name, np.eye(4)
        which = f" '{name}'" if name else " in this version of Blender"
        reader.report.add(reader.place, f"a lamp has no UV map{which}; one colour of its texture is used")
        return "", _constant_place((0.0, 0.0, 0.0))
    if owner == "area lamp" and node.type == "NEW_GEOMETRY" and source.output.name == "Parametric":
        return "", np.eye(4)
    if node.type != "MAPPING" or node.vector_type == "NORMAL":
        return None
    if any(origin(socket, source.groups).node is not None for socket in node.inputs if socket.name != "Vector"):
        return None
    vector = origin(node.inputs["Vector"], source.groups)
    linked = vector.node is not None
    before = _placed(reader, vector, owner) if linked else ("", _constant_place(vector.socket.default_value))
    return None if before is None else (before[0], _mapping(node, source.groups) @ before[1])


def _uv_map(source: Origin) -> str | None:
    """The name of the UV map that a texture's Vector is, "" for the default; None if it is no UV map."""
    node = source.node
    if node is None or (node.type == "TEX_COORD" and source.output.name == "UV" and not node.from_instancer):
        return ""
    return str(node.uv_map) if node.type == "UVMAP" and not node.from_instancer else None


def _constant_place(place: Sequence[float]) -> Array:
    """What takes every place to this one, (4, 4)."""
    constant = np.zeros((4, 4))
    constant[:, 3] = (*place, 1.0)
    return constant


def _mapping(node: Any, groups: tuple[Any, ...]) -> Array:
    """What a Mapping node of constants does with a place, (4, 4)."""
    value = {socket.name: origin(socket, groups).socket.default_value for socket in node.inputs}
    scale, turn, shift = np.eye(4), np.eye(4), np.eye(4)
    turn[:3, :3] = np.array(Euler(value["Rotation"], "XYZ").to_matrix())
    factors = np.array(value["Scale"], dtype=np.float64)
    if node.vector_type != "VECTOR":
        shift[:3, 3] = value["Location"]
    if node.vector_type == "TEXTURE":
        shift[:3, 3] *= -1.0
        scale[:3, :3] = np.diag(np.divide(1.0, factors, out=np.zeros(3), where=factors != 0.0))
        return scale @ turn.T @ shift
    scale[:3, :3] = np.diag(factors)
    return shift @ turn @ scale
