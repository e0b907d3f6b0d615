# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera: the rectangle that the image sees, from lens, sensor fit, shift and pixel aspect."""

from __future__ import annotations

from typing import Any

import numpy as np

import shlight

from ..frame import Frame
from ..report import ExportError, ExportReport


def set_camera(
    scene: shlight.Scene, camera: Any, depsgraph: Any, frame: Frame, render: Any, report: ExportReport
) -> None:
    """Gives `scene` the evaluated object `camera`, looking at `frame`; ExportError for one without a picture plane."""
    lens = camera.data
    place = f"Camera '{camera.name}'"
    if lens.type not in {"PERSP", "ORTHO"}:
        raise ExportError(
            f"{place}: {lens.type.lower()} cameras are not supported; use a perspective or orthographic one"
        )
    if lens.dof.use_dof:
        report.add(place, "depth of field is not supported; everything is in focus")
    to_world = np.array(camera.matrix_world, dtype=np.float64)
    scale = np.linalg.norm(to_world[:3, :3], axis=0)
    if not np.isfinite(to_world).all() or not scale.all():
        raise ExportError(f"{place}: its transform is not finite or has scale 0")
    to_world[:3, :3] /= scale  # a camera's scale means nothing
    left, right, bottom, top = camera_window(camera, depsgraph, frame, render)
    scene.set_camera_window(
        to_world,
        left,
        right,
        bottom,
        top,
        orthographic=lens.type == "ORTHO",
        clip_start=float(lens.clip_start),
        clip_end=float(lens.clip_end),
    )


def camera_window(camera: Any, depsgraph: Any, frame: Frame, render: Any) -> tuple[float, float, float, float]:
    """(left, right, bottom, top) of `frame` on the plane z = -1 of the camera, or in metres if it is orthographic."""
    projection = np.array(
        camera.calc_matrix_camera(
            depsgraph,
            x=frame.full_width,
            y=frame.full_height,
            scale_x=render.pixel_aspect_x,
            scale_y=render.pixel_aspect_y,
        ),
        dtype=np.float64,
    )
    # Normalized coordinates are (P00 x + P02 z) / -z, or P00 x + P03 for the orthographic camera; same for y.
    column = 3 if camera.data.type == "ORTHO" else 2
    sign = -1.0 if camera.data.type == "ORTHO" else 1.0

    def window(axis: int, pixel: int, size: int) -> float:
        normalized = 2.0 * pixel / size - 1.0
        return float((normalized + sign * projection[axis, column]) / projection[axis, axis])

    return (
        window(0, frame.left, frame.full_width),
        window(0, frame.right, frame.full_width),
        window(1, frame.bottom, frame.full_height),
        window(1, frame.top, frame.full_height),
    )
