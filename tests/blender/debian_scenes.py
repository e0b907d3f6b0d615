# SPDX-License-Identifier: MIT
"""Runs inside Debian's Blender in the background: renders small scenes with shlight and Cycles, writes results.json."""

import json
import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector

import shlight_blender
from shlight_blender.export import export_scene

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])


def prepare():
    """An empty file set up for direct light."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="cycles")
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.resolution_x, render.resolution_y = 64, 48
    settings = render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth, settings.exr_codec = (
        "OPEN_EXR",
        "RGBA",
        "32",
        "ZIP",
    )
    cycles.samples, cycles.seed, cycles.max_bounces = 256, 7, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = cycles.blur_glossy = 0.0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    link(bpy.data.cameras.new("Camera"), (3, -6, 4))
    camera = scene.camera = bpy.data.objects["Camera"]
    camera.rotation_euler = (Vector((0, 0, 0.4)) - camera.location).to_track_quat("-Z", "Y").to_euler()


def link(data, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1)):
    made = bpy.data.objects.new(data.name, data)
    made.location, made.rotation_euler, made.scale = location, rotation, scale
    bpy.context.scene.collection.objects.link(made)
    return made


def shader(kind="ShaderNodeBsdfDiffuse", **values):
    material = bpy.data.materials.new("Material")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new(kind), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for key, value in values.items():
        if key == "distribution":
            node.distribution = value
        else:
            node.inputs[key.replace("_", " ")].default_value = value
    return material


def plane(material=None):
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.object.data.materials.append(material or shader())


def ball(material, location=(0, 0, 1.1), smooth=True, scale=(1, 1, 1)):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, location=location, scale=scale)
    made = bpy.context.object
    made.data.materials.append(material)
    made.data.polygons.foreach_set("use_smooth", [smooth] * len(made.data.polygons))
    return made


def lamp(kind, energy, location, rotation=(0, 0, 0), scale=(1, 1, 1), **values):
    data = bpy.data.lights.new(kind, kind)
    data.energy = energy
    for key, value in values.items():
        setattr(data, key, value)
    return link(data, location, rotation, scale)


def shine_on(material):
    plane(material)
    ball(material)
    lamp("POINT", 150, (1.5, -2, 3), shadow_soft_size=0.6)
    lamp("POINT", 80, (-2, -2, 2), shadow_soft_size=0.4)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = 64, 48


def lamps():
    plane()
    lamp("POINT", 60, (0.2, -0.1, 0.9), shadow_soft_size=0.5, color=(1.0, 0.7, 0.4))


def area():
    plane()
    lamp("AREA", 120, (0, 0.5, 1.2), (0.35, 0.2, 0.5), (-1.5, 0.6, -1.0), shape="RECTANGLE", size=1, size_y=0.7)
    lamp("AREA", 60, (1, -0.5, 1.5), (0.3, 0.2, 0.5), (1.5, 0.6, 2.0), shape="SQUARE", size=0.7)


def lit_by(kind, energy, rotation=(0, 0, 0), scale=(1, 1, 1), **values):
    plane()
    ball(shader(Color=(0.8, 0.6, 0.2, 1)), location=(-0.8, 0.2, 0.5), scale=(0.5, 0.5, 0.5))
    lamp(kind, energy, (0.3, -0.4, 1.7), rotation, scale, **values)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = 48, 48


def spot():
    lit_by("SPOT", 200, shadow_soft_size=0.3, spot_size=1.0, spot_blend=0.5)


def small_spot():
    lit_by(
        "SPOT",
        200,
        (0.2, 0.3, 0.5),
        (1.6, 0.7, 1.2),
        shadow_soft_size=0.0,
        spot_size=0.9,
        spot_blend=0.3,
        color=(1, 0.5, 0.2),
    )


def small_point():
    lit_by("POINT", 60, shadow_soft_size=0.0)


def sun():
    lit_by("SUN", 3, (0.4, 0.5, 0), angle=0.9)


def small_sun():
    lit_by("SUN", 3, (0.4, 0.5, 0), angle=0.0)


def spread():
    lit_by("AREA", 60, (0.2, 0.1, 0.3), shape="RECTANGLE", size=1.4, size_y=0.5, spread=math.radians(60))


def textured_by_default():
    """An area lamp that shines as a picture without symmetry."""
    plane()
    made = lamp("AREA", 60, (0.2, -0.3, 0.8), (0.4, 0.2, 0.3), shape="RECTANGLE", size=1.5, size_y=1.0)
    image = bpy.data.images.new("Picture", 4, 3, float_buffer=True)
    image.pixels = [value for y in range(3) for x in range(4) for value in (0.1 + 0.2 * x, 0.1 + 0.4 * y, 0.3, 1.0)]
    made.data.use_nodes = True
    tree = made.data.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.extension, node.interpolation = image, "EXTEND", "Closest"
    tree.links.new(node.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    return tree, node


def textured():
    tree, node = textured_by_default()
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Parametric"], node.inputs["Vector"])


def smooth():
    plane()
    made = ball(shader(Color=(0.8, 0.6, 0.2, 1)), location=(-1.2, 0, 0.8), scale=(0.7, 0.7, 0.8))
    made.data.use_auto_smooth, made.data.auto_smooth_angle = True, math.radians(11.0)
    link(made.data, (1.2, 0, 0.8), (0.3, 0.4, 0.5), (-0.9, 0.5, 0.6))
    ball(shader(Color=(0.2, 0.6, 0.8, 1)), location=(0, -1.8, 0.5), scale=(0.4, 0.5, 0.4))
    lamp("AREA", 150, (1.5, -1, 3), size=0.8)


def glossy():
    shine_on(shader("ShaderNodeBsdfGlossy", Color=(0.9, 0.6, 0.3, 1), Roughness=0.5, distribution="GGX"))


def metal():
    shine_on(
        shader("ShaderNodeBsdfPrincipled", Base_Color=(0.9, 0.6, 0.3, 1), Metallic=1.0, Roughness=0.5, Specular=0.7)
    )


def principled():
    shine_on(shader("ShaderNodeBsdfPrincipled", Base_Color=(0.3, 0.6, 0.8, 1), Roughness=0.5, Specular=0.8))


def blackbody():
    plane()
    material = shader("ShaderNodeEmission", Strength=8.0)
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeBlackbody")
    node.inputs[0].default_value = 2400.0
    tree.links.new(node.outputs[0], tree.nodes["Emission"].inputs["Color"])
    bpy.ops.mesh.primitive_cube_add(size=0.5, location=(0.3, 0, 1.0))
    bpy.context.object.data.materials.append(material)


def curves():
    plane()
    bpy.ops.curve.primitive_bezier_circle_add(location=(0, 0, 0.5))
    bpy.context.object.data.bevel_depth = 0.2
    bpy.ops.object.text_add(location=(-0.5, 0, 0.1), rotation=(1.2, 0, 0.3))
    bpy.context.object.data.extrude = 0.1
    lamp("AREA", 150, (1.5, -1, 3), size=0.8)


def border():
    smooth()
    render = bpy.context.scene.render
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.21, 0.83, 0.13, 0.66
    camera = bpy.context.scene.camera.data
    camera.shift_x, camera.shift_y, camera.sensor_fit = 0.1, -0.05, "VERTICAL"


def sky():
    """A world that is baked to a picture and a sun."""
    plane()
    ball(shader(Color=(0.8, 0.6, 0.2, 1)))
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 64, 48
    scene.shlight.world_width, scene.shlight.shadow_rays = 512, 64
    scene.world = world = bpy.data.worlds.new("World")
    world.use_nodes = True
    tree = world.node_tree
    node = tree.nodes.new("ShaderNodeTexSky")
    node.sun_elevation, node.sun_rotation = 0.5, 0.8
    tree.links.new(node.outputs[0], tree.nodes["Background"].inputs["Color"])
    tree.nodes["Background"].inputs["Strength"].default_value = 0.1


def dark():
    plane()


def picture(name, engine):
    render = bpy.context.scene.render
    render.engine = engine
    render.filepath = str(FOLDER / f"{name}_{engine}.exr")
    bpy.ops.render.render(write_still=True)
    return render.filepath


def main():
    shlight_blender.register()
    results = {}
    for build in (
        lamps,
        area,
        spot,
        small_spot,
        small_point,
        sun,
        small_sun,
        spread,
        textured,
        textured_by_default,
        smooth,
        glossy,
        metal,
        principled,
        blackbody,
        curves,
        border,
        sky,
        dark,
    ):
        prepare()
        build()
        name = build.__name__
        try:
            results[name] = {engine: picture(name, engine) for engine in ("SHLIGHT", "CYCLES")}
            results[name]["messages"] = export_scene(bpy.context.evaluated_depsgraph_get()).report.lines()
        except RuntimeError as error:
            results[name] = {"error": str(error)}
    shlight_blender.unregister()
    (FOLDER / "results.json").write_text(json.dumps(results))


main()
