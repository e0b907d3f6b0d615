# SPDX-License-Identifier: MIT
"""One random call of a public function, and what must hold of its result."""

from __future__ import annotations

import math
import re
import tempfile
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import argument_walk
import numpy as np
from fuzz_values import (
    Array,
    Expected,
    Rng,
    Zero,
    cast,
    chance,
    direction,
    disguised,
    disk,
    material,
    number,
    numbers,
    one_of,
    polygon,
    sphere,
)

import shlight
from shlight import Bsdf, images, methods

Check = Callable[[Any], str | None]
NOTHING = 1e-12  # what rounding leaves of light without extent


def finite(result: Any) -> str | None:
    """Of all arrays in the result."""
    for part in result if isinstance(result, tuple) else (result,):
        if isinstance(part, np.ndarray | np.floating | float) and not np.isfinite(part).all():
            return "the result is not finite"
    return None


@dataclass
class Step:
    call: str
    function: Callable[..., Any]
    arguments: dict[str, Any]
    accepted: Expected = None
    check: Check = finite
    names: Iterable[str] = ()  # what an error may start with; those of all arguments unless given

    def complaint(self) -> str | None:
        """What is wrong with the answer; None: nothing."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                result = self.function(**self.arguments)
        except (TypeError, ValueError) as error:
            if "progress" in self.names:
                return None  # what it raises is raised
            names = "|".join(map(re.escape, self.names or self.arguments))
            if not re.match(rf"({names})\b|.*do not broadcast$", str(error)):
                return f"the error names no argument: {type(error).__name__}: {error}"
            return f"refused: {error}" if self.accepted else None
        except (OSError, shlight.RenderCancelled) as error:
            return None if {"path", "progress"} & set(self.names) else f"{type(error).__name__}: {error}"
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        return "accepted" if self.accepted is False else self.check(result)


def coefficient_problem(c: Array, shape: tuple[int, ...], *, clip: bool, zero: Zero, slack: float) -> str | None:
    """Of a region of solid angle Ω = √4π L_00 and unit radiance.

    Σ_m Y_lm² = (2l + 1)/4π everywhere, so that the vector L_l = ∫ Y_l dω of a band is no longer than √((2l + 1)/4π) Ω,
    nor is any |L_lm|; and Bessel's inequality has Σ L_lm² ≤ ∫ 1² dω = Ω. Clipped, or seen from outside, Ω ≤ 2π.
    """
    if c.shape != shape:
        return f"the shape is {c.shape}, not {shape}"
    if not np.isfinite(c).all():
        return "the result is not finite"
    rounding = np.finfo(c.dtype).eps
    c = c.astype(np.float64).reshape(-1, shape[-1])
    if zero and np.abs(c).max() > NOTHING:
        return f"not zero: {np.abs(c).max()}"
    lowest, largest = c[:, 0].min(initial=0), math.sqrt(math.pi if clip else 4 * math.pi)
    if lowest < -rounding:
        return f"the solid angle is negative: L_00 = {lowest}"
    if c[:, 0].max() > largest * (1 + slack):
        return f"the solid angle is too large: L_00 = {c[:, 0].max()}"
    for l in range(math.isqrt(shape[-1])):  # noqa: E741
        over = np.sqrt((c[:, l * l : (l + 1) ** 2] ** 2).sum(-1)) - math.sqrt(2 * l + 1) * c[:, 0]
        if over.max() > slack * largest:
            return f"band {l} exceeds what the solid angle allows by {over.max()}"
    over = (c**2).sum(-1) - math.sqrt(4 * math.pi) * c[:, 0]
    return f"the squares exceed the solid angle by {over.max()}" if over.max() > slack * largest else None


def all_accepted(expected: Iterable[Expected]) -> Expected:
    given = list(expected)
    return False if False in given else None if None in given else True


def all_zero(each: Iterable[Zero]) -> Zero:
    given = list(each)
    return None if None in given else all(given)


def lights(rng: Rng, shape: str, dtype: Any) -> tuple[dict[str, Array], int, Expected, Zero]:
    """Arguments, how many lights they are (0: one without an axis), and as of polygon."""
    count = int(one_of(rng, 0, 0, 0, 1, 2, 5, 9, 17))
    corners = int(one_of(rng, 3, 4, 4, 5, 8, 19))
    drawn: list[tuple[Any, ...]] = []
    for _ in range(max(count, 1)):
        if shape == "spheres":
            drawn.append((*sphere(rng, dtype), False))
        elif shape == "caps":
            angle = one_of(rng, rng.uniform(0, math.pi), 10 ** rng.uniform(-45, 0.4), math.pi, number(rng, dtype))
            half, axis = cast(angle, dtype), one_of(rng, direction(rng), numbers(rng, (3,), dtype)).astype(dtype)
            in_range = bool(axis.any() and np.isfinite(axis).all() and 0 < half <= math.pi * (1 + 1e-7))
            drawn.append((axis, half, in_range, False))
        elif shape == "polygons":
            drawn.append(polygon(rng, corners, dtype))
        else:
            drawn.append(disk(rng, dtype))
    names = {
        "spheres": ("centers", "radii"),
        "caps": ("axes", "half_angles"),
        "polygons": ("vertices",),
        "disks": ("centers", "half_axes_u", "half_axes_v"),
    }[shape]
    arrays = {name: np.stack([d[i] for d in drawn]) for i, name in enumerate(names)}
    if count == 0:
        arrays = {name: array[0] for name, array in arrays.items()}
    return arrays, count, all_accepted(d[-2] for d in drawn), all_zero(d[-1] for d in drawn)


def coefficients_of_light(rng: Rng) -> Step:
    shape, dtype = one_of(rng, "spheres", "caps", "polygons", "disks"), one_of(rng, np.float32, np.float64)
    arrays, count, accepted, zero = lights(rng, shape, dtype)
    options: dict[str, Any] = {"clip": chance(rng, 0.6), "dtype": dtype, "threads": 1}
    most, exact = 64, True
    if shape != "disks" and chance(rng, 0.15):
        known = [
            m
            for m in methods.coefficient_methods().values()
            if (m.knows_polygons if shape == "polygons" else m.knows_caps)
            and (m.name != "reference" or (chance(rng, 0.05) and count < 2))
        ]
        method = known[rng.integers(len(known))]
        options["method"], most = method.name, method.largest_order
        most = 6 if method.name in ("reference", "quadrature") else most
        # Lobes in place of the basis multiply their errors; quadrature may stop at its own tolerance.
        exact = method.name == "exact"
        if method.random:
            options |= {"samples": int(rng.integers(1, 50)), "seed": int(rng.integers(2**32)), "sampling": "solid_angle"}
    order = int(min(most, 2 ** rng.uniform(0, 6.02)))
    name = {"spheres": "sphere", "caps": "cap", "polygons": "polygon", "disks": "disk"}[shape]
    full = (*((count,) if count else ()), order**2)
    above = options["clip"] or shape != "caps"
    slack = 1e-4 if dtype == np.float32 else 1e-8

    def check(result: Any) -> str | None:
        bounded = exact and zero is not None
        return coefficient_problem(result, full, clip=above, zero=zero, slack=slack) if bounded else finite(result)

    arguments = {**{k: disguised(rng, a) for k, a in arrays.items()}, "order": order, **options}
    call = f"{name}_coefficients"
    return Step(call, getattr(shlight, call), arguments, accepted if exact else None, check)


def cosine(rng: Rng) -> float:
    return float(one_of(rng, rng.random(), 0.0, 1.0, 5e-324, 1e-30, 1e-8, 1e-3, math.nextafter(1, 0)))


def shaded_light(rng: Rng) -> Step:
    shape, method = one_of(rng, "spheres", "polygons", "disks"), "auto"
    options: dict[str, Any] = {"threads": 1, "tolerance": float(10 ** one_of(rng, -3, -3, -2, -1, rng.uniform(-6, 1)))}
    if chance(rng, 0.25):
        options["order"] = int(2 ** rng.uniform(0, 6.02))
    elif shape != "disks" and chance(rng, 0.1):
        ways = methods.shading_methods()
        method = options["method"] = list(ways)[rng.integers(len(ways))]
        options["tolerance"] = max(options["tolerance"], 1e-3)
        if ways[method].harmonic:
            options["order"] = int(rng.integers(1, 17))
        if ways[method].sampled:
            options["samples"] = int(rng.integers(1, 50))
    auto = method == "auto" and "order" not in options
    arrays, count, accepted, zero = lights(rng, shape, np.float64 if method != "auto" else one_of(rng, np.float32, np.float64))
    bsdf = material(rng)
    views = np.array([cosine(rng) for _ in range(count)]) if count and chance(rng, 0.3) else cosine(rng)
    # Estimates are root mean squares and not bounds; all materials here reflect at most what they receive.
    slack = 0.02 + 20 * options["tolerance"]

    def check(result: Any) -> str | None:
        if result.shape != (*((count,) if count else ()), 3):
            return f"the shape is {result.shape}"
        if not np.isfinite(result).all():
            return "the result is not finite"
        if zero and method == "auto" and np.abs(result).max() > NOTHING:
            return f"not zero: {np.abs(result).max()}"
        if auto and zero is not None and not (result.min() >= -slack and result.max() <= 1 + slack):
            return f"the radiance is not 0 … 1: {result.min()} … {result.max()}"
        return None

    arguments = {**{k: disguised(rng, a) for k, a in arrays.items()}, "bsdf": bsdf, "cos_theta_o": views, **options}
    return Step(f"shade_{shape}", getattr(shlight, f"shade_{shape}"), arguments, accepted if auto else None, check)


def basis_or_sum(rng: Rng) -> Step:
    dtype, order = one_of(rng, np.float32, np.float64), int(2 ** rng.uniform(0, 6.02))
    count = int(rng.integers(0, 20))
    d = numbers(rng, (count, 3), dtype)
    accepted = bool(d.any(-1).all() and np.isfinite(d).all())
    if chance(rng, 0.5):

        def unit_bands(basis: Any) -> str | None:
            squares = np.add.reduceat(basis.astype(np.float64) ** 2, np.arange(order) ** 2, axis=-1)
            error = np.abs(squares * 4 * np.pi / (2 * np.arange(order) + 1) - 1).max(initial=0)
            return finite(basis) or (f"the squares of a band are wrong by {error}" if not error <= 1e-3 else None)

        arguments = {"directions": disguised(rng, d), "order": order, "dtype": dtype, "threads": 1}
        return Step("sh_basis", shlight.sh_basis, arguments, accepted, unit_bands)
    c, b = (numbers(rng, (count, order**2), dtype) for _ in range(2))
    largest = float(np.finfo(dtype).max) / 1e4
    if chance(rng, 0.5):
        in_range = bool((np.abs(c).sum(-1, dtype=np.longdouble) * order < largest).all()) if accepted else False
        arguments = {"coefficients": disguised(rng, c), "directions": disguised(rng, d), "threads": 1}
        return Step("evaluate", shlight.evaluate, arguments, None, finite if in_range else lambda _: None)
    in_range = bool((np.abs(c.astype(np.longdouble) * b).sum(-1) < largest).all())
    arguments = {"light_coefficients": disguised(rng, c), "bsdf_coefficients": disguised(rng, b), "threads": 1}
    return Step("shade", shlight.shade, arguments, None, finite if in_range else lambda _: None)


def of_material(rng: Rng) -> Step:
    def color() -> Any:
        return [abs(number(rng)) for _ in range(3)] if chance(rng, 0.5) else number(rng)

    bsdf, order = material(rng), int(one_of(rng, 1, 2, 3, 6, 11, 16, 64))
    kind = rng.integers(7)
    if kind == 0:
        arguments = {"roughness": one_of(rng, rng.random(), number(rng), 0.003, 0.0030001), "f0": color()}
        arguments["ior"] = one_of(rng, None, 1 + abs(number(rng)), math.nextafter(1, 2), 1.5)

        def made(**given: Any) -> Any:
            return Bsdf.ggx(**given).evaluate([0.6, 0, 0.8], [[0, 0, 1.0], [-0.6, 0, 0.8], [1, 0, 0]])

        return Step("Bsdf.ggx", made, arguments)
    if kind == 1:
        return Step("Bsdf.lambert", lambda albedo: Bsdf.lambert(albedo).coefficients(0.5, 3), {"albedo": color()})
    if kind == 2:
        factor = color()
        return Step("Bsdf.__mul__", lambda factor: (bsdf * factor).evaluate([0.6, 0, 0.8], [0, 0, 1]), {"factor": factor})
    if kind == 3:
        w = [np.array([direction(rng) for _ in range(3)]) if chance(rng, 0.5) else numbers(rng, (3, 3)) for _ in "io"]
        return Step("Bsdf.evaluate", bsdf.evaluate, {"wi": disguised(rng, w[0]), "wo": disguised(rng, w[1])})
    views = one_of(rng, cosine(rng), np.array([cosine(rng) for _ in range(3)]), number(rng))
    call = one_of(rng, "coefficients", "residual")
    names = ("cos_theta_o", "order", "a perfect mirror")
    return Step(f"Bsdf.{call}", getattr(bsdf, call), {"cos_theta_o": views, "order": order}, names=names)


def picture_file(rng: Rng) -> Step:
    pixels = numbers(rng, (*rng.integers(1, 6, 2), int(one_of(rng, 1, 3, 4))), np.float32)
    pixels[rng.random(pixels.shape) < 0.1] = one_of(rng, np.nan, np.inf, -np.inf)
    if chance(rng, 0.5):
        arguments = {"image": disguised(rng, pixels), "exposure": one_of(rng, 0.0, number(rng), 500, -500)}
        return Step("images.linear_to_srgb8", images.linear_to_srgb8, arguments)

    def there_and_back(image: Any) -> Any:
        with tempfile.TemporaryDirectory() as folder:
            images.write_exr(Path(folder) / "a.exr", image)
            return images.read_exr(Path(folder) / "a.exr")

    def same(result: Any) -> str | None:
        return None if np.array_equal(result, pixels, equal_nan=True) else "the file holds other numbers"

    return Step("images.write_exr", there_and_back, {"image": disguised(rng, pixels)}, True, same)


def wrong_arguments(rng: Rng) -> Step:
    """Of any function of the walk up to three arguments replaced, by any object or array."""
    call = one_of(rng, *argument_walk.CALLS)
    function, arguments = argument_walk.CALLS[call]
    changed: dict[str, Any] = {}
    for _ in range(rng.integers(1, 4) if arguments else 0):
        name, value = one_of(rng, *arguments), argument_walk.WRONG[rng.integers(len(argument_walk.WRONG))]
        if chance(rng, 0.4) and isinstance(arguments[name], list | np.ndarray):
            shape = tuple(rng.integers(0, 5, rng.integers(0, 4)))
            value = numbers(rng, np.shape(arguments[name]) if chance(rng, 0.5) else shape)
            value = disguised(rng, value.astype(one_of(rng, "f2", "f4", ">f8", "f8", "g", "c16", "i4", "u1", "O", "U")))
        changed[name] = value
    names = {other for name in changed for other in (name, *argument_walk.RELATED.get(name, ()))}
    return Step(call, function, {**arguments, **changed}, names=names)


DRAWS = [(coefficients_of_light, 0.35), (shaded_light, 0.25), (basis_or_sum, 0.1), (of_material, 0.1)]
DRAWS += [(picture_file, 0.01), (wrong_arguments, 0.19)]


def random_call(rng: Rng) -> list[Step]:
    draws, shares = zip(*DRAWS, strict=True)
    return [draws[rng.choice(len(draws), p=shares)](rng)]
