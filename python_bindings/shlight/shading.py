# SPDX-License-Identifier: MIT
"""Materials lit by area lights: Eq. 5 of Zhou & Wei 2020 without the detour over coefficients.

Glossy lobes are spherical harmonics in a warp of the sphere that makes them broad, against light that is warped with
them, exactly (docs/theory.md, 6); small lights and views that few bands do not describe are integrated by cubature of
the true f·cos, and a roughness of 0 shows the light's own image. Nothing here is random.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shlight import _core
from shlight._arrays import (
    CORE_AXES,
    Floats,
    all_rows,
    broadcast,
    check_finite,
    checked_array,
    checked_flag,
    checked_name,
    checked_order,
    checked_threads,
    checked_tolerance,
    checked_vectors,
    given_type,
    rows,
)
from shlight._calls import names_rows
from shlight._core import DEFAULT_TOLERANCE, Bsdf
from shlight._methods import is_own, refuse_options, shading_function
from shlight.bsdfs import Bsdfs, lobes_of_rows
from shlight.gradients import PolygonGradient, SphereGradient

_MAX_AXES = 32  # of numpy's arrays before its version 2

Radiance = NDArray[np.float32]
Effort = NDArray[np.int32]
_NO_COLORS, _NO_ALPHAS = np.zeros((0, 0, 3), np.float32), np.zeros((0, 0), np.float32)

Sampling = Literal["solid_angle", "area", "bsdf", "mis"]


class _Settings(TypedDict, total=False):
    """Keywords of every function here, for the overloads, which differ in the result only."""

    phi_o: ArrayLike | None
    order: int | Literal["auto"]
    tolerance: float
    threads: int
    method: str


class _MethodSettings(_Settings, total=False):
    """Settings of lights that other methods support too."""

    samples: int | None
    seed: int | None
    sampling: Sampling | None


@overload
def shade_spheres(
    centers: ArrayLike,
    radii: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[False] = ...,
    gradient: Literal[False] = ...,
    **settings: Unpack[_MethodSettings],
) -> Radiance: ...
@overload
def shade_spheres(
    centers: ArrayLike,
    radii: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[True],
    gradient: Literal[False] = ...,
    **settings: Unpack[_MethodSettings],
) -> tuple[Radiance, Effort]: ...
@overload
def shade_spheres(
    centers: ArrayLike,
    radii: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[False] = ...,
    gradient: Literal[True, "places"],
    **settings: Unpack[_MethodSettings],
) -> tuple[Radiance, SphereGradient]: ...
@overload
def shade_spheres(
    centers: ArrayLike,
    radii: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[True],
    gradient: Literal[True, "places"],
    **settings: Unpack[_MethodSettings],
) -> tuple[Radiance, Effort, SphereGradient]: ...
@names_rows
def shade_spheres(
    centers: ArrayLike,
    radii: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    phi_o: ArrayLike | None = None,
    order: int | Literal["auto"] = "auto",
    tolerance: float = DEFAULT_TOLERANCE,
    threads: int = 0,
    method: str = "auto",
    samples: int | None = None,
    seed: int | None = None,
    sampling: Sampling | None = None,
    return_effort: bool = False,
    gradient: bool | Literal["places"] = False,
) -> Any:
    """Radiance reflected of sphere lights of unit radiance towards ω_o = (sinθ_o, 0, cosθ_o), clipped by the horizon.

    centers: (..., 3), radii: (...), in the shading frame, any unit of length; 0 < radius ≤ |center|.
    bsdf: one material, or Bsdfs, whose leading axes broadcast with those of the lights; method must then be "auto".
    cos_theta_o: (...), in [0, 1]. Leading axes broadcast; lights that share a view should be neighbours along the last.
    phi_o: (...), azimuth of the view [rad] in the frame of the lights, whose x is then the surface's tangent:
    ω_o = (sinθ_o cosφ_o, sinθ_o sinφ_o, cosθ_o); None: 0. Only anisotropic materials reflect another radiance for
    lights that turn with the view.
    order: "auto" for whatever meets the tolerance, or 1 … 64 for harmonics of that order.
    tolerance: of the radiance ÷ the material's albedo at that view, in each colour channel.
    method: "auto", or where shlight_tools is built one of its methods.shading_methods(), with its options; those of a
    fixed size ignore the tolerance.

    Returns (..., 3), float32. With return_effort also (...), int32: per light the largest order, or number of values
    of f·cos, that a lobe of the material took; 0 where a light is hidden or mirrored.
    With gradient also a SphereGradient, of the arrays' type: the exact derivatives of the reflected radiance, whatever
    the tolerance of the radiance returned. Where a lamp at the horizon adds little, differences of that radiance err
    by up to 40 % of the derivative at the default tolerance, and by 0.3 % at 1e-5. Derivatives of mirrors are 0; method
    and order must then be "auto". With gradient "places" those by roughness are left out, which take most of the time.

    >>> metal = shlight.Bsdf.ggx(0.3, (1.0, 0.8, 0.3))
    >>> shlight.shade_spheres([[-0.8, 0, 1.0], [0, 0, 2]], 0.2, metal, cos_theta_o=0.8).round(3)
    array([[0.475, 0.38 , 0.143],
           [0.002, 0.002, 0.001]], dtype=float32)
    """
    options: dict[str, Any] = {"samples": samples, "seed": seed, "sampling": sampling}
    settings = (phi_o, order, tolerance, threads, method, return_effort, gradient)
    return _shaded("shade_spheres", {"centers": centers, "radii": radii}, bsdf, cos_theta_o, *settings, **options)


@overload
def shade_polygons(
    vertices: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[False] = ...,
    gradient: Literal[False] = ...,
    **settings: Unpack[_MethodSettings],
) -> Radiance: ...
@overload
def shade_polygons(
    vertices: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[True],
    gradient: Literal[False] = ...,
    **settings: Unpack[_MethodSettings],
) -> tuple[Radiance, Effort]: ...
@overload
def shade_polygons(
    vertices: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[False] = ...,
    gradient: Literal[True, "places"],
    **settings: Unpack[_MethodSettings],
) -> tuple[Radiance, PolygonGradient]: ...
@overload
def shade_polygons(
    vertices: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[True],
    gradient: Literal[True, "places"],
    **settings: Unpack[_MethodSettings],
) -> tuple[Radiance, Effort, PolygonGradient]: ...
@names_rows
def shade_polygons(
    vertices: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    phi_o: ArrayLike | None = None,
    order: int | Literal["auto"] = "auto",
    tolerance: float = DEFAULT_TOLERANCE,
    threads: int = 0,
    method: str = "auto",
    samples: int | None = None,
    seed: int | None = None,
    sampling: Sampling | None = None,
    return_effort: bool = False,
    gradient: bool | Literal["places"] = False,
) -> Any:
    """Like shade_spheres, for planar polygons.

    vertices: (..., k, 3) with k ≥ 3, in the shading frame, in either winding: the region counts. A polygon without area
    or seen edge-on gives zeros. ValueError for vertices that are not planar and for a shading point in the polygon.
    gradient: a PolygonGradient, of the region within the outline; moved vertices need not stay in one plane.

    >>> panel = [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
    >>> shlight.shade_polygons(panel, shlight.Bsdf.lambert(0.8), cos_theta_o=0.5).round(3)
    array([0.443, 0.443, 0.443], dtype=float32)
    """
    options: dict[str, Any] = {"samples": samples, "seed": seed, "sampling": sampling}
    settings = (phi_o, order, tolerance, threads, method, return_effort, gradient)
    return _shaded("shade_polygons", {"vertices": vertices}, bsdf, cos_theta_o, *settings, **options)


@overload
def shade_disks(
    centers: ArrayLike,
    half_axes_u: ArrayLike,
    half_axes_v: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[False] = ...,
    **settings: Unpack[_Settings],
) -> Radiance: ...
@overload
def shade_disks(
    centers: ArrayLike,
    half_axes_u: ArrayLike,
    half_axes_v: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    return_effort: Literal[True],
    **settings: Unpack[_Settings],
) -> tuple[Radiance, Effort]: ...
@names_rows
def shade_disks(
    centers: ArrayLike,
    half_axes_u: ArrayLike,
    half_axes_v: ArrayLike,
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    *,
    phi_o: ArrayLike | None = None,
    order: int | Literal["auto"] = "auto",
    tolerance: float = DEFAULT_TOLERANCE,
    threads: int = 0,
    method: str = "auto",
    return_effort: bool = False,
) -> Radiance | tuple[Radiance, Effort]:
    """Like shade_spheres, for disks and ellipses.

    centers, half_axes_u, half_axes_v: (..., 3), in the shading frame, as of disk_coefficients: the points
    centre + a u + b v with a² + b² ≤ 1, seen from either side. A disk seen edge-on gives zeros.
    What a lobe reflects is that of a polygon of as many sides as it takes to keep a coefficient within about 1e-4 of
    L_00, or the tolerance if that is less (docs/theory.md, 5.5).
    method: "auto" only; the others know no disks.

    >>> shlight.shade_disks([0, 0, 1], [1, 0, 0], [0, 1, 0], shlight.Bsdf.lambert(0.8), cos_theta_o=0.5).round(3)
    array([0.4, 0.4, 0.4], dtype=float32)
    """
    checked_name("method", method, ("auto",))
    lights = {"centers": centers, "half_axes_u": half_axes_u, "half_axes_v": half_axes_v}
    settings = (phi_o, order, tolerance, threads, method, return_effort)
    return _shaded("shade_disks", lights, bsdf, cos_theta_o, *settings)


_GRADIENTS: dict[str, Callable[..., SphereGradient | PolygonGradient]] = {
    "shade_spheres": SphereGradient,
    "shade_polygons": PolygonGradient,
}


def _shaded(
    name: str,
    lights: dict[str, ArrayLike],
    bsdf: Bsdf | Bsdfs,
    cos_theta_o: ArrayLike,
    phi_o: ArrayLike | None,
    order: int | Literal["auto"],
    tolerance: float,
    threads: int,
    method: str,
    return_effort: bool,
    gradient: bool | Literal["places"] = False,
    **options: Any,
) -> Any:
    """The result of the function `name`, whose first arguments are the lights. `options` are those of other methods."""
    bsdf, wanted = _checked_material(bsdf), checked_flag("return_effort", return_effort)
    derived = _checked_gradient(gradient, bsdf, order, method)
    own = is_own("auto", method)
    arrays, shapes = checked_vectors(given_type(*lights.values()) if own else np.float64, **lights)
    cosines = checked_array("cos_theta_o", cos_theta_o, np.float64)
    phi = _checked_azimuths(phi_o, bsdf, method)
    shapes |= {"bsdf": bsdf.shape if isinstance(bsdf, Bsdfs) else (), "cos_theta_o": cosines.shape, "phi_o": phi.shape}
    axes = [CORE_AXES[argument] for argument in arrays]
    shape = _broadcast_with(1 + max(axes) if derived else 0, shapes)
    turned = {argument: _seen_by(phi, array, CORE_AXES[argument]) for argument, array in arrays.items()}
    flat_lights, cores = all_rows(turned, shape), checked_threads(threads)
    if own:
        refuse_options(method, options)
        seen = _material_and_views(bsdf, cosines, phi, shape)
        flat = getattr(_core, name)(*flat_lights, *seen, _order(order), checked_tolerance(tolerance), cores, wanted)
    else:
        shade = shading_function(name, method, _order(order), tolerance=tolerance, **options)
        flat = shade(*flat_lights, bsdf, rows(cosines.astype(np.float64), shape), cores)
    radiance, effort = flat
    results = [radiance.reshape(*shape, 3), *([effort.reshape(shape)[()]] if wanted else [])]
    if derived:
        *moved, rough = getattr(_core, f"{name}_gradient")(*flat_lights, *seen[:3], derived == "all", cores)
        parts = []
        for part, array, count in zip(moved, arrays.values(), axes, strict=True):
            by_rgb = part.reshape(*shape, 3, *array.shape[array.ndim - count :])
            parts.append(_seen_by(-phi, by_rgb, count + 1 if count else 0))
        results.append(_GRADIENTS[name](*parts, rough.reshape(*shape, rough.shape[-1])))
    return tuple(results) if len(results) > 1 else results[0]


def _checked_material(bsdf: Any) -> Bsdf | Bsdfs:
    if not isinstance(bsdf, Bsdf | Bsdfs):
        raise TypeError(f"bsdf must be a Bsdf or Bsdfs, got {type(bsdf).__name__}")
    return bsdf


def _checked_azimuths(phi_o: ArrayLike | None, bsdf: Bsdf | Bsdfs, method: str) -> Floats:
    if isinstance(bsdf, Bsdfs) and method != "auto":
        raise ValueError(f"method must be 'auto' for Bsdfs, got {method!r}")
    if bsdf.is_anisotropic and method != "auto":
        raise ValueError(f"method must be 'auto' for an anisotropic bsdf, got {method!r}")
    phi = np.zeros(()) if phi_o is None else checked_array("phi_o", phi_o, np.float64)
    check_finite("phi_o", phi)
    return phi


def _seen_by(phi: Floats, arrays: Floats, axes: int) -> Floats:
    """Vectors in the frame whose x is that of the view. axes: behind those of views; 0: numbers, which stay."""
    if axes == 0 or not phi.any():
        return arrays
    phi = phi[(..., *[None] * (axes - 1))]
    c, s = np.cos(phi), np.sin(phi)
    x, y, z = np.moveaxis(arrays, -1, 0)
    with np.errstate(over="ignore", invalid="ignore"):  # the core says which row is too large or not finite
        turned = np.broadcast_arrays(c * x + s * y, c * y - s * x, z)
    return np.stack(turned, axis=-1).astype(arrays.dtype)


def _material_and_views(
    bsdf: Bsdf | Bsdfs, cosines: Floats, phi: Floats, shape: tuple[int, ...]
) -> tuple[Bsdf, Floats, Floats, Floats, Floats]:
    """Lobes, cosines and azimuths of views, one for each light or one for all, and what Bsdfs have for each light."""
    known = phi if bsdf.is_anisotropic else np.zeros(())
    views = _one_or_all(cosines, shape), _one_or_all(known, shape)
    if isinstance(bsdf, Bsdf):
        return bsdf, *views, _NO_COLORS, _NO_ALPHAS
    lobes, colors, alphas = lobes_of_rows(bsdf, shape)
    return lobes, *views, colors, alphas


def _one_or_all(values: Floats, shape: tuple[int, ...]) -> Floats:
    return values.reshape(1) if values.size == 1 else rows(values, shape)


def _order(order: int | Literal["auto"]) -> int:
    return 0 if isinstance(order, str) and order == "auto" else checked_order(order)


def _broadcast_with(added: int, shapes: dict[str, tuple[int, ...]]) -> tuple[int, ...]:
    """The shape that these broadcast to, which bears so many axes more."""
    shape = broadcast(**shapes)
    if len(shape) + added > _MAX_AXES:
        raise ValueError(f"{max(shapes, key=lambda name: len(shapes[name]))} has too many leading axes for a gradient")
    return shape


def _checked_gradient(
    gradient: bool | Literal["places"], bsdf: Bsdf | Bsdfs, order: int | Literal["auto"], method: str
) -> Literal["", "places", "all"]:
    """Which derivatives are wanted."""
    if not isinstance(gradient, str) and not checked_flag("gradient", gradient):
        return ""
    if isinstance(bsdf, Bsdfs):
        raise ValueError("bsdf must be one Bsdf with gradient, got Bsdfs")
    for name, value in (("order", order), ("method", method)):
        if not (isinstance(value, str) and value == "auto"):
            raise ValueError(f"{name} must be 'auto' with gradient")
    if not isinstance(gradient, str):
        return "all"
    checked_name("gradient", gradient, ("places",))
    return "places"
