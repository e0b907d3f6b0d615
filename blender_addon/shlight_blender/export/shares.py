# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the picture a thing can change at most, by which the report is ordered."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import lamp_tint, slot_materials
from ..frame import Frame
from ..names import name_of
from .camera import View

Array = NDArray[np.float64]
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
            to_world = np.array(instance.matrix_world)
            boxes.append(np.array(shown.bound_box) @ to_world[:3, :3].T + to_world[:3, 3])
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
    to_camera = np.array(view.to_camera)
    points = boxes @ to_camera[:, :3].T + to_camera[:, 3]
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
    """Points around which the part of each box in front of the camera lies, and NaN (n, 36, 3)."""
    first, second = points[:, PAIRS[0]], points[:, PAIRS[1]]
    from_plane, to_plane = first[..., 2:] - NEAREST, second[..., 2:] - NEAREST
    cut = from_plane * to_plane < 0.0
    cuts = first + (second - first) * np.divide(
        from_plane, from_plane - to_plane, where=cut, out=np.full(cut.shape, np.nan)
    )
    return np.concatenate([np.where(points[..., 2:] > NEAREST, points, np.nan), cuts], axis=1)
