# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps: emitted radiance and shape as Cycles gives them, one function per type of lamp."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import shlight

from ..compat import Lamps, lamp_casts_shadows, lamp_is_normalized, lamp_tint, point_is_disk, uses_nodes
from ..names import name_of
from ..report import Effect, ExportReport
from .directed_lamps import directed_lamp, varies_by_direction
from .materials import with_light
from .nodes import RGB, Surroundings, TreeReader
from .shaders import NODES
from .textured_lamps import UNIT_SQUARE, EvenLamp, EvenPart, even_lamp

# The widest sun of Blender 3.4 [rad]: beyond, the plane that it is even on is nearly parallel to its light.
WIDEST_TANGENT_SUN = 3.0
# The narrowest spread of an area lamp [rad] that is drawn as it is.
SMALLEST_SPREAD = math.radians(0.1)
ROUND_SHAPES = {"DISK", "ELLIPSE"}


class Lamp(NamedTuple):
    """A lamp that gives light."""

    data: Any  # bpy.types.Light
    power: RGB  # [W], of a sun [W m^-2]; the mean where an area lamp has parts
    parts: list[EvenPart]  # of an area lamp with a texture; their emission is power, as if all of it shone like them
    to_world: NDArray[np.float64]  # (4, 4)
    place: str  # how the report names it
    traits: dict[str, Any]  # arguments that every `shlight.Scene.add_…_light` takes

    @property
    def location(self) -> NDArray[np.float64]:
        """Its place in the world (3,)."""
        return self.to_world[:3, 3]


def add_lamp(
    scene: shlight.Scene,
    lamp_object: Any,
    to_world: NDArray[np.float64],
    report: ExportReport,
    surroundings: Surroundings,
    instancer: Any = None,
) -> bool:
    """Adds a lamp to `scene`; False if it gives no light (switched off, or not supported and reported).

    instancer: the object that shows it, if it is an instance.
    """
    lamp = lamp_object.data
    place = f"Light '{name_of(lamp_object)}'"
    if lamp.type == "AREA" and getattr(getattr(lamp, "cycles", None), "is_portal", False):
        return False  # guides Cycles' sampling of the world, emits nothing
    unit = float(lamp.energy) * lamp_tint(lamp) * surroundings.factors.get(name_of(lamp_object), 1.0)
    glow = _glow_of_nodes(lamp, to_world, place, report, surroundings)
    power = unit * glow.mean
    if not np.isfinite(power).all() or not np.isfinite(to_world).all():
        report.add(place, "its power or its transform is not finite; left out", Effect.LIGHT)
        return False
    if (power < 0.0).any():
        report.add(place, "negative light is not supported; left out", Effect.LIGHT)
        return False
    if not power.any():
        return False
    shown_by = [lamp_object] if instancer is None or not Lamps.instancer_hides else [lamp_object, instancer]
    traits: dict[str, Any] = {
        "shadows": lamp_casts_shadows(lamp),
        "diffuse": all(shown.visible_diffuse for shown in shown_by),
        "camera": surroundings.part.shows_lamps and all(shown.visible_camera for shown in shown_by),
        "glossy": all(shown.visible_glossy for shown in shown_by),
        "group": surroundings.passes.light_part(name_of(lamp_object), name_of(lamp_object, "lightgroup")),
        **surroundings.linking.links(lamp_object, instancer).of_light(),
    }
    if glow.profile is not None and lamp.type != "SUN":
        traits["profile"] = glow.profile
    parts = [part._replace(emission=unit * part.emission) for part in glow.parts]
    return LAMP_TYPES[lamp.type](scene, Lamp(lamp, power, parts, to_world, place, traits), report)


def _glow_of_nodes(
    lamp: Any, to_world: NDArray[np.float64], place: str, report: ExportReport, surroundings: Surroundings
) -> EvenLamp:
    """RGB factors from the lamp's node tree: the emission of its shader, 1 without nodes."""
    if not uses_nodes(lamp):
        return EvenLamp(np.ones(3), [])
    output = lamp.node_tree.get_output_node("CYCLES")
    if output is None:
        return EvenLamp(np.zeros(3), [])
    reader = TreeReader(lamp, place, report, surroundings, NODES)
    surface = with_light(reader.shader(output.inputs["Surface"]), place, report)
    if surface.varying is None:
        return EvenLamp(np.atleast_2d(surface.emission)[0], [])
    remark = partial(report.add, place)
    if lamp.type == "AREA" and not varies_by_direction(surface.varying):
        return even_lamp(surface.varying, lamp.shape in ROUND_SHAPES, remark)
    return directed_lamp(surface.varying, lamp, to_world, remark)


def _add_point(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    radius = float(lamp.data.shadow_soft_size)
    if radius <= 0.0:
        scene.add_point_light(lamp.location, _intensity(lamp), **lamp.traits)
        return True
    radiance = _intensity(lamp) / (math.pi * radius * radius)
    scene.add_sphere_light(lamp.location, radius, radiance, facing_disk=point_is_disk(lamp.data), **lamp.traits)
    return True


def _intensity(lamp: Lamp) -> RGB:
    """Intensity of a point or spot lamp, on its axis, from afar.

    Not normalized, its power is that of a disk of area 1 with its radiance; one of no size shines as that disk.
    """
    radius = float(lamp.data.shadow_soft_size)
    if lamp_is_normalized(lamp.data):
        return lamp.power / (4.0 * math.pi)
    return lamp.power * (radius * radius if radius > 0.0 else 1.0 / math.pi)


def spot_direction(to_world: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The direction argument of `shlight.Scene.add_spot_light`: (3,) or (3, 3); None for a lamp of scale 0."""
    axes = to_world[:3, :3]
    lengths = np.linalg.norm(axes, axis=0)
    # Without volume its directions have no place in the lamp's frame.
    if not lengths.all() or not abs(np.linalg.det(axes / lengths)) > 1e-9:
        return None
    return axes if Lamps.spot_is_scaled else -axes[:, 2]


def _add_spot(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    direction = spot_direction(lamp.to_world)
    if direction is None:
        report.add(lamp.place, "its scale is 0; left out", Effect.LIGHT)
        return False
    scene.add_spot_light(
        lamp.location,
        direction,
        float(lamp.data.spot_size),
        float(lamp.data.spot_blend),
        _intensity(lamp),
        radius=float(lamp.data.shadow_soft_size),
        facing_disk=point_is_disk(lamp.data),
        times_cosine=Lamps.spot_times_cosine,
        **lamp.traits,
    )
    return True


def _add_sun(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    direction = -lamp.to_world[:3, 2]
    if not np.linalg.norm(direction) > 0.0:
        report.add(lamp.place, "its scale is 0; left out", Effect.LIGHT)
        return False
    angle = float(lamp.data.angle)
    if Lamps.sun_is_tangent and angle > WIDEST_TANGENT_SUN:
        text = f"a sun wider than {math.degrees(WIDEST_TANGENT_SUN):.0f}° is drawn as wide as that"
        report.add(lamp.place, text, Effect.SLIGHT)
        angle = WIDEST_TANGENT_SUN
    irradiance = lamp.power
    if not lamp_is_normalized(lamp.data) and angle > 0.0:
        irradiance = irradiance * (math.pi * math.sin(0.5 * angle) ** 2)
    scene.add_sun_light(direction, angle, irradiance, tangent=Lamps.sun_is_tangent, **lamp.traits)
    return True


def _add_area(scene: shlight.Scene, lamp: Lamp, report: ExportReport) -> bool:
    data = lamp.data
    axis_x, axis_y, axis_z = lamp.to_world[:3, :3].T
    height = data.size_y if data.shape in {"RECTANGLE", "ELLIPSE"} else data.size
    half_axes = np.array([0.5 * float(data.size) * axis_x, 0.5 * float(height) * axis_y])
    area = 4.0 * float(np.linalg.norm(half_axes, axis=1).prod())
    if area <= 0.0 or not np.linalg.norm(axis_z) > 0.0:
        report.add(lamp.place, "its area is 0; left out", Effect.LIGHT)
        return False
    is_round = data.shape in ROUND_SHAPES
    if is_round:
        area *= 0.25 * math.pi
    spread = float(data.spread)
    if spread < SMALLEST_SPREAD:
        report.add(lamp.place, f"a spread below {math.degrees(SMALLEST_SPREAD):g}° is drawn as that", Effect.SLIGHT)
        spread = SMALLEST_SPREAD
    sheared = abs(float(axis_x @ axis_y)) > 1e-3 * float(np.linalg.norm(axis_x) * np.linalg.norm(axis_y))
    if sheared:
        report.add(lamp.place, "sheared area lamps are drawn as parallelograms; Cycles takes them for rectangles")
    factor = Lamps.area / area if lamp_is_normalized(data) else 1.0 / math.pi
    # The core wants them counter-clockwise seen from the side that the lamp shines to, which is -Z.
    order = -1 if float(np.linalg.det(lamp.to_world[:3, :3])) > 0.0 else 1
    if is_round and not lamp.parts:
        u, v = half_axes[::order]
        scene.add_disk_light(lamp.location, u, v, factor * lamp.power, spread=spread, **lamp.traits)
        return True
    for corners, power in lamp.parts or [EvenPart(UNIT_SQUARE, lamp.power)]:
        outline = lamp.location + (2.0 * corners - 1.0) @ half_axes
        scene.add_polygon_light(outline[::order], factor * power, spread=spread, **lamp.traits)
    return True


AddLamp = Callable[[shlight.Scene, Lamp, ExportReport], bool]
LAMP_TYPES: dict[str, AddLamp] = {"POINT": _add_point, "SPOT": _add_spot, "SUN": _add_sun, "AREA": _add_area}
