# SPDX-License-Identifier: MIT
"""One random call of a public function, and what must hold of its answer."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import argument_walk
import numpy as np
from fuzz_values import Array, Rng, cap, chance, disguised, disk, material, numbers, one_of, polygon, sphere

import shlight
from shlight import Bsdf
from shlight_tools import methods

NOTHING = 1e-12  # what rounding leaves of light that is zero
SHAPES: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "sphere": (sphere, ("centers", "radii")),
    "cap": (cap, ("axes", "half_angles")),
    "polygon": (polygon, ("vertices",)),
    "disk": (disk, ("centers", "half_axes_u", "half_axes_v")),
}
LENGTHS = {name for _, names in SHAPES.values() for name in names} - {"half_angles"}


def finite(result: Any) -> str | None:
    for part in result if isinstance(result, tuple) else (result,):
        values = part.evaluate([0.6, 0, 0.8], [[0, 0, 1.0], [-0.6, 0, 0.8]]) if isinstance(part, Bsdf) else part
        if isinstance(values, np.ndarray | np.floating | float) and not np.isfinite(values).all():
            return "the result is not finite"
    return None


@dataclass
class Step:
    call: str
    function: Callable[..., Any]
    arguments: dict[str, Any]
    accepted: bool | None = None
    check: Callable[[Any], str | None] = finite
    names: Iterable[str] = ()  # what an error may start with; those of all arguments unless given

    def complaint(self) -> str | None:
        """What is wrong with the answer; None: nothing."""
        names = set(self.names or self.arguments)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                result = self.function(**self.arguments)
        except (TypeError, ValueError) as error:
            # Exceptions of functions that are given are passed on, and mirrors have no coefficients, for all arguments.
            named = re.match(rf"({'|'.join(names)}|a perfect mirror)\b|.*do not broadcast$", str(error))
            if not named and not names & {"progress", "f"}:
                return f"the error names no argument: {type(error).__name__}: {error}"
            return f"refused: {error}" if self.accepted else None
        except (OSError, shlight.RenderCancelled) as error:
            return None if names & {"path", "progress"} else f"{type(error).__name__}: {error}"
        except Exception as error:
            return f"{type(error).__name__}: {error}"
        return "accepted" if self.accepted is False else self.check(result)


def coefficient_problem(c: Array, shape: tuple[int, ...], *, clip: bool, zero: bool) -> str | None:
    """Checks coefficients of a region of solid angle Ω = √4π L_00 and unit radiance.

    Σ_m Y_lm² = (2l + 1)/4π everywhere, so that the vector L_l = ∫ Y_l dω of a band is no longer than √((2l + 1)/4π) Ω,
    nor is any |L_lm|; and by Bessel's inequality Σ L_lm² ≤ ∫ 1² dω = Ω. Clipped, or seen from outside, Ω ≤ 2π.
    """
    if c.shape != shape:
        return f"the shape is {c.shape}, not {shape}"
    if not np.isfinite(c).all():
        return "the result is not finite"
    slack, rounding = 1e-4 if c.dtype == np.float32 else 1e-8, np.finfo(c.dtype).eps
    c = c.astype(np.float64).reshape(-1, shape[-1])
    if zero and np.abs(c).max() > NOTHING:
        return f"not zero: {np.abs(c).max()}"
    lowest, highest, largest = c[:, 0].min(), c[:, 0].max(), math.sqrt(math.pi if clip else 4 * math.pi)
    if lowest < -rounding or highest > largest * (1 + slack):
        return f"the solid angle is negative or too large: L_00 = {lowest} … {highest}"
    squares = np.add.reduceat(c**2, np.arange(math.isqrt(shape[-1])) ** 2, axis=-1)
    over = np.sqrt(squares / (2 * np.arange(squares.shape[-1]) + 1)) - c[:, :1]
    if over.max() > slack * largest:
        return f"band {over.max(0).argmax()} exceeds what the solid angle allows by {over.max()}"
    over = squares.sum(-1) - math.sqrt(4 * math.pi) * c[:, 0]
    return f"the squares exceed the solid angle by {over.max()}" if over.max() > slack * largest else None


def units_problem(step: Step, axes: tuple[int, ...], result: Any, slack: float) -> str | None:
    """Checks that the unit of length, here a power of two near each light's size, makes no difference."""
    lengths = {name: a for name, a in step.arguments.items() if name in LENGTHS}
    sizes = np.max([np.abs(a).reshape(*axes, -1).max(-1) for a in lengths.values()], axis=0)
    scaled: dict[str, Any] = {}
    for name, a in lengths.items():
        exponents = np.reshape(np.frexp(sizes)[1], (*axes, *[1] * (np.ndim(a) - len(axes))))
        scaled[name] = np.ldexp(a, -exponents)
        if (np.ldexp(scaled[name], exponents) != a).any():
            return None  # the least numbers lose digits
    try:
        error = np.abs(step.function(**{**step.arguments, **scaled}) - result).max()
    except ValueError as refused:
        return f"in other units of length: {refused}"
    return None if error <= slack else f"in other units of length the result differs by {error}"


def lights(rng: Rng, kind: str, dtype: Any) -> tuple[dict[str, Array], tuple[int, ...], bool | None, bool | None]:
    """Arguments, their leading axes, and whether they are accepted and all of their light is zero, as of Shape."""
    count, corners = one_of(rng, 0, 0, 0, 1, 2, 5, 9, 17), int(one_of(rng, 3, 4, 4, 5, 8, 19))
    draw, names = SHAPES[kind]
    shapes, accepted, zero = zip(*(draw(rng, corners, dtype) for _ in range(max(count, 1))), strict=True)
    arrays = {name: np.stack([s[i] for s in shapes])[slice(None) if count else 0] for i, name in enumerate(names)}
    sound = all(np.isfinite(array).all() for array in arrays.values()) and False not in accepted
    arrays = {name: disguised(rng, array) for name, array in arrays.items()}
    every = sound and (None if None in accepted else True)
    return arrays, (count,) * bool(count), every, None if None in zero else all(zero)


def coefficients_of_light(rng: Rng) -> Step:
    kind, dtype = one_of(rng, *SHAPES), one_of(rng, np.float32, np.float64)
    arrays, axes, accepted, zero = lights(rng, kind, dtype)
    options: dict[str, Any] = {"clip": chance(rng, 0.6), "dtype": dtype, "threads": 1}
    order = int(2 ** rng.uniform(0, 6.02))
    known = methods.coefficient_methods().values()
    method = one_of(rng, *(m for m in known if (m.knows_polygons if kind == "polygon" else m.knows_caps)))
    exact = kind == "disk" or chance(rng, 0.85) or method.name == "exact"
    if not exact and (method.name != "reference" or chance(rng, 0.05)):
        options["method"] = method.name
        order = min(order, method.largest_order, 6 if method.name in ("reference", "quadrature") else 64)
        if method.random:
            options |= {"samples": int(rng.integers(1, 50)), "seed": int(rng.integers(2**32))}

    def check(result: Any) -> str | None:
        if not exact or zero is None:
            return finite(result)
        clip = options["clip"] or kind != "cap"
        problem = coefficient_problem(result, (*axes, order**2), clip=clip, zero=zero)
        return problem or units_problem(step, axes, result, 1e-4 if dtype == np.float32 else 1e-8)

    call = f"{kind}_coefficients"
    arguments = {**arrays, "order": order, **options}
    step = Step(call, getattr(shlight, call), arguments, accepted if exact else None, check)
    return step


def shaded_light(rng: Rng) -> Step:
    kind, dtype = one_of(rng, "sphere", "polygon", "disk"), one_of(rng, np.float32, np.float64)
    options: dict[str, Any] = {"threads": 1, "tolerance": float(10 ** one_of(rng, -3, -3, -2, -1, rng.uniform(-6, 1)))}
    if chance(rng, 0.25):
        options["order"] = int(2 ** rng.uniform(0, 6.02))
    elif kind != "disk" and chance(rng, 0.1):
        way, dtype = one_of(rng, *methods.shading_methods().values()), np.float64
        options |= {"method": way.name, "tolerance": max(options["tolerance"], 1e-3)}
        options |= ({"order": one_of(rng, 3, 8)} if way.harmonic else {}) | ({"samples": 20} if way.sampled else {})
    arrays, axes, accepted, zero = lights(rng, kind, dtype)
    of_views = axes if chance(rng, 0.2) else ()
    views = np.array(one_of(rng, rng.random(of_views), rng.choice([0, 1, 5e-324, 1e-8, 1e-3, 1 - 1e-16], of_views)))
    exact, auto = "method" not in options, "method" not in options and "order" not in options
    # Estimates are root mean squares and not bounds.
    slack = 0.02 + 20 * options["tolerance"]

    def check(result: Any) -> str | None:
        if result.shape != (*axes, 3) or not np.isfinite(result).all():
            return f"the result is not finite or of shape {result.shape}"
        if exact and zero and np.abs(result).max() > NOTHING:
            return f"not zero: {np.abs(result).max()}"
        if auto and zero is not None and not (result.min() >= -slack and result.max() <= 1 + slack):
            return f"the radiance is not 0 … 1: {result.min()} … {result.max()}"
        return units_problem(step, axes, result, slack) if auto and zero is not None else None

    arguments = {**arrays, "bsdf": material(rng), "cos_theta_o": views, **options}
    step = Step(f"shade_{kind}s", getattr(shlight, f"shade_{kind}s"), arguments, accepted if exact else None, check)
    return step


def derived_light(rng: Rng) -> Step:
    step = one_of(rng, coefficients_of_light, shaded_light)(rng)
    if step.call in ("sphere_coefficients", "shade_spheres", "shade_polygons"):
        step.arguments["gradient"], step.accepted = True, None
        step.check = lambda result: finite((result[0], *result[1]))
    return step


def any_arguments(rng: Rng) -> Step:
    """A call of the walk with up to three arguments replaced by any object, number or array."""
    call = one_of(rng, *argument_walk.CALLS)
    function, arguments = argument_walk.CALLS[call]
    changed: dict[str, Any] = {}
    for name in rng.choice([*arguments], rng.integers(1, 4)) if arguments else ():
        old, array = arguments[name], isinstance(arguments[name], list | np.ndarray)
        if isinstance(old, Bsdf):
            changed[name] = material(rng)
        elif chance(rng, 0.7) and (array or isinstance(old, float)):
            shape = tuple(rng.integers(0, 5, rng.integers(0, 4))) if array and chance(rng, 0.3) else np.shape(old)
            dtype = one_of(rng, *["f8"] * 5, *["f4"] * 3, "f2", ">f8", "g", "c16", "i4", "u1", "O", "U")
            changed[name] = disguised(rng, numbers(rng, shape).astype(dtype)) if array else float(numbers(rng, ()))
        else:
            changed[name] = argument_walk.WRONG[rng.integers(len(argument_walk.WRONG))]
    names = {other for name in changed for other in (name, *argument_walk.RELATED.get(name, ()))}
    # Nothing is promised of sums of products that leave a type's range, and a file may hold anything.
    is_free = call.split("/")[0] in ("evaluate", "contract", "images.read_exr")
    return Step(call, function, {**arguments, **changed}, None, (lambda _: None) if is_free else finite, names)


def random_call(rng: Rng) -> list[Step]:
    return [one_of(rng, coefficients_of_light, coefficients_of_light, shaded_light, derived_light, any_arguments)(rng)]
