# SPDX-License-Identifier: MIT
"""Runs inside a window of Debian's Blender: changes a scene and its view in a rendered viewport, and quits."""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Quaternion

import shlight
from shlight_blender import viewport
from shlight_blender.picture_maker import PictureMaker

sys.path.append(str(Path(__file__).parent))
from debian_steps import FOLDER, area_of, start

LONGEST_WAIT, CALM = 600, 4  # ticks
found = {"updated": {}, "differs": {}, "anew": {}}
shown = []  # RenderedViewports, the latest last
jobs, ended = [], []
gathered = []  # records of light that bounces, by each picture that was done


def watch():
    """Notes the viewports that are made, and the jobs that they give to their threads."""
    make = viewport.RenderedViewport.__init__
    start, make_picture, render = PictureMaker.start, PictureMaker._make, shlight.render

    def init(self, engine):
        make(self, engine)
        shown.append(self)

    def started(self, job):
        jobs.append(job)
        start(self, job)

    def made(self, job, number):
        make_picture(self, job, number)
        ended.append(job)

    def rendered(*arguments, **options):
        result = render(*arguments, **options)
        gathered.append(result.report.records)
        return result

    viewport.RenderedViewport.__init__ = init
    shlight.render = rendered
    PictureMaker.start, PictureMaker._make = started, made


def area():
    return area_of("VIEW_3D")


def region():
    return next(region for region in area().regions if region.type == "WINDOW")


def settled():
    """Waits until the picture of the latest job is complete and drawn, and no other job has come for a while."""
    calm = 0
    for _ in range(LONGEST_WAIT):
        yield
        done = jobs and any(jobs[-1] is job for job in ended) and shown[-1]._maker.picture is shown[-1]._picture
        calm = calm + 1 if done else 0
        if calm == CALM:
            return
    raise RuntimeError(f"the viewport is not done: {shown and shown[-1]._status}")


def pixels():
    return shown[-1]._maker.picture.pixels.copy()


def set_up():
    """The factory scene on a floor, in a view of its own, small and without overlays."""
    scene = bpy.context.scene
    scene.render.engine = "SHLIGHT"
    scene.shlight.max_bounces = scene.shlight.preview_max_bounces = 0
    scene.view_settings.view_transform = "Raw"
    scene.render.preview_pixel_size = "2"
    scene.shlight.preview_max_samples = 8
    bpy.ops.mesh.primitive_plane_add(size=8, location=(0, 0, -1))
    bpy.context.object.name = "Floor"
    space = area().spaces[0]
    space.overlay.show_overlays = False
    space.show_gizmo = False
    space.shading.type = "RENDERED"


def cube():
    return bpy.data.objects["Cube"]


def vertex():
    cube().data.vertices[0].co.x += 0.5
    cube().data.update()


def show_image():
    image = bpy.data.images.new("Grid", 32, 32)
    image.generated_type = "COLOR_GRID"
    tree = bpy.data.materials["Material"].node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])


def animate():
    cube().keyframe_insert("rotation_euler", frame=1)
    cube().rotation_euler.z = 1.0
    cube().keyframe_insert("rotation_euler", frame=9)


def undo():
    bpy.ops.ed.undo_push(message="before")
    bpy.data.objects["Light"].location.z += 2
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()


def local_view():
    for seen in bpy.data.objects:
        seen.select_set(seen.name in {"Cube", "Light"})
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area(), region=region()):
        bpy.ops.view3d.localview(frame_selected=False)


def color():
    node = bpy.data.materials["Material"].node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (0.8, 0.1, 0.1, 1)


def world():
    bpy.data.worlds["World"].node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.4, 1)


def depth_of_field():
    lens = bpy.context.scene.camera.data
    lens.dof.use_dof, lens.dof.focus_object, lens.dof.aperture_fstop = True, bpy.data.objects["Floor"], 1.0


def panorama():
    lens = bpy.context.scene.camera.data
    lens.type, lens.cycles.panorama_type = "PANO", "EQUIRECTANGULAR"


def perspective():
    bpy.context.scene.camera.data.type = "PERSP"
    bpy.context.scene.camera.data.dof.use_dof = False


def exposure():
    bpy.context.scene.cycles.film_exposure = 2.0
    area().tag_redraw()  # as Blender does where a user changes it


CHANGES = {
    "select": lambda: cube().select_set(not cube().select_get()),
    "move a lamp": lambda: setattr(bpy.data.objects["Light"], "location", (1, -3, 4)),
    "lamp's power": lambda: setattr(bpy.data.lights["Light"], "energy", 500),
    "move an object": lambda: setattr(cube(), "location", (0.5, 0, 0)),
    "colour": color,
    "texture": show_image,
    "world": world,
    "vertex": vertex,
    "modifier": lambda: cube().modifiers.new("Bevel", "BEVEL"),
    "hide": lambda: bpy.data.objects["Floor"].hide_set(True),
    "show": lambda: bpy.data.objects["Floor"].hide_set(False),
    "keyframes": animate,
    "frame": lambda: bpy.context.scene.frame_set(5),
    "orbit": lambda: setattr(area().spaces[0].region_3d, "view_distance", 9.0),
    "undo": undo,
    "orthographic": lambda: setattr(area().spaces[0].region_3d, "view_perspective", "ORTHO"),
    "camera": lambda: setattr(area().spaces[0].region_3d, "view_perspective", "CAMERA"),
    "depth of field": depth_of_field,
    "panorama": panorama,
    "in focus": perspective,
    "local view": local_view,
    "exposure": exposure,
}


def steps():
    set_up()
    yield from settled()
    for name, change in CHANGES.items():
        before, count = pixels(), len(jobs)
        shown[-1]._updated = ""
        change()
        yield from settled()
        found["updated"][name] = shown[-1]._updated.split(" read in ")[0] if len(jobs) > count else None
        found["differs"][name] = float(np.abs(pixels() - before).max())
    yield from compare_with_a_viewport_made_anew()
    yield from compare_with_final_render()
    yield from light_that_bounces()
    yield from mix_of_lamps()
    yield from two_viewports()


def make_viewport_anew():
    area().spaces[0].shading.type = "SOLID"
    yield
    area().spaces[0].shading.type = "RENDERED"
    yield from settled()


def compare_with_a_viewport_made_anew():
    before = pixels()
    yield from make_viewport_anew()
    found["anew"] = bool(np.array_equal(before, pixels()))
    bpy.ops.screen.screenshot(filepath=str(FOLDER / "window.png"))
    found["region"] = [region().x, region().y, region().width, region().height]
    np.save(FOLDER / "shown.npy", pixels())


def compare_with_final_render():
    """Compares the viewport with a final render from the same view."""
    space, scene = area().spaces[0], bpy.context.scene
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area(), region=region()):
        bpy.ops.view3d.localview(frame_selected=False)
    space.region_3d.view_perspective = "PERSP"
    yield from settled()
    np.save(FOLDER / "viewport.npy", pixels())
    camera = scene.camera
    camera.matrix_world = space.region_3d.view_matrix.inverted()
    camera.data.lens, camera.data.sensor_width = space.lens, 72.0  # as a viewport has it
    camera.data.clip_start, camera.data.clip_end = space.clip_start, space.clip_end
    render, settings = scene.render, scene.shlight
    render.resolution_x, render.resolution_y = jobs[-1].frame.full_width, jobs[-1].frame.full_height
    for name in ("noise_threshold", "min_samples", "max_samples"):
        setattr(settings, name, getattr(settings, f"preview_{name}"))
    space.shading.type = "SOLID"
    render.image_settings.file_format = "OPEN_EXR"
    render.filepath = str(FOLDER / "final.exr")
    bpy.ops.render.render(write_still=True)


def light_that_bounces():
    """It is kept when the view moves, and gathered anew when a lamp does."""
    settings = bpy.context.scene.shlight
    settings.preview_max_bounces, settings.preview_noise_threshold, settings.preview_max_samples = 2, 0.1, 4
    area().spaces[0].shading.type = "RENDERED"
    yield from settled()
    count = len(gathered)
    for change in (lambda: turn(0.02), lambda: turn(0.04), lambda: setattr(bpy.data.lights["Light"], "energy", 300)):
        change()
        yield from settled()
    found["gathered"] = [gathered[count - 1], *gathered[count:]]
    changed = pixels()
    yield from make_viewport_anew()
    found["lit anew"] = bool(np.array_equal(changed, pixels()))
    area().spaces[0].shading.type = "SOLID"
    settings.preview_max_bounces = 0
    yield


def mix_of_lamps():
    """A lamp's factor changes what is drawn and renders nothing, unless the picture lacks its light."""
    settings = bpy.context.scene.shlight
    area().spaces[0].shading.type = "RENDERED"
    settings.use_light_mixer = True
    yield from settled()
    found["mixed"] = []
    for power in (0.25, 100.0):
        count, before = len(jobs), drawn()
        settings.light_mix["Light"].power = power
        yield from settled()
        found["mixed"].append((len(jobs) - count, float(drawn().mean() / before.mean())))
    settings.use_light_mixer = False
    area().spaces[0].shading.type = "SOLID"
    yield


def drawn():
    return np.array(shown[-1]._texture.read().to_list())[..., :3]


def turn(angle):
    view = area().spaces[0].region_3d
    view.view_rotation = Quaternion((0, 0, 1), angle) @ view.view_rotation


def two_viewports():
    """Both are drawn, and their threads end with them."""
    area().spaces[0].shading.type = "RENDERED"
    yield from settled()
    count = len(shown)
    other = next(each for each in bpy.context.window_manager.windows[0].screen.areas if each.type == "DOPESHEET_EDITOR")
    other.type = "VIEW_3D"
    other.spaces[0].shading.type = "RENDERED"
    yield from settled()
    found["viewports"] = len(shown) - count
    makers = [each._maker for each in shown]
    for each in bpy.context.window_manager.windows[0].screen.areas:
        if each.type == "VIEW_3D":
            each.spaces[0].shading.type = "SOLID"
    yield
    yield
    shown.clear()
    yield
    found["threads"] = sum(maker._thread is not None and maker._thread.is_alive() for maker in makers)


watch()
start(steps(), found, 0.05)
