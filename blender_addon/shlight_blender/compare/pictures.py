# SPDX-License-Identifier: GPL-3.0-or-later
"""How pictures of a comparison are shown."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

PALETTE = "PuOr"  # diverging, told apart by the colour-blind too
# Its colours from one end to the other, even steps apart, as ColorBrewer has them.
PALETTE_COLORS = (
    "7f3b08", "b35806", "e08214", "fdb863", "fee0b6", "f7f7f7", "d8daeb", "b2abd2", "8073ac", "542788", "2d004b",
)  # fmt: skip


def difference_limit(difference: npt.NDArray[np.float64]) -> float:
    """End of the colour scale [%]: 1, 2 or 5 times a power of ten that only the outermost hundredth exceeds."""
    needed = max(100 * float(np.percentile(np.abs(difference), 99)), 0.1)
    power = 10.0 ** math.floor(math.log10(needed))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= needed * (1 - 1e-9))


def in_palette(values: npt.NDArray[np.floating[Any]]) -> npt.NDArray[np.float32]:
    """The palette's colours (…, 4), sRGB and opaque, of values (…) from -1 to 1."""
    colors = np.array([list(bytes.fromhex(color)) for color in PALETTE_COLORS]) / 255.0
    steps = np.linspace(-1.0, 1.0, len(colors))
    channels = [np.interp(values, steps, colors[:, channel]) for channel in range(3)]
    return np.stack([*channels, np.ones_like(channels[0])], axis=-1).astype(np.float32)
