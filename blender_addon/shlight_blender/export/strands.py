# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair and point clouds as arrays: points with radii, and what Curves Info, UV maps and attributes read of them.

Radii of particles' hair, and the numbers of Curves Info, are those of Cycles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compat import DEFAULT_RADII, values_of
from ..names import name_of, with_name
from ..report import Effect, ExportReport
from .mesh_attributes import CURVE_INTERCEPT, CURVE_LENGTH, CURVE_RANDOM, CURVE_THICKNESS, IS_CURVE, TYPES, UV
from .object_values import hashed, share

FloatArray = NDArray[np.float32]

# Kinds of surfaces that are no meshes: hair of a mesh's particle systems, and types of objects.
HAIR, CURVES, POINT_CLOUD = "HAIR", "CURVES", "POINTCLOUD"


@dataclass
class Strands:
    """Curves, or spheres, in their object's frame, with radii (n,) of all points (n, 3).

    first: number of each curve's first point (c,); None: they are spheres.
    materials: (c,) of curves, or (n,) of spheres.
    attributes: by name numbers (n, k) of points or (c, k) of curves.
    """

    points: FloatArray
    radii: FloatArray
    first: NDArray[np.int64] | None
    materials: NDArray[np.int64]
    attributes: dict[str, FloatArray] = field(default_factory=dict)


def strands_of(
    kind: str, shown: Any, place: str, names: Sequence[str], depsgraph: Any, report: ExportReport
) -> Strands | None:
    """The hair or the points of an evaluated object, with those of the attributes that it has; None: there are none."""
    made = _particle_hair(shown, names, depsgraph) if kind == HAIR else _own_points(kind, shown.data, names)
    if made is None or not len(made.materials):
        return None
    if not np.isfinite(made.points).all():
        report.add(place, "some of its points are not finite; left out", Effect.THING)
        return None
    if (made.radii < 0.0).any() or not np.isfinite(made.radii).all():
        report.add(place, "some of its radii are negative or not finite; they count as 0", Effect.SLIGHT)
        made.radii = np.nan_to_num(np.maximum(made.radii, 0.0), posinf=0.0)
    if made.first is not None:
        made.attributes |= {name: values for name, values in _curve_values(made).items() if name in names}
    return made


def _own_points(kind: str, data: Any, names: Sequence[str]) -> Strands | None:
    """Takes the points of hair curves, or of a point cloud."""
    position = data.attributes.get("position")
    if position is None:
        return None
    points = values_of(position.data, "vector", np.float32, 3)
    radius = data.attributes.get("radius")
    radii = np.full(len(points), DEFAULT_RADII[kind], np.float32)
    if radius is not None and radius.data_type == "FLOAT" and radius.domain == "POINT":
        radii = values_of(radius.data, "value", np.float32)
    found = {name: _attribute(data, name) for name in names}
    attributes = {name: values for name, values in found.items() if values is not None}
    if kind == POINT_CLOUD:
        return Strands(points, radii, None, np.zeros(len(points), np.int64), attributes)
    first = values_of(data.curves, "first_point_index", np.int32).astype(np.int64)
    return _of_two_points(Strands(points, radii, first, np.zeros(len(first), np.int64), attributes))


def _of_two_points(made: Strands) -> Strands:
    """The curves that have two points or more; Cycles draws none of the others."""
    assert made.first is not None
    counts = np.diff(made.first, append=len(made.points))
    long = counts > 1
    if long.all():
        return made
    kept = np.repeat(long, counts)
    total = {len(long): long, len(kept): kept}
    first = np.concatenate([[0], np.cumsum(counts[long])[:-1]]) if long.any() else np.zeros(0, np.int64)
    attributes = {name: values[total[len(values)]] for name, values in made.attributes.items()}
    return Strands(made.points[kept], made.radii[kept], first, made.materials[long], attributes)


def _attribute(data: Any, name: str) -> FloatArray | None:
    """An attribute of points or of curves; the UV map for rendering is the first of two numbers for each curve."""
    if name != UV:
        own = with_name(data.attributes, name)
    else:
        of_curves = (a for a in data.attributes if a.domain == "CURVE" and a.data_type == "FLOAT2")
        own = next(of_curves, None)
    if own is None or own.data_type not in TYPES:
        return None
    value, count = TYPES[own.data_type]
    values: FloatArray = np.nan_to_num(values_of(own.data, value, np.float32, count)).reshape(-1, count)
    return values


def hair_systems(shown: Any, depsgraph: Any) -> list[tuple[Any, Any]]:
    """The modifiers of an evaluated object whose particles are drawn as hair, with their particle systems."""
    switch = "show_viewport" if depsgraph.mode == "VIEWPORT" else "show_render"
    found = [(own, own.particle_system) for own in shown.modifiers if own.type == "PARTICLE_SYSTEM"]
    return [
        (own, system)
        for own, system in found
        if getattr(own, switch) and system.settings.type == "HAIR" and system.settings.render_type == "PATH"
    ]


def _particle_hair(shown: Any, names: Sequence[str], depsgraph: Any) -> Strands | None:
    """The hair of all particle systems, parents and children, as many as the depsgraph has for its kind of render."""
    viewport = depsgraph.mode == "VIEWPORT"
    made = [_system_hair(shown, *own, names, viewport) for own in hair_systems(shown, depsgraph)]
    made = [own for own in made if len(own.materials)]
    if not made:
        return None
    starts = np.cumsum([0, *(len(own.points) for own in made)])
    first = np.concatenate(
        [own.first + start for own, start in zip(made, starts, strict=False) if own.first is not None]
    )
    return Strands(
        np.concatenate([own.points for own in made]),
        np.concatenate([own.radii for own in made]),
        first,
        np.concatenate([own.materials for own in made]),
        {name: np.concatenate([own.attributes[name] for own in made]) for name in made[0].attributes},
    )


def _system_hair(shown: Any, modifier: Any, system: Any, names: Sequence[str], viewport: bool) -> Strands:
    settings, parents = system.settings, len(system.particles)
    children = len(system.child_particles)
    if viewport:
        children = int(children * settings.display_percentage / 100.0)
    has_children = settings.child_type != "NONE" and children > 0
    numbers = range(parents if has_children else 0, parents + children if has_children else parents)
    steps = (1 << (settings.display_step if viewport else settings.render_step)) + 1
    if settings.kink == "SPIRAL":
        steps += settings.kink_extra_steps
    # Blender hands over children's points one by one alone.
    place = system.co_hair
    each = (place(shown, particle_no=number, step=step) for number in numbers for step in range(steps))
    points = np.fromiter(chain.from_iterable(each), np.float32, 3 * steps * len(numbers)).reshape(-1, 3)
    to_object = np.linalg.inv(np.array(shown.matrix_world, dtype=np.float64))
    points = (points @ to_object[:3, :3].T + to_object[:3, 3]).astype(np.float32)
    first = steps * np.arange(len(numbers))
    made = Strands(points, np.zeros(len(points), np.float32), first, np.full(len(first), settings.material - 1))
    made.radii = _particle_radii(settings, _curve_values(made)[CURVE_INTERCEPT].reshape(-1, steps)).ravel()
    made.attributes = _on_emitter(shown.data, modifier, system, numbers, names)
    return made


def _particle_radii(settings: Any, share_of_length: FloatArray) -> FloatArray:
    """The radii along curves (c, n), from the root's to the tip's by the power that Shape gives."""
    shape, scale = float(settings.shape), 0.5 * settings.radius_scale
    root, tip = scale * settings.root_radius, scale * settings.tip_radius
    power = 1.0 + shape if shape < 0.0 else 1.0 / (1.0 - shape) if shape < 1.0 else np.inf
    left = np.clip(1.0 - share_of_length, 0.0, 1.0) ** power
    radii: FloatArray = (left * (root - tip) + tip).astype(np.float32)
    if settings.use_close_tip:
        radii[:, -1] = 0.0
    return radii


def _on_emitter(mesh: Any, modifier: Any, system: Any, numbers: range, names: Sequence[str]) -> dict[str, FloatArray]:
    """UV maps where each strand has its root."""
    made: dict[str, FloatArray] = {}
    for index, layer in enumerate(mesh.uv_layers):
        wanted = [name for name in names if name == name_of(layer) or (name == UV and layer.active_render)]
        if wanted:
            owners = (system.particles[min(number, len(system.particles) - 1)] for number in numbers)
            each = (
                system.uv_on_emitter(modifier, particle=owner, particle_no=number, uv_no=index)
                for owner, number in zip(owners, numbers, strict=True)
            )
            values = np.array([tuple(uv) for uv in each], dtype=np.float32).reshape(-1, 2)
            made |= dict.fromkeys(wanted, values)
    return made


def _curve_values(made: Strands) -> dict[str, FloatArray]:
    """The numbers of Curves Info."""
    assert made.first is not None
    ahead = np.diff(made.points, axis=0, prepend=made.points[:1]).astype(np.float64)
    steps = np.linalg.norm(ahead, axis=1)
    steps[made.first] = 0.0
    way = np.cumsum(steps)
    counts = np.diff(made.first, append=len(made.points))
    way -= np.repeat(way[made.first], counts)
    lengths = way[made.first + counts - 1]
    whole = np.repeat(lengths, counts)
    values = {
        IS_CURVE: np.ones(len(lengths)),
        CURVE_INTERCEPT: np.divide(way, whole, out=np.zeros_like(way), where=whole > 0.0),
        CURVE_LENGTH: lengths,
        CURVE_RANDOM: share(hashed(np.arange(len(lengths)), 0)),
        CURVE_THICKNESS: 2.0 * made.radii,
    }
    return {name: np.asarray(numbers, np.float32)[:, None] for name, numbers in values.items()}
