# SPDX-License-Identifier: MIT
"""Noise-free direct light from area lights with spherical harmonics.

Coefficients are real, orthonormal, without Condon–Shortley phase, stored at index l² + l + m; an order n means the
bands l = 0 … n-1. Lights and materials are given in the shading frame: the shading point is the origin, z the surface
normal. Scenes are given in the world frame, in metres; radiance is linear RGB [W m⁻² sr⁻¹].
"""

from shlight._load import load_native

load_native("shlight._core")

from shlight import _core, images  # noqa: E402
from shlight._calls import explain_methods, explained  # noqa: E402
from shlight._core import (  # noqa: E402
    DEFAULT_TOLERANCE,
    Bsdf,
    RenderCancelled,
    RenderReport,
    Scene,
    SceneMesh,
)
from shlight.coefficients import (  # noqa: E402
    cap_coefficients,
    disk_coefficients,
    evaluate,
    polygon_coefficients,
    sh_basis,
    shade,
    sphere_coefficients,
)
from shlight.denoising import denoise, has_denoiser  # noqa: E402
from shlight.queries import Hits  # noqa: E402
from shlight.shading import shade_disks, shade_polygons, shade_spheres  # noqa: E402

render = explained(_core.render)
for _kind in (Bsdf, Scene, SceneMesh):
    explain_methods(_kind)

__version__ = "0.1.0"

__all__ = [
    "DEFAULT_TOLERANCE",
    "Bsdf",
    "Hits",
    "RenderCancelled",
    "RenderReport",
    "Scene",
    "SceneMesh",
    "cap_coefficients",
    "denoise",
    "disk_coefficients",
    "evaluate",
    "has_denoiser",
    "images",
    "polygon_coefficients",
    "render",
    "sh_basis",
    "shade",
    "shade_disks",
    "shade_polygons",
    "shade_spheres",
    "sphere_coefficients",
]
