# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps: emitted radiance and shape as Cycles gives them, one function per type of lamp."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypedDict

import numpy as np
from numpy.typing import NDArray

import shlight

from ..compat import LAMPS, lamp_casts_shadows, lamp_is_normalized, lamp_tint, point_is_disk, uses_nodes
from ..report import ExportReport
from .nodes import RGB, rgb
from .shaders import SHADERS
from .surface import SurfaceReader

# The widest sun of Blender 3.4 [rad]: beyond, the plane that it is even on is nearly parallel to its light.
WIDEST_TANGENT_SUN = 3.0
# The narrowest spread of an area lamp [rad] that is drawn as it is.
SMALLEST_SPREAD = math.radians(0.1)


class Traits(TypedDict):
    """What `shlight.Scene.add_…_light` takes for every lamp."""

    shadows: bool
    diffuse: bool
    glossy: bool
    camera: bool


class Lamp(NamedTuple):
    """A lamp that gives light."""

    data: Any  # bpy.types.Light
    power: RGB  # [W], of a sun [W m^-2]
    to_world: NDArray[np.float64]  # (4, 4)
    place: str  # how the report names it
    traits: Traits

    def place_in_world(self) -> tuple[float, float, float]:
        x, y, z = (float(c) for c in self.to_world[:3, 3])
        return x, y, z


def add_lamp(
    scene: shlight.Scene,
    lamp_object: Any,
    to_world: NDArray[np.float64],
    report: ExportReport,
    instancer: Any = None,
) -> bool:
    """Adds a lamp to `scene`; False if it gives no light (switched off, or not supported and reported).

    instancer: the object that shows it, if it is an instance.
    """
    lamp = lamp_object.data
    place = f"Light '{lamp_object.name}'"
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
    shown_by = [lamp_object] if instancer is None or not LAMPS.instancer_hides else [lamp_object, instancer]
    traits: Traits = {
        "shadows": lamp_casts_shadows(lamp),
        "diffuse": all(shown.visible_diffuse for shown in shown_by),
        "camera": all(shown.visible_camera for shown in shown_by),
        "glossy": all(shown.visible_glossy for shown in shown_by),
    }
    return LAMP_TYPES[lamp.type](scene, Lamp(lamp, power, to_world, place, traits), report)


def _emission_of_nodes(lamp: Any, place: str, report: ExportReport) -> RGB:
    """RGB factor from the lamp's node tree: the emission of its shader, 1 without nodes."""
    if not uses_nodes(lamp):
        return np.ones(3)
    output = lamp.node_tree.get_output_node("CYCLES")
    if output is None:
        return np.zeros(3)
    return SurfaceReader(place, report, SHADERS).surface(output.inputs["Surface"]).emission


def _add_point(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    radius = float(lamp.data.shadow_soft_size)
    if radius <= 0.0:
        scene.add_point_light(lamp.place_in_world(), rgb(_intensity(lamp)), **lamp.traits)
        return True
    radiance = _intensity(lamp) / (math.pi * radius * radius)
    disk = point_is_disk(lamp.data)
    scene.add_sphere_light(lamp.place_in_world(), radius, rgb(radiance), facing_disk=disk, **lamp.traits)
    return True


def _intensity(lamp: Lamp) -> RGB:
    """Of a point or spot lamp, along its axis, from afar.

    Not normalized, its power is that of a disk of area 1 with its radiance; one of no size shines as that disk.
    """
    radius = float(lamp.data.shadow_soft_size)
    if lamp_is_normalized(lamp.data):
        return lamp.power / (4.0 * math.pi)
    return lamp.power * (radius * radius if radius > 0.0 else 1.0 / math.pi)


def spot_direction(to_world: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """What `shlight.Scene.add_spot_light` takes as a direction: (3,) or (3, 3); None for a lamp of scale 0."""
    axes = to_world[:3, :3]
    lengths = np.linalg.norm(axes, axis=0)
    # Without volume its directions have no place in the lamp's frame.
    if not lengths.all() or not abs(np.linalg.det(axes / lengths)) > 1e-9:
        return None
    return axes if LAMPS.spot_is_scaled else -axes[:, 2]


def _add_spot(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    direction = spot_direction(lamp.to_world)
    if direction is None:
        report.add(lamp.place, "its scale is 0; left out")
        return False
    scene.add_spot_light(
        lamp.place_in_world(),
        direction,
        float(lamp.data.spot_size),
        float(lamp.data.spot_blend),
        rgb(_intensity(lamp)),
        radius=float(lamp.data.shadow_soft_size),
        facing_disk=point_is_disk(lamp.data),
        times_cosine=LAMPS.spot_times_cosine,
        **lamp.traits,
    )
    return True


def _add_sun(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    direction = -lamp.to_world[:3, 2]
    if not np.linalg.norm(direction) > 0.0:
        report.add(lamp.place, "its scale is 0; left out")
        return False
    angle = float(lamp.data.angle)
    if LAMPS.sun_is_tangent and angle > WIDEST_TANGENT_SUN:
        report.add(lamp.place, f"a sun wider than {math.degrees(WIDEST_TANGENT_SUN):.0f}° is drawn as wide as that")
        angle = WIDEST_TANGENT_SUN
    irradiance = lamp.power
    if not lamp_is_normalized(lamp.data) and angle > 0.0:
        irradiance = irradiance * (math.pi * math.sin(0.5 * angle) ** 2)
    scene.add_sun_light(direction, angle, rgb(irradiance), tangent=LAMPS.sun_is_tangent, **lamp.traits)
    return True


def area_corners(lamp: Any, to_world: NDArray[np.float64]) -> NDArray[np.float64]:
    """Corners (4, 3) of an area lamp in the world, counter-clockwise seen from the side it shines to (its -Z)."""
    along, across = _half_axes(lamp, to_world)
    return to_world[:3, 3] + np.stack([-along - across, along - across, along + across, across - along])


def _half_axes(lamp: Any, to_world: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of an area lamp, (3,) each, in the order whose cross product is on the side that it shines to."""
    axis_x, axis_y, axis_z = to_world[:3, :3].T
    height = lamp.size if lamp.shape in {"SQUARE", "DISK"} else lamp.size_y
    half_x, half_y = 0.5 * float(lamp.size) * axis_x, 0.5 * float(height) * axis_y
    # A mirrored transform turns the order round.
    towards_z = np.dot(np.cross(axis_x, axis_y), axis_z) > 0.0
    return (half_y, half_x) if towards_z else (half_x, half_y)


def _add_area(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    data = lamp.data
    axis_x, axis_y, axis_z = lamp.to_world[:3, :3].T
    area = float(np.linalg.norm(axis_x) * np.linalg.norm(axis_y) * data.size)
    area *= float(data.size if data.shape in {"SQUARE", "DISK"} else data.size_y)
    if area <= 0.0 or not np.linalg.norm(axis_z) > 0.0:
        report.add(lamp.place, "its area is 0; left out")
        return False
    is_round = data.shape in {"DISK", "ELLIPSE"}
    if is_round:
        area *= 0.25 * math.pi
    spread = float(data.spread)
    if spread < SMALLEST_SPREAD:
        report.add(lamp.place, f"a spread below {math.degrees(SMALLEST_SPREAD):g}° is drawn as that")
        spread = SMALLEST_SPREAD
    sheared = abs(float(axis_x @ axis_y)) > 1e-3 * float(np.linalg.norm(axis_x) * np.linalg.norm(axis_y))
    if sheared:
        report.add(lamp.place, "sheared area lamps are drawn as parallelograms; Cycles takes them for rectangles")
    radiance = lamp.power * (LAMPS.area / area if lamp_is_normalized(data) else 1.0 / math.pi)
    if is_round:
        half_axes = _half_axes(data, lamp.to_world)
        scene.add_disk_light(lamp.place_in_world(), *half_axes, rgb(radiance), spread=spread, **lamp.traits)
    else:
        scene.add_polygon_light(area_corners(data, lamp.to_world), rgb(radiance), spread=spread, **lamp.traits)
    return True


AddLamp = Callable[[shlight.Scene, Lamp, ExportReport], bool]
LAMP_TYPES: dict[str, AddLamp] = {"POINT": _add_point, "SPOT": _add_spot, "SUN": _add_sun, "AREA": _add_area}
