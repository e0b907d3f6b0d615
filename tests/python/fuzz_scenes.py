# SPDX-License-Identifier: MIT
"""One random scene, and what must hold of its picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from fuzz_calls import Step
from fuzz_values import SPECIAL, Array, Rng, chance, direction, material, number, one_of, outline, plane

import shlight

LIMITS = [1e15, 1e-15, 1e19, 1e-19, 1e20, 1e-30, 1e30, 1e-38, 1e38, 1e-45, 1e200]
SQUARE = np.array([[-4.0, -4, 0], [4, -4, 0], [4, 4, 0], [-4, 4, 0]])


def rgb(rng: Rng) -> Array:
    return np.asarray(10 ** rng.uniform(-3, 3) * rng.random(3))


def turned(rng: Rng, scale: Any, translation: Any) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = plane(rng).T * scale
    matrix[:3, 3] = translation
    return matrix


def mesh(rng: Rng, unit: float) -> dict[str, Any]:
    faces = int(one_of(rng, 1, 2, 20, 40))
    if chance(rng, 0.4):
        vertices, triangles = SQUARE, np.array([[0, 1, 2], [0, 2, 3]])
    else:
        vertices = rng.normal(size=(faces + 2, 3)) + [0, 0, 1]
        triangles = one_of(rng, np.arange(faces)[:, None] + [0, 1, 2], rng.integers(0, faces + 2, (faces, 3)))
    arguments: dict[str, Any] = {"vertices": vertices * unit, "triangles": triangles, "bsdf": material(rng)}
    if chance(rng, 0.3):
        arguments["emission"] = rgb(rng)
        if chance(rng, 0.5):
            arguments["emission"] = np.stack([rgb(rng), rgb(rng), np.zeros(3)])
            arguments["material_indices"] = rng.integers(0, 3, len(triangles))
    if chance(rng, 0.3):
        shape = one_of(rng, vertices.shape, (len(triangles), 3, 3))
        arguments["normals"] = rng.normal(size=shape) * one_of(rng, 0, 1, 1e-30, 1e30, 1)
    if chance(rng, 0.4):
        small = one_of(rng, unit, 1.0)  # the same size in the world by a transform
        arguments["vertices"] = vertices * small
        arguments["transforms"] = np.stack(
            [
                turned(rng, unit / small * rng.uniform(0.5, 2, 3), rng.normal(size=3) * unit)
                for _ in range(rng.integers(1, 4))
            ]
        )
    return arguments


def lamp(rng: Rng, unit: float) -> tuple[str, dict[str, Any]]:
    kind = one_of(rng, "sphere", "polygon", "disk", "point", "spot", "sun")
    position = (rng.normal(size=3) + [0, 0, 2]) * unit
    size = 10 ** rng.uniform(-3, 0.5) * unit
    axes = plane(rng) * size
    seen_by = {name: chance(rng, 0.5) for name in ("shadows", "diffuse", "glossy", "camera") if chance(rng, 0.2)}
    spread = {"spread": rng.uniform(0.01, math.pi)} if chance(rng, 0.2) else {}
    given: dict[str, Any] = {
        "sphere": lambda: {"center": position, "radius": size, "radiance": rgb(rng)},
        "polygon": lambda: {"vertices": position + outline(rng, 5) @ axes[:2], "radiance": rgb(rng), **spread},
        "disk": lambda: {
            "center": position,
            "half_axis_u": axes[0],
            "half_axis_v": axes[1] + 0.3 * axes[0],
            "radiance": rgb(rng),
            **spread,
        },
        "point": lambda: {"position": position, "intensity": rgb(rng) * min(unit * unit, 1e30)},
        "spot": lambda: {
            "position": position,
            "direction": direction(rng),
            "spot_angle": rng.uniform(0.01, math.pi),
            "blend": rng.random(),
            "intensity": rgb(rng) * min(unit * unit, 1e30),
            "radius": one_of(rng, 0.0, size),
            "times_cosine": chance(rng, 0.3),
        },
        "sun": lambda: {
            "direction": direction(rng),
            "angle": one_of(rng, 0.0, 0.01, rng.uniform(0, math.pi)),
            "irradiance": rgb(rng),
        },
    }[kind]()
    if kind in ("sphere", "spot"):
        given["facing_disk"] = chance(rng, 0.3)
    return f"add_{kind}_light", {**given, **seen_by}


def camera(rng: Rng, unit: float) -> tuple[str, dict[str, Any]]:
    to_world = np.eye(4)
    to_world[2, 3] = 6
    if chance(rng, 0.3):
        to_world = turned(rng, 1.0, rng.normal(size=3))
    to_world[:3, 3] *= unit
    if chance(rng, 0.5):
        return "set_camera", {"to_world": to_world, "fov_x": rng.uniform(0.01, 3)}
    orthographic = chance(rng, 0.5)
    w, h = rng.uniform(0.1, 5, 2) * (unit if orthographic else 0.2)
    window = {"left": -w, "right": w, "bottom": -h, "top": h, "orthographic": orthographic}
    clip = {"clip_start": 0.01 * unit, "clip_end": 100 * unit} if chance(rng, 0.3) else {}
    return "set_camera_window", {"to_world": to_world, **window, **clip}


def environment(rng: Rng) -> dict[str, Any]:
    radiance = rgb(rng) if chance(rng, 0.5) else rng.random((*rng.integers(1, 9, 2), 3)) * 10 ** rng.uniform(-3, 3)
    turn = {"to_world": plane(rng)} if chance(rng, 0.2) else {}
    return {"radiance": radiance, "visible": chance(rng, 0.5), **turn}


def spoil(rng: Rng, arguments: dict[str, Any]) -> None:
    """Makes numbers of one argument extreme."""
    names = [name for name, value in arguments.items() if isinstance(value, float | np.ndarray)]
    name = one_of(rng, *names)
    value = np.array(arguments[name], np.float64)
    with np.errstate(all="ignore"):
        if chance(rng, 0.5):
            value = value * one_of(rng, *LIMITS)
        elif chance(rng, 0.5):
            value[rng.random(value.shape) < 0.5] = one_of(rng, *SPECIAL, number(rng), np.nan, np.inf)
        else:
            value = np.round(value)
    integral = isinstance(arguments[name], np.ndarray) and arguments[name].dtype.kind == "i"
    arguments[name] = value.astype(np.int64) if integral and np.abs(value).max() < 1e18 else value[()]


def picture_problem(image: Any) -> str | None:
    if not np.isfinite(image).all():
        return "the picture is not finite"
    alpha = image[..., 3]
    return None if alpha.min() >= 0 and alpha.max() <= 1 else f"alpha is {alpha.min()} … {alpha.max()}"


def random_scene(rng: Rng) -> list[Step]:
    hostile = chance(rng, 0.7)
    unit = float(one_of(rng, *LIMITS, 1.0, 1.0) if chance(rng, 0.5) else 10 ** rng.uniform(-15, 15)) if hostile else 1.0
    steps = [("add_mesh", mesh(rng, unit)) for _ in range(rng.integers(1, 4))]
    steps += [lamp(rng, unit) for _ in range(rng.integers(0, 6))]
    steps += [("set_environment", environment(rng))] if chance(rng, 0.3) else []
    steps += [camera(rng, unit)]
    if hostile and chance(rng, 0.7):
        spoil(rng, steps[rng.integers(len(steps))][1])
    scene = shlight.Scene()
    accepted = None if hostile else True
    result = [
        Step(f"scene.{name}", getattr(scene, name), arguments, accepted, lambda _: None) for name, arguments in steps
    ]
    sizes = {"width": int(rng.integers(1, 10)), "height": int(rng.integers(1, 10)), "threads": 1}
    samples = {"pixel_samples": int(one_of(rng, 1, 1, 2, 4)), "shadow_rays": int(one_of(rng, 0, 1, 4))}
    order = {"order": int(rng.integers(1, 17))} if chance(rng, 0.1) else {}
    names = ["scene", *sizes, *samples, *(name for step in result for name in step.arguments)]
    call, more = "shlight.render", {**sizes, **samples, **order}
    if chance(rng, 0.1):
        call, more = "methods.render_monte_carlo", {**sizes, "samples": 2, "seed": int(rng.integers(2**32))}
        accepted = None  # it does not know all emissive meshes
    function = shlight.render if call == "shlight.render" else shlight.methods.render_monte_carlo
    picture = Step(call, lambda **given: function(scene, **given), more, accepted, picture_problem, names)
    return [*result, picture]
