# SPDX-License-Identifier: MIT
"""Other ways to the same numbers, as `method=` of the coefficient and shading functions, to compare with.

"exact" (coefficients) and "auto" (shading) are the library's own; `coefficient_methods()` and `shading_methods()` list
the others with their sources. Each takes the options that make sense for it and refuses the rest:

    tolerance   adaptive methods: error ÷ L_00, by default what the type can hold; in shading radiance ÷ albedo
    samples     random methods: directions per light; cubature: points
    seed        random methods: an integer 0 … 2³²-1; the result depends on it and on nothing else
    sampling    random methods: "solid_angle" or "area" of the light; in shading also "bsdf" and "mis"
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import Scene
from shlight._arrays import checked_integer, checked_name, checked_tolerance
from shlight._load import load_native
from shlight._methods import refuse_options

load_native("shlight_tools._methods")

from shlight_tools import _methods  # noqa: E402

__all__ = ["coefficient_methods", "lobe_condition", "render_monte_carlo", "shading_methods"]

DEFAULT_SAMPLES = 256
SAMPLINGS = ("solid_angle", "area", "bsdf", "mis")


def coefficient_methods() -> dict[str, _methods.Method]:
    """The values of `method=` in sphere_, cap_ and polygon_coefficients by name, "exact" first."""
    return dict(_coefficient_methods())


def shading_methods() -> dict[str, _methods.ShadingMethod]:
    """The values of `method=` in shade_spheres and shade_polygons by name, except "auto"."""
    return dict(_shading_methods())


@functools.cache
def _coefficient_methods() -> dict[str, _methods.Method]:
    return {method.name: method for method in _methods.all_methods()}


@functools.cache
def _shading_methods() -> dict[str, _methods.ShadingMethod]:
    return {method.name: method for method in _methods.all_shading_methods()}


def lobe_condition(band: int) -> float:
    """The condition number of the zonal factorization of one band, 0 … 31, by which zhou_wei, snyder and
    wang_ramamoorthi multiply the errors of their integrals over lobes."""
    return _methods.lobe_condition(checked_integer("band", band, 0, 31))


def render_monte_carlo(
    scene: Scene,
    width: int,
    height: int,
    *,
    samples: int,
    seed: int = 0,
    threads: int = 0,
    progress: Callable[[float], object] | None = None,
) -> NDArray[np.float32]:
    """Render as shlight.render does, by plain Monte Carlo: unbiased and noisy.

    samples: 1 … 2²⁰ camera rays per pixel, through random points of its square. Where one meets a surface, each light
    gets a direction uniform in its solid angle, and one direction as the material reflects serves all lights, both
    weighed by the balance heuristic and followed by shadow rays.
    seed: 0 … 2³²-1; the image depends on it and not on threads. progress, result and errors: as of shlight.render.
    """
    return _methods.render_monte_carlo(scene, width, height, samples, seed, threads, progress)


def coefficient_function(name: str, method: Any, **options: Any) -> Callable[..., NDArray[Any]]:
    """shlight._methods.coefficient_function for these methods."""
    known = _coefficient_methods()
    found = known[checked_name("method", method, known)]
    takes = {"tolerance": found.adaptive, "samples": found.random, "seed": found.random, "sampling": found.random}
    checked = _options(method, takes, options, order=0, sampling="solid_angle")
    return functools.partial(getattr(_methods, name), method, checked)


def shading_function(
    name: str, method: Any, order: int, **options: Any
) -> Callable[..., tuple[NDArray[np.float32], NDArray[np.int32]]]:
    """shlight._methods.shading_function."""
    known = _shading_methods()
    found = known[checked_name("method", method, ("auto", *known))]
    takes = {"tolerance": True, "samples": found.sampled, "seed": found.random, "sampling": found.random}
    if found.harmonic and order == 0:
        raise ValueError(f"order must be 1 … 64 for method {method!r}")
    if order > 0 and not found.harmonic:
        raise ValueError(f"order does not apply to method {method!r}")
    return functools.partial(
        getattr(_methods, name), method, _options(method, takes, options, order=order, sampling="mis")
    )


def _options(
    method: str, takes: dict[str, bool], given: dict[str, Any], *, order: int, sampling: str
) -> _methods.MethodOptions:
    refuse_options(method, {name: value for name, value in given.items() if not takes[name]})
    chosen = {name: value for name, value in given.items() if value is not None}
    if "tolerance" in chosen:
        chosen["tolerance"] = checked_tolerance(chosen["tolerance"])
    if "samples" in chosen:
        chosen["samples"] = checked_integer("samples", chosen["samples"], 1, 2**24)
    if "seed" in chosen:
        chosen["seed"] = checked_integer("seed", chosen["seed"], 0, 2**32 - 1)
    if "sampling" in chosen:
        checked_name("sampling", chosen["sampling"], SAMPLINGS)
    defaults = {"tolerance": 0.0, "samples": DEFAULT_SAMPLES, "seed": 0, "sampling": sampling}
    return _methods.method_options(order=order, **{**defaults, **chosen})
