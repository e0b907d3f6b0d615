# SPDX-License-Identifier: MIT
"""Skies: what air scatters, beside the integral by scipy, and where the sun is."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from shlight import nodes
from shlight.nodes import atmospheres
from shlight.nodes.program import ProgramBuilder

Array = NDArray[np.float64]


def seen(color: nodes.Color, directions: Array) -> Array:
    """A colour by directions (n, 3) of `nodes.position()`."""
    builder = ProgramBuilder()
    builder.result(tuple(color))
    program = builder.program()
    number, count = builder.input_number("position", 0), len(directions)
    given = [((*number, i), np.broadcast_to(np.float32(directions[:, i]), (3, count))) for i in range(3)]
    return np.array(program.evaluate(given, count)[:3].T, dtype=np.float64)


def scattered(latitude: float, azimuth: float, elevation: float) -> Array:
    """Single scattering at an altitude of 100 m as Nishita et al. have it, by adaptive quadrature; XYZ.

    azimuth: between the direction that is looked in and the sun.
    """
    integrate = pytest.importorskip("scipy.integrate")
    earth, top = atmospheres.EARTH, atmospheres.TOP
    start = np.array([0.0, 0.0, earth + 100.0])
    along = np.array(
        [math.cos(latitude) * math.cos(azimuth), math.cos(latitude) * math.sin(azimuth), math.sin(latitude)]
    )
    sun = np.array([math.cos(elevation), 0.0, math.sin(elevation)])

    air = 5.4248e-5 * (380.0 / atmospheres.WAVELENGTHS) ** 4

    def reach(place: Array, direction: Array) -> float:
        rise = float(place @ direction)
        return math.sqrt(rise * rise + top * top - float(place @ place)) - rise

    def densities(place: Array) -> Array:
        height = float(np.linalg.norm(place)) - earth
        ozone = max(1.0 - abs(height - 25e3) / 15e3, 0.0)
        return np.array([math.exp(-height / 8e3), math.exp(-height / 1.2e3), ozone])

    def depth(place: Array, direction: Array, far: float) -> Array:
        return np.asarray(integrate.quad_vec(lambda t: densities(place + t * direction), 0.0, far, epsrel=1e-6)[0])

    def light(t: float) -> Array:
        place = start + t * along
        lost = depth(start, along, t) + depth(place, sun, reach(place, sun))
        left = np.exp(-lost @ [air, np.full_like(air, 1.11 * 2e-5), atmospheres.OZONE])
        own = densities(place)
        return np.concatenate([own[0] * left, own[1] * left])

    by_air, by_aerosols = np.split(integrate.quad_vec(light, 0.0, reach(start, along), epsrel=1e-5)[0], 2)
    cosine, g = float(along @ sun), 0.76  # that of aerosols, which scatter forwards
    rayleigh = 3.0 / (16.0 * math.pi) * (1.0 + cosine**2)
    mie = 3.0 / (8.0 * math.pi) * (1 - g * g) * (1 + cosine**2) / ((2 + g * g) * (1 + g * g - 2 * g * cosine) ** 1.5)
    spectrum = rayleigh * air * by_air + mie * 2e-5 * by_aerosols
    return np.asarray(spectrum @ atmospheres._to_xyz())


@pytest.mark.parametrize(("latitude", "column"), [(1.2, 30), pytest.param(0.3, 250, marks=pytest.mark.slow)])
def test_single_scattering_is_its_integral(latitude: float, column: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """To what 8 places towards the sun leave, along a ray of many steps; Cycles' 32 are up to 12 % too dark."""
    monkeypatch.setattr(atmospheres, "STEPS", 2048)
    elevation = 0.6
    row = atmospheres._scattered_once(latitude, elevation, atmospheres.Atmosphere())
    azimuth = 2.0 * math.pi / atmospheres.WIDTH * column - math.pi
    np.testing.assert_allclose(row[column], scattered(latitude, azimuth, elevation), rtol=5e-3)


@pytest.mark.parametrize("model", atmospheres.MODELS)
def test_the_sun_stands_where_the_sky_is_brightest(model: str) -> None:
    sky = nodes.Sky(model, elevation=0.5, rotation=0.8)
    np.testing.assert_allclose(np.linalg.norm(sky.towards_sun), 1.0)
    turns = np.linspace(0.0, 2.0 * math.pi, 360, endpoint=False)
    flat = math.cos(0.5)
    ring = np.stack([flat * np.sin(turns), flat * np.cos(turns), np.full_like(turns, math.sin(0.5))], axis=1)
    light = seen(sky.light(nodes.position()), ring).sum(axis=1)
    assert abs(turns[light.argmax()] - 0.8) <= math.radians(1.5)
    np.testing.assert_allclose(ring[light.argmax()], sky.towards_sun, atol=0.03)


@pytest.mark.parametrize("model", atmospheres.MODELS)
def test_the_disc_has_the_suns_irradiance(model: str) -> None:
    """1 - 0.6 / 3 of it, since the limb is darker; of the sun of 3 suns' strength."""
    sky = nodes.Sky(model, elevation=1.0, sun_intensity=3.0, sun_size=0.02)
    half = 0.01
    radius, angle = half * np.sqrt((np.arange(64) + 0.5) / 64), 2.0 * math.pi * np.arange(64) / 64
    middle = sky.towards_sun
    u = np.cross(middle, (0.0, 0.0, 1.0))
    u /= np.linalg.norm(u)
    v = np.cross(middle, u)
    out = u * np.cos(angle)[:, None] + v * np.sin(angle)[:, None]
    places = middle + np.tan(radius)[:, None, None] * out
    places = (places / np.linalg.norm(places, axis=-1, keepdims=True)).reshape(-1, 3)
    added = seen(sky.with_sun(nodes.position()), places)
    if model != "nishita":  # whose disc hides the sky
        added = added - seen(sky.light(nodes.position()), places)
    found = 2.0 * math.pi * (1.0 - math.cos(half)) * added.mean(axis=0)
    wanted = 3.0 * 0.8 * atmospheres.sunlight(model, 1.0, atmospheres.Atmosphere())
    np.testing.assert_allclose(found, wanted, rtol=2e-3)


def test_preetham_at_the_zenith_has_the_papers_luminance() -> None:
    """Appendix A.2: the zenith's luminance under a sun at 60° of turbidity 3, as Rec. 709 weighs its colour."""
    turbidity, at = 3.0, math.radians(30.0)
    chi = (4.0 / 9.0 - turbidity / 120.0) * (math.pi - 2.0 * at)
    luminance = (4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192
    sky = nodes.preetham(nodes.position(), (0.0, math.sin(at), math.cos(at)), turbidity)
    (found,) = seen(sky, np.array([[0.0, 0.0, 1.0]])) @ (0.2126729, 0.7151522, 0.0721750)
    assert found == pytest.approx(0.06 * luminance, rel=1e-4)


@pytest.mark.parametrize(
    ("name", "value"),
    [("model", "rayleigh"), ("elevation", math.nan), ("air", -1.0), ("ozone", math.inf), ("sun_size", 0.0)],
)
def test_bad_skies_are_refused(name: str, value: Any) -> None:
    with pytest.raises(ValueError, match=name):
        nodes.Sky(**{name: value})


@pytest.mark.parametrize("model", [nodes.preetham, nodes.hosek_wilkie])
@pytest.mark.parametrize(("sun", "turbidity", "name"), [((0, 0, 0), 2.0, "sun"), ((0, 0, 1), 0.5, "turbidity")])
def test_bad_arguments_of_analytic_skies_are_refused(model: Any, sun: Any, turbidity: float, name: str) -> None:
    with pytest.raises(ValueError, match=name):
        model(nodes.position(), sun, turbidity)


def test_bad_grounds_are_refused() -> None:
    with pytest.raises(ValueError, match="ground_albedo"):
        nodes.hosek_wilkie(nodes.position(), (0, 0, 1), 2.0, ground_albedo=1.5)
