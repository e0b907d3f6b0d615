# SPDX-License-Identifier: MIT
"""Lobes of shlight.nodes, on a plane in parallel views, against their formulas and cubature of these."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import shlight
from shlight import nodes
from shlight.nodes import energy, metals
from shlight.nodes.shader import Lobe, Shader
from shlight.nodes.values import color, number

Doubles = NDArray[np.float64]
VIEW = np.array([math.sin(0.9), 0.0, math.cos(0.9)])
LIGHTS = np.array([[-math.sin(0.8), 0.1, math.cos(0.8)], [0.5, 0.4, 0.6], [-0.1, -0.95, 0.2]])
LIGHTS /= np.linalg.norm(LIGHTS, axis=1, keepdims=True)


def radiance(shader: Any, sun: Doubles | None, angle: float = 0.0) -> Any:
    """The radiance towards VIEW of a plane under a sun of irradiance 1, or in a world of radiance 1."""
    scene = shlight.Scene()
    corners = np.array([[-9.0, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]])
    uvs = np.full((4, 2), 0.5)
    scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], uvs=uvs, bsdf=shader)
    if sun is None:
        scene.set_environment(np.ones((8, 16, 3)), visible=False)
    else:
        scene.add_sun_light(-sun, angle, (1.0, 1.0, 1.0))
    pose = np.eye(4)
    pose[:3, :3] = np.stack([[0, 1, 0], np.cross(VIEW, [0, 1, 0]), VIEW], axis=1)
    pose[:3, 3] = 5 * VIEW
    scene.set_camera(pose, 0.002)
    image = shlight.render(scene, 1, 1, min_samples=4, max_samples=4, shadow_rays=0, max_bounces=0, tolerance=1e-4)
    return image[0, 0, :3].astype(np.float64)


def in_cone(axis: Doubles, angle: float) -> tuple[Doubles, Doubles]:
    """Directions (n, 3) of an even grid over a cone of whole angle `angle`, and each one's solid angle."""
    steps, turns = 200, 400
    z = 1 - (1 - math.cos(angle / 2)) * (np.arange(steps) + 0.5) / steps
    phi = 2 * math.pi * (np.arange(turns) + 0.5) / turns
    x = np.cross(axis, [0.3, 0.5, 0.8])
    x /= np.linalg.norm(x)
    s = np.sqrt(1 - z * z)[:, None]
    across = np.cos(phi)[:, None] * x + np.sin(phi)[:, None] * np.cross(axis, x)
    ways = (s[..., None] * across + z[:, None, None] * axis).reshape(-1, 3)
    return ways, np.full(len(ways), 2 * math.pi * (1 - math.cos(angle / 2)) / len(ways))


def reflected(f: Callable[[Doubles], Doubles], sun: Doubles, angle: float) -> float:
    """∫ f·cos over a cone of irradiance 1 at right angles."""
    if angle == 0:
        return float(f(sun[None])[0])
    ways, share = in_cone(sun, angle)
    whole = math.pi * math.sin(angle / 2) ** 2
    return float((np.where(ways[:, 2] > 0, f(ways), 0.0) * share).sum() / whole)


def fresnel(factor: str, c: Doubles) -> Doubles:
    return {
        "": np.ones_like(c),
        "_schlick": (1 - c) ** 5,
        "_dip": c * (1 - c) ** 6,
        "_wide_dip": c * (1 - c) ** 3,
        "_narrow_dip": c * (1 - c) ** 12,
        "_broad_dip": c * (1 - c) ** 2,
        "_linear": 1 - c,
    }[factor]


def microfacets(distribution: str, factor: str, alpha: float, light: Doubles) -> Doubles:
    """f·cos, with Λ as in Heitz 2014 and Walter et al. 2007, and Ashikhmin & Shirley's Eq. 4 without Fresnel's term."""
    light = np.where(light[:, 2:] > 0, light, [[0, 0, 1]])
    half = light + VIEW
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    c, cos_h = half @ VIEW, half[:, 2]
    if distribution == "ashikhmin_shirley":
        n = 2 / alpha**2 - 2
        lobe = (n + 1) / (8 * math.pi) * cos_h**n / (c * np.maximum(light[:, 2], VIEW[2]))
        return fresnel(factor, c) * lobe * light[:, 2]
    tan2 = 1 / cos_h**2 - 1
    if distribution == "beckmann":
        d = np.exp(-tan2 / alpha**2) / (math.pi * alpha**2 * cos_h**4)
    else:
        d = alpha**2 / (math.pi * cos_h**4 * (alpha**2 + tan2) ** 2)

    def hidden(cosine: Doubles) -> Doubles:
        slope = alpha * np.sqrt(1 / cosine**2 - 1)
        if distribution == "ggx":
            return np.asarray((np.sqrt(1 + slope**2) - 1) / 2)
        a = 1 / np.maximum(slope, 1e-9)
        return np.where(a < 1.6, (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)

    seen = 1 / (1 + hidden(light[:, 2]) + hidden(VIEW[2:]))
    return np.asarray(fresnel(factor, c) * d * seen / (4 * VIEW[2]))


FACTORS = ("", "_schlick", "_dip", "_wide_dip", "_narrow_dip", "_broad_dip", "_linear")
KINDS = [
    *itertools.product(("beckmann", "ashikhmin_shirley"), FACTORS),
    *itertools.product(("ggx",), FACTORS[3:]),
]


@pytest.mark.parametrize(("distribution", "factor"), KINDS)
def test_microfacets_are_their_formula(distribution: str, factor: str) -> None:
    """Without extent the light shows f·cos; a large one, its integral; whether the width varies or not."""
    strength = 1.0 if factor in ("", "_schlick") else 100.0
    for alpha, sun, angle in itertools.product((0.09, 1.0), LIGHTS[:2], (0.0, 1.0)):
        truth = strength * reflected(lambda ways, a=alpha: microfacets(distribution, factor, a, ways), sun, angle)
        for width in (number(alpha), nodes.uv().x * (2 * alpha)):
            found = radiance(Shader((Lobe(distribution + factor, color(strength), width),)), sun, angle)
            assert np.abs(found - truth).max() <= 2e-3 * truth + 2e-5, (alpha, sun, angle)


TANGENT = np.array([math.cos(0.4), math.sin(0.4), 0.0])


def stretched(distribution: str, x: float, y: float, light: Doubles) -> Doubles:
    """f·cos of microfacets of width x along TANGENT and y across it (Heitz 2014; Ashikhmin & Shirley 2000)."""
    light = np.where(light[:, 2:] > 0, light, [[0, 0, 1]])
    across = np.cross([0.0, 0.0, 1.0], TANGENT)
    half = light + VIEW
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    hx, hy, hz = half @ TANGENT, half @ across, half[:, 2]
    if distribution == "ashikhmin_shirley":
        nx, ny = 2 / x**2 - 2, 2 / y**2 - 2
        power = (nx * hx**2 + ny * hy**2) / (1 - hz**2)
        norm = math.sqrt((nx + 1) * (ny + 1)) / (8 * math.pi)
        return np.asarray(norm * hz**power / (half @ VIEW * np.maximum(light[:, 2], VIEW[2])) * light[:, 2])
    slope2 = ((hx / x) ** 2 + (hy / y) ** 2) / hz**2
    d = (np.exp(-slope2) if distribution == "beckmann" else (1 + slope2) ** -2.0) / (math.pi * x * y * hz**4)

    def hidden(v: Doubles) -> Doubles:
        slope = np.hypot(x * (v @ TANGENT), y * (v @ across)) / v[..., 2]
        if distribution == "ggx":
            return np.asarray((np.sqrt(1 + slope**2) - 1) / 2)
        a = 1 / np.maximum(slope, 1e-9)
        return np.where(a < 1.6, (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)

    return np.asarray(d / (1 + hidden(light) + hidden(VIEW)) / (4 * VIEW[2]))


@pytest.mark.parametrize("distribution", ["ggx", "beckmann", "ashikhmin_shirley"])
@pytest.mark.parametrize("anisotropy", [0.5, -0.5, 0.8])
def test_anisotropic_microfacets_are_their_formula(distribution: Any, anisotropy: float) -> None:
    ratio = 1 - anisotropy if anisotropy > 0 else 1 / (1 + anisotropy)
    tangent = nodes.Vector(*(2.0 * TANGENT + [0.0, 0.0, 0.3]))
    quarter_turn = nodes.Vector(*np.cross(TANGENT, [0.0, 0.0, 1.0]))
    for sun, angle in itertools.product(LIGHTS, (0.0, 0.1, 1.0)):
        truth = reflected(lambda ways: stretched(distribution, 0.25 * ratio, min(0.25 / ratio, 1), ways), sun, angle)
        for share, turns, along in (
            (number(anisotropy), 0.0, tangent),
            (nodes.uv().x * (2 * anisotropy), nodes.uv().y * 0.5, quarter_turn),
        ):
            shader = nodes.glossy(1.0, 0.5, distribution=distribution, anisotropy=share, rotation=turns, tangent=along)
            assert np.abs(radiance(shader, sun, angle) - truth).max() <= 2e-3 * truth + 2e-5, (sun, angle)


def test_anisotropic_lobes_reflect_no_more_than_they_get() -> None:
    along = nodes.Vector(*TANGENT)
    for roughness, share in itertools.product((0.3, 0.6, 1.0), (0.5, 1.0)):
        own = {"anisotropy": share, "tangent": along}
        for shader in (
            nodes.glossy(1.0, roughness, **own),
            nodes.metallic(1.0, 1.0, roughness, **own),
            nodes.principled(1.0, roughness=roughness, anisotropic=share, tangent=along),
        ):
            assert radiance(shader, None).max() <= 1 + 1e-3


def toon_value(glossy: bool, size: float, smooth: float, light: Doubles) -> Doubles:
    axis = VIEW * [-1, 0, 1] if glossy else np.array([0.0, 0.0, 1.0])
    angle = np.arccos(np.clip(light @ axis, -1, 1)) / (math.pi / 2)
    whole = min(size + smooth, 1.0)
    share = np.where(angle > whole, 0.0, 1 - np.maximum(angle - size, 0) / max(smooth, 1e-9))
    return np.asarray(share / (2 * math.pi * (1 - math.cos(whole * math.pi / 2))))


@pytest.mark.parametrize("glossy", [False, True])
@pytest.mark.parametrize("smooth", [0.0, 0.5, 1.0])
def test_toon_is_its_formula(glossy: bool, smooth: float) -> None:
    """Without extent the light shows f·cos. Of others the sum of 80,000 directions errs where an edge crosses them."""
    for size in (0.1, 0.5, 0.9):
        makes = number(size), nodes.uv().x * (2 * size)
        shaders = [nodes.toon(1.0, own, smooth, glossy=glossy) for own in makes]
        for sun, angle in itertools.product(LIGHTS, (0.0, 0.2, 1.0)):
            truth = reflected(lambda ways, s=size: toon_value(glossy, s, smooth, ways), sun, angle)
            for shader in shaders:
                found = radiance(shader, sun, angle)[0]
                assert abs(found - truth) <= (5e-3 if angle else 3e-4) * truth + 3e-4, (size, sun, angle)
        ways, share = in_cone(
            VIEW * [-1, 0, 1] if glossy else np.array([0.0, 0.0, 1.0]), min(size + smooth, 1) * math.pi
        )
        albedo = float((toon_value(glossy, size, smooth, ways) * (ways[:, 2] > 0) * share).sum())
        assert radiance(shaders[0], None)[0] == pytest.approx(albedo, rel=2e-3)


def sheen_value(roughness: float, light: Doubles) -> Doubles:
    a, b = (float(energy.sheen_transform(name, roughness, VIEW[2:])[0]) for name in ("a", "b"))
    x, y, z = light.T
    return np.asarray(z / math.pi * (a / ((a * x + b * z) ** 2 + (a * y) ** 2 + z * z)) ** 2)


@pytest.mark.parametrize(
    "roughness", [pytest.param(0.4, marks=pytest.mark.slow), 0.6, pytest.param(1.0, marks=pytest.mark.slow)]
)
def test_microfibres_are_a_transformed_cosine(roughness: float) -> None:
    share = radiance(nodes.microfibre(1.0, roughness), None)[0]
    assert share <= 1 + 1e-3
    of_roughness = [np.interp(roughness, energy.SHEEN_STEPS, row) for row in energy.tables()["sheen"].values]
    albedo = float(np.interp(VIEW[2], energy.SHEEN_STEPS, of_roughness))
    assert share == pytest.approx(albedo, rel=5e-3)
    for sun, angle in itertools.product(LIGHTS, (0.0, 1.0)):
        truth = albedo * reflected(lambda ways: sheen_value(roughness, ways), sun, angle)
        for width, error in ((number(roughness), 0.01), (nodes.uv().x * (2 * roughness), 0.03)):
            found = radiance(nodes.microfibre(1.0, width), sun, angle)[0]
            assert abs(found - truth) <= error * truth + 1e-3 * albedo, (sun, angle)


def test_the_parts_of_disneys_diffuse_reflection() -> None:
    for roughness, sun in itertools.product((0.0, 0.5, 1.0), LIGHTS):
        light, view = (1 - sun[2]) ** 5, (1 - VIEW[2]) ** 5
        retro = roughness * (1 + sun @ VIEW)
        f = (1 - light / 2) * (1 - view / 2) + retro * (light + view + light * view * (retro - 1))
        found = radiance(nodes.disney_diffuse(0.7, roughness), sun)
        np.testing.assert_allclose(found, 0.7 * f * sun[2] / math.pi, rtol=1e-5)
        cosine = math.sqrt((1 + sun @ VIEW) / 2)
        np.testing.assert_allclose(
            radiance(nodes.disney_sheen(0.7), sun), 0.7 * (1 - cosine) ** 5 * sun[2], rtol=1e-5, atol=1e-7
        )


@pytest.mark.parametrize("roughness", [0.3, 0.5, 1.0])
def test_the_clear_coat_of_disney(roughness: float) -> None:
    """GTR1 of alpha = roughness², and masking of alpha 0.25."""

    def coat(ways: Doubles) -> Doubles:
        half = ways + VIEW
        half /= np.linalg.norm(half, axis=-1, keepdims=True)
        squared = roughness**4
        spread = 1 + (squared - 1) * half[:, 2] ** 2
        normals = 1 / math.pi if roughness == 1 else (squared - 1) / (math.pi * math.log(squared) * spread)
        masked = sum((np.sqrt(1 + 0.0625 * (1 / z**2 - 1)) - 1) / 2 for z in (VIEW[2], ways[:, 2]))
        cosine = half @ VIEW
        g = np.sqrt(1.25 + cosine**2)
        rise = (
            0.5
            * ((g - cosine) / (g + cosine)) ** 2
            * (1 + ((cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1)) ** 2)
        )
        return np.asarray(0.25 * rise * normals / (1 + masked) / (4 * VIEW[2]))

    for sun in LIGHTS:
        truth = float(coat(sun[None])[0])
        # Four lobes, and masking for one angle of light, of what is 1 % of the light at most angles.
        error = 0.16 if roughness == 1 else 0.09
        assert abs(radiance(nodes.disney_clearcoat(1.0, roughness), sun)[0] / truth - 1) <= (
            error if sun[2] > 0.5 else 0.35
        )


@pytest.mark.parametrize(
    ("n", "k", "kink"),
    [(0.18, 3.42, 0), (1.37, 1.77, 0), (2.76, 3.87, 0), (1.1, 6.6, 0), (0.0, 1.0, 0), (0.5, 0.5, 0.04), (0, 0, 0)],
)
def test_a_conductors_curve_is_fresnels(n: float, k: float, kink: float) -> None:
    """Against the equations with complex cosines; the form for large n and k leaves out the bending."""
    cosines = np.linspace(0.05, 1, 96)
    index = complex(n, k) or 1e-9j
    inside = np.sqrt(1 - (1 - cosines**2) / index**2 + 0j)
    s = (cosines - index * inside) / (cosines + index * inside)
    p = (index * cosines - inside) / (index * cosines + inside)
    truth = (abs(s) ** 2 + abs(p) ** 2) / 2

    def curve(model: Any, at: Any) -> Any:
        return np.array([model(float(c), color(n), color(k)).constant for c in at])[:, 0]

    exact = curve(metals.exact_reflectance, cosines)
    assert np.abs(exact - truth).max() <= 1e-6
    near = curve(metals.large_index_reflectance, cosines)
    assert np.abs(near - truth).max() <= (0.03 if n * n + k * k > 4 else 1.0)
    for model, own in ((metals.exact_reflectance, exact), (metals.large_index_reflectance, near)):
        shares = metals.shares_of_known() @ curve(model, metals.COSINES)
        made = sum(share * fresnel(factor, cosines) for share, factor in zip(shares, metals.FACTORS, strict=True))
        assert np.abs(made - own).max() <= 3e-3 + kink


def test_metals_reflect_no_more_than_they_get() -> None:
    for several, roughness in itertools.product((False, True), (0.3, 0.6, 1.0)):
        for shader in (
            nodes.metallic(1.0, 1.0, roughness, several_bounces=several),
            nodes.conductor((0.0, 0.2, 1.0), (1.0, 3.4, 6.0), roughness, several_bounces=several),
        ):
            assert radiance(shader, None).max() <= 1 + 1e-3


def test_what_is_refused() -> None:
    with pytest.raises(ValueError, match="distribution must be one of"):
        nodes.glossy(0.5, 0.5, distribution="phong")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="tangent must be given where anisotropy is not 0"):
        nodes.glossy(0.5, 0.5, anisotropy=0.5)
    with pytest.raises(ValueError, match="tangent must be given where anisotropic is not 0"):
        nodes.principled(anisotropic=0.5)
    with pytest.raises(ValueError, match="several_bounces is known for distribution 'ggx' alone"):
        nodes.metallic(0.5, 0.5, 0.5, several_bounces=True, distribution="beckmann")
