# SPDX-License-Identifier: MIT
"""What the example scenes are made of: meshes, materials, lamps and cameras in Blender 3.4 and later."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bmesh
import bpy
from mathutils import Vector

Triple = tuple[float, float, float]


def new_scene(name: str, width: int, height: int) -> Any:
    """An empty scene before a black world in Blender's current file; the window shows it."""
    scene = bpy.data.scenes.new(name)
    if bpy.context.window is not None:
        bpy.context.window.scene = scene
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0.0, 0.0, 0.0)
    return scene


def add_mesh(
    scene: Any,
    name: str,
    shape: Callable[[Any], None],
    material: Any,
    location: Triple = (0, 0, 0),
    *,
    scale: Triple = (1, 1, 1),
    rotation: Triple = (0, 0, 0),
    smooth: bool = False,
) -> Any:
    """An object whose mesh `shape` fills in: one of the shapes below, or a function of a bmesh like them."""
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


def grid(form: Any) -> None:
    """The square from -1 to 1 in the xy-plane."""
    bmesh.ops.create_grid(form, x_segments=1, y_segments=1, size=1.0)


def cube(form: Any) -> None:
    """The cube from -1 to 1."""
    bmesh.ops.create_cube(form, size=2.0)


def sphere(form: Any) -> None:
    """A sphere of radius 1."""
    bmesh.ops.create_uvsphere(form, u_segments=96, v_segments=48, radius=1.0)


def monkey(form: Any) -> None:
    """Blender's Suzanne."""
    bmesh.ops.create_monkey(form)


def surface(name: str, color: Triple, roughness: float, *, metallic: float = 0.0, specular: float = 0.5) -> Any:
    """A Principled BSDF; without specular it is matt."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (*color, 1.0)
    inputs["Roughness"].default_value = roughness
    inputs["Metallic"].default_value = metallic
    inputs["Specular IOR Level" if "Specular IOR Level" in inputs else "Specular"].default_value = specular
    return material


def metal(name: str, color: Triple, roughness: float) -> Any:
    """A Principled BSDF that is a single GGX lobe, in every version of Blender."""
    material = surface(name, color, roughness, metallic=1.0)
    material.node_tree.nodes["Principled BSDF"].distribution = "GGX"
    return material


def matt(name: str, color: Triple) -> Any:
    """A Diffuse BSDF."""
    return _single_shader(name, "ShaderNodeBsdfDiffuse", color)[0]


def emission(name: str, color: Triple, strength: float) -> Any:
    """A surface that glows."""
    material, node = _single_shader(name, "ShaderNodeEmission", color)
    node.inputs["Strength"].default_value = strength
    return material


def _single_shader(name: str, shader: str, color: Triple) -> tuple[Any, Any]:
    """A material of one shader node, and that node."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    node = tree.nodes.new(shader)
    node.inputs["Color"].default_value = (*color, 1.0)
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material, node


def add_area_lamp(
    scene: Any,
    name: str,
    power: float,
    location: Triple,
    target: Triple,
    size: tuple[float, float],
    color: Triple = (1, 1, 1),
) -> None:
    """A rectangular lamp of `size` that faces `target`."""
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.shape = "RECTANGLE"
    lamp.size, lamp.size_y = size
    _add_lamp(scene, lamp, power, location, target, color)


def add_sphere_lamp(
    scene: Any, name: str, power: float, location: Triple, radius: float, color: Triple = (1, 1, 1)
) -> None:
    """A spherical lamp; Blender before 4 knows only the disk that faces what it lights."""
    lamp = bpy.data.lights.new(name, "POINT")
    lamp.shadow_soft_size = radius
    if hasattr(lamp, "use_soft_falloff"):
        lamp.use_soft_falloff = False
    _add_lamp(scene, lamp, power, location, (0, 0, 0), color)


def _add_lamp(scene: Any, lamp: Any, power: float, location: Triple, target: Triple, color: Triple) -> None:
    lamp.energy, lamp.color = power, color
    made = bpy.data.objects.new(lamp.name, lamp)
    made.visible_camera = False
    _look_at(made, location, target)
    scene.collection.objects.link(made)


def add_camera(scene: Any, location: Triple, target: Triple, **lens: Any) -> None:
    """The scene's camera, looking at `target`; `lens` are properties of its data."""
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    for name, value in lens.items():
        setattr(camera.data, name, value)
    _look_at(camera, location, target)
    scene.collection.objects.link(camera)
    scene.camera = camera


def _look_at(seen: Any, location: Triple, target: Triple) -> None:
    """Puts a camera or lamp at `location`, its -Z towards `target`, its Y upwards."""
    seen.location = location
    seen.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
