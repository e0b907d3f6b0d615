# SPDX-License-Identifier: MIT
"""Pictures of shlight against pictures of Cycles: camera, lamps and meshes."""

from __future__ import annotations

import math
from typing import Any

import bmesh
import bpy
import numpy as np
import pytest

from shlight.metrics import rel_mse

# --- camera


def test_perspective_camera_and_its_handedness(studio: Any) -> None:
    studio.still_life()
    studio.camera()
    image, reference = studio.compare()
    right_way = rel_mse(image, reference)
    for turned in (image[::-1], image[:, ::-1], image[::-1, ::-1]):
        assert rel_mse(turned, reference) > 20 * right_way


@pytest.mark.parametrize("fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
def test_lens_shift_sensor_fit_and_pixel_aspect(studio: Any, fit: str) -> None:
    studio.still_life()
    studio.camera(lens=40, shift_x=0.12, shift_y=-0.07, sensor_fit=fit, sensor_width=30, sensor_height=26)
    studio.scene.camera.scale = (2.0, 0.5, 3.0)  # which means nothing
    render = studio.scene.render
    render.resolution_x, render.resolution_y = 36, 50
    render.pixel_aspect_x, render.pixel_aspect_y = 1.5, 1.0
    studio.compare()


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_clipping_planes(studio: Any, kind: str) -> None:
    studio.still_life()
    studio.camera(type=kind, clip_start=6.9, clip_end=8.2, ortho_scale=5.5, shift_x=0.1, shift_y=0.05)
    _, reference = studio.compare()
    assert (reference[..., :3].max(axis=-1) == 0).mean() > 0.05, "the planes cut nothing off"


@pytest.mark.parametrize("crop", [True, False])
def test_render_border(studio: Any, crop: bool) -> None:
    studio.still_life()
    studio.camera()
    render = studio.scene.render
    render.resolution_percentage = 90
    whole = studio.render("SHLIGHT")
    render.use_border, render.use_crop_to_border = True, crop
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.22, 0.84, 0.13, 0.66
    image, _ = studio.compare()
    height, width = whole.shape[:2]
    left, right = int(np.float32(0.22) * width), int(np.float32(0.84) * width)
    bottom, top = int(np.float32(0.13) * height), int(np.float32(0.66) * height)
    part = image if crop else image[height - top : height - bottom, left:right]
    assert image.shape[:2] == ((top - bottom, right - left) if crop else (height, width))
    expected = whole[height - top : height - bottom, left:right]
    # The pixels are the same; the samples within them need not be.
    assert rel_mse(part, expected) < 1e-2


# --- lamps


def test_temperature_exposure_and_unnormalized_power(studio: Any) -> None:
    studio.plane(material=studio.material())
    point = studio.lamp("POINT", 3, (-1.0, 0.5, 1.5), shadow_soft_size=0.4, normalize=False)
    area = studio.area(4, (1.5, -1, 1.5), normalize=False, size=0.7)
    for lamp in (point.data, area.data):
        lamp.use_temperature = True
        lamp.exposure = 1.25
    point.data.temperature, area.data.temperature = 2700.0, 9000.0
    studio.camera()
    studio.compare()


@pytest.mark.parametrize("scale", [(2.0, 0.5, 0.3), (-1.5, 1.0, 1.0), (-1.0, -2.0, -0.5)])
def test_area_lamp_under_any_scale(studio: Any, scale: tuple[float, float, float]) -> None:
    # Two planes face each other: the lamp between them lights one of them only.
    studio.plane(material=studio.material(Color=(0.8, 0.4, 0.4)))
    studio.plane(
        material=studio.material(Color=(0.4, 0.4, 0.8)), location=(0, 3, 3), rotation_euler=(math.pi / 2, 0, 0)
    )
    studio.area(
        120, (0, 0.5, 1.2), shape="RECTANGLE", size=1.0, size_y=0.7, rotation_euler=(0.35, 0.2, 0.5), scale=scale
    )
    studio.camera()
    studio.resolution(64, 48)
    studio.compare()


@pytest.mark.slow
def test_a_crowd_of_far_lamps(studio: Any) -> None:
    studio.still_life()
    studio.camera()
    data = bpy.data.lights.new("Far", "POINT")
    data.energy, data.shadow_soft_size = 300.0, 0.05
    rng = np.random.default_rng(3)
    for _ in range(300):
        x, y, z = rng.normal(size=3)
        direction = np.array([x, y, abs(z) + 0.3]) / np.linalg.norm([x, y, abs(z) + 0.3])
        studio.link("Far", data, tuple(rng.uniform(30, 60) * direction))
    studio.resolution(32, 24)
    studio.compare(mean=5e-3)


# --- film


@pytest.mark.parametrize(
    ("kind", "width"),
    [("GAUSSIAN", 1.5), pytest.param("BLACKMAN_HARRIS", 1.5, marks=pytest.mark.slow), ("BLACKMAN_HARRIS", 4.0)],
)
def test_pixel_filters(studio: Any, kind: str, width: float) -> None:
    """Bright edges against grey, as wide as the filter makes them."""
    studio.world((0.5, 0.5, 0.5))
    glowing = studio.material("ShaderNodeEmission", Strength=2.0)
    for i in range(3):
        studio.plane(0.35, glowing, location=(1.1 * (i - 1), 0.2 * i, 0)).rotation_euler = (0, 0, 0.2 + 0.3 * i)
    studio.camera((0, 0, 4), (0, 0, 0))
    studio.resolution(32, 24)
    cycles = studio.scene.cycles
    cycles.pixel_filter_type, cycles.filter_width, cycles.samples = kind, width, 4096
    studio.scene.shlight.noise_threshold = 1e-3
    studio.compare(mean=1e-3, error=1e-4)


# --- meshes


def test_mirrored_instances_and_smooth_normals(studio: Any) -> None:
    studio.lit_floor()
    ball = studio.ball(0.7, studio.material(Color=(0.8, 0.6, 0.2)), rings=6, location=(-1.4, 0, 0.8))
    ball.scale = (1.0, 0.6, 1.2)
    # The same data mirrored and sheared by a rotated parent's scale.
    mirrored = studio.link("Mirrored", ball.data, (1.0, 0.4, 0.7), scale=(-0.7, 1.0, 0.9))
    mirrored.rotation_euler = (0.4, 0.3, 0.9)
    wedge = studio.mesh(
        "Wedge",
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
        studio.material(),
    )
    wedge.location = (-0.4, -1.6, 0)
    studio.link("Twin", wedge.data, (0.9, -1.4, 0), scale=(-1, -1, -1)).location.z = 1.0
    studio.compare()


def test_smooth_and_flat_faces_and_sharp_edges(studio: Any) -> None:
    studio.lit_floor()
    ball = studio.ball(0.9, studio.material(Color=(0.7, 0.7, 0.7)), rings=8, location=(0, 0, 0.9))
    polygons = ball.data.polygons
    for index in range(0, len(polygons), 3):
        polygons[index].use_smooth = False
    sharp = np.zeros(len(ball.data.edges), dtype=bool)
    sharp[::4] = True
    ball.data.attributes.new("sharp_edge", "BOOLEAN", "EDGE").data.foreach_set("value", sharp)
    studio.compare()


def test_several_materials_and_slots_of_the_object(studio: Any) -> None:
    studio.lit_floor()
    colours = [(0.8, 0.1, 0.1), (0.1, 0.8, 0.1), (0.1, 0.1, 0.8)]
    box = studio.box((1, 1, 1), location=(-1.2, 0, 0.5))
    for colour in colours:
        box.data.materials.append(studio.material(Color=colour))
    box.data.polygons.foreach_set("material_index", [0, 1, 2, 1, 7, 2])
    other = studio.link("Other", box.data, (1.0, 0, 0.5))
    other.material_slots[1].link = "OBJECT"
    other.material_slots[1].material = studio.material(Color=(0.9, 0.9, 0.1))
    other.material_slots[2].link = "OBJECT"  # an empty slot
    studio.compare()


def test_modifiers_and_instances_of_geometry_nodes(studio: Any) -> None:
    """Boxes in a row, and balls on the corners of a tetrahedron, their material set by the nodes."""
    studio.lit_floor()
    box = studio.box((0.5, 0.5, 0.5), studio.material(Color=(0.7, 0.3, 0.6)), location=(-2, 0.6, 0.6))
    subdivision = box.modifiers.new("Subdivision", "SUBSURF")
    subdivision.render_levels, subdivision.levels = 2, 0
    array = box.modifiers.new("Array", "ARRAY")
    array.count = 3
    array.relative_offset_displace = (1.2, 0.7, 0.2)
    ball = studio.ball(0.3, studio.material(Color=(0.2, 0.2, 0.8)), location=(-2, -1.5, 0.4))

    def painted_balls(tree: Any) -> Any:
        source, paint = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeSetMaterial")
        source.inputs["Object"].default_value = ball
        paint.inputs["Material"].default_value = studio.material(Color=(0.8, 0.5, 0.1))
        tree.links.new(source.outputs["Geometry"], paint.inputs["Geometry"])
        return paint.outputs["Geometry"]

    corners = [(0, 0, 0.4), (1.5, 0, 0.4), (0, 1.5, 0.4), (0.3, 0.3, 1.5)]
    studio.on_points(corners, [(0, 1, 2), (0, 1, 3)], painted_balls, Scale=(1.0, 0.7, 1.3))
    studio.compare()


def test_curves_texts_and_metaballs(studio: Any) -> None:
    studio.lit_floor()
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.12
    spline = curve.splines.new("POLY")
    spline.points.add(2)
    for point, place in zip(spline.points, ((-1.5, 0, 0.3), (-0.5, 0.6, 0.9), (0.2, -0.4, 0.4)), strict=True):
        point.co = (*place, 1)
    studio.link("Curve", curve)
    studio.link("Curve twice", curve, (0.4, -1.2, 0), scale=(-1, 1, 1))
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "Rg", 0.1
    studio.link("Text", text, (0.6, 0, 0.1), rotation_euler=(1.2, 0, 0.2))
    meta = bpy.data.metaballs.new("Meta")
    meta.elements.new().radius = 1.0
    studio.link("Meta", meta, (-0.2, 1.8, 0.6))
    studio.compare(error=1e-2)


@pytest.mark.slow
def test_emissive_icosphere(studio: Any) -> None:
    """1280 faces that glow, as one light."""
    studio.plane(material=studio.material())
    studio.box((0.5, 0.5, 0.9), studio.material(Color=(0.3, 0.6, 0.7)), location=(0.5, 0.2, 0.45))
    globe = studio.mesh("Globe", [], [], studio.material("ShaderNodeEmission", Color=(1.0, 0.6, 0.3), Strength=12.0))
    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=4, radius=0.4)
    shape.to_mesh(globe.data)
    shape.free()
    globe.location, globe.scale = (-0.8, 0, 1), (1, 0.7, 1.2)
    assert len(globe.data.polygons) == 1280
    studio.camera()
    studio.scene.shlight.pixel_samples = 64
    image, reference = studio.compare(mean=2e-3, error=2e-3)
    assert reference[..., 0].max() > 11.0, "the lamp is not in the picture"
    assert image[..., 0].max() == pytest.approx(12.0, rel=1e-3)


def test_hidden_objects(studio: Any) -> None:
    studio.still_life()
    studio.box((1, 1, 1), location=(0, -2, 1)).hide_render = True
    hidden = bpy.data.collections.new("Hidden")
    hidden.hide_render = True
    studio.scene.collection.children.link(hidden)
    hidden.objects.link(studio.box((1, 1, 1), location=(0, -2, 1)))
    studio.scene.collection.objects.unlink(hidden.objects[0])
    studio.lamp("POINT", 500, (0, 0, 4)).hide_render = True
    studio.camera()
    studio.compare()
