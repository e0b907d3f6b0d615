# SPDX-License-Identifier: MIT
"""Runs inside Debian's Blender in the background: renders small scenes with shlight and Cycles, writes results.json."""

import json
import math
import sys
from pathlib import Path

import bpy

import shlight_blender
from shlight_blender.compat import nodes_by_engine
from shlight_blender.export import export_scene

sys.path.append(str(Path(__file__).parent))
from studio import Studio

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
GOLD = (0.8, 0.6, 0.2)


def lit_by(studio, kind, energy, rotation=(0, 0, 0), scale=(1, 1, 1), **values):
    studio.plane(material=studio.material())
    studio.ball(0.5, studio.material(Color=GOLD), location=(-0.8, 0.2, 0.5))
    return studio.lamp(kind, energy, (0.3, -0.4, 1.7), rotation_euler=rotation, scale=scale, **values)


def point(studio):
    lit_by(studio, "POINT", 60, shadow_soft_size=0.5, color=(1.0, 0.7, 0.4))


def area(studio):
    lit_by(studio, "AREA", 120, (0.35, 0.2, 0.5), (-1.5, 0.6, -1.0), shape="RECTANGLE", size=1, size_y=0.7)
    rotation, scale = (0.3, 0.2, 0.5), (1.5, 0.6, 2.0)
    studio.area(60, (1, -0.5, 1.5), rotation_euler=rotation, scale=scale, shape="SQUARE", size=0.7)


def spot(studio):
    lit_by(studio, "SPOT", 200, shadow_soft_size=0.3, spot_size=1.0, spot_blend=0.5)


def small_spot(studio):
    rotation, scale, shape = (0.2, 0.3, 0.5), (1.6, 0.7, 1.2), {"spot_size": 0.9, "spot_blend": 0.3}
    lit_by(studio, "SPOT", 200, rotation, scale, shadow_soft_size=0.0, color=(1, 0.5, 0.2), **shape)


def small_point(studio):
    lit_by(studio, "POINT", 60, shadow_soft_size=0.0)


def sun(studio):
    lit_by(studio, "SUN", 3, (0.4, 0.5, 0), angle=0.9)


def small_sun(studio):
    lit_by(studio, "SUN", 3, (0.4, 0.5, 0), angle=0.0)


def spread(studio):
    shape = {"shape": "RECTANGLE", "size": 1.4, "size_y": 0.5}
    lit_by(studio, "AREA", 60, (0.2, 0.1, 0.3), spread=math.radians(60), **shape)


def textured_by_default(studio):
    """An area lamp that shines as a picture without symmetry."""
    made = lit_by(studio, "AREA", 60, (0.4, 0.2, 0.3), shape="RECTANGLE", size=1.5, size_y=1.0)
    made.data.use_nodes = True
    tree = made.data.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = studio.picture([[(0.1 + 0.2 * x, 0.1 + 0.4 * y, 0.3) for x in range(4)] for y in range(3)])
    node.extension, node.interpolation = "EXTEND", "Closest"
    tree.links.new(node.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    return tree, node


def textured(studio):
    tree, node = textured_by_default(studio)
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Parametric"], node.inputs["Vector"])


def smooth(studio):
    """Sharp edges by an angle, mirrored, behind a border and a shifted lens."""
    studio.plane(material=studio.material())
    made = studio.ball(0.8, studio.material(Color=GOLD), location=(-1.2, 0, 0.8), scale=(0.9, 0.9, 1))
    made.data.use_auto_smooth, made.data.auto_smooth_angle = True, math.radians(11.0)
    studio.link("Twin", made.data, (1.2, 0, 0.8), rotation_euler=(0.3, 0.4, 0.5), scale=(-1.1, 0.6, 0.8))
    studio.ball(0.4, studio.material(Color=(0.2, 0.6, 0.8)), location=(0, -1.8, 0.5), scale=(1, 1.2, 1))
    studio.area(150, size=0.8)
    render, camera = studio.scene.render, studio.scene.camera.data
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.21, 0.83, 0.13, 0.66
    camera.shift_x, camera.shift_y, camera.sensor_fit = 0.1, -0.05, "VERTICAL"


def shine_on(studio, shader, **values):
    material = studio.material(shader, **{"Roughness": 0.5} | values)
    studio.plane(material=material)
    studio.ball(1.0, material, location=(0, 0, 1.1))
    studio.lamp("POINT", 150, (1.5, -2, 3), shadow_soft_size=0.6)
    studio.lamp("POINT", 80, (-2, -2, 2), shadow_soft_size=0.4)


def glossy(studio):
    """Twice as bright by the film's exposure."""
    studio.scene.cycles.film_exposure = 2.0
    shine_on(studio, "ShaderNodeBsdfGlossy", Color=(0.9, 0.6, 0.3), distribution="GGX")


def metal(studio):
    shine_on(studio, "ShaderNodeBsdfPrincipled", Base_Color=(0.9, 0.6, 0.3), Metallic=1.0, Specular=0.7)


def principled(studio):
    shine_on(studio, "ShaderNodeBsdfPrincipled", Base_Color=(0.3, 0.6, 0.8), Specular=0.8)


def brushed(studio):
    """Narrow highlights have much noise in Cycles."""
    studio.scene.cycles.samples, studio.scene.shlight.noise_threshold = 4096, 2e-3
    inputs = {"Base_Color": (0.9, 0.6, 0.3), "Metallic": 1.0, "Anisotropic": 0.7, "Anisotropic_Rotation": 0.1}
    shine_on(studio, "ShaderNodeBsdfPrincipled", **inputs)


def satin(studio):
    """Rough, under sheen."""
    inputs = {"Base_Color": (0.8, 0.3, 0.2), "Specular": 0.0, "Sheen": 1.0, "Sheen_Tint": 0.7}
    shine_on(studio, "ShaderNodeBsdfPrincipled", **inputs)


def several_bounces(studio):
    """Balls whose microfacets light each other."""
    studio.scene.cycles.samples = 2048
    inputs = {"Color": (0.9, 0.6, 0.3), "Roughness": 0.6, "distribution": "MULTI_GGX"}
    studio.ball(1.0, studio.material("ShaderNodeBsdfGlossy", **inputs), location=(-1.1, 0, 1.1))
    inputs = {"Base_Color": (0.9, 0.6, 0.3), "Metallic": 0.7, "Roughness": 0.6, "distribution": "MULTI_GGX"}
    studio.ball(1.0, studio.material("ShaderNodeBsdfPrincipled", **inputs), location=(1.1, 0, 1.1))
    studio.lamp("POINT", 150, (1.5, -2, 3), shadow_soft_size=0.6)


def lacquer(studio):
    """A rough clear coat over bumps."""
    studio.scene.cycles.samples = 2048
    inputs = {"Base_Color": (0.1, 0.2, 0.3), "Specular": 0.0, "Clearcoat": 1.0, "Clearcoat_Roughness": 0.5}
    shine_on(studio, "ShaderNodeBsdfPrincipled", **inputs)
    tree = next(each.active_material for each in studio.scene.objects if each.active_material).node_tree
    noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
    bump.inputs["Distance"].default_value = 0.1
    tree.links.new(noise.outputs["Fac"], bump.inputs["Height"])
    for name in ("Normal", "Clearcoat Normal"):
        tree.links.new(bump.outputs["Normal"], tree.nodes["Principled BSDF"].inputs[name])


def velvet(studio):
    material = studio.material("ShaderNodeBsdfVelvet", Color=(0.8, 0.3, 0.2), Sigma=0.6)
    studio.plane(material=material)
    studio.ball(1.0, material, location=(0, 0, 1.1))
    studio.lamp("POINT", 150, (1.5, -2, 3), shadow_soft_size=0.6)


def translucent(studio):
    """A ball and a sheet before lamps."""
    paper = studio.material("ShaderNodeBsdfTranslucent", Color=(0.9, 0.6, 0.4))
    studio.plane(material=studio.material())
    studio.ball(1.0, paper, location=(0.4, 0, 1.1))
    studio.box((0.02, 1.5, 2), paper, location=(-1.2, 0.3, 1))
    for place in ((0.4, 0, 1.1), (-2.5, 1, 2)):
        studio.lamp("POINT", 80, place, shadow_soft_size=0.4)


def transmission(studio):
    """Balls that light goes through, two rough ones and one of another shader."""
    for place, roughness in ((-1.7, 0.0), (0, 0.3)):
        inputs = {"Roughness": roughness, "Transmission_Roughness": roughness, "IOR": 1.3, "Specular_Tint": 0.5}
        glass = studio.material("ShaderNodeBsdfPrincipled", Base_Color=(0.9, 0.7, 0.6), Transmission=1.0, **inputs)
        studio.ball(0.8, glass, location=(place, 0, 0.9))
    studio.ball(0.8, studio.material("ShaderNodeBsdfRefraction", IOR=1.3, Roughness=0.0), location=(1.7, 0, 0.9))
    studio.plane(material=studio.material())
    studio.plain_world((0.5, 0.6, 0.7))
    cycles = studio.scene.cycles
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = studio.scene.shlight.max_bounces = 4


def curves(studio):
    """Under a cube that glows by its temperature."""
    studio.plane(material=studio.material())
    bpy.ops.curve.primitive_bezier_circle_add(location=(0, 0, 0.5))
    bpy.context.object.data.bevel_depth = 0.2
    bpy.ops.object.text_add(location=(-0.5, 0, 0.1), rotation=(1.2, 0, 0.3))
    bpy.context.object.data.extrude = 0.1
    material = studio.material("ShaderNodeEmission", Strength=8.0)
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeBlackbody")
    node.inputs[0].default_value = 2400.0
    tree.links.new(node.outputs[0], tree.nodes["Emission"].inputs["Color"])
    studio.box((0.5, 0.5, 0.5), material, location=(0.3, 0, 1.4))


def noise(studio):
    """A floor of Musgrave's noise, which no later Blender has, where plain noise and waves say."""
    material = studio.material()
    tree = material.node_tree
    kinds = ("TexWave", "TexNoise", "TexMusgrave", "ValToRGB")
    wave, plain, made, ramp = (tree.nodes.new(f"ShaderNode{kind}") for kind in kinds)
    made.musgrave_type = "HETERO_TERRAIN"
    made.inputs["Offset"].default_value = 0.6
    tree.links.new(wave.outputs["Fac"], plain.inputs["Distortion"])
    tree.links.new(plain.outputs["Color"], made.inputs["Vector"])
    tree.links.new(made.outputs["Fac"], ramp.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], tree.nodes["Diffuse BSDF"].inputs["Color"])
    studio.plane(material=material)
    studio.area(120, (0, 0, 2), shape="RECTANGLE", size=1, size_y=0.7)


def sky(studio):
    """A world of a sky and its sun."""
    studio.plane(material=studio.material())
    studio.ball(1.0, studio.material(Color=GOLD), location=(0, 0, 1.1))
    studio.scene.shlight.world_width, studio.scene.shlight.shadow_rays = 512, 64
    background = studio.world(strength=0.1)
    tree = background.id_data
    node = tree.nodes.new("ShaderNodeTexSky")
    node.sun_elevation, node.sun_rotation = 0.5, 0.8
    tree.links.new(node.outputs[0], background.inputs["Color"])


def dark(studio):
    """Lit by a lamp that is not yet turned on, with nothing behind the plane's edge."""
    studio.plane(1.0, studio.material("ShaderNodeBsdfPrincipled"))
    studio.box(material=studio.material("ShaderNodeBsdfHair"))
    studio.lamp("POINT", 0, (0, 0, 2))
    studio.scene.render.film_transparent = True


def panoramic(studio):
    lit_by(studio, "POINT", 60)
    studio.resolution(48, 48)
    camera = studio.scene.camera.data
    camera.type = "PANO"
    camera.cycles.panorama_type = "FISHEYE_EQUISOLID"
    camera.cycles.fisheye_fov = 2.0
    camera.dof.use_dof = True
    camera.dof.focus_distance, camera.dof.aperture_fstop = 4.0, 0.05


def orthographic(studio):
    """Out of focus, with a lens that Cycles 3.4 puts into the near clip plane."""
    lit_by(studio, "POINT", 60)
    camera = studio.scene.camera.data
    camera.type, camera.ortho_scale, camera.clip_start = "ORTHO", 4.0, 3.0
    camera.dof.use_dof = True
    camera.dof.focus_distance, camera.dof.aperture_fstop = 2.0, 1.5


def simplified(studio):
    """Boxes before, beside and far from the camera, some of which are culled, and no light from the world."""
    studio.plane(60, material=studio.material())
    studio.lamp("SUN", 2, (0, 0, 5), angle=0.2, rotation_euler=(1.1, 0.6, 0.4))
    for i in range(64):
        made = studio.box((0.5, 0.6, 0.7), location=(3 * (i % 8 - 4), 3 * (i // 8 - 4), 0.4))
        made.cycles.use_camera_cull, made.cycles.use_distance_cull = bool(i % 3), bool(i % 4)
    render, cycles = studio.scene.render, studio.scene.cycles
    render.use_simplify = cycles.use_camera_cull = cycles.use_distance_cull = True
    cycles.camera_cull_margin, cycles.distance_cull_margin = 0.05, 8.0
    studio.world((0.3, 0.3, 0.3))
    studio.scene.view_layers[0].use_sky = False


def flat_camera(studio):
    lit_by(studio, "POINT", 60)
    studio.scene.camera.scale = (1, 0, 1)


def coarse(studio):
    """Balls of few faces, with the default of Shadow Terminator and with a Shading Offset."""
    studio.ball(1.0, studio.material(), rings=4, location=(-1.1, 0, 1))
    studio.terminator(studio.ball(1.0, studio.material(), rings=4, location=(1.1, 0, 1)), 0.1, 0.3)
    studio.lamp("SUN", 3, (0, 0, 0), rotation_euler=(0.2, 1.1, 0), angle=0.3)


def displaced(studio):
    """A ball whose sharp edges come apart."""
    material = studio.material(Color=GOLD)
    material.cycles.displacement_method = "DISPLACEMENT"
    tree = material.node_tree
    waves, moves = tree.nodes.new("ShaderNodeTexGradient"), tree.nodes.new("ShaderNodeDisplacement")
    waves.gradient_type = "SPHERICAL"
    moves.inputs["Midlevel"].default_value = 0.2
    tree.links.new(waves.outputs["Fac"], moves.inputs["Height"])
    tree.links.new(moves.outputs["Displacement"], tree.get_output_node("CYCLES").inputs["Displacement"])
    made = studio.ball(1.0, material, location=(0, 0, 1.1))
    made.data.use_auto_smooth, made.data.auto_smooth_angle = True, math.radians(11.0)
    studio.plane(material=studio.material())
    studio.area(150, size=0.8)


SCENES = [
    point, area, spot, small_spot, small_point, sun, small_sun, spread, textured, textured_by_default, smooth, glossy,
    metal, brushed, principled, several_bounces, satin, lacquer, velvet, translucent, transmission, curves, noise, sky,
    dark, panoramic, orthographic, simplified, flat_camera, coarse, displaced,
]  # fmt: skip

polls = [item.poll for item in nodes_by_engine()]
shlight_blender.register()
results = {}
for build in SCENES:
    folder = FOLDER / build.__name__
    studio = Studio(folder)
    studio.resolution(36, 27)
    studio.camera()
    build(studio)
    try:
        results[folder.name] = {engine: str(studio.write(engine)) for engine in ("SHLIGHT", "CYCLES")}
        results[folder.name]["messages"] = export_scene(bpy.context.evaluated_depsgraph_get()).report.lines()
    except RuntimeError as error:
        results[folder.name] = {"error": str(error)}
shlight_blender.unregister()
results["left_menu"] = polls == [item.poll for item in nodes_by_engine()] != []
(FOLDER / "results.json").write_text(json.dumps(results))
