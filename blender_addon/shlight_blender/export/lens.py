# SPDX-License-Identifier: GPL-3.0-or-later
"""Lens of a camera: its aperture and what is in focus, and the panorama that it shows, as Cycles reads them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import CAMERAS, panorama_settings
from ..frame import Frame

Matrix = NDArray[np.float64]

MILLIMETRE = 1e-3
# Least values in Cycles, which replace smaller ones.
LEAST_F_STOP = 1e-5
LEAST_FOCUS_DISTANCE = 1e-5


def aperture_of(lens: Any, to_world: Matrix, depsgraph: Any) -> dict[str, float]:
    """Arguments of `Scene.set_camera_window` for the depth of field of a camera's evaluated data; none without it."""
    dof = lens.dof
    if not dof.use_dof:
        return {}
    length = 1.0 if lens.type == "ORTHO" else MILLIMETRE * lens.lens
    size = 0.5 * length / max(dof.aperture_fstop, LEAST_F_STOP)
    focus_distance = max(_focus_distance(dof, to_world, depsgraph), LEAST_FOCUS_DISTANCE)
    if lens.type == "ORTHO" and CAMERAS.lens_is_at_near_plane:
        # The lens in the camera's own plane through which the same rays go.
        size *= (focus_distance + lens.clip_start) / focus_distance
        focus_distance += lens.clip_start
    return {
        "aperture_size": size,
        "focus_distance": focus_distance,
        "aperture_blades": dof.aperture_blades,
        "aperture_rotation": dof.aperture_rotation,
        "aperture_ratio": dof.aperture_ratio,
    }


def _focus_distance(dof: Any, to_world: Matrix, depsgraph: Any) -> float:
    if dof.focus_object is None:
        return float(dof.focus_distance)
    focused = dof.focus_object.evaluated_get(depsgraph)
    place = np.array(focused.matrix_world, dtype=np.float64)
    bone = focused.pose.bones.get(dof.focus_subtarget) if focused.pose else None
    if bone is not None:
        place = place @ np.array(bone.matrix)
    return abs(float(to_world[:3, 2] @ (to_world[:3, 3] - place[:3, 3])))


def panorama_of(lens: Any, frame: Frame, render: Any) -> dict[str, Any] | None:
    """Arguments of `Scene.set_panorama_camera` for a camera's data; None for a type that is not supported."""
    settings = panorama_settings(lens)
    kind = str(settings.panorama_type)
    arguments: dict[str, Any] = {}
    if kind == "EQUIRECTANGULAR":
        names = ("longitude_min", "longitude_max", "latitude_min", "latitude_max")
        arguments["equirectangular_range"] = [getattr(settings, name) for name in names]
    elif kind == "CENTRAL_CYLINDRICAL":
        scales = {"u_min": 1.0, "u_max": 1.0, "v_min": settings.central_cylindrical_radius}
        scales["v_max"] = scales["v_min"]
        arguments["central_cylindrical_range"] = [
            getattr(settings, f"central_cylindrical_range_{name}") / scale for name, scale in scales.items()
        ]
    elif kind.startswith("FISHEYE"):
        arguments["fisheye_fov"] = settings.fisheye_fov
        arguments["fisheye_lens"] = MILLIMETRE * settings.fisheye_lens
        arguments["fisheye_polynomial"] = [
            getattr(settings, f"fisheye_polynomial_k{i}") / MILLIMETRE**i for i in range(5)
        ]
        arguments["sensor_width"], arguments["sensor_height"] = _sensor(lens, frame, render)
    elif kind not in {"MIRRORBALL", "EQUIANGULAR_CUBEMAP_FACE"}:
        return None
    return {"panorama_type": kind.lower(), **arguments}


def _sensor(lens: Any, frame: Frame, render: Any) -> tuple[float, float]:
    """The size of the sensor's part that the whole picture covers [m], with the picture's proportions."""
    width, height = frame.full_width * render.pixel_aspect_x, frame.full_height * render.pixel_aspect_y
    horizontal = lens.sensor_fit == "HORIZONTAL" or (lens.sensor_fit == "AUTO" and width > height)
    size = MILLIMETRE * (lens.sensor_height if lens.sensor_fit == "VERTICAL" else lens.sensor_width)
    return (size, size * height / width) if horizontal else (size * width / height, size)
