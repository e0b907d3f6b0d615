# SPDX-License-Identifier: GPL-3.0-or-later
"""How pictures of a comparison are shown."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

PALETTE = "PuOr"  # diverging, told apart by the colour-blind too
WHITE_AT = 0.8  # linear value to which the brightest parts are brought


def common_exposure(reference: npt.NDArray[np.float32]) -> float:
    """Stops by which all pictures are brightened: few of the reference's pixels are then brighter than WHITE_AT."""
    bright = float(np.percentile(reference[..., :3].max(axis=-1), 95))
    return math.log2(WHITE_AT / bright) if bright > 0 else 0.0
