# SPDX-License-Identifier: MIT
"""One random scene, and what must hold of its picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from argument_walk import LIGHTS
from fuzz_calls import Step
from fuzz_values import SPECIAL, Array, Rng, chance, direction, material, numbers, one_of, outline, plane

import shlight
from shlight_tools import methods

SCALES = [1e15, 1e-15, 1e19, 1e-19, 1e20, 1e-30, 1e30, 1e-38, 1e38, 1e-45, 1e200]
SQUARE = np.array([[-4.0, -4, 0], [4, -4, 0], [4, 4, 0], [-4, 4, 0]])
PANORAMAS = [
    *("equirectangular", "central_cylindrical", "mirrorball", "equiangular_cubemap_face"),
    *("fisheye_equidistant", "fisheye_equisolid", "fisheye_lens_polynomial"),
]
Call = tuple[str, dict[str, Any]]


def rgb(rng: Rng) -> Array:
    return np.asarray(10 ** rng.uniform(-3, 3) * rng.random(3))


def placed(rng: Rng, scale: float, unit: float) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = plane(rng).T * scale * rng.uniform(0.5, 2, 3)
    matrix[:3, 3] = rng.normal(size=3) * unit
    return matrix


def mesh(rng: Rng, unit: float) -> Call:
    vertices, triangles = SQUARE, np.array([[0, 1, 2], [0, 2, 3]])
    if chance(rng, 0.6):
        faces = one_of(rng, 1, 2, 20, 40)
        vertices = rng.normal(size=(faces + 2, 3)) + np.array([0, 0, 1])
        triangles = one_of(rng, np.arange(faces)[:, None] + np.arange(3), rng.integers(0, faces + 2, (faces, 3)))
    given: dict[str, Any] = {"vertices": vertices * unit, "triangles": triangles, "bsdf": material(rng)}
    if chance(rng, 0.3):
        each = np.stack([rgb(rng), rgb(rng), np.zeros(3)])
        given["emission"] = one_of(rng, rgb(rng), each, np.stack([each, each[::-1]], axis=1))
        given["material_indices"] = rng.integers(0, 1 if given["emission"].ndim == 1 else 3, len(triangles))
    if chance(rng, 0.3):
        shape = one_of(rng, vertices.shape, (len(triangles), 3, 3))
        given["normals"] = rng.normal(size=shape) * one_of(rng, 0, 1, 1e-30, 1e30, 1)
    if chance(rng, 0.4):
        own = one_of(rng, unit, 1.0)  # the same size in the world by a transform
        given["vertices"] = vertices * own
        given["transforms"] = np.stack([placed(rng, unit / own, unit) for _ in range(rng.integers(1, 4))])
    return "add_mesh", given


def lamp(rng: Rng, unit: float) -> Call:
    position, size = (rng.normal(size=3) + np.array([0, 0, 2])) * unit, 10 ** rng.uniform(-3, 0.5) * unit
    axes = plane(rng) * size
    values = {"center": position, "position": position, "direction": direction(rng), "radius": size}
    values |= {"half_axis_u": axes[0], "half_axis_v": axes[1] + 0.3 * axes[0], "blend": rng.random()}
    values |= {"vertices": position + outline(rng, 5) @ axes[:2], "angle": one_of(rng, 0.0, 0.01, rng.uniform(0, 3))}
    values |= {angle: rng.uniform(0.01, math.pi) for angle in ("spread", "spot_angle")}
    values |= {"intensity": rgb(rng) * min(unit * unit, 1e30), "radiance": rgb(rng), "irradiance": rgb(rng)}
    name, arguments = one_of(rng, *LIGHTS.items())
    flags = {flag: chance(rng, 0.5) for flag in ("shadows", "diffuse", "glossy", "camera") if chance(rng, 0.2)}
    flags |= {name: chance(rng, 0.3) for name, value in arguments.items() if value is False}
    return name, {**{name: values[name] for name in arguments if name in values}, **flags}


def environment(rng: Rng, unit: float) -> Call:
    radiance = one_of(rng, rgb(rng), rng.random((*rng.integers(1, 9, 2), 3)) * 10 ** rng.uniform(-3, 3))
    return "set_environment", {"radiance": radiance, "to_world": plane(rng), "visible": chance(rng, 0.5)}


def aperture(rng: Rng, unit: float) -> dict[str, Any]:
    return {
        "aperture_size": unit * 10 ** rng.uniform(-3, 1),
        "focus_distance": unit * 10 ** rng.uniform(-1, 2),
        "aperture_blades": int(rng.integers(0, 9)),
        "aperture_rotation": rng.uniform(-4, 4),
        "aperture_ratio": 10 ** rng.uniform(-1, 1),
    }


def panorama(rng: Rng) -> dict[str, Any]:
    return {
        "panorama_type": one_of(rng, *PANORAMAS),
        "equirectangular_range": rng.uniform(-3, 3, 4),
        "central_cylindrical_range": rng.uniform(-3, 3, 4),
        "fisheye_fov": rng.uniform(0.1, 7),
        "fisheye_lens": rng.uniform(0.001, 0.1),
        "fisheye_polynomial": rng.uniform(-1, 0, 5) * 50.0 ** np.arange(5),
    }


def camera(rng: Rng, unit: float) -> Call:
    to_world = np.eye(4)
    to_world[2, 3] = 6 * unit
    to_world = one_of(rng, to_world, placed(rng, 1.0, unit))
    lens = aperture(rng, unit) if chance(rng, 0.3) else {}
    if chance(rng, 0.4):
        return "set_camera", {"to_world": to_world, "fov_x": rng.uniform(0.01, 3), **lens}
    if chance(rng, 0.3):
        return "set_panorama_camera", {"to_world": to_world, **panorama(rng), **lens}
    orthographic = chance(rng, 0.5)
    w, h = rng.uniform(0.1, 5, 2) * (unit if orthographic else 0.2)
    window = {"left": -w, "right": w, "bottom": -h, "top": h, "orthographic": orthographic}
    clip = {"clip_start": 0.01 * unit, "clip_end": 100 * unit} if chance(rng, 0.3) else {}
    return "set_camera_window", {"to_world": to_world, **window, **clip, **lens}


def spoil(rng: Rng, arguments: dict[str, Any]) -> None:
    """Makes numbers of one argument extreme."""
    name = one_of(rng, *(name for name, value in arguments.items() if isinstance(value, float | np.ndarray)))
    value = np.array(arguments[name])
    chosen = rng.random(value.shape) < 0.5
    extreme = one_of(
        rng, value * one_of(rng, *SCALES), one_of(rng, *SPECIAL, np.nan, np.inf), numbers(rng, value.shape)
    )
    value = np.where(chosen, extreme, value) if chance(rng, 0.5) else extreme + 0 * value
    integral = np.asarray(arguments[name]).dtype.kind == "i"
    arguments[name] = np.asarray(value).astype(np.int64 if integral else np.float64)[()]


def picture_problem(image: Any) -> str | None:
    if not np.isfinite(image).all():
        return "the picture is not finite"
    alpha = image[..., 3]
    return None if alpha.min() >= 0 and alpha.max() <= 1 else f"alpha is {alpha.min()} … {alpha.max()}"


def random_scene(rng: Rng) -> list[Step]:
    hostile = chance(rng, 0.7)
    unit = float(one_of(rng, 1.0, *[10 ** rng.uniform(-6, 10)] * 3, one_of(rng, *SCALES))) if hostile else 1.0
    calls = [mesh(rng, unit) for _ in range(rng.integers(1, 4))] + [lamp(rng, unit) for _ in range(rng.integers(0, 6))]
    calls += [environment(rng, unit)] * chance(rng, 0.3) + [camera(rng, unit)]
    if hostile and chance(rng, 0.7):
        spoil(rng, one_of(rng, *calls)[1])
    scene, accepted = shlight.Scene(), None if hostile else True
    steps = [Step(f"scene.{name}", getattr(scene, name), given, accepted, lambda _: None) for name, given in calls]
    settings: dict[str, Any] = {"width": int(rng.integers(1, 10)), "height": int(rng.integers(1, 10)), "threads": 1}
    names = ["scene", "width", *(name for _, given in calls for name in given)]
    if chance(rng, 0.1):  # it does not know all emissive meshes
        call, settings, accepted = "methods.render_monte_carlo", {**settings, "samples": 2}, None
    else:
        call = "render"
        settings |= {"pixel_samples": int(one_of(rng, 1, 1, 2, 4)), "shadow_rays": int(one_of(rng, 0, 1, 4))}
        settings |= {"order": int(rng.integers(1, 17))} if chance(rng, 0.1) else {}
        settings |= {"max_bounces": int(one_of(rng, 1, 2, 4)) if chance(rng, 0.3) else 0}
    function = shlight.render if call == "render" else methods.render_monte_carlo
    return [*steps, Step(call, function, {"scene": scene, **settings}, accepted, picture_problem, names)]
