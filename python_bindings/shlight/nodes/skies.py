# SPDX-License-Identifier: MIT
"""Skies: the radiance of what lies in a direction, z up."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import _core
from shlight._arrays import checked_name
from shlight.nodes.atmospheres import MODELS, Atmosphere, dip, picture, sunlight
from shlight.nodes.spectra import TO_REC709
from shlight.nodes.textures import image, texture_pixels
from shlight.nodes.values import Color, Value, Vector, clamp, dot, maximum, minimum, number, operation, select, sqrt

Array = NDArray[np.float64]

LIMB = 0.6  # the part of the light of the sun's middle that its edge lacks
HORIZON = math.sin(0.001)  # below which the analytic models are constant


def _on_sphere(towards: Vector) -> Vector:
    """The direction with the same z, which is 1 at most, and azimuth."""
    z = clamp(towards.z, -1.0, 1.0)
    flat = sqrt(towards.x * towards.x + towards.y * towards.y)
    factor = select(flat, sqrt(1.0 - z * z) / flat, 0.0)
    return Vector(factor * towards.x, factor * towards.y, z)


def _rgb(x: Value, y: Value, z: Value) -> Color:
    """XYZ as linear Rec. 709 within the gamut."""
    return Color(*(maximum(a * x + b * y + c * z, 0.0) for a, b, c in TO_REC709))


# Coefficients a … e of Perez' function for Y, x and y, and of the zenith's x and y: Preetham et al. 1999, appendix A.2.
PEREZ = (
    ((0.1787, -1.4630), (-0.3554, 0.4275), (-0.0227, 5.3251), (0.1206, -2.5771), (-0.0670, 0.3703)),
    ((-0.0193, -0.2592), (-0.0665, 0.0008), (-0.0004, 0.2125), (-0.0641, -0.8989), (-0.0033, 0.0452)),
    ((-0.0167, -0.2608), (-0.0950, 0.0092), (-0.0079, 0.2102), (-0.0441, -1.6537), (-0.0109, 0.0529)),
)
ZENITH = (
    ((0.00166, -0.00375, 0.00209, 0.0), (-0.02903, 0.06377, -0.03202, 0.00394), (0.11693, -0.21196, 0.06052, 0.25886)),
    ((0.00275, -0.00610, 0.00317, 0.0), (-0.04214, 0.08970, -0.04153, 0.00516), (0.15346, -0.26756, 0.06670, 0.26688)),
)
PREETHAM_SCALE = 0.06  # of the luminance [kcd/m²], as in Cycles


def preetham(towards: Vector, sun: Any, turbidity: float) -> Color:
    """The clear sky of Preetham, Shirley & Smits 1999, as Blender scales it; constant below the horizon.

    towards: the direction that is looked in. sun: (3,), the direction that the sun is seen in, of any length > 0.
    turbidity: how hazy it is, 1.7 … 10.
    Raises ValueError naming the argument.
    """
    unit = _unit("sun", sun)
    number(turbidity, "turbidity", 1.0, 20.0)
    at, height = math.acos(float(np.clip(unit[2], -1.0, 1.0))), _on_sphere(towards)
    cosine, gamma = _beside(height, unit)

    def perez(number: int) -> Value:
        a, b, c, d, e = (slope * turbidity + offset for slope, offset in PEREZ[number])
        above = 1.0 + a * operation("exp", b / maximum(height.z, HORIZON))
        own = (1.0 + a * math.exp(b)) * (1.0 + c * math.exp(d * at) + e * math.cos(at) ** 2)
        return above * (1.0 + c * operation("exp", d * gamma) + e * cosine * cosine) * (1.0 / own)

    chi = (4.0 / 9.0 - turbidity / 120.0) * (math.pi - 2.0 * at)
    luminance = (4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192
    zenith = [float(np.polyval([np.polyval(row, at) for row in rows], turbidity)) for rows in ZENITH]
    y = PREETHAM_SCALE * luminance * perez(0)
    first, second = zenith[0] * perez(1), zenith[1] * perez(2)
    return _rgb(first / second * y, y, (1.0 - first - second) / second * y)


# shlight_tools.hosek_wilkie measures it, and tells what the numbers are.
KEPT_HOSEK = Path(__file__).with_name("hosek_wilkie.npz")
HOSEK_DEGREE = 5


@lru_cache(maxsize=1)
def _hosek_points() -> Array:
    with np.load(KEPT_HOSEK) as kept:
        return np.asarray(kept["points"], dtype=np.float64)


def hosek_numbers(points: Array, elevation: float, turbidity: float, ground_albedo: float) -> Array:
    """The ten numbers of X, Y and Z (3, 10) between points of Bézier curves (3, turbidities 1 … 10, albedos 0 and 1,
    10, 6): A … I as in the paper, and the mean radiance. elevation: of the sun [rad], not negative.
    """
    x = np.cbrt(elevation / (math.pi / 2.0))
    powers = np.arange(HOSEK_DEGREE + 1)
    curve = [math.comb(HOSEK_DEGREE, i) for i in powers] * x**powers * (1.0 - x) ** (HOSEK_DEGREE - powers)
    low = min(int(turbidity) - 1, points.shape[1] - 2)
    hazes = np.array([low + 2.0 - turbidity, turbidity - 1.0 - low])
    grounds = np.array([1.0 - ground_albedo, ground_albedo])
    return np.asarray(np.einsum("t,a,ctank,k->cn", hazes, grounds, points[:, low : low + 2], curve))


def hosek_wilkie(towards: Vector, sun: Any, turbidity: float, ground_albedo: float = 0.3) -> Color:
    """The clear sky of Hosek & Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance", as Blender scales
    it. Below the horizon only the distance to the sun changes it; a sun below the horizon is drawn as one at it.

    towards, sun, turbidity: see `preetham`; here the turbidity is 1 … 10. ground_albedo: 0 … 1.
    Raises ValueError naming the argument.
    """
    unit = _unit("sun", sun)
    number(turbidity, "turbidity", 1.0, 10.0)
    number(ground_albedo, "ground_albedo", 0.0, 1.0)
    if unit[2] < 0.0:
        unit = _unit("sun", (*(unit[:2] if unit[:2].any() else (0.0, 1.0)), 0.0))
    height = _on_sphere(towards)
    cosine, gamma = _beside(height, unit)
    up = maximum(height.z, HORIZON)
    elevation = math.asin(min(float(unit[2]), 1.0))

    def radiance(numbers: list[float]) -> Value:
        a, b, c, d, e, f, g, i, h, r = numbers
        aureole = 1.0 + h * h - 2.0 * h * cosine
        scattered = c + d * operation("exp", e * gamma) + f * cosine * cosine + i * sqrt(up)
        scattered += g * (1.0 + cosine * cosine) / (aureole * sqrt(aureole))
        return r * (1.0 + a * operation("exp", b / (up + 0.01))) * scattered

    found = hosek_numbers(_hosek_points(), elevation, turbidity, ground_albedo)
    return _rgb(*(radiance(row) for row in found.tolist()))


def _beside(towards: Vector, unit: Array) -> tuple[Value, Value]:
    """The cosine of the angle to a direction, and the angle."""
    cosine = clamp(dot(towards, Vector(*(float(c) for c in unit))), -1.0, 1.0)
    return cosine, operation("arccosine", cosine)


def _unit(name: str, direction: Any) -> Array:
    found = np.asarray(direction, dtype=np.float64)
    if found.shape != (3,) or not np.isfinite(found).all() or not found.any():
        raise ValueError(f"{name} must be a direction of shape (3,), finite and not 0, got {direction!r}")
    return np.asarray(found / np.linalg.norm(found))


@lru_cache(maxsize=8)
def _texture(model: str, elevation: float, around: Atmosphere) -> _core.TexturePixels:
    return texture_pixels(picture(model, elevation, around), extension="extend")


@dataclass(frozen=True)
class Sky:
    """A sky that an atmosphere scatters, and the sun in it.

    model: "nishita" or "single", single scattering as Blender has it before and since 5.0, or "multiple".
    elevation, rotation: of the sun, above the horizon and from +y towards +x [rad].
    altitude: of the viewer above the sea [m]. air, aerosols, ozone: densities as parts of the Earth's.
    sun_size, sun_intensity: the sun's angle [rad], and a factor on its light.
    Raises ValueError naming the argument.
    """

    model: str = "multiple"
    elevation: float = math.radians(15.0)
    rotation: float = 0.0
    altitude: float = 100.0
    air: float = 1.0
    aerosols: float = 1.0
    ozone: float = 1.0
    sun_size: float = math.radians(0.545)
    sun_intensity: float = 1.0
    _around: Atmosphere = field(init=False, repr=False, compare=False)
    _height: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        checked_name("model", self.model, MODELS)
        for name in ("elevation", "rotation", "altitude"):
            number(getattr(self, name), name)
        for name in ("air", "aerosols", "ozone", "sun_intensity"):
            number(getattr(self, name), name, 0.0)
        number(self.sun_size, "sun_size", 1e-4, math.pi)
        object.__setattr__(self, "_around", Atmosphere(self.altitude, self.air, self.aerosols, self.ozone))
        # An elevation beyond the zenith leads down on the other side.
        object.__setattr__(self, "_height", math.asin(math.sin(self.elevation)))

    @property
    def towards_sun(self) -> Array:
        """The direction (3,) in which the sun is seen."""
        flat = math.cos(self.elevation)
        return np.array([flat * math.sin(self.rotation), flat * math.cos(self.rotation), math.sin(self.elevation)])

    def light(self, towards: Vector) -> Color:
        """Radiance without the sun's disc in a direction."""
        at = _on_sphere(towards)
        x, y, _ = (float(c) for c in self.towards_sun)
        # Around z from opposite the sun.
        across, along = towards.x * y - towards.y * x, towards.x * x + towards.y * y
        u = 0.5 + operation("arctangent2", across, along) / (2.0 * math.pi)
        height = operation("arcsine", at.z) * (2.0 / math.pi)
        half = 0.5 * sqrt(abs(height))
        v = 0.5 + select(height < 0.0, -half, half)
        found = image(self._picture(), Vector(u, v, 0.0), extension="extend", filtered=False)
        below = clamp(1.0 + 2.5 * at.z)
        fade = below * below * below if self.model == "nishita" else 1.0
        return Color(*(maximum(fade * channel, 0.0) for channel in found))

    def _picture(self) -> _core.TexturePixels:
        return _texture(self.model, self._height, self._around)

    def with_sun(self, towards: Vector) -> Color:
        """Radiance in a direction with the sun's disc, which is darker towards its limb."""
        sky, at = self.light(towards), _on_sphere(towards)
        half, low = 0.5 * self.sun_size, self._height - 0.5 * self.sun_size
        away = self._from_sun(at)
        height = operation("arcsine", at.z)
        cut = self.model == "nishita"
        if cut and low <= 0.0:
            share, low = height / max(low + self.sun_size, 1e-9), 0.0
        else:
            share = (height - self._height) / self.sun_size + 0.5
        limb = 1.0 - LIMB * (1.0 - sqrt(1.0 - (away / half) * (away / half)))
        bottom, top = (self._disc_radiance(elevation) for elevation in (low, self._height + half))
        seen = (away < half) * (at.z > 0.0 if cut else height > -dip(self.altitude))
        disc = [
            maximum(float(a) * (1.0 - share) + float(b) * share, 0.0) * limb for a, b in zip(bottom, top, strict=True)
        ]
        return Color(*(select(seen, own if cut else own + other, other) for own, other in zip(disc, sky, strict=True)))

    def _disc_radiance(self, elevation: float) -> Array:
        """In the disc's middle, of a sun that stands there."""
        # Rounded as by Cycles, whose narrow discs are brighter or darker for it by up to a third.
        solid_angle = 2.0 * math.pi * (1.0 - float(np.cos(np.float32(0.5 * self.sun_size))))
        return self.sun_intensity / solid_angle * sunlight(self.model, elevation, self._around)

    def _from_sun(self, at: Vector) -> Value:
        """The angle [rad] of a unit vector to the sun."""
        chord = at - Vector(*(float(c) for c in self.towards_sun))
        return 2.0 * operation("arcsine", minimum(0.5 * sqrt(dot(chord, chord)), 1.0))
