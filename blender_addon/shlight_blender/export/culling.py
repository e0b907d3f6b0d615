# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplify's culling: objects that Cycles leaves out of final renders, beside the camera's view or far from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .camera import View

Points = NDArray[np.float64]


@dataclass(frozen=True)
class Culling:
    """Tells what Cycles leaves out by the corners of its bounding box; a render border changes nothing of it."""

    view: View
    clips: tuple[float, float]
    margin: float | None  # beside the picture, as a share of it; None: nothing is left out for that
    distance: float | None  # [m] from the camera; likewise

    def leaves_out(self, shown: Any, to_world: Points) -> bool:
        """Whether an object of the depsgraph is left out at `to_world`: for all reasons that are asked of it."""
        own = shown.cycles
        beside = self.margin is not None and own.use_camera_cull
        far = self.distance is not None and own.use_distance_cull
        if not beside and not far:
            return False
        corners = np.array(shown.bound_box) @ to_world[:3, :3].T + to_world[:3, 3]
        return not (beside and self._is_near_picture(corners)) and not (far and self._is_near_camera(corners))

    def _is_near_picture(self, corners: Points) -> bool:
        """Corners before the near plane count as on the other side of the picture, as in Cycles."""
        margin, (near, far) = self.margin or 0.0, self.clips
        to_camera = np.array(self.view.to_camera)
        x, y, z = (corners @ to_camera[:, :3].T + to_camera[:, 3]).T
        divisor = 1.0 if self.view.orthographic else z
        depth = (z - near) / (far - near) * (1.0 if self.view.orthographic else far)
        if (depth < -margin).all():
            return False
        place = np.stack([x, y], axis=-1) * self.view.slope / np.reshape(divisor, (-1, 1)) + self.view.offset
        shares = 0.5 + np.where(depth[:, None] < 0.0, -0.5, 0.5) * place
        return bool((shares.min(axis=0) < 1.0 + margin).all() and (shares.max(axis=0) > -margin).all())

    def _is_near_camera(self, corners: Points) -> bool:
        to_camera = np.array(self.view.to_camera)
        camera = -to_camera[:, :3].T @ to_camera[:, 3]
        nearest = np.clip(camera, corners.min(axis=0), corners.max(axis=0))
        return bool(np.linalg.norm(camera - nearest) <= (self.distance or 0.0))


def culling_of(scene: Any, lens: Any, view: View) -> Culling | None:
    """The culling of a scene seen by a camera; None: there is none, as for panoramas and several views."""
    cycles = getattr(scene, "cycles", None)  # its add-on may be off
    if cycles is None or not scene.render.use_simplify or view.panoramic or scene.render.use_multiview:
        return None
    margin = float(cycles.camera_cull_margin) if cycles.use_camera_cull else None
    distance = (float(cycles.distance_cull_margin) or None) if cycles.use_distance_cull else None
    if margin is None and distance is None:
        return None
    return Culling(view, (float(lens.clip_start), float(lens.clip_end)), margin, distance)
