# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes of textures: which picture is looked up, and where; patterns; and the colours of light."""

from __future__ import annotations

import math
from typing import Any

from shlight import nodes
from shlight.nodes import Color, Value, Vector
from shlight.nodes.values import Number, clamp, dot, equal, maximum, normalize, operation, select, sqrt

from ..compat import MISSING_PICTURE_IS_PIXEL
from ..names import name_of
from ..report import Effect
from .cell_nodes import CELL_NODES
from .ies_node import ies_texture
from .images import (
    TextureUse,
    associates_alpha,
    datablock_texture,
    file_texture,
    has_plain_file,
    is_known,
    missing_texture,
    needs_conversion,
)
from .mesh_attributes import GENERATED
from .nodes import Expression, NodeInputs, ReadNode
from .pattern_nodes import PATTERN_NODES
from .sky_nodes import sky_texture

INTERPOLATIONS = {"Closest": "closest", "Linear": "linear", "Cubic": "cubic", "Smart": "cubic"}
EXTENSIONS = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip", "MIRROR": "mirror"}
FIRST_TILE = 1001


def image_texture(inputs: NodeInputs) -> Color | Value:
    """An Image Texture node."""
    textures = _textures(inputs)
    is_even = textures is missing_texture(False) and not (
        MISSING_PICTURE_IS_PIXEL and _extension(inputs.node) == "clip"
    )
    place = nodes.values.vector((0.5, 0.5, 0.0)) if is_even else inputs.vector_or("Vector", nodes.uv(""))
    found = _projected(inputs, textures, place)
    return found.alpha if inputs.output.identifier == "Alpha" else found


def environment_texture(inputs: NodeInputs) -> Color:
    """An Environment Texture node, looked up by a direction or a place."""
    textures = _textures(inputs)
    direction = normalize(inputs.vector_or("Vector", nodes.position()))
    if inputs.node.projection == "MIRROR_BALL":
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


def _textures(inputs: NodeInputs) -> Any:
    """The texture of a node's image, or several by tile; one that is missing is reported."""
    node, image = inputs.node, inputs.node.image
    if image is None:
        return missing_texture(False)
    space = image.colorspace_settings.name
    if not is_known(space):
        inputs.remark(f"colour space {space} is unknown; taken for sRGB")
    use = TextureUse(INTERPOLATIONS[node.interpolation], _extension(node))
    if image.source == "TILED":
        found: Any = _tiles(image, use)
    elif image.source == "SEQUENCE":
        found = file_texture(image, image.filepath_from_user(image_user=node.image_user), use)
    else:
        found = file_texture(image, image.filepath, use) if has_plain_file(image) else None
        if image.source in ("MOVIE", "VIEWER"):
            inputs.remark(f"images of the kind {image.source} are not supported; the picture in memory is used")
        found = found or datablock_texture(image, use)
    if not found:
        black = MISSING_PICTURE_IS_PIXEL and needs_conversion(space)
        color = "black" if black else "magenta"
        inputs.remark(f"its picture '{image.filepath or name_of(image)}' is missing; {color} is used", Effect.THING)
        found = missing_texture(black)
    return found


def _extension(node: Any) -> str:
    return EXTENSIONS.get(getattr(node, "extension", "REPEAT"), "repeat")


def _tiles(image: Any, use: TextureUse) -> dict[tuple[int, int], Any]:
    found: dict[tuple[int, int], Any] = {}
    for tile in image.tiles:
        column, row = (tile.number - FIRST_TILE) % 10, (tile.number - FIRST_TILE) // 10
        path = image.filepath.replace("<UDIM>", str(tile.number)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")
        texture = file_texture(image, path, use)
        if texture is None and tile == image.tiles[0]:
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
        unassociate=alpha_is_used and (node.image is None or associates_alpha(node.image)),
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
    first, second, third = ([weight * c for c in (*color, color.alpha)] for weight, color in looked_up)
    return Color(*(a + b + c for a, b, c in zip(first, second, third, strict=True)))


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


def _checker(inputs: NodeInputs) -> Expression:
    place = inputs.vector_or("Vector", nodes.attribute(GENERATED))
    floors = [
        operation("modulo", abs(operation("floor", (c * inputs.number("Scale") + 1e-6) * 0.999999)), 2.0) for c in place
    ]
    same = equal(equal(floors[0], floors[1]), floors[2])
    if inputs.output.identifier == "Fac":
        return same
    first, second = inputs.color("Color1"), inputs.color("Color2")
    return Color(*(select(same, a, b) for a, b in zip(first, second, strict=True)))


def _gradient(inputs: NodeInputs) -> Expression:
    place = inputs.vector_or("Vector", nodes.attribute(GENERATED))
    x, y, _ = place
    kind = inputs.node.gradient_type
    if kind == "RADIAL":
        found = operation("arctangent2", y, x) / (2.0 * math.pi) + 0.5
    elif kind in ("SPHERICAL", "QUADRATIC_SPHERE"):
        found = maximum(0.999999 - nodes.values.length(place), 0.0)
        found = found * found if kind == "QUADRATIC_SPHERE" else found
    elif kind == "EASING":
        t = clamp(x)
        found = t * t * (3.0 - 2.0 * t)
    elif kind == "QUADRATIC":
        r = maximum(x, 0.0)
        found = r * r
    else:
        found = (x + y) * 0.5 if kind == "DIAGONAL" else x
    return clamp(found)


def _white_noise(inputs: NodeInputs) -> Expression:
    count = int(inputs.node.noise_dimensions[0])
    along = [inputs.number("W")] if count in (1, 4) else []
    place = inputs.vector("Vector") if count > 1 and inputs.is_linked("Vector") else nodes.position()
    key = ([*place][: min(count, 3)] if count > 1 else []) + along

    def noise(*more: float) -> Value:
        return operation(f"hash{len(key) + len(more)}", *key, *more)

    if inputs.output.identifier == "Value":
        return noise()
    if count < 4:
        return Color(noise(), noise(1.0), noise(2.0))
    x, y, z, w = key
    return Color(noise(), operation("hash4", z, x, w, y), operation("hash4", w, z, y, x))


TEXTURE_NODES: dict[str, ReadNode] = {
    "TEX_IMAGE": image_texture,
    "TEX_ENVIRONMENT": environment_texture,
    "TEX_SKY": sky_texture,
    "TEX_IES": ies_texture,
    "TEX_CHECKER": _checker,
    "TEX_GRADIENT": _gradient,
    "TEX_WHITE_NOISE": _white_noise,
    "BLACKBODY": lambda inputs: nodes.blackbody(inputs.number("Temperature")),
    "WAVELENGTH": lambda inputs: nodes.wavelength(inputs.number("Wavelength")),
    **CELL_NODES,
    **PATTERN_NODES,
}
