# SPDX-License-Identifier: GPL-3.0-or-later
"""Image Texture nodes: which picture is looked up, and where."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy

from shlight import nodes
from shlight.nodes import Color, Value, Vector
from shlight.nodes.values import Number, clamp, dot, equal, maximum, normalize, operation, select, sqrt

from ..names import name_of
from ..report import Effect
from .color_spaces import is_known
from .expressions import NodeInputs
from .image_pixels import MISSING, TextureUse, associates_alpha, datablock_texture, file_texture, has_plain_file

INTERPOLATIONS = {"Closest": "closest", "Linear": "linear", "Cubic": "cubic", "Smart": "cubic"}
EXTENSIONS = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip", "MIRROR": "mirror"}
FIRST_TILE = 1001
CHANNELS: tuple[Callable[[Color], Value], ...] = (
    lambda c: c.x,
    lambda c: c.y,
    lambda c: c.z,
    lambda c: c.alpha,
)


def image_texture(inputs: NodeInputs) -> Color | Value:
    """An Image Texture node."""
    node = inputs.node
    textures = None if node.image is None else _textures(inputs, node.image)
    if textures is None:
        found: Color = Color(*MISSING)
    else:
        place = inputs.vector_or("Vector", nodes.uv(""))
        found = _projected(inputs, textures, place)
    return found.alpha if inputs.output.identifier == "Alpha" else found


def environment_texture(inputs: NodeInputs) -> Color:
    """An Environment Texture node, looked up by a direction or a place."""
    node = inputs.node
    textures = None if node.image is None else _textures(inputs, node.image)
    if textures is None:
        return Color(*MISSING)
    direction = normalize(inputs.vector_or("Vector", nodes.position()))
    if node.projection == "MIRROR_BALL":
        return _lookup(inputs, textures, _on_mirror_ball(direction))
    x, y, z = direction
    u = 0.5 - operation("arctangent2", y, x) / (2.0 * math.pi)
    v = 0.5 + operation("arctangent2", z, sqrt(x * x + y * y)) / math.pi
    return _lookup(inputs, textures, Vector(u, v, 0.0), closed=True)


def _on_mirror_ball(direction: Vector) -> Vector:
    """The place in a picture of a mirror ball, seen along +y, that shows a direction."""
    x, y, z = direction.x, direction.y - 1.0, direction.z
    width = 2.0 * sqrt(maximum(-0.5 * y, 0.0))
    return Vector(0.5 + 0.5 * select(width, x / width, x), 0.5 + 0.5 * select(width, z / width, z), 0.0)


def _textures(inputs: NodeInputs, image: Any) -> Any:
    """The texture of an image, or several by tile; None if there are no pixels, which is reported."""
    space = image.colorspace_settings.name
    if not is_known(space):
        inputs.remark(f"colour space {space} is unknown; taken for sRGB")
    node = inputs.node
    use = TextureUse(INTERPOLATIONS[node.interpolation], _extension(node))
    if image.source == "TILED":
        found: Any = _tiles(image, use)
    elif image.source == "SEQUENCE":
        path = bpy.path.abspath(image.filepath_from_user(image_user=inputs.node.image_user), library=image.library)
        found = file_texture(image, path, use)
    else:
        found = None
        if has_plain_file(image):
            path = bpy.path.abspath(image.filepath, library=image.library)
            found = file_texture(image, path, use)
        if image.source in ("MOVIE", "VIEWER"):
            inputs.remark(f"images of the kind {image.source} are not supported; the picture in memory is used")
        found = found or datablock_texture(image, use)
    if not found:
        inputs.remark(f"its picture '{image.filepath or name_of(image)}' is missing; magenta is used", Effect.THING)
        return None
    return found


def _extension(node: Any) -> str:
    return EXTENSIONS.get(getattr(node, "extension", "REPEAT"), "repeat")


def _tiles(image: Any, use: TextureUse) -> dict[tuple[int, int], Any]:
    pattern = bpy.path.abspath(image.filepath, library=image.library)
    found: dict[tuple[int, int], Any] = {}
    for tile in image.tiles:
        column, row = (tile.number - FIRST_TILE) % 10, (tile.number - FIRST_TILE) // 10
        name = f"u{column + 1}_v{row + 1}"
        path = pattern.replace("<UDIM>", str(tile.number)).replace("<UVTILE>", name)
        texture = file_texture(image, path, use) if Path(path).is_file() else None
        if texture is None and len(found) == 0 and tile == image.tiles[0]:
            texture = datablock_texture(image, use)
        if texture is not None:
            found[column, row] = texture
    return found


def _projected(inputs: NodeInputs, textures: Any, place: Vector) -> Color:
    projection = inputs.node.projection
    if projection == "BOX":
        return _box(inputs, textures, place)
    if projection == "SPHERE":
        place = _on_sphere(place * 2.0 - 1.0)
    elif projection == "TUBE":
        place = _on_tube(place * 2.0 - 1.0)
    return _lookup(inputs, textures, place, closed=projection != "FLAT")


def _lookup(inputs: NodeInputs, textures: Any, place: Vector, *, closed: bool = False) -> Color:
    node = inputs.node
    alpha_is_used = any(output.name == "Alpha" and output.is_linked for output in node.outputs)
    return nodes.image(
        textures,
        place,
        interpolation=INTERPOLATIONS[node.interpolation],
        extension=_extension(node),
        unassociate=alpha_is_used and associates_alpha(node.image),
        closed=closed,
    )


def _on_sphere(p: Vector) -> Vector:
    square = dot(p, p)
    pole = equal(p.x * p.x + p.y * p.y, 0.0)
    u = select(pole, 0.0, 0.5 - operation("arctangent2", p.x, p.y) / (2.0 * math.pi))
    v = 1.0 - operation("arccosine", p.z / sqrt(square)) / math.pi
    return Vector(select(square, u, 0.0), select(square, v, 0.0), 0.0)


def _on_tube(p: Vector) -> Vector:
    radius = sqrt(p.x * p.x + p.y * p.y)
    u = (1.0 - operation("arctangent2", p.x, p.y) / math.pi) * 0.5
    return Vector(select(radius, u, 0.0), select(radius, (p.z + 1.0) * 0.5, 0.0), 0.0)


def _box(inputs: NodeInputs, textures: Any, place: Vector) -> Color:
    """Three pictures along the axes of the object, blended where a normal lies between them."""
    n = nodes.values.normalize(nodes.inputs.normal_to_object(nodes.normal()))
    x, y, z = _box_weights(n, float(inputs.node.projection_blend))
    sides = (
        (x, Vector(select(n.x < 0.0, 1.0 - place.y, place.y), place.z, 0.0)),
        (y, Vector(select(n.y > 0.0, 1.0 - place.x, place.x), place.z, 0.0)),
        (z, Vector(select(n.z > 0.0, 1.0 - place.y, place.y), place.x, 0.0)),
    )
    looked_up = [(weight, _lookup(inputs, textures, where)) for weight, where in sides]

    def blended(channel: Callable[[Color], Value]) -> Value:
        first, second, third = (weight * channel(color) for weight, color in looked_up)
        return first + second + third

    return Color(*(blended(channel) for channel in CHANNELS))


def _box_weights(normal: Vector, blend: float) -> tuple[Value, Value, Value]:
    a = [abs(component) for component in normal]
    total = a[0] + a[1] + a[2]
    a = [component / total for component in a]
    limit = 0.5 * (1.0 + blend)

    def leads(i: int) -> Value:
        j, k = (other for other in range(3) if other != i)
        return (a[i] > limit * (a[i] + a[j])) * (a[i] > limit * (a[i] + a[k]))

    alone = [leads(i) for i in range(3)]
    if blend <= 0.0:
        none = 1.0 - (alone[0] + alone[1] + alone[2])
        return alone[0] + none, alone[1], alone[2]

    def between(i: int, j: int) -> Value:
        share = a[i] / (a[i] + a[j])
        return clamp((share - 0.5 * (1.0 - blend)) / blend)

    three = [((2.0 - limit) * component + (limit - 1.0)) / (2.0 * limit - 1.0) for component in a]
    xy, yz, xz = between(0, 1), between(1, 2), between(0, 2)
    cases: tuple[tuple[Value, tuple[Number, Number, Number]], ...] = (
        (a[2] < (1.0 - limit) * (a[1] + a[0]), (xy, 1.0 - xy, 0.0)),
        (a[0] < (1.0 - limit) * (a[1] + a[2]), (0.0, yz, 1.0 - yz)),
        (a[1] < (1.0 - limit) * (a[0] + a[2]), (xz, 0.0, 1.0 - xz)),
    )
    result: list[Any] = list(three)
    for condition, weights in reversed(cases):
        result = [select(condition, w, r) for w, r in zip(weights, result, strict=True)]
    for i in reversed(range(3)):
        single = [1.0 if k == i else 0.0 for k in range(3)]
        result = [select(alone[i], w, r) for w, r in zip(single, result, strict=True)]
    return result[0], result[1], result[2]
