# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps: emitted radiance and shape as Cycles gives them, one function per type of lamp."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import shlight

from ..compat import LAMPS, lamp_casts_shadows, lamp_is_normalized, lamp_tint, point_is_disk, uses_nodes
from ..report import ExportReport
from .nodes import RGB, rgb
from .shaders import SHADERS
from .surface import SurfaceReader

# A point lamp of radius 0 is drawn as a sphere of this radius [m]; its light differs by less than (radius/distance)².
SMALLEST_RADIUS = 1e-3
# Sides of the polygon of equal area that stands for a round area lamp.
ROUND_SIDES = 24


def add_lamp(scene: shlight.Scene, lamp_object: Any, to_world: NDArray[np.float64], report: ExportReport) -> bool:
    """Adds a lamp to `scene`; False if it gives no light (switched off, or not supported and reported)."""
    lamp = lamp_object.data
    place = f"Light '{lamp_object.name}'"
    add = LAMP_TYPES.get(lamp.type)
    if add is None:
        report.add(place, f"{lamp.type.lower()} lamps are not supported; left out")
        return False
    if lamp.type == "AREA" and getattr(getattr(lamp, "cycles", None), "is_portal", False):
        return False  # guides Cycles' sampling of the world, emits nothing
    power = float(lamp.energy) * lamp_tint(lamp) * _emission_of_nodes(lamp, place, report)
    if not np.isfinite(power).all() or not np.isfinite(to_world).all():
        report.add(place, "its power or its transform is not finite; left out")
        return False
    if (power < 0.0).any():
        report.add(place, "negative light is not supported; left out")
        return False
    if not power.any():
        return False
    _report_visibility(lamp_object, place, report)
    return add(scene, lamp, power, to_world, place, report)


def _emission_of_nodes(lamp: Any, place: str, report: ExportReport) -> RGB:
    """RGB factor from the lamp's node tree: the emission of its shader, 1 without nodes."""
    if not uses_nodes(lamp):
        return np.ones(3)
    output = lamp.node_tree.get_output_node("CYCLES")
    if output is None:
        return np.zeros(3)
    return SurfaceReader(place, report, SHADERS).surface(output.inputs["Surface"]).emission


def _report_visibility(lamp_object: Any, place: str, report: ExportReport) -> None:
    if not lamp_casts_shadows(lamp_object.data):
        report.add(place, "lamps without shadows are not supported; its light is shadowed")
    if lamp_object.visible_camera:
        report.add(place, "lamps seen by the camera are not supported; it lights, but is not drawn")
    if not (lamp_object.visible_diffuse and lamp_object.visible_glossy):
        report.add(place, "lamps for only diffuse or only glossy reflection are not supported; it lights both")


def _add_point(
    scene: shlight.Scene, lamp: Any, power: RGB, to_world: NDArray[np.float64], place: str, report: ExportReport
) -> bool:
    radius = float(lamp.shadow_soft_size)
    if radius <= 0.0:
        report.add(place, f"radius 0 is not supported; drawn as a sphere of {SMALLEST_RADIUS * 1000:g} mm")
    # A lamp that is not normalized shines as if the disk of its radius had area 1; from a point that is intensity.
    shown_radius = max(radius, SMALLEST_RADIUS)
    normalized = lamp_is_normalized(lamp) or radius <= 0.0
    area = math.pi * shown_radius * shown_radius if normalized else 1.0
    radiance = power / (4.0 * math.pi * area) if normalized else power / math.pi
    scene.add_sphere_light(
        tuple(float(c) for c in to_world[:3, 3]), shown_radius, rgb(radiance), facing_disk=point_is_disk(lamp)
    )
    return True


def area_corners(lamp: Any, to_world: NDArray[np.float64]) -> NDArray[np.float64]:
    """Outline (k, 3) of an area lamp in the world, counter-clockwise seen from the side it shines to (its -Z)."""
    round_shape = lamp.shape in {"DISK", "ELLIPSE"}
    width = float(lamp.size)
    height = width if lamp.shape in {"SQUARE", "DISK"} else float(lamp.size_y)
    if round_shape:
        angles = 2.0 * np.pi * np.arange(ROUND_SIDES) / ROUND_SIDES
        # Radius at which the polygon has the area of the disk of diameter 1.
        radius = 0.5 * math.sqrt(math.pi / (0.5 * ROUND_SIDES * math.sin(2.0 * math.pi / ROUND_SIDES)))
        outline = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    else:
        outline = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    axis_x, axis_y, axis_z, center = to_world[:3].T
    corners = center + outline[:, :1] * width * axis_x + outline[:, 1:] * height * axis_y
    # Seen from +Z the outline above is counter-clockwise; a mirrored transform turns the order round.
    towards_z = np.dot(np.cross(axis_x, axis_y), axis_z) > 0.0
    return np.ascontiguousarray(corners[::-1] if towards_z else corners)


def _add_area(
    scene: shlight.Scene, lamp: Any, power: RGB, to_world: NDArray[np.float64], place: str, report: ExportReport
) -> bool:
    axis_x, axis_y, axis_z = to_world[:3, :3].T
    area = float(np.linalg.norm(axis_x) * np.linalg.norm(axis_y) * lamp.size)
    area *= float(lamp.size if lamp.shape in {"SQUARE", "DISK"} else lamp.size_y)
    if area <= 0.0 or not np.linalg.norm(axis_z) > 0.0:
        report.add(place, "its area is 0; left out")
        return False
    if lamp.shape in {"DISK", "ELLIPSE"}:
        area *= 0.25 * math.pi
        report.add(place, f"round area lamps are not supported; drawn as a polygon of {ROUND_SIDES} sides")
    if lamp.spread < math.pi * (1.0 - 1e-6):
        report.add(place, "a spread below 180° is not supported; its light is spread over 180°")
    sheared = abs(float(axis_x @ axis_y)) > 1e-3 * float(np.linalg.norm(axis_x) * np.linalg.norm(axis_y))
    if sheared:
        report.add(place, "sheared area lamps are drawn as parallelograms; Cycles takes them for rectangles")
    radiance = power * (LAMPS.area / area if lamp_is_normalized(lamp) else 1.0 / math.pi)
    scene.add_polygon_light(area_corners(lamp, to_world), rgb(radiance))
    return True


AddLamp = Callable[[shlight.Scene, Any, RGB, NDArray[np.float64], str, ExportReport], bool]
LAMP_TYPES: dict[str, AddLamp] = {"POINT": _add_point, "AREA": _add_area}
