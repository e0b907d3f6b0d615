# SPDX-License-Identifier: MIT
"""Measures the numbers of `shlight.nodes.hosek_wilkie`: those with which Cycles draws its sky of Hosek and Wilkie.

X, Y and Z of the sky are r (1 + A exp(B / (cosθ + 0.01))) (C + D exp(E γ) + F cos²γ + G (1 + cos²γ) / (1 + H² -
2 H cosγ)^1.5 + I √cosθ), γ from the sun. Each of A, B, C, D, E, F, G, I, H and r is a Bézier curve of degree 5 over the
cube root of the sun's height, for ten turbidities and two albedos of the ground, between which it is linear. Cycles'
pictures of skies have no noise: curves are fitted to those of whole turbidities, first the numbers of each height by
themselves. A factor may move from r to C, D, F, G and I; those between tell which.

`python -m shlight_tools.hosek_wilkie` writes the file that the package keeps, in some minutes; it needs bpy and scipy.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import cache

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from shlight.nodes.skies import HORIZON, HOSEK_DEGREE, KEPT_HOSEK, hosek_numbers
from shlight.nodes.spectra import TO_REC709

from .exact_pixels import empty_scene, picture

Array = NDArray[np.float64]

HEIGHT, WIDTH = 16, 32  # pixels of all directions around
TURBIDITIES = range(1, 11)
# Cube roots of the sun's height as a part of a right angle: more at the ends, as polynomials want.
PLACES = 0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, 14))
BETWEEN = (0.3, 0.6, 0.9)
A, B, C, D, E, F, G, I, H, R = range(10)  # noqa: E741
LINEAR = [C, D, F, G, I]
STARTS = [(-1.1, -0.2, -3.0, 0.7), (-1.2, -0.5, -2.0, 0.8), (-2.0, -1.0, -1.0, 0.6)]  # A, B, E and H
GOOD = 3e-4  # the relative error, root mean square, of a fit that is one


class Sky:
    """XYZ of one sky and where that is looked at; pixels that Cycles clips are left out."""

    def __init__(self, turbidity: float, albedo: float, place: float) -> None:
        self.turbidity, self.albedo, self.place = turbidity, albedo, place
        latitude = math.pi / 2 * (1 - (np.arange(HEIGHT) + 0.5) / (HEIGHT / 2))[:, None]
        around = 2 * math.pi * ((np.arange(WIDTH // 2) + 0.5) / WIDTH - 0.5)[None]  # to one side of the sun
        cosine = np.cos(latitude) * np.cos(around) * math.cos(self.elevation)
        cosine = np.clip(cosine + np.sin(latitude) * math.sin(self.elevation), -1, 1)
        rgb = sky_picture(turbidity, albedo, self.elevation)[:, : WIDTH // 2]
        seen = (rgb > 0).all(axis=-1)
        self.xyz = (rgb @ np.linalg.inv(TO_REC709).T)[seen]
        self.cosine = cosine[seen]
        self.up = np.maximum(np.broadcast_to(np.sin(latitude), cosine.shape)[seen], HORIZON)

    @property
    def elevation(self) -> float:
        return float(math.pi / 2 * self.place**3)


@cache
def _scene() -> tuple[bpy.types.Scene, bpy.types.Node]:
    scene = empty_scene(WIDTH, HEIGHT)
    camera = bpy.data.cameras.new("Around")
    camera.type, camera.panorama_type = "PANO", "EQUIRECTANGULAR"
    scene.camera = bpy.data.objects.new("Around", camera)
    scene.camera.rotation_euler.x = math.pi / 2
    scene.collection.objects.link(scene.camera)
    scene.world = bpy.data.worlds.new("Sky")
    scene.world.use_nodes = True
    scene.world.cycles.sampling_method = "NONE"
    tree = scene.world.node_tree
    node = tree.nodes.new("ShaderNodeTexSky")
    node.sky_type = "HOSEK_WILKIE"
    tree.links.new(node.outputs[0], tree.nodes["Background"].inputs[0])
    return scene, node


def sky_picture(turbidity: float, albedo: float, elevation: float) -> Array:
    """All directions (HEIGHT, WIDTH, 3) around; the sun is in the middle column."""
    scene, node = _scene()
    node.turbidity, node.ground_albedo = turbidity, albedo
    node.sun_direction = (0.0, math.cos(elevation), math.sin(elevation))
    return picture(scene)


def radiance(v: Array, sky: Sky) -> tuple[Array, Array]:
    """A channel by the numbers v (10) or (pixels, 10), and its derivatives by them (pixels, 10)."""
    a, b, c, d, e, f, g, i, h, r = v.T
    gamma, cosine = np.arccos(sky.cosine), sky.cosine
    fade = np.exp(np.clip(b / (sky.up + 0.01), -50, 50))
    glow = np.exp(np.clip(e * gamma, -60, 20))
    aureole = np.maximum(1 + h * h - 2 * h * cosine, 1e-9)
    wide = 1 + cosine * cosine
    base, inner = 1 + a * fade, c + d * glow + f * cosine * cosine + g * wide / aureole**1.5 + i * np.sqrt(sky.up)
    by_h = -3 * g * wide * (h - cosine) / aureole**2.5
    of_inner = (
        d * gamma * glow,
        by_h,
        np.ones_like(cosine),
        glow,
        cosine * cosine,
        wide / aureole**1.5,
        np.sqrt(sky.up),
    )
    by = np.empty((len(cosine), 10))
    by[:, A], by[:, B] = fade * inner * r, a * fade / (sky.up + 0.01) * inner * r
    by[:, [E, H, *LINEAR]] = np.stack(of_inner, axis=-1) * (base * r)[..., None]
    by[:, R] = base * inner
    return base * inner * r, by


def numbers_of(sky: Sky, channel: int, starts: Iterable[Array]) -> Array:
    """The numbers of one sky, where r is 1, from the best of some starts for A, B, E and H."""
    truth = sky.xyz[:, channel]

    def completed(free: Array) -> Array:
        v = np.zeros(10)
        v[[A, B, E, H]], v[R] = free, 1.0
        columns = radiance(v, sky)[1][:, LINEAR]
        v[LINEAR] = np.linalg.lstsq(columns / truth[:, None], np.ones_like(truth), rcond=1e-9)[0]
        return v

    def error(free: Array) -> Array:
        return radiance(completed(free), sky)[0] / truth - 1

    fits = (least_squares(error, start, method="lm", max_nfev=400) for start in starts)
    return completed(min(fits, key=lambda fit: fit.cost).x)


def powers(place: float) -> Array:
    return np.array([math.comb(HOSEK_DEGREE, k) * place**k * (1 - place) ** (HOSEK_DEGREE - k) for k in range(6)])


def fitted(skies: list[Sky], channel: int, start: Array) -> tuple[Array, float]:
    """Points (10, 6) of the curves through skies of one turbidity and albedo; and the error, root mean square."""

    def parts(points: Array) -> tuple[Array, Array]:
        errors, slopes = [], []
        for sky in skies:
            curve = powers(sky.place)
            found, by = radiance(points.reshape(10, 6) @ curve, sky)
            errors.append(found / sky.xyz[:, channel] - 1)
            slopes.append((by[:, :, None] * curve / sky.xyz[:, channel, None, None]).reshape(len(found), -1))
        # The mean of r's points is held at 1.
        held = np.repeat(np.arange(10) == R, 6) / 6
        return np.append(np.concatenate(errors), held @ points - 1), np.vstack([*slopes, held])

    fit = least_squares(
        lambda p: parts(p)[0], start.ravel(), jac=lambda p: parts(p)[1], method="lm", x_scale="jac", max_nfev=120
    )
    return fit.x.reshape(10, 6), float(np.sqrt(np.mean(fit.fun**2)))


def first_points(skies: list[Sky], channel: int) -> Array:
    """Curves near the numbers of each sky."""
    rows: list[Array] = []
    for sky in reversed(skies):
        near = [rows[-1][[A, B, E, H]]] if rows else []
        rows.append(numbers_of(sky, channel, [*near, *map(np.array, STARTS)]))
    found, curves = np.array(rows[::-1]), np.array([powers(sky.place) for sky in skies])
    weights = np.ones_like(found)
    weights[:, E] = np.abs(found[:, D] * found[:, E]) + 1e-3  # where the exponential counts
    columns = zip(found.T, weights.T, strict=True)
    return np.array([np.linalg.lstsq(curves * w[:, None], n * w, rcond=1e-4)[0] for n, w in columns])


def points_of(skies: dict[int, list[Sky]], channel: int, others: list[Array]) -> Array:
    """The points (10 turbidities, 10, 6) for one albedo; others: those of other channels.

    Few starts lead to the best fit, but that of a neighbour does: up and down again over all that are not good yet.
    """
    done: dict[int, tuple[Array, float]] = {}

    def starts(turbidity: int) -> Iterator[Array]:
        for step in (-1, 1):
            near = [done[t][0] for t in (turbidity + step, turbidity + 2 * step) if t in done]
            yield from [2 * near[0] - near[1]] if len(near) > 1 else near
        yield from (other[turbidity - 1] for other in others)
        if turbidity not in done:
            yield first_points(skies[turbidity], channel)

    for order in (TURBIDITIES, reversed(TURBIDITIES), TURBIDITIES):
        for turbidity in order:
            best = done.get(turbidity, (np.zeros(0), math.inf))
            for start in [] if best[1] <= GOOD else starts(turbidity):
                best = min(best, fitted(skies[turbidity], channel, start), key=lambda fit: fit[1])
                if best[1] <= GOOD:
                    break
            done[turbidity] = best
    for turbidity in TURBIDITIES:
        print(f"turbidity {turbidity}, {'XYZ'[channel]}: {done[turbidity][1]:.1e}", flush=True)
    return np.array([done[turbidity][0] for turbidity in TURBIDITIES])


def scaled(points: Array, factors: Array) -> Array:
    """The points of a channel; factors (turbidities, 2) are moved from r to its linear numbers."""
    moved = points.copy()
    moved[:, :, LINEAR] *= factors[..., None, None]
    moved[:, :, R] /= factors[..., None]
    return moved


def balanced(points: Array, channel: int, between: list[Sky]) -> Array:
    """The points (turbidities, 2, 10, 6) of a channel with the factors that skies between them have."""

    def errors(logarithms: Array) -> Array:
        own = scaled(points, np.exp(np.append(0.0, logarithms)).reshape(-1, 2))[None]
        rows = []
        for sky in between:
            v = hosek_numbers(own, sky.elevation, sky.turbidity, sky.albedo)[0]
            rows.append((radiance(v, sky)[0] / sky.xyz[:, channel] - 1)[::5])
        return np.concatenate(rows)

    fit = least_squares(errors, np.zeros(2 * len(points) - 1))
    print(f"{'XYZ'[channel]} between: {np.sqrt(np.mean(fit.fun**2)):.1e}", flush=True)
    return scaled(points, np.exp(np.append(0.0, fit.x)).reshape(-1, 2))


def main() -> None:
    skies = {albedo: {t: [Sky(t, albedo, x) for x in PLACES] for t in TURBIDITIES} for albedo in (0.0, 1.0)}
    between = [Sky(t, 0.5, x) for t in TURBIDITIES for x in BETWEEN]
    between += [Sky(t + 0.5, albedo, x) for t in TURBIDITIES[:-1] for albedo in (0.0, 1.0) for x in BETWEEN]
    fits: list[Array] = []
    channels = []
    for channel in range(3):
        dark = points_of(skies[0.0], channel, [fit[:, 0] for fit in fits])
        # The ground changes all channels alike.
        near = [dark + fit[:, 1] - fit[:, 0] for fit in fits] or [dark]
        bright = points_of(skies[1.0], channel, near)
        fits.append(np.stack([dark, bright], axis=1))
        channels.append(balanced(fits[-1], channel, between))
    np.savez_compressed(KEPT_HOSEK, points=np.array(channels, dtype=np.float32))


if __name__ == "__main__":
    main()
