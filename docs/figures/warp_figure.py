# SPDX-License-Identifier: MIT
"""Draws docs/images/warp.png: what the warp of a glossy lobe does, and what it is good for.

.venv/bin/python docs/figures/warp_figure.py        (some ten seconds)
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from warped_lobes import Array, Warp, brute_force, circle, random_lights, view_direction

import shlight

ROUGHNESS = 0.35
COS_O = 0.75
LIGHT = np.array([-0.72, -0.52, 0.52]) / np.linalg.norm([-0.72, -0.52, 0.52])
LIGHT_HALF_ANGLE = 0.24
BANDS = 8

# Okabe & Ito's colours, told apart by everyone.
ORANGE, BLUE, DARK, RING = "#D55E00", "#0072B2", "#333333", "#6c8396"
GLOW = LinearSegmentedColormap.from_list("glow", ["#eef1f4", "#9fc3de", "#2f79b5", "#0b3c6e"])

# The spheres are seen from the lobe's side and a little from above.
EYE = np.array([-0.68, -0.69, 0.25]) / np.linalg.norm([-0.68, -0.69, 0.25])
RIGHT = np.cross([0, 0, 1], EYE) / np.linalg.norm(np.cross([0, 0, 1], EYE))
UP = np.cross(EYE, RIGHT)


def front_of_sphere(pixels: int) -> tuple[Array, Array]:
    """Unit vectors seen in a square picture, and where there are any."""
    x, y = np.meshgrid(np.linspace(-1, 1, pixels), np.linspace(-1, 1, pixels))
    depth = 1 - x**2 - y**2
    return (x[..., None] * RIGHT + y[..., None] * UP + np.sqrt(abs(depth))[..., None] * EYE), depth >= 0


def draw_curve(ax: Axes, points: Array, color: str, width: float, alpha: float = 1) -> None:
    """A curve on the sphere; dotted behind it."""
    x, y = points @ RIGHT, points @ UP
    behind = points @ EYE < 0
    ax.plot(np.where(behind, np.nan, x), np.where(behind, np.nan, y), color=color, lw=width, alpha=alpha)
    ax.plot(np.where(behind, x, np.nan), np.where(behind, y, np.nan), color=color, lw=0.7 * width, ls=":", alpha=alpha)


def draw_sphere(ax: Axes, values: Array, above: Array, inside: Array) -> None:
    """values: the lobe at each pixel, its peak is 1; above: whether the pixel is above the horizon."""
    picture = GLOW(np.clip(values, 0, 1))
    picture[~above] = (0.80, 0.79, 0.77, 1)
    picture[~inside, 3] = 0
    ax.imshow(picture, extent=(-1, 1, -1, 1), origin="lower", interpolation="antialiased")
    ax.add_artist(mpl.patches.Circle((0, 0), 1, fill=False, color="#555555", lw=1))
    ax.set_xlim(-1.04, 1.04)
    ax.set_ylim(-1.04, 1.04)
    ax.set_aspect("equal")
    ax.axis("off")


def project(direction: Array) -> tuple[float, float]:
    return float(direction @ RIGHT), float(direction @ UP)


def label(ax: Axes, text: str, at: tuple[float, float], color: str) -> None:
    ax.text(*at, text, color=color, fontsize=11.5, ha="center", va="center", weight="bold")


def spheres(axes: list[Axes]) -> None:
    alpha = ROUGHNESS**2
    bsdf = shlight.Bsdf.ggx(ROUGHNESS, 1.0)
    warp = Warp(alpha, COS_O)
    points, inside = front_of_sphere(700)
    view = view_direction(COS_O)
    mirror = view * [-1, 1, 1]
    rings = [circle(mirror, angle) for angle in np.deg2rad([10, 20, 40])]

    lobe = bsdf.evaluate(points, view)
    draw_sphere(axes[0], lobe / bsdf.evaluate(mirror, view), points[..., 2] >= 0, inside)

    def density(u: Array) -> Array:
        return bsdf.evaluate(warp.direction(u), view) * warp.density(u)

    above = points[..., 2] >= warp.horizon_height
    broad = density(points)
    peak = broad.max()
    draw_sphere(axes[1], broad / peak, above, inside)

    # A least-squares fit where the lobe lives, as in core/src/lobes/fit_solver.cpp.
    rng = np.random.default_rng(1)
    samples = rng.normal(size=(20000, 3))
    samples /= np.linalg.norm(samples, axis=-1, keepdims=True)
    samples = samples[samples[:, 2] >= warp.horizon_height]
    fit = np.linalg.lstsq(shlight.sh_basis(samples, BANDS), density(samples), rcond=1e-4)[0]
    draw_sphere(axes[2], shlight.evaluate(fit, points) / peak, above, inside)

    horizon = circle(np.array([0.0, 0, 1]), np.pi / 2)
    light = circle(LIGHT, LIGHT_HALF_ANGLE)
    for ax, image in zip(axes, [lambda d: d, warp.warped, warp.warped], strict=True):
        for ring in rings:
            draw_curve(ax, np.where(image(ring) @ EYE > 0, image(ring).T, np.nan).T, RING, 0.9)
        draw_curve(ax, image(horizon), DARK, 1.6)
        draw_curve(ax, image(light), ORANGE, 2.4)
    label(axes[0], "light", project(LIGHT), ORANGE)
    label(axes[1], "light", project(warp.cap(LIGHT, LIGHT_HALF_ANGLE)[0]), ORANGE)
    label(axes[0], "horizon", (0, -0.36), DARK)
    label(axes[1], "horizon", (0.86, -0.87), DARK)
    label(axes[0], "lobe", (-0.78, 0.84), BLUE)
    label(axes[1], "lobe", project(warp.warped(mirror)), "white")
    axes[0].set_title("A glossy lobe and a light,\nas directions", fontsize=12.5)
    axes[1].set_title("The same after the warp:\ncircles are still circles", fontsize=12.5)
    axes[2].set_title(f"Spherical harmonics of order {BANDS}\nin place of the warped lobe", fontsize=12.5)


def errors(ax: Axes) -> None:
    """Root mean square error of random lights ÷ the brightest, over orders, with the warp and without."""
    orders = np.array([3, 4, 6, 8, 12, 16, 24, 32, 48, 64])
    rng = np.random.default_rng(2)
    for roughness, color, marker in [(0.5, BLUE, "o"), (0.2, ORANGE, "s")]:
        axes, half = random_lights(rng, roughness**2, COS_O, 90)
        bsdf = shlight.Bsdf.ggx(roughness, 1.0)
        warp = Warp(roughness**2, COS_O)
        truth = np.array([brute_force(bsdf, warp, COS_O, a, h, 150) for a, h in zip(axes, half, strict=True)])
        plain, warped = [], []
        for order in orders:
            light = shlight.cap_coefficients(axes, half, order=int(order))
            coefficients = bsdf.coefficients(COS_O, int(order))
            plain.append(np.sqrt(np.mean((shlight.contract(light, coefficients) - truth) ** 2)) / truth.max())
            if order <= 24:
                shaded = shlight.shade_spheres(axes, np.sin(half), bsdf, COS_O, order=int(order))[:, 0]
                warped.append(np.sqrt(np.mean((shaded - truth) ** 2)) / truth.max())
        ax.plot(orders, plain, color=color, marker=marker, ms=4.5, lw=1.4, ls="--", mfc="white")
        ax.plot(orders[: len(warped)], warped, color=color, marker=marker, ms=4.5, lw=2)
        print("roughness", roughness, "plain", np.round(plain, 7), "warped", np.round(warped, 7))
    ax.text(68, 0.06, "roughness 0.2,\nno warp", color=ORANGE, fontsize=11, ha="right", va="bottom")
    ax.text(17.5, 1.1e-4, "roughness 0.5,\nno warp", color=BLUE, fontsize=11)
    ax.text(2.8, 3.2e-6, "either,\nwith the warp", color=DARK, fontsize=11)
    ax.set_xscale("log", base=2)
    ax.set_yscale("log")
    ax.set_xticks([4, 8, 16, 32, 64], ["4", "8", "16", "32", "64"])
    ax.minorticks_off()
    ax.set_xlabel("order", fontsize=11)
    ax.set_title("Error of the reflected\nlight, relative", fontsize=12)
    ax.grid(color="#dddddd", lw=0.6)
    for side in ["top", "right"]:
        ax.spines[side].set_visible(False)


def main() -> None:
    figure = Figure(figsize=(13.2, 4.1), layout="constrained")
    grid = figure.subplots(1, 4, width_ratios=[1, 1, 1, 1.08])
    spheres(list(grid[:3]))
    errors(grid[3])
    path = Path(__file__).parent.parent / "images" / "warp.png"
    figure.savefig(path, dpi=115)
    print(path, path.stat().st_size // 1000, "kB")


if __name__ == "__main__":
    main()
