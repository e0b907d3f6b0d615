# SPDX-License-Identifier: MIT
"""A small scene built by code: matt and glossy things, an area lamp, a sphere lamp and a glowing strip.

`./dev preview` renders it when it is given no other.

usage: blender --python examples/example_scene.py     to look at it
"""

from __future__ import annotations

import math
from typing import Any

import bmesh
import bpy
from mathutils import Vector

Color = tuple[float, float, float]


def build_example_scene() -> Any:
    """Makes the scene in Blender's current file, gives it the window, and returns it."""
    scene = bpy.data.scenes.new("shlight example")
    if bpy.context.window is not None:
        bpy.context.window.scene = scene
    scene.render.resolution_x, scene.render.resolution_y = 640, 400
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0.0, 0.0, 0.0)

    grey = _material("matt grey", (0.55, 0.55, 0.55), 0.6, specular=0.0)
    _mesh(scene, "floor", _grid, grey, (0, 0, 0), scale=(7, 7, 1))
    _mesh(scene, "wall", _grid, grey, (0, 3.2, 3), scale=(7, 3, 1), rotation=(math.pi / 2, 0, 0))
    monkey = _material("orange plastic", (0.80, 0.24, 0.04), 0.5)
    turned = (math.radians(-12), 0, math.radians(14))
    head = _mesh(
        scene, "Suzanne", _monkey, monkey, (0.0, 0.1, 1.0), scale=(1.1, 1.1, 1.1), rotation=turned, smooth=True
    )
    head.modifiers.new("smooth", "SUBSURF").render_levels = 2
    gold = _material("rough gold", (0.92, 0.62, 0.25), 0.5, metallic=1.0)
    _mesh(scene, "gold sphere", _sphere, gold, (-2.1, 0.3, 0.75), scale=(0.75,) * 3, smooth=True)
    blue = _material("blue plastic", (0.03, 0.12, 0.42), 0.55)
    _mesh(scene, "blue box", _cube, blue, (2.1, 0.7, 0.7), scale=(0.6, 0.6, 0.7), rotation=(0, 0, 0.5))
    green = _material("matt green", (0.12, 0.40, 0.14), 0.8, specular=0.0)
    _mesh(scene, "green ball", _sphere, green, (1.3, -1.2, 0.4), scale=(0.4,) * 3, smooth=True)

    area = _lamp(scene, "window", "AREA", 190.0, (1.0, 0.96, 0.90), (-3.2, -2.2, 4.2), target=(0, 0, 0.8))
    area.shape, area.size, area.size_y = "RECTANGLE", 1.6, 1.1
    bulb = _lamp(scene, "bulb", "POINT", 60.0, (0.75, 0.85, 1.0), (3.0, -1.6, 2.6))
    bulb.shadow_soft_size = 0.35
    glow = _emission("glow", (1.0, 0.45, 0.25), 9.0)
    _mesh(scene, "glowing strip", _grid, glow, (0.9, 2.6, 0.16), scale=(1.0, 0.12, 1.0), rotation=(1.2, 0, 0))

    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.lens = 45.0
    _look_at(camera, (0.3, -7.4, 2.9), (0.05, 0.2, 0.95))
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def _mesh(
    scene: Any,
    name: str,
    shape: Any,
    material: Any,
    location: tuple[float, float, float],
    *,
    scale: tuple[float, ...] = (1, 1, 1),
    rotation: tuple[float, float, float] = (0, 0, 0),
    smooth: bool = False,
) -> Any:
    form = bmesh.new()
    shape(form)
    for face in form.faces:
        face.smooth = smooth
    mesh = bpy.data.meshes.new(name)
    form.to_mesh(mesh)
    form.free()
    mesh.materials.append(material)
    made = bpy.data.objects.new(name, mesh)
    made.location, made.scale, made.rotation_euler = location, scale, rotation
    scene.collection.objects.link(made)
    return made


def _grid(form: Any) -> None:
    bmesh.ops.create_grid(form, x_segments=1, y_segments=1, size=1.0)


def _cube(form: Any) -> None:
    bmesh.ops.create_cube(form, size=2.0)


def _sphere(form: Any) -> None:
    bmesh.ops.create_uvsphere(form, u_segments=96, v_segments=48, radius=1.0)


def _monkey(form: Any) -> None:
    bmesh.ops.create_monkey(form)


def _material(name: str, color: Color, roughness: float, *, metallic: float = 0.0, specular: float = 0.5) -> Any:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1.0)
    inputs["Roughness"].default_value = roughness
    inputs["Metallic"].default_value = metallic
    inputs["Specular IOR Level" if "Specular IOR Level" in inputs else "Specular"].default_value = specular
    return material


def _emission(name: str, color: Color, strength: float) -> Any:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeEmission")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Strength"].default_value = strength
    tree.links.new(node.outputs["Emission"], tree.nodes["Material Output"].inputs["Surface"])
    return material


def _lamp(
    scene: Any,
    name: str,
    kind: str,
    power: float,
    color: Color,
    location: tuple[float, float, float],
    *,
    target: tuple[float, float, float] = (0, 0, 0),
) -> Any:
    lamp = bpy.data.lights.new(name, kind)
    lamp.energy, lamp.color = power, color
    lamp_object = bpy.data.objects.new(name, lamp)
    lamp_object.visible_camera = False
    _look_at(lamp_object, location, target)
    scene.collection.objects.link(lamp_object)
    return lamp


def _look_at(seen: Any, location: tuple[float, float, float], target: tuple[float, float, float]) -> None:
    """Puts a camera or lamp at `location`, its -Z towards `target`, its Y upwards."""
    seen.location = location
    seen.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()


if __name__ == "__main__":
    build_example_scene()
