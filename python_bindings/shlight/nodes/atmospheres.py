# SPDX-License-Identifier: MIT
"""Light that an atmosphere scatters towards a viewer: pictures of the sky, and the light of the sun through it.

Single scattering is that of Nishita et al. 1993: air and aerosols, whose densities fall exponentially with the height,
scatter sunlight once; they and ozone attenuate it, at 21 wavelengths. Multiple scattering is the model of García
Liñán (fgarlin.com, "A spectral sky", 2024): four wavelengths, and fits of what is scattered more than once. The
numbers of both, and the quadratures, are those of Cycles, so that the skies are the same.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight.nodes.spectra import TO_REC709, matching

Array = NDArray[np.float64]
Gather = Callable[[Array], Array]

WIDTH, HEIGHT = 512, 256  # of a sky's picture, in texels


@dataclass(frozen=True)
class Atmosphere:
    """How dense it is, as parts of the Earth's, and the viewer's height above the sea [m]."""

    altitude: float = 100.0
    air: float = 1.0
    aerosols: float = 1.0
    ozone: float = 1.0


def _latitudes(offset: float) -> Array:
    """Angles above the horizon of the upper rows of a picture, denser towards it; offset: of a row's place in it."""
    return 0.5 * math.pi * ((np.arange(HEIGHT // 2) + offset) / (HEIGHT // 2)) ** 2


def _by_rows(row: Any, latitudes: Array) -> Array:
    """The left halves of rows (n, WIDTH / 2, 3)."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return np.stack(list(pool.map(row, latitudes)))


# --- single scattering; lengths in metres

EARTH, TOP = 6360e3, 6420e3  # radii
AIR_SCALE, AEROSOL_SCALE = 8e3, 1.2e3  # heights in which densities fall by e
OZONE_HEIGHT, OZONE_REACH = 25e3, 15e3
STEPS = 32  # along a ray
WAVELENGTHS = np.arange(380.0, 781.0, 20.0)  # [nm]
# Scattering and absorption coefficients [1/m] of air (Rayleigh), aerosols and ozone at sea level.
AIR = 1131148.7658 * WAVELENGTHS**-4.0
AEROSOLS, AEROSOL_LOSS, ANISOTROPY = 2e-5, 1.11, 0.76
OZONE = 1e-11 * np.fromstring(
    "325.1268 585.3954 1977.191 7309.569 20084.56 40383.96 63551.34 96707.04 154797.4 209038.6 246128.1 273551.3 "
    "215125.9 159051.8 112356.2 73527.55 46450.13 33096.08 22512.61 14879.13 16828.62",
    sep=" ",
)
EXTINCTION = np.stack([AIR, np.full_like(AIR, AEROSOL_LOSS * AEROSOLS), OZONE])
SUN_TEMPERATURE, SUN_SHARE = 5777.998, 6.790175e-5  # of a black body, and of its radiance that is irradiance here


def _sunlight() -> Array:
    """Irradiance above the atmosphere [W m^-2 nm^-1] at the wavelengths: Planck's law."""
    metres = 1e-9 * WAVELENGTHS
    exponent = 1.438776877e-2 / (metres * SUN_TEMPERATURE)
    return SUN_SHARE * 1e-9 * 1.191042972e-16 / metres**5 / np.expm1(exponent)


@cache
def _to_xyz() -> Array:
    """(wavelengths, 3): sums over it are integrals of sunlit spectra times the matching functions."""
    return 20.0 * _sunlight()[:, None] * matching()[:, ::4].T


def _densities(height: Any) -> list[Any]:
    """The densities of air, aerosols and ozone at a height."""
    ozone = np.maximum(1.0 - np.abs(height - OZONE_HEIGHT) / OZONE_REACH, 0.0)
    return [np.exp(height / -AIR_SCALE), np.exp(height / -AEROSOL_SCALE), ozone]


def _depths(height: Any, cosine: Any) -> Array:
    """Integrals (3, …) of the densities along rays from a height to the atmosphere's top, by Gauss & Laguerre.

    cosine: of the angle between a ray and the zenith where it starts.
    """
    places, weights = np.polynomial.laguerre.laggauss(8)
    rise, excess = (EARTH + height) * cosine, height * (2.0 * EARTH + height)
    length = np.sqrt(rise * rise + (TOP * TOP - EARTH * EARTH) - excess) - rise
    found = np.zeros((3, *np.shape(length)))
    for place, weight in zip(places / 25.0, weights * np.exp(places) / 25.0, strict=True):
        s = place * length
        beyond = excess + (2.0 * rise + s) * s
        above = beyond / (EARTH + np.sqrt(np.maximum(EARTH * EARTH + beyond, 0.0)))
        found += weight * np.stack(_densities(np.maximum(above, -1e4)))
    return np.asarray(found * length)


def _scattered_once(latitude: float, elevation: float, around: Atmosphere) -> Array:
    """XYZ (WIDTH / 2, 3) of directions from opposite the sun to it."""
    longitude = 2.0 * math.pi / WIDTH * np.arange(WIDTH // 2) - math.pi
    amounts = np.array([around.air, around.aerosols, around.ozone])
    start = min(max(around.altitude, 1.0), 59999.0)
    rise, excess = (EARTH + start) * math.sin(latitude), start * (2.0 * EARTH + start)
    step = (math.sqrt(rise * rise + TOP * TOP - EARTH * EARTH - excess) - rise) / STEPS
    along = step * (np.arange(STEPS) + 0.5)
    beyond = excess + (2.0 * rise + along) * along
    height = beyond / (EARTH + np.sqrt(EARTH * EARTH + beyond))
    density = step * amounts * np.stack(_densities(height), axis=-1)

    cosine = math.sin(latitude) * math.sin(elevation) + math.cos(latitude) * math.cos(elevation) * np.cos(longitude)
    # Along the direction of the sun (longitudes, steps).
    sunwards = (EARTH + start) * math.sin(elevation) + cosine[:, None] * along
    depths = np.moveaxis(_depths(height, sunwards / (EARTH + height)), 0, -1) * amounts + np.cumsum(density, axis=0)
    left = np.exp(-(depths @ EXTINCTION).astype(np.float32))
    if elevation < 0.0:
        left[sunwards * sunwards >= beyond] = 0.0  # in the shadow of the Earth
    spectra = np.matmul(density[:, :2].T.astype(np.float32), left)
    square = cosine * cosine
    g = ANISOTROPY * ANISOTROPY
    by_air = 3.0 / (16.0 * math.pi) * (1.0 + square)
    by_aerosols = 3.0 * (1.0 - g) * (1.0 + square) / (8.0 * math.pi * (2.0 + g))
    by_aerosols /= (1.0 + g - 2.0 * ANISOTROPY * cosine) ** 1.5
    return np.asarray(
        by_air[:, None] * (spectra[:, 0] @ (AIR[:, None] * _to_xyz()))
        + by_aerosols[:, None] * (spectra[:, 1] @ (AEROSOLS * _to_xyz()))
    )


def _picture_of_one(elevation: float, around: Atmosphere, *, fades: bool) -> Array:
    """fades: below the horizon; otherwise the horizon goes on there."""
    stretch = 1.0 if fades else 1.0 + 1.0 / HEIGHT
    above = _by_rows(lambda latitude: _scattered_once(latitude, elevation, around), stretch * _latitudes(0.0))
    fade = np.maximum(1.0 - 2.5 * np.sin(_latitudes(1.0)[::-1]), 0.0) ** 3 if fades else np.ones(HEIGHT // 2)
    return np.concatenate([fade[:, None, None] * above[0], above])


def _sun_through_air(elevation: float, around: Atmosphere) -> Array:
    """XYZ of the sun's irradiance, of one below the horizon as on it; ozone is left out, as in Cycles."""
    start = min(max(around.altitude, 1.0), 59999.0)
    amounts = np.array([around.air, around.aerosols, 0.0])
    depths = amounts * _depths(start, math.sin(max(elevation, 0.0)))
    return np.asarray(np.exp(-depths @ EXTINCTION) @ _to_xyz())


# --- multiple scattering; lengths in kilometres, at 630, 560, 490 and 430 nm

RADIUS, THICKNESS = 6371.0, 100.0
GROUND_ALBEDO = 0.3
IRRADIANCE = np.array([1.679, 1.828, 1.986, 1.307])
MOLECULES = np.array([6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2])
OZONE_LOSS = 334.5 * 3.78547397e20 * np.array([3.472e-25, 3.914e-25, 1.349e-25, 1.103e-26])
URBAN = 1.3681e20  # density of aerosols
URBAN_LOSS = URBAN * np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23])
URBAN_SCATTERING = URBAN * np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22])
FORWARD = 0.8
SCATTERED_OFTEN = 0.02 * np.array([0.217, 0.347, 0.594, 1.0])
OFTEN_TO_XYZ = np.array(
    [
        [53.386917738564668, 22.981337506691025, 0.0],
        [43.904844466369358, 71.347795700053394, 0.102506867965741],
        [1.613727825160896, 18.422960591455485, 31.742921188390806],
        [20.762668673810577, 2.361421314352337, 110.480096432521404],
    ]
)
LONG_STEPS = 64
SUN_COSINES, LEVELS = 256, 64  # of the table of transmittances


def _coefficients(height: Any, around: Atmosphere) -> tuple[Array, Array, Array]:
    """At heights (…): scattering of molecules and of aerosols, and all that is lost (…, 4) [1/km]."""
    h = np.asarray(height)[..., None]
    logarithm = np.log(np.maximum(h, 1e-4))
    air = around.air * MOLECULES * np.exp(-0.07771971 * h**1.16364243)
    ozone = around.ozone * OZONE_LOSS * np.exp(-((logarithm - 3.22261) ** 2) * 5.55555555 - logarithm)
    share = around.aerosols * (np.exp(h / -0.73) + 2e6 / URBAN)
    scattered = share * URBAN_SCATTERING
    return air, scattered, air + scattered + ozone + share * URBAN_LOSS


def _transmittance(height: Any, cosine: Any, around: Atmosphere) -> Array:
    """The transmittance (…, 4) from heights to the top; inside the Earth the air is as dense as on the ground."""
    distance = RADIUS + np.asarray(height, dtype=np.float64)
    rise = distance * cosine
    length = np.sqrt(rise * rise + (RADIUS + THICKNESS) ** 2 - distance**2) - rise
    lost = np.zeros((*np.shape(length), 4))
    for place in (np.arange(LONG_STEPS) + 0.5) / LONG_STEPS:
        s = place * length
        below = np.sqrt(distance**2 + 2.0 * rise * s + s * s) - RADIUS
        lost += _coefficients(np.maximum(below, 0.0), around)[2]
    return np.exp(-lost * (length / LONG_STEPS)[..., None])


def _between(table: Any, place: Any) -> Any:
    """Entries of a table's last axis but one at places 0 … 1 (rows, n), a row of places for each row of the table."""
    steps = table.shape[-2] - 1
    x = np.clip(place, 0.0, 1.0) * np.float32(steps)
    low = np.minimum(x.astype(np.intp), steps - 1)
    rows = np.arange(len(table))[:, None]
    first = table[rows, low]
    return first + (table[rows, low + 1] - first) * (x - low).astype(np.float32)[..., None]


class _OftenScattered:
    """A sky of one sun and atmosphere."""

    def __init__(self, elevation: float, around: Atmosphere) -> None:
        self._around = around
        self._elevation = elevation
        self._start = min(max(around.altitude, 1.0), 99999.0) / 1000.0
        levels, cosines = np.linspace(0.0, THICKNESS, LEVELS), np.linspace(-1.0, 1.0, SUN_COSINES)
        self._table = _transmittance(levels[:, None], cosines, around).astype(np.float32)

    def row(self, latitude: float) -> Array:
        """XYZ (WIDTH / 2, 3) of directions from opposite the sun to it."""
        azimuth = 2.0 * math.pi * (np.arange(WIDTH // 2) + 0.5) / WIDTH
        distance, rise = RADIUS + self._start, (RADIUS + self._start) * math.sin(latitude)
        under = rise * rise - distance**2 + RADIUS**2
        down = rise < 0.0 and under >= 0.0
        reach = RADIUS if down else RADIUS + THICKNESS
        root = math.sqrt(rise * rise - distance**2 + reach**2)
        step = ((-root if down else root) - rise) / LONG_STEPS
        along = step * (np.arange(LONG_STEPS) + 0.5)
        radius = np.sqrt(distance**2 + 2.0 * rise * along + along * along)
        height = np.maximum(radius - RADIUS, 0.0)

        to_sun = math.sin(latitude) * math.sin(self._elevation)
        to_sun = to_sun - math.cos(latitude) * math.cos(self._elevation) * np.cos(azimuth)
        # (steps, azimuths): the cosine at each place between the zenith and the sun.
        cosine = (distance * math.sin(self._elevation) + along[:, None] * to_sun) / radius[:, None]
        air, aerosols, lost = _coefficients(height, self._around)
        passed = np.exp(-step * lost)
        before = np.cumprod(np.concatenate([np.ones((1, 4)), passed[:-1]]), axis=0)
        weights = before * (1.0 - passed) / np.maximum(lost, 1e-7)
        forward = FORWARD * FORWARD
        by_air = 3.0 / (16.0 * math.pi) * (1.0 + to_sun**2)
        by_aerosols = (1.0 - forward) / (4.0 * math.pi * (1.0 + forward - 2.0 * FORWARD * to_sun) ** 1.5)
        once, often = self._arriving(height, radius, cosine.astype(np.float32), weights)
        found = by_air[:, None] * once(air) + by_aerosols[:, None] * once(aerosols) + often(air + aerosols)
        return np.asarray((found * IRRADIANCE) @ OFTEN_TO_XYZ)

    def _arriving(self, height: Array, radius: Array, cosine: Any, weights: Array) -> tuple[Gather, Gather]:
        """Functions that sum up what scatters sunlight, (steps, 4), along the ray to (azimuths, 4): of what arrives
        straight, and of what has been scattered or reflected already."""
        level = np.broadcast_to(height / THICKNESS, (SUN_COSINES, len(height)))
        tables = np.swapaxes(_between(np.swapaxes(self._table, 0, 1), level), 0, 1)
        place = np.float32(0.5) * cosine + np.float32(0.5)
        sunlight = _between(tables, place)
        on_ground = _between(np.broadcast_to(self._table[0], tables.shape), place) * cosine[..., None]
        solid_angle = 2.0 * math.pi * (1.0 - np.sqrt(1.0 - np.minimum(RADIUS / radius, 1.0) ** 2))
        up = (GROUND_ALBEDO / (4.0 * math.pi**2)) * solid_angle[:, None] * self._table[0, -1] / tables[:, -1]
        above = (1.0 / (1.0 + 5.0 * np.exp(-17.92 * cosine))).T

        def summed(light: Any, scattering: Array) -> Array:
            return np.asarray(np.einsum("snw,sw->nw", light, (weights * scattering).astype(np.float32)))

        def often(scattering: Array) -> Array:
            return np.asarray(above @ (weights * scattering * SCATTERED_OFTEN) + summed(on_ground, up * scattering))

        return partial(summed, sunlight), often


def _picture_of_many(elevation: float, around: Atmosphere) -> Array:
    above = _latitudes(0.5)
    return _by_rows(_OftenScattered(elevation, around).row, np.concatenate([-above[::-1], above]))


def _sun_through_all(elevation: float, around: Atmosphere) -> Array:
    height = min(max(around.altitude, 1.0), 99999.0) / 1000.0
    return np.asarray((IRRADIANCE * _transmittance(height, math.sin(elevation), around)) @ OFTEN_TO_XYZ)


# --- both

MODELS = ("nishita", "single", "multiple")


def _to_rgb(xyz: Array) -> Array:
    return np.asarray(xyz @ np.array(TO_REC709).T)


@lru_cache(maxsize=8)
def picture(model: str, elevation: float, around: Atmosphere) -> NDArray[np.float32]:
    """Radiance (HEIGHT, WIDTH, 3), linear Rec. 709, which may lie outside the gamut; row 0 shows the zenith.

    The sun is in the middle; the angle to the horizon of a place in the picture is the square of its height.
    model: one of MODELS; "nishita" is single scattering as Blender has it before 5.0.
    """
    if model == "multiple":
        half = _picture_of_many(elevation, around)
    else:
        half = _picture_of_one(elevation, around, fades=model != "nishita")
    found = _to_rgb(np.concatenate([half, half[:, ::-1]], axis=1)).astype(np.float32)[::-1]
    found.flags.writeable = False
    return found


def sunlight(model: str, elevation: float, around: Atmosphere) -> Array:
    """Irradiance of the sun at an angle above the horizon, at right angles to it: linear Rec. 709 (3,)."""
    return _to_rgb(_sun_through_all(elevation, around) if model == "multiple" else _sun_through_air(elevation, around))


def dip(altitude: float) -> float:
    """The angle of the Earth's edge below the horizontal plane."""
    return math.acos(min(RADIUS / (RADIUS + altitude / 1000.0), 1.0))
