# SPDX-License-Identifier: GPL-3.0-or-later
"""What of the picture objects can cover: those that Cycles culls, and how much of it a thing can change at most."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import lamp_tint, slot_materials
from ..frame import Frame
from ..names import name_of
from .camera import View

Array = NDArray[np.float64]


def _moved(points: Array, matrix: Array) -> Array:
    """Points (..., 3) in another frame; matrix: its first three rows, at least."""
    return points @ matrix[:3, :3].T + matrix[:3, 3]


@dataclass(frozen=True)
class Culling:
    """Tells what Cycles leaves out by the corners of its bounding box; a render border changes nothing of it."""

    view: View
    clips: tuple[float, float]
    margin: float | None  # beside the picture, as a share of it; None: nothing is left out for that
    distance: float | None  # [m] from the camera; likewise

    def leaves_out(self, shown: Any, to_world: Array) -> bool:
        """Whether an object of the depsgraph is left out at `to_world`: for all reasons that are asked of it."""
        own = shown.cycles
        beside = self.margin is not None and own.use_camera_cull
        far = self.distance is not None and own.use_distance_cull
        if not beside and not far:
            return False
        corners = _moved(np.array(shown.bound_box), to_world)
        return not (beside and self._is_near_picture(corners)) and not (far and self._is_near_camera(corners))

    def _is_near_picture(self, corners: Array) -> bool:
        """Corners before the near plane count as on the other side of the picture, as in Cycles."""
        margin, (near, far) = self.margin or 0.0, self.clips
        x, y, z = _moved(corners, np.array(self.view.to_camera)).T
        divisor = 1.0 if self.view.orthographic else z
        depth = (z - near) / (far - near) * (1.0 if self.view.orthographic else far)
        if (depth < -margin).all():
            return False
        place = np.stack([x, y], axis=-1) * self.view.slope / np.reshape(divisor, (-1, 1)) + self.view.offset
        shares = 0.5 + np.where(depth[:, None] < 0.0, -0.5, 0.5) * place
        return bool((shares.min(axis=0) < 1.0 + margin).all() and (shares.max(axis=0) > -margin).all())

    def _is_near_camera(self, corners: Array) -> bool:
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


NEAREST = 1e-4  # distance from the camera's plane beyond which things are projected
PAIRS = np.triu_indices(8, 1)  # of the corners of a box


def shares_of_picture(depsgraph: Any, view: View, frame: Frame, wanted: Container[str]) -> dict[str, float]:
    """What is known of the wanted things, by their names in the report, as "Object 'Cube'"; 1 is all of the picture.

    An object covers no more than the rectangle around its bounding box, and a material what the objects cover that have
    it; what hides them does not count. A lamp has its share of the power of all but suns.
    """
    power: defaultdict[str, float] = defaultdict(float)
    boxes, owners = [], []
    for instance in depsgraph.object_instances:
        shown = instance.object
        if shown.type == "LIGHT":
            if shown.data.type != "SUN":
                power[f"Light '{name_of(shown)}'"] += abs(
                    float(shown.data.energy) * float(lamp_tint(shown.data).mean())
                )
            continue
        names = {
            f"Object '{name_of(shown)}'",
            *(f"Material '{name_of(each)}'" for each in slot_materials(shown) if each),
        }
        owned = [name for name in names if name in wanted]
        if owned and instance.show_self:
            boxes.append(_moved(np.array(shown.bound_box), np.array(instance.matrix_world)))
            owners.append(owned)
    total = sum(power.values())
    shares = {name: own / total for name, own in power.items()} if 0.0 < total < np.inf else {}
    covered: defaultdict[str, float] = defaultdict(float)
    for owned, share in zip(owners, _covered(np.reshape(boxes, (-1, 8, 3)), view, frame), strict=True):
        for name in owned:
            covered[name] += float(share)
    return shares | covered


def _covered(boxes: Array, view: View, frame: Frame) -> Array:
    """The shares of the frame covered by rectangles around boxes with corners (n, 8, 3) in the world."""
    if view.panoramic:
        return np.ones(len(boxes))
    points = _moved(boxes, np.array(view.to_camera))
    if not view.orthographic:
        points = _in_front(points)
        points = points / points[..., 2:]
    seen = points[..., :2] * view.slope + view.offset
    size = np.array([frame.full_width, frame.full_height])
    left_bottom, right_top = (2.0 * np.array(corner) / size - 1.0 for corner in frame.corners)
    high = np.minimum(np.fmax.reduce(seen, axis=1, initial=-np.inf), right_top)
    low = np.maximum(np.fmin.reduce(seen, axis=1, initial=np.inf), left_bottom)
    part = np.clip(high - low, 0.0, None).prod(axis=1) / np.prod(right_top - left_bottom)
    return np.where(np.isfinite(boxes).all(axis=(1, 2)), part, 1.0)


def _in_front(points: Array) -> Array:
    """Array around which the part of each box in front of the camera lies, and NaN (n, 36, 3)."""
    first, second = points[:, PAIRS[0]], points[:, PAIRS[1]]
    from_plane, to_plane = first[..., 2:] - NEAREST, second[..., 2:] - NEAREST
    cut = from_plane * to_plane < 0.0
    cuts = first + (second - first) * np.divide(
        from_plane, from_plane - to_plane, where=cut, out=np.full(cut.shape, np.nan)
    )
    return np.concatenate([np.where(points[..., 2:] > NEAREST, points, np.nan), cuts], axis=1)
