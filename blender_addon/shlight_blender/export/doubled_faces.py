# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie on others: shadow rays of Cycles leave out only the face on which they start, and meet the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Triangles of a scene up to which doubled ones are looked for, in some 0.3 s.
MOST_TRIANGLES = 1_000_000
# Distance at which centres of triangles count as the same ÷ the scene's largest coordinate.
SAME = 1e-6
# Odd numbers that make one of three coordinates; a chance hit among a million triangles has a probability of 3e-8.
MIXED = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)


def doubled(centers: Sequence[NDArray[Any]]) -> list[bool]:
    """For each (n, 3) array of triangles' centres in the world: whether any is that of another triangle, too."""
    counts = [len(own) for own in centers]
    if sum(counts) == 0:
        return [False] * len(counts)
    places = np.concatenate(centers)
    grid = np.rint(places / max(float(np.abs(places).max()) * SAME, np.finfo(np.float64).tiny))
    keys = (grid.astype(np.int64).astype(np.uint64) * MIXED).sum(axis=1)
    _, number, often = np.unique(keys, return_inverse=True, return_counts=True)
    ends = np.cumsum(counts)
    return [bool((often[number[end - n : end]] > 1).any()) for n, end in zip(counts, ends, strict=True)]
