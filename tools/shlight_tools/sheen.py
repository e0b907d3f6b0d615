# SPDX-License-Identifier: MIT
"""Measures the tables of `shlight.nodes.energy.sheen`: what Cycles draws of its Sheen BSDF under parallel light.

f·cos is A z/π · a²/((a x + b z)² + (a y)² + z²)², with a, b and the albedo A between whose entries over cosine and
roughness Cycles interpolates linearly. √(z / f·cos) is linear in three numbers that are made of these, so that a few
lights without extent, whose pictures have no noise, tell them.

`python -m shlight_tools.sheen` writes the file that the package keeps; it needs bpy.
"""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

from shlight.nodes.energy import KEPT_SHEEN

from .exact_pixels import empty_scene, picture

Array = NDArray[np.float64]

STEPS = 32
# Tables' ends cannot be seen (grazing views, no roughness) or have no plane of incidence: those half a step away are.
COSINES = np.array([0.5, *range(1, STEPS - 1), STEPS - 1.5]) / (STEPS - 1)
ROUGHNESSES = np.array([0.5, *range(1, STEPS)]) / (STEPS - 1)
# Height and azimuth of the lights over the plane that the camera looks down on; strips of it lean towards azimuth 0.
LIGHTS = [(z, math.radians(azimuth)) for z in (0.97, 0.8, 0.55, 0.3, 0.12, 0.04) for azimuth in (0, 50, 120, 180)]


def build_scene() -> Any:
    """A tile for each cosine (rows) and roughness, one in each pixel; returns the lamp."""
    scene = empty_scene(STEPS, STEPS)
    scene.cycles.max_bounces, scene.cycles.light_sampling_threshold = 0, 0.0

    material = bpy.data.materials.new("Fibres")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    kinds = ("ShaderNodeBsdfSheen", "ShaderNodeOutputMaterial", "ShaderNodeAttribute")
    shader, output, roughness = (tree.nodes.new(kind) for kind in kinds)
    shader.distribution, shader.inputs["Color"].default_value = "MICROFIBER", (1, 1, 1, 1)
    roughness.attribute_name = "roughness"
    tree.links.new(roughness.outputs["Fac"], shader.inputs["Roughness"])
    tree.links.new(shader.outputs[0], output.inputs[0])

    corners = [
        (column + 0.5 + 0.5 * x, row + 0.5 + 0.5 * y, -0.5 * x * math.tan(math.acos(cosine)))
        for row, cosine in enumerate(COSINES)
        for column in range(STEPS)
        for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    mesh = bpy.data.meshes.new("Tiles")
    mesh.from_pydata(corners, [], np.arange(len(corners)).reshape(-1, 4).tolist())
    mesh.materials.append(material)
    mesh.attributes.new("roughness", "FLOAT", "FACE").data.foreach_set("value", np.tile(ROUGHNESSES, STEPS))
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale, camera.clip_end = "ORTHO", STEPS, 1000.0
    lamp = bpy.data.lights.new("Sun", "SUN")
    lamp.angle, lamp.energy, lamp.use_shadow = 0.0, math.pi, False
    objects = [bpy.data.objects.new("", data) for data in (mesh, camera, lamp)]
    for made in objects:
        scene.collection.objects.link(made)
    scene.camera = objects[1]
    scene.camera.location = (STEPS / 2, STEPS / 2, 200)
    return objects[2]


def pictures() -> tuple[Array, Array]:
    """f·cos of all tiles (lights, cosines, roughnesses), and the lights' directions (lights, 3)."""
    lamp = build_scene()
    directions = [(math.sqrt(1 - z * z) * math.cos(a), math.sqrt(1 - z * z) * math.sin(a), z) for z, a in LIGHTS]
    images = []
    for direction in directions:
        lamp.rotation_euler = Vector(direction).to_track_quat("Z", "Y").to_euler()
        images.append(picture(bpy.context.scene)[::-1, :, 0] / math.pi)
    return np.array(images), np.array(directions)


def solved(reflected: Array, lights: Array) -> Array:
    """a, b and A of a tile; 0 where it is black. reflected: (n,); lights: (n, 3), in the frame of the view."""
    lit = (lights[:, 2] > 1e-3) & (reflected > 1e-12)
    if lit.sum() < 5:
        return np.zeros(3)
    x, y, z = lights[lit].T
    root = np.sqrt(z / (math.pi * reflected[lit]))
    terms = np.stack([x * x + y * y, x * z, z * z], axis=-1) / root[:, None]
    square, product, up = np.linalg.lstsq(terms, np.ones(len(root)), rcond=None)[0]
    albedo = 1 / (square * up - product**2 / 4)
    return np.array([square, product / 2, albedo / math.sqrt(albedo)]) * math.sqrt(albedo)


def measured() -> dict[str, Array]:
    """The tables over cosine (rows) and roughness."""
    images, directions = pictures()
    tables = np.empty((3, STEPS, STEPS))
    for row, cosine in enumerate(COSINES):
        sine = math.sqrt(1 - cosine**2)
        frame = np.array([[-cosine, 0, sine], [0, 1, 0], [sine, 0, cosine]])
        for column in range(STEPS):
            tables[:, row, column] = solved(images[:, row, column], directions @ frame.T)
    tables[:, 0] = 2 * tables[:, 0] - tables[:, 1]
    tables[:, -1] = 2 * tables[:, -1] - tables[:, -2]
    tables[:, :, 0] = 2 * tables[:, :, 0] - tables[:, :, 1]
    tables[[0, 2]] = np.maximum(tables[[0, 2]], 0)
    return dict(zip(("a", "b", "albedo"), tables, strict=True))


if __name__ == "__main__":
    np.savez(KEPT_SHEEN, **{name: table.astype(np.float32) for name, table in measured().items()})
