# SPDX-License-Identifier: MIT
"""Colours of light: of black bodies, and of one wavelength."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from shlight.nodes.program import Table
from shlight.nodes.values import Color, Number, Value, clamp, maximum, number, operation, select

COOLEST, HOTTEST = 800.0, 12000.0  # [K], outside of which Cycles' colour is constant
# Linear Rec. 709 of luminance 1 as polynomials in ln(T / 3000 K): Planck's law over the CIE 1931 colour matching
# functions, within 1e-4 of the brightest channel. What Cycles has fitted to it differs by at most 0.2 %.
BLACKBODY = (
    (1.770077, 0.844492, 0.271730),
    (-1.465398, 0.354444, 0.805948),
    (0.852723, -0.294940, 0.409782),
    (-0.237564, 0.087909, -0.171040),
    (-0.006027, 0.013412, -0.115139),
    (0.043979, -0.017442, 0.043237),
    (-0.022332, 0.005084, 0.015429),
    (0.003773, -0.000491, -0.006254),
)


def blackbody(temperature: Number) -> Color:
    """Linear Rec. 709 colour of a black body at a temperature [K]; what lies outside the gamut is clipped at 0.

    Raises ValueError naming the argument.
    """
    x = operation("log", clamp(number(temperature, "temperature"), COOLEST, HOTTEST) / 3000.0)

    def polynomial(channel: int) -> Value:
        found = number(BLACKBODY[-1][channel])
        for row in BLACKBODY[-2::-1]:
            found = found * x + row[channel]
        return maximum(found, 0.0)

    return Color(*(polynomial(channel) for channel in range(3)))


# The CIE 1931 colour matching functions from 380 to 780 nm in steps of 5 nm, times 10000.
MATCHING = (
    "14 22 42 76 143 232 435 776 1344 2148 2839 3285 3483 3481 3362 3187 2908 2511 1954 1421 956 580 320 147 49 "
    "24 93 291 633 1096 1655 2257 2904 3597 4334 5121 5945 6784 7621 8425 9163 9786 10263 10567 10622 10456 10026 "
    "9384 8544 7514 6424 5419 4479 3608 2835 2187 1649 1212 874 636 468 329 227 158 114 81 58 41 29 20 14 10 7 5 "
    "3 2 2 1 1 1 0",
    "0 1 1 2 4 6 12 22 40 73 116 168 230 298 380 480 600 739 910 1126 1390 1693 2080 2586 3230 4073 5030 6082 "
    "7100 7932 8620 9149 9540 9803 9950 10000 9950 9786 9520 9154 8700 8163 7570 6949 6310 5668 5030 4412 3810 "
    "3210 2650 2170 1750 1382 1070 816 610 446 320 232 170 119 82 57 41 29 21 15 10 7 5 4 2 2 1 1 1 0 0 0 0",
    "65 105 201 362 679 1102 2074 3713 6456 10391 13856 16230 17471 17826 17721 17441 16692 15281 12876 10419 "
    "8130 6162 4652 3533 2720 2123 1582 1117 782 573 422 298 203 134 87 57 39 27 21 18 17 14 11 10 8 6 3 2 2 1 0 "
    "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0",
)
SHORTEST, LONGEST, STEP = 380.0, 780.0, 5.0  # [nm]
TO_REC709 = (
    (3.2404542, -1.5371385, -0.4985314),
    (-0.9692660, 1.8760108, 0.0415560),
    (0.0556434, -0.2040259, 1.0572252),
)
BRIGHTEST = 2.52  # to which Cycles scales a channel 1


def matching() -> NDArray[np.float64]:
    """The matching functions (3, 81)."""
    return np.array([np.fromstring(row, sep=" ") for row in MATCHING]) / 1e4


def wavelength(nanometres: Number) -> Color:
    """Linear Rec. 709 colour of light of one wavelength [nm], as Blender's Wavelength node has it; black from 780 on.

    Raises ValueError naming the argument.
    """
    length = number(nanometres, "nanometres")
    rgb = np.array(TO_REC709) @ matching() / BRIGHTEST
    # Cycles goes on along the first interval for another step.
    table = np.concatenate([2.0 * rgb[:, :1] - rgb[:, 1:2], rgb], axis=1)
    place = (length - (SHORTEST - STEP)) / (LONGEST - SHORTEST + STEP)
    seen = (length > SHORTEST - STEP) * (length < LONGEST)
    channels = (maximum(operation("table1", place, data=Table(own)), 0.0) for own in table)
    return Color(*(select(seen, channel, 0.0) for channel in channels))
