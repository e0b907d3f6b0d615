# SPDX-License-Identifier: MIT
"""How many operations on floats a light takes, counted in the kernels' sources; a multiply-add counts as two.

docs/performance.md says which line of which kernel each term stands for. Angles and other set-up are the constants.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping


def basis(n: int) -> int:
    """4 a step of the recurrence, 2 a pair of products, 6 a power of the azimuth."""
    return 2 * n * (n - 1) + n * (n - 1) + 6 * (n - 1) + 15


OPERATIONS: Mapping[str, Callable[[int], int]] = {"basis": basis}
