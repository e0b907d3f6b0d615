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
    """Each degree of each band: 7 a step of N downwards with its two sums, 10.5 one of Q upwards with the integral, 5
    for the share of N and the turn by the azimuth, or for the two sums of Eq. 5. A band: 27; a degree: 19, its arcs and
    powers."""
    return 45 * n * (n - 1) // 4 + 27 * (n - 1) + 19 * n + 200


def whole_sphere(n: int) -> int:
    """Each degree of each band: 4 a step of N, 3 for the share and the turn."""
    return 7 * n * (n - 1) // 2 + 24 * (n - 1) + 7 * n + 150


OPERATIONS: Mapping[str, Callable[[int], int]] = {
    "basis": basis,
    "clipped sphere": clipped_sphere,
    "clipped sphere, fused": clipped_sphere,
    "whole sphere": whole_sphere,
}
