# SPDX-License-Identifier: MIT
"""Light that is scattered below surfaces: random walks of numpy in slabs, and the profile's integral."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import shlight
from shlight import nodes
from shlight.nodes import Shader

ALBEDO = (0.8, 0.4, 0.1)


def box(scene: Any, low: tuple[float, float, float], high: tuple[float, float, float], shader: Shader) -> None:
    corners = [[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    scene.add_mesh(corners, [[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)], bsdf=shader)


def seen(scene: Any, place: tuple[float, float, float], way: tuple[float, float, float], **settings: Any) -> Any:
    """The mean radiance of a few places around one, seen along a direction."""
    scene.set_camera(shlight.look_at(np.subtract(place, np.multiply(way, 5.0)), place, (0.0, 1.0, 0.1)), 0.0005)
    options = {"min_samples": 1024, "max_samples": 1024, "max_bounces": 0, "noise_threshold": 0.0, **settings}
    return shlight.render(scene, 8, 8, **options)[..., :3].astype(np.float64).mean(axis=(0, 1))


def walked(albedo: float, thickness: float, g: float) -> tuple[float, float]:
    """Shares of diffuse light that a slab reflects and lets through. thickness: in mean free paths."""
    rng = np.random.default_rng(1)
    z = np.zeros(400_000)
    cosine, weight = np.sqrt(rng.random(z.size)), np.ones(z.size)
    back, through = 0.0, 0.0
    while z.size:
        z = z + cosine * rng.exponential(size=z.size)
        back += weight[z < 0].sum()
        through += weight[z > thickness].sum()
        inside = (z >= 0) & (z <= thickness)
        z, cosine, weight = z[inside], cosine[inside], weight[inside] * albedo
        lives = rng.random(z.size) < 0.99
        z, cosine, weight = z[lives], cosine[lives], weight[lives] / 0.99
        u = 2 * rng.random(z.size) - 1
        bent = u if g == 0 else (1 + g * g - ((1 - g * g) / (1 + g * u)) ** 2) / (2 * g)
        turn = np.cos(2 * math.pi * rng.random(z.size))
        cosine = cosine * bent + np.sqrt(np.maximum((1 - cosine**2) * (1 - bent**2), 0)) * turn
    return back / 400_000, through / 400_000


@pytest.mark.parametrize("g", [0.0, pytest.param(0.6, marks=pytest.mark.slow)])
def test_a_slab_reflects_and_transmits_as_random_walks_do(g: float) -> None:
    body = nodes.subsurface(ALBEDO, (1.0, 2.0, 0.5), anisotropy=g, diffuse_entry=True)
    numbers = [value.constant or 0.0 for value in body.lobes[0].below.numbers]  # type: ignore[union-attr]
    extinction, single, gain = np.reshape(numbers[:9], (3, 3))
    scene = shlight.Scene()
    box(scene, (-40, -40, -0.15), (40, 40, 0), body)
    scene.add_sun_light((0, 0, -1), 0.0, (math.pi,) * 3)
    top, bottom = seen(scene, (0, 0, 0), (0.3, 0, -1)), seen(scene, (0, 0, -0.15), (0.3, 0, 1))
    for i, albedo in enumerate(ALBEDO):
        back, through = walked(single[i], 0.15 * extinction[i], g)
        scale = albedo * gain[i]
        # Three standard errors: 0.6 % of the 65,536 walks of the picture, 0.5 % of those of numpy.
        assert abs(top[i] - scale * back) <= 0.025 * scale * back
        assert abs(bottom[i] - scale * through) <= 0.03 * scale * through + 1e-4
        thick, _ = walked(single[i], 1e9, g)
        assert abs(scale * thick - albedo) <= 0.03 * albedo, "a thick body reflects its albedo"


def test_a_shadows_edge_is_as_wide_as_the_profile() -> None:
    radius, albedo, end = 0.7, 0.8, 16.0
    scene = shlight.Scene()
    box(scene, (-40, -40, -20), (40, 40, 0), nodes.subsurface(albedo, radius, method="burley"))
    scene.add_mesh([[-40, -40, 1], [0, -40, 1], [0, 40, 1], [-40, 40, 1]], [[0, 1, 2], [0, 2, 3]])
    scene.add_sun_light((0, 0, -1), 0.0, (math.pi,) * 3)
    d = radius / (4 * math.pi) / (1.9 - albedo + 3.5 * (albedo - 0.8) ** 2)
    r = (np.arange(200_000) + 0.5) * end / 200_000
    density = (np.exp(-r) + np.exp(-r / 3)) / 4
    density /= density.sum()
    for x in (0.3, 1.0, 3.0):  # from the edge, in units of d, on the bright side
        lit = (density * (1 - np.arccos(np.minimum(x / r, 1.0)) / math.pi)).sum()
        found = seen(scene, (x * d, 0, 0), (-1.0, 0.0, -0.2))
        np.testing.assert_allclose(found, albedo * lit, rtol=0.015)


def test_channels_without_a_radius_are_diffuse_and_threads_do_not_matter() -> None:
    scene = shlight.Scene()
    box(scene, (-1, -1, -0.02), (1, 1, 0), nodes.subsurface(ALBEDO, (0.5, 0.0, 0.5)))
    scene.add_sun_light((0, 0, -1), 0.0, (math.pi,) * 3)
    pictures = [seen(scene, (0, 0, 0), (0.3, 0, -1), max_samples=16, min_samples=16, threads=n) for n in (1, 2)]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert abs(pictures[0][1] - ALBEDO[1]) <= 1e-5
    assert pictures[0][0] < 0.95 * ALBEDO[0]
    assert nodes.subsurface(ALBEDO, 0.0).lobes[0].below is None


def test_a_thick_body_in_white_light_shows_its_albedo_where_light_bounces() -> None:
    scene = shlight.Scene()
    box(scene, (-1, -1, -1), (1, 1, 1), nodes.subsurface(0.6, 0.2, method="random_walk_skin"))
    scene.set_environment(np.ones((8, 16, 3)))
    for bounces in (0, 2):
        found = seen(scene, (0, 0, 1), (0.3, 0, -1), max_samples=64, min_samples=64, max_bounces=bounces)
        np.testing.assert_allclose(found, 0.6, rtol=0.03)


def test_bad_arguments_are_named() -> None:
    for name, bad in {"method": "dipole", "radius": math.nan, "albedo": -1, "ior": math.inf, "roughness": "x"}.items():
        with pytest.raises(ValueError, match=name):
            nodes.subsurface(**{"albedo": 0.5, "radius": 0.1, name: bad})  # type: ignore[arg-type]
