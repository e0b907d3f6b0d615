# SPDX-License-Identifier: MIT
"""Noise-free direct light from area lights with spherical harmonics.

Coefficients are real, orthonormal, without Condon–Shortley phase, stored at index l² + l + m; an order n means the
bands l = 0 … n-1. Lights and materials are given in the shading frame: the shading point is the origin, z the surface
normal. Scenes are given in the world frame, in metres; radiance is linear RGB [W m⁻² sr⁻¹].
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from shlight._load import load_native

load_native("shlight._core")

from shlight import images, metrics  # noqa: E402
from shlight._calls import explain_methods  # noqa: E402
from shlight._core import (  # noqa: E402
    DEFAULT_TOLERANCE,
    Bsdf,
    KeptLight,
    Light,
    RenderCancelled,
    RenderReport,
    Scene,
    SceneMesh,
    View,
)
from shlight.bsdfs import Bsdfs  # noqa: E402
from shlight.cameras import look_at  # noqa: E402
from shlight.coefficients import (  # noqa: E402
    cap_coefficients,
    contract,
    disk_coefficients,
    evaluate,
    polygon_coefficients,
    sh_basis,
    sphere_coefficients,
)
from shlight.coefficients import shade as shade  # noqa: E402  the deprecated name of contract
from shlight.denoising import denoise, has_denoiser  # noqa: E402
from shlight.gradients import CoefficientGradient, PolygonGradient, SphereGradient  # noqa: E402
from shlight.photometry import luminous  # noqa: E402
from shlight.queries import Hits, shading_frames  # noqa: E402
from shlight.rendering import RenderResult, render  # noqa: E402
from shlight.shading import shade_disks, shade_polygons, shade_spheres  # noqa: E402

for _kind in (Bsdf, KeptLight, Light, Scene, SceneMesh, View):
    explain_methods(_kind)

if TYPE_CHECKING:
    from shlight import nodes
    from shlight.models import load


def __getattr__(name: str) -> Any:
    """Modules that take long to import, and that not every user of the package wants."""
    if name == "nodes":
        return importlib.import_module("shlight.nodes")
    if name == "load":
        return importlib.import_module("shlight.models").load
    raise AttributeError(f"module 'shlight' has no attribute {name!r}")


def __dir__() -> list[str]:
    """The names that users call; the modules that the package is made of stay out of completion."""
    return [*__all__, "__doc__", "__version__"]


__version__ = "0.1.0"

__all__ = [
    "DEFAULT_TOLERANCE",
    "Bsdf",
    "Bsdfs",
    "CoefficientGradient",
    "Hits",
    "KeptLight",
    "Light",
    "PolygonGradient",
    "RenderCancelled",
    "RenderReport",
    "RenderResult",
    "Scene",
    "SceneMesh",
    "SphereGradient",
    "View",
    "cap_coefficients",
    "contract",
    "denoise",
    "disk_coefficients",
    "evaluate",
    "has_denoiser",
    "images",
    "load",
    "look_at",
    "luminous",
    "metrics",
    "nodes",
    "polygon_coefficients",
    "render",
    "sh_basis",
    "shade_disks",
    "shade_polygons",
    "shade_spheres",
    "shading_frames",
    "sphere_coefficients",
]
