# SPDX-License-Identifier: MIT
"""Light as the eye measures it: lux and candela from watts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from shlight._arrays import check_rows, checked_array, given_type
from shlight._core import LUMINANCE

__all__ = ["LUMENS_PER_WATT", "LUMINANCE", "luminous"]

LUMENS_PER_WATT = 683.0


def luminous(irradiance: ArrayLike) -> Any:
    """Photometric values of light in linear Rec. 709 RGB: 683 lm/W times its luminance.

    irradiance: a number, which counts as grey, or (..., 3). Irradiance [W/m²] becomes illuminance [lx], radiance
    [W/m²/sr] luminance [cd/m²], and radiant intensity [W/sr] luminous intensity [cd].
    The luminance is 0.2126729 R + 0.7151522 G + 0.0721750 B, which ITU-R BT.709-6, 3.3, rounds to four digits, so that
    white light of (1, 1, 1) W/m² has 683 lx: RGB says how strongly light stimulates the eye, not which spectrum it has.
    Blender's glTF exporter counts alike.

    Returns () or (...): float32 of float32, else float64. ValueError naming the row of what is not finite.

    >>> float(shlight.luminous(1.0))
    683.0
    >>> shlight.luminous([[1, 1, 1], [0, 0.5, 0]]).round(2)
    array([683.  , 244.22])
    """
    dtype = given_type(irradiance)
    light = checked_array("irradiance", irradiance, dtype)
    if light.ndim > 0 and light.shape[-1] != 3:
        raise ValueError(f"irradiance must be a number or have shape (..., 3), got {light.shape}")
    with np.errstate(all="ignore"):
        values = LUMENS_PER_WATT * (light @ np.asarray(LUMINANCE, dtype) if light.ndim else light)
    check_rows("irradiance", np.isfinite(values), "must be finite, and so must 683 times it")
    return np.asarray(values, dtype)[()]
