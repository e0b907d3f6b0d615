# SPDX-License-Identifier: MIT
"""How many operations on floats a light takes, counted in the kernels' sources; a multiply-add counts as two.

docs/performance.md says which line of which kernel each term stands for. Angles and other set-up are the constants.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping


def basis(n: int) -> int:
    """4 a step of the recurrence, 2 a pair of products, 6 a power of the azimuth."""
    return 2 * n * (n - 1) + n * (n - 1) + 6 * (n - 1) + 15


def clipped_sphere(n: int) -> int:
    """Each degree of each band: 5 a step of the recurrence downwards, 3 for the turn by the azimuth and the sum of
    Eq. 5 or for two coefficients. A band: 13, its sectoral term; a degree: 21, its arcs and powers."""
    return 4 * n * (n - 1) + 13 * (n - 1) + 21 * n + 200


def whole_sphere(n: int) -> int:
    """Each degree of each band: 4 a step of N, 3 for the share and the turn."""
    return 7 * n * (n - 1) // 2 + 24 * (n - 1) + 7 * n + 150


def warped_sphere(n: int) -> int:
    """A quarter of the lights crosses the horizon, which at any height takes 11 a step downwards and 3 for the sum of
    Eq. 5; of the others each degree of each band takes 7. The lobe's terms are interpolated by 7 each."""
    crossed, whole = 7 * n * (n - 1) + 15 * (n - 1) + 21 * n, 7 * n * (n - 1) // 2 + 24 * (n - 1) + 7 * n
    return (crossed + 3 * whole) // 4 + 7 * n * (n + 1) // 2 + 400


def quad(n: int) -> int:
    """At each Gauss point 7 a term of Clenshaw's recurrence and 13 a degree; 3.5 arcs of about 2.5 + 3n/8 points, and
    half an arc of the horizon of 13 a degree."""
    points = 3.5 * (2.5 + 0.375 * n)
    return round(points * (7 * (n - 1) * (n - 2) / 2 + 13 * (n - 1)) + 6.5 * n + 600)


OPERATIONS: Mapping[str, Callable[[int], int]] = {
    "basis": basis,
    "clipped sphere": clipped_sphere,
    "clipped sphere, fused": clipped_sphere,
    "whole sphere": whole_sphere,
    "warped lobe": warped_sphere,
    "quad, fused": quad,
}
