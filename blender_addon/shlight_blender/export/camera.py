# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera: what the image sees, from its kind, lens, aperture, sensor fit, shift and pixel aspect."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import shlight

from ..compat import LENS_IS_AT_NEAR_PLANE, panorama_settings
from ..frame import Frame
from ..names import name_of
from ..report import ExportError, ExportReport

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
    if lens.type == "ORTHO" and LENS_IS_AT_NEAR_PLANE:
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
    fitted_width, fitted_height = _fitted(lens, frame, render)
    size = MILLIMETRE * (lens.sensor_height if lens.sensor_fit == "VERTICAL" else lens.sensor_width)
    return size * fitted_width, size * fitted_height


def _fitted(lens: Any, frame: Frame, render: Any) -> tuple[float, float]:
    """Width and height of the whole picture in units of the side that the sensor is fitted to."""
    width, height = frame.full_width * render.pixel_aspect_x, frame.full_height * render.pixel_aspect_y
    horizontal = lens.sensor_fit == "HORIZONTAL" or (lens.sensor_fit == "AUTO" and width > height)
    return (1.0, height / width) if horizontal else (width / height, 1.0)


@dataclass(frozen=True)
class Eye:
    """One eye of a camera, or the camera of one view."""

    camera: Any
    to_world: Any  # 4 × 4
    shift_x: float


@dataclass(frozen=True)
class View:
    """How the camera sees the world.

    to_camera, 3 x 4: to x to the right, y up and z forward; of a panorama to Cycles' frame of it.
    pixel: the width of a pixel [m] one metre before the camera, or of all of an orthographic one's. That of a panorama
        is of one whose width is a whole turn.
    slope, offset: x/z slope[0] + offset[0] is -1 … 1 over the picture, and so is y/z; x and y where it is orthographic.
        Without meaning for a panorama.
    """

    to_camera: tuple[tuple[float, ...], ...]
    pixel: float
    slope: tuple[float, float]
    offset: tuple[float, float]
    orthographic: bool
    panoramic: bool = False


def set_camera(scene: shlight.Scene, eye: Eye, depsgraph: Any, frame: Frame, render: Any, report: ExportReport) -> View:
    """Gives `scene` the eye, looking at `frame`; ExportError for a camera of a kind that is not supported."""
    camera = eye.camera.evaluated_get(depsgraph)
    lens = camera.data
    place = f"Camera '{name_of(camera)}'"
    if lens.type not in {"PERSP", "ORTHO", "PANO"}:
        raise ExportError(
            f"{place}: {lens.type.lower()} cameras are not supported; use a perspective, orthographic or panoramic one"
        )
    to_world = np.array(eye.to_world, dtype=np.float64)
    scale = np.linalg.norm(to_world[:3, :3], axis=0)
    if not np.isfinite(to_world).all() or not scale.all():
        raise ExportError(f"{place}: its transform is not finite or has scale 0")
    to_world[:3, :3] /= scale  # a camera's scale means nothing
    aperture = aperture_of(lens, to_world, depsgraph)
    clips = float(lens.clip_start), float(lens.clip_end)
    if lens.type == "PANO":
        if render.use_multiview and lens.stereo.use_spherical_stereo:
            report.add(place, "spherical stereo is not supported; each eye sees all directions from one point")
        window = (
            frame.left / frame.full_width + eye.shift_x,
            frame.right / frame.full_width + eye.shift_x,
            frame.bottom / frame.full_height + float(lens.shift_y),
            frame.top / frame.full_height + float(lens.shift_y),
        )
        return set_panorama(scene, to_world, window, frame, clips, panorama_of(lens, frame, render), aperture)
    projection = _projection(eye, camera, depsgraph, frame, render)
    return set_projection(scene, to_world, projection, frame, clips, aperture, orthographic=lens.type == "ORTHO")


def set_projection(
    scene: shlight.Scene,
    to_world: Matrix,
    projection: Matrix,
    frame: Frame,
    clips: tuple[float, float],
    aperture: Mapping[str, Any] | None = None,
    *,
    orthographic: bool,
) -> View:
    """Gives `scene` a camera that sees what OpenGL would, through `frame`.

    to_world, projection: 4 x 4, without scale, and to normalized device coordinates. aperture: as of `aperture_of`;
    None: everything is in focus.
    """
    window = _window(projection, frame, orthographic=orthographic)
    near, far = clips
    scene.set_camera_window(
        to_world, *window, orthographic=orthographic, clip_start=near, clip_end=far, **(aperture or {})
    )
    rows = np.linalg.inv(to_world)[:3] * np.array([[1.0], [1.0], [-1.0]])
    offset = projection[:2, 3] if orthographic else -projection[:2, 2]
    slope = float(projection[0, 0]), float(projection[1, 1])
    pixel = min(2.0 / (slope[0] * frame.full_width), 2.0 / (slope[1] * frame.full_height))
    return View(_plain(rows), pixel, slope, (float(offset[0]), float(offset[1])), orthographic)


def set_panorama(
    scene: shlight.Scene,
    to_world: Matrix,
    window: Sequence[float],
    frame: Frame,
    clips: tuple[float, float],
    panorama: Mapping[str, Any] | None,
    aperture: Mapping[str, Any],
) -> View:
    """Gives `scene` a camera whose picture is no plane; ExportError without a panorama.

    to_world: 4 x 4, without scale. window: left, right, bottom and top, in shares of the whole panorama, of frame.
    panorama, aperture: as of `panorama_of` and `aperture_of`.
    """
    if panorama is None:
        raise ExportError("the camera's type of panorama is not supported; choose another Panorama Type")
    sides: dict[str, Any] = dict(zip(("left", "right", "bottom", "top"), window, strict=True))
    scene.set_panorama_camera(to_world, clip_start=clips[0], clip_end=clips[1], **sides, **panorama, **aperture)
    right, up, back = np.linalg.inv(to_world)[:3]
    rows = (right, back, up) if panorama["panorama_type"] == "mirrorball" else (-back, -right, up)
    pixel = 2.0 * math.pi * (window[1] - window[0]) / max(frame.width, 1)
    return View(_plain(rows), pixel, (0.0, 0.0), (0.0, 0.0), orthographic=False, panoramic=True)


def matrix_of_camera(camera: Any, depsgraph: Any, frame: Frame, render: Any) -> Any:
    """The projection matrix of an evaluated camera to normalized device coordinates of the whole picture."""
    size = {"x": frame.full_width, "y": frame.full_height}
    return camera.calc_matrix_camera(depsgraph, scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y, **size)


def _projection(eye: Eye, camera: Any, depsgraph: Any, frame: Frame, render: Any) -> Matrix:
    """The projection matrix of one eye.

    The eye's shift is added to the matrix of the camera: Blender refuses to write to the camera, and to its evaluated
    copy, in any thread as long as another thread draws a panel.
    """
    lens = camera.data
    projection = np.array(matrix_of_camera(camera, depsgraph, frame, render), dtype=np.float64)
    column, sign = (3, -1.0) if lens.type == "ORTHO" else (2, 1.0)  # as in _window
    fitted_width, _ = _fitted(lens, frame, render)
    projection[0, column] += sign * 2.0 * (eye.shift_x - lens.shift_x) / fitted_width
    return projection


def _plain(rows: Any) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(row) for row in np.array(rows).tolist())


def _window(projection: Matrix, frame: Frame, *, orthographic: bool) -> tuple[float, float, float, float]:
    """(left, right, bottom, top) of `frame` on the plane z = -1 of the camera, or in metres if it is orthographic."""
    # Normalized coordinates are (P00 x + P02 z) / -z, or P00 x + P03 for the orthographic camera; same for y.
    column = 3 if orthographic else 2
    sign = -1.0 if orthographic else 1.0

    def window(axis: int, pixel: int, size: int) -> float:
        normalized = 2.0 * pixel / size - 1.0
        return float((normalized + sign * projection[axis, column]) / projection[axis, axis])

    width, height = frame.full_width, frame.full_height
    left, right = (window(0, pixel, width) for pixel in (frame.left, frame.right))
    bottom, top = (window(1, pixel, height) for pixel in (frame.bottom, frame.top))
    return left, right, bottom, top
