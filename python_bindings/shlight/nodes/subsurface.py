# SPDX-License-Identifier: MIT
"""Light that enters a body, is scattered there, and comes out of its surface elsewhere."""

from __future__ import annotations

import math
from typing import Literal, get_args

from shlight._arrays import checked_name
from shlight.nodes.microfacets import reflecting_normal
from shlight.nodes.shader import DIFFUSE, DISK, REFRACTED, SKIN, Lobe, Shader, Subsurface, lambert
from shlight.nodes.values import (
    Color,
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    color,
    maximum,
    number,
    operation,
    reflectance,
    select,
    sqrt,
    vector,
)

SubsurfaceMethod = Literal["burley", "random_walk", "random_walk_skin", "random_walk_van_de_hulst"]

# Wrenninge, Villemin & Hery 2017, "Path Traced Subsurface Scattering using Anisotropic Phase Functions and
# Non-Exponential Free Flights": what a half space reflects gives its albedo of single scattering,
# (1 - A¼) a atan(b A)^c + A¼ d atan(e A)^f. The numbers are polynomials in the mean cosine, of rising degree; b and e
# are a constant and a factor of exp of one.
A = (1.8260523782, -1.28451056436, -1.79904629312, 9.19393289202, -22.8215585862, 32.0234874259, -23.6264803333,
     7.21067002658)  # fmt: skip
B = (4.98511194385, 0.127355959438)
B_EXPONENT = (0.0, 31.1491581433, -201.847017512, 841.576016723, -2018.09288505, 2731.71560286, -1935.41424244,
              559.009054474)  # fmt: skip
C = (1.09686102424, -0.394704063468, 1.05258115941, -8.83963712726, 28.8643230661, -46.8802913581, 38.5402837518,
     -12.7181042538)  # fmt: skip
D = (0.496310210422, 0.360146581622, -2.15139309747, 17.8896899217, -55.2984010333, 82.065982243, -58.5106008578,
     15.8478295021)  # fmt: skip
E = (4.23190299701, 0.00310603949088)
E_EXPONENT = (0.0, 76.7316253952, -594.356773233, 2448.8834203, -5576.68528998, 7116.60171912, -4763.54467887,
              1303.5318055)  # fmt: skip
F = (2.40602999408, -2.51814844609, 9.18494908356, -79.2191708682, 259.082868209, -403.613804597, 302.85712436,
     -87.4370473567)  # fmt: skip
# Radii below which Cycles draws diffuse reflection [m].
LEAST_RADIUS = 1e-8
# The least albedo of single scattering; a darker body's light is dimmed in its place, as in Cycles.
LEAST_ALBEDO = 0.2
HALVINGS = 12  # of the interval in which Cycles looks for the dipole's albedo


def subsurface(
    albedo: Varying,
    radius: Varying,
    *,
    method: SubsurfaceMethod = "random_walk",
    roughness: Number = 1.0,
    ior: Number = 1.4,
    anisotropy: Number = 0.0,
    diffuse_entry: bool = False,
    at: Vector | None = None,
) -> Shader:
    """A body in which light is scattered: Blender's Subsurface Scattering.

    albedo: what a thick body of it reflects, 0 … 1, clamped. radius: [m], of each channel, how far light gets, as the
    method takes it: "burley" has the diffusion profile of Christensen & Burley 2015, the others walk at random through
    the body, which the mesh bounds; of "random_walk_van_de_hulst", Blender 5.2's Random Walk, it is the mean free path.
    roughness, ior: of the surface that bends what enters, alpha = roughness²; index 1.01 … 3.8, clamped; anisotropy:
    the mean cosine of a scattered direction, -0.99 … 0.9, or up to 0.99 with "random_walk_van_de_hulst", clamped;
    diffuse_entry: rays enter like diffuse light, as before Blender 4. Raises ValueError naming an argument.
    """
    method = checked_method("method", method)
    rho = reflectance(albedo, "albedo")
    known = Color(*(clamp(c) for c in rho))
    far = color(radius, "radius")
    n = None if at is None else reflecting_normal(vector(at, "at"))
    width = clamp(number(roughness, "roughness"))
    index = clamp(number(ior, "ior"), 1.01, 3.8)
    is_free = method == "random_walk_van_de_hulst"
    g = clamp(number(anisotropy, "anisotropy"), -0.99, 0.99 if is_free else 0.9)
    if far.constant is not None and max(far.constant) < LEAST_RADIUS:
        return lambert(rho, n)
    if method == "random_walk_skin":
        scaled = [r * sqrt(3.0 * (1.0 - _dipole_albedo(a, index))) for r, a in zip(far, known, strict=True)]
    elif is_free:
        scaled = list(far)
    else:
        scaled = [r * (0.25 / math.pi) for r in far]
    if method == "burley":
        scaled = [d / (1.9 - a + 3.5 * (a - 0.8) * (a - 0.8)) for d, a in zip(scaled, known, strict=True)]
        numbers: list[Value] = [1.0 / d for d in scaled] + [number(0.0)] * 3 + [number(1.0)] * 3
        entry = DISK
    else:
        similar = number(1.0) if is_free else g < 0.0  # Wrenninge's polynomials are of g from 0 on
        single = [select(similar, _similar_albedo(a, g), _single_albedo(a, maximum(g, 0.0))) for a in known]
        numbers = [1.0 / (d * select(similar, 1.0, 1.0 - g)) for d in scaled]
        numbers += [maximum(a, LEAST_ALBEDO) for a in single]
        numbers += [select(a < LEAST_ALBEDO, a / LEAST_ALBEDO, 1.0) / r for a, r in zip(single, known, strict=True)]
        entry = DIFFUSE if diffuse_entry else SKIN if method == "random_walk_skin" else REFRACTED
    numbers[:3] = [select(r < LEAST_RADIUS, 0.0, own) for r, own in zip(far, numbers, strict=False)]
    below = Subsurface((*numbers, width * width, index, g), entry)
    return Shader((Lobe("lambert", rho, normal=n, below=below),))


def checked_method(name: str, method: SubsurfaceMethod) -> SubsurfaceMethod:
    """The method. Raises ValueError naming the argument if there is none of this name."""
    checked_name(name, method, get_args(SubsurfaceMethod))
    return method


def _polynomial(coefficients: tuple[float, ...], x: Value) -> Value:
    result = number(0.0)
    for coefficient in reversed(coefficients):
        result = result * x + coefficient
    return result


def _single_albedo(reflected: Value, g: Value) -> Value:
    """The albedo of single scattering of a half space that reflects a share of light."""

    def angle(numbers: tuple[float, float], exponent: tuple[float, ...]) -> Value:
        steep = numbers[0] + numbers[1] * operation("exp", _polynomial(exponent, g))
        return operation("arctangent", steep * reflected)

    blend = reflected**0.25
    low = (1.0 - blend) * _polynomial(A, g) * angle(B, B_EXPONENT) ** _polynomial(C, g)
    high = blend * _polynomial(D, g) * angle(E, E_EXPONENT) ** _polynomial(F, g)
    return clamp(low + high, 0.0, 0.999999)


def _similar_albedo(reflected: Value, g: Value) -> Value:
    """The same by Van de Hulst's relation of similarity (d'Eon, A Hitchhiker's Guide to Multiple Scattering, 53.7)."""
    root = sqrt(9.59217 + reflected * (41.6808 + 17.7126 * reflected))
    s = 4.20863 * reflected + 4.09712 - root
    return clamp((1.0 - s * s) / (1.0 - g * s * s), 0.0, 0.999999)


def _dipole_albedo(reflected: Value, index: Value) -> Value:
    """The albedo α' at which a dipole reflects a share of light (Jensen et al. 2001), found by halving 0 … 1."""
    inverse = 1.0 / index
    internal = inverse * (0.71 - 1.44 * inverse) + 0.668 + 0.0636 * index
    far = 4.0 / 3.0 * (1.0 + internal) / (1.0 - internal)
    low, high, middle = number(0.0), number(1.0), number(0.5)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        s = sqrt(3.0 * (1.0 - middle))
        own = 0.5 * middle * (1.0 + operation("exp", -(far * s))) * operation("exp", -s)
        low, high = select(own < reflected, middle, low), select(own < reflected, high, middle)
    return select(reflected < 1e-4, 0.0, select(reflected < 0.995, middle, 0.999999))
