# SPDX-License-Identifier: MIT
"""Normals that pictures and heights bend."""

from __future__ import annotations

from shlight.nodes.inputs import (
    attribute,
    backfacing,
    mesh_normal,
    normal,
    normal_to_world,
    position,
)
from shlight.nodes.mathematics import sign
from shlight.nodes.rays import on_ray, unfiltered
from shlight.nodes.values import (
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    cross,
    dot,
    equal,
    length,
    maximum,
    normalize,
    number,
    operation,
    select,
    vector,
)


def choose(condition: Number, if_true: Vector, if_false: Vector) -> Vector:
    """One of two vectors, by whether a number is 0."""
    return Vector(*(select(condition, a, b) for a, b in zip(if_true, if_false, strict=True)))


def normal_map(
    color: Varying,
    strength: Number = 1.0,
    *,
    space: str = "tangent",
    tangents: str = "tangents",
    unit_normal: bool = False,
) -> Vector:
    """The normal that a picture holds as (n + 1) / 2.

    Light is not linear in normals: a lobe at their mean is not the mean of their lobes. So pictures in the colour are
    not filtered; each camera ray sees them at one point.

    space: "tangent", "object" or "world". The tangent space is that of the mesh's normal as it is interpolated, as in
        Cycles: where Shader.with_normal bends normals, this one stays.
    tangents: the mesh attribute of the tangent space: per corner the tangent and the bitangent's sign.
    unit_normal: the normal of the tangent space has length 1, as in Cycles since 5.1. Otherwise it is as long as what
        is interpolated between the normals of corners, which is shorter where these differ, as in Cycles before.
    """
    n = Vector(*on_ray(vector(color), None, filtered=False)) * 2.0 - 1.0
    s = number(strength)
    flip = 1.0 - 2.0 * backfacing()
    if space == "tangent":
        known = attribute(tangents)
        along = Vector(known.x, known.y, known.z)
        up = (normalize(mesh_normal()) if unit_normal else mesh_normal()) * flip
        across = cross(up, along) * known.alpha
        height = 1.0 + clamp(s) * (n.z - 1.0)
        bent = along * (n.x * s) + across * (n.y * s) + up * height
        bent = normalize(normal_to_world(bent)) * flip
        missing = equal(dot(along, along), 0.0)
        bent = choose(missing, normal(), bent)
    else:
        bent = normalize(normal_to_world(n) if space == "object" else n) * flip
        bent = normalize(normal() + (bent - normal()) * maximum(s, 0.0)) if s.constant != 1.0 else bent
    return choose(equal(length(bent), 0.0), normal(), bent)


def near(place: Vector, side: str, width: float) -> Vector:
    """How far the surface goes within `width` pixels, to the side "near_x" or "near_y" of the hit."""
    return Vector(*(operation(side, component, data=width) for component in place))


def bump(
    height: Number,
    strength: Number = 1.0,
    distance: Number = 1.0,
    *,
    at: Vector | None = None,
    place: Vector | None = None,
    invert: bool = False,
    filter_width: float = 0.1,
) -> Vector:
    """The normal of a surface that is raised by height times distance [m]; strength mixes it with the one before.

    at, place: the normal before, and where the hit is, in the frame of the normal that is returned; None: the smooth
        normal and the position in the world.
    filter_width: the distance over which heights are compared, in pixels; of a material's bumps the greatest counts.
    """
    width = number(filter_width, "filter_width", 1e-3, 1e3).constant
    if width is None:
        raise ValueError("filter_width must be a number, got an expression")
    h = unfiltered(number(height))
    rises = (operation("near_x", h, data=width), operation("near_y", h, data=width))
    scale = -number(distance) if invert else number(distance)
    before, here = normal() if at is None else at, position() if place is None else place
    return raised(rises, scale, before, here, width, maximum(strength, 0.0))


def raised(
    rises: tuple[Value, Value], scale: Value, before: Vector, place: Vector, width: float, s: Number = 1.0
) -> Vector:
    """The normal of a surface that rises by this, times a scale, within `width` pixels in x and in y of the picture.

    before, place: see bump(); s: how much of it is mixed with the normal before.
    """
    dx, dy = near(place, "near_x", width), near(place, "near_y", width)
    rx, ry = cross(dy, before), cross(before, dx)
    determinant = dot(dx, rx)
    slope = rx * rises[0] + ry * rises[1]
    whole = normalize(before * abs(determinant) - slope * (scale * sign(determinant)))
    flat = equal(length(whole), 0.0)
    return choose(flat, before, normalize(whole * s + before * (1.0 - s)))
