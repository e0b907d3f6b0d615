# SPDX-License-Identifier: MIT
"""Textures of random points in the cells of a grid: those that are near, or the waves around them."""

from __future__ import annotations

import math
from typing import NamedTuple

from shlight._arrays import checked_flag, checked_name
from shlight.nodes.inputs import texture_coordinates, texture_place
from shlight.nodes.values import (
    Color,
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    maximum,
    number,
    operation,
    sqrt,
    steps,
    vector,
)

FEATURES = ("f1", "f2", "smooth_f1", "distance_to_edge", "n_sphere_radius")
METRICS = ("euclidean", "manhattan", "chebychev", "minkowski")


class Voronoi(NamedTuple):
    """The result of `voronoi`; its color, position and w are 0 for "distance_to_edge" and "n_sphere_radius"."""

    distance: Value
    color: Color
    position: Vector
    w: Value


def voronoi(
    place: Vector | None = None,
    w: Number = 0.0,
    *,
    dimensions: int = 3,
    scale: Number = 5.0,
    feature: str = "f1",
    metric: str = "euclidean",
    detail: Number = 0.0,
    roughness: Number = 0.5,
    lacunarity: Number = 2.0,
    smoothness: Number = 1.0,
    exponent: Number = 0.5,
    randomness: Number = 1.0,
    normalize: bool = False,
    definition: int = 5,
) -> Voronoi:
    """Cells around points (Worley 1996, A Cellular Texture Basis Function), as Blender's Voronoi Texture has them.

    place, w: where it is looked up: one dimension is w, two are x and y of the place, three are the place, four the
        place and w; None: `position()`. Times `scale`, each unit cell has a point.
    feature: "f1": the nearest point; "f2": the second nearest; "smooth_f1": a mean of near points, whose width is
        smoothness, 0 … 1; "distance_to_edge": how far the next edge between two cells is; "n_sphere_radius": half the
        distance from the nearest point to the one nearest to it.
    metric: of the first three, "euclidean", "manhattan", "chebychev", or "minkowski" of this exponent.
    detail, roughness, lacunarity: number of further octaves, 0 … 15, their amplitudes and their scales, each relative
        to the one before; not of "n_sphere_radius".
    randomness: 0: points are the corners of a grid; 1: anywhere in its cells.
    normalize: distances and colours are divided by the most that they can be.
    definition: as in Blender 3.4 (without octaves), or as of 4 or of 5.
    Raises ValueError naming the argument.
    """
    features = FEATURES.index(checked_name("feature", feature, FEATURES))
    metrics = METRICS.index(checked_name("metric", metric, METRICS))
    if definition not in (3, 4, 5):
        raise ValueError(f"definition must be 3, 4 or 5, got {definition!r}")
    size = number(scale, "scale")
    chosen = texture_coordinates(place, w, size, dimensions)
    settings = {
        "detail": detail,
        "roughness": roughness,
        "lacunarity": lacunarity,
        "smoothness": smoothness,
        "exponent": exponent,
        "randomness": randomness,
    }
    distance, r, g, b, *point = steps(
        f"voronoi{len(chosen)}",
        *chosen,
        *(number(value, name) for name, value in settings.items()),
        data=features + 5 * (metrics + 4 * (int(definition) - 3 + 3 * checked_flag("normalize", normalize))),
    )
    placed = [c / size for c in point]
    last = placed.pop() if dimensions in (1, 4) else number(0.0)
    x, y, z = [*placed, *[number(0.0)] * (3 - len(placed))]
    return Voronoi(distance, Color(r, g, b), Vector(x, y, z), last)


class Gabor(NamedTuple):
    """The result of `gabor`: the noise, 0 … 1 with mean 0.5; the phase of its wave, 0 … 1; and the wave's amplitude."""

    value: Value
    phase: Value
    intensity: Value


def gabor(
    place: Vector | None = None,
    *,
    dimensions: int = 2,
    scale: Number = 5.0,
    frequency: Number = 2.0,
    anisotropy: Number = 1.0,
    orientation: Varying = math.pi / 4.0,
) -> Gabor:
    """Waves in spots around random points (Lagae et al. 2009, Procedural Noise using Sparse Gabor Convolution).

    It is what Blender's Gabor Texture has, whose phase and intensity are those of Tricard et al. 2019, Procedural
    Phasor Noise, Eq. 8 and 9.

    place: where it is looked up; of two dimensions its x and y; None: `position()`.
    frequency: waves in a spot's radius, which is 1 / scale.
    anisotropy: 1: all waves run along the orientation; 0: along any direction.
    orientation: of two dimensions the angle to x, of three a vector, of any length.
    Raises ValueError naming the argument.
    """
    if dimensions not in (2, 3):
        raise ValueError(f"dimensions must be 2 or 3, got {dimensions!r}")
    where = texture_place(place) * number(scale, "scale")
    if dimensions == 2:
        angles = [number(orientation, "orientation")]
    else:
        x, y, z = vector(orientation, "orientation")
        angles = [operation("arctangent2", sqrt(x * x + y * y), z), operation("arctangent2", y, x)]
    cosine, sine = steps(
        f"gabor{dimensions}",
        *[*where][:dimensions],
        maximum(number(frequency, "frequency"), 0.001),
        1.0 - clamp(number(anisotropy, "anisotropy")),
        *angles,
    )
    # Six standard deviations of the sum of eight waves in each cell, for frequencies that are not small.
    largest = 6.0 * (1.0 if dimensions == 2 else 2.0**-0.25)
    phase = operation("arctangent2", sine, cosine) / (2.0 * math.pi) + 0.5
    return Gabor(sine / (2.0 * largest) + 0.5, phase, sqrt(cosine * cosine + sine * sine) / largest)
