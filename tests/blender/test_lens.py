# SPDX-License-Identifier: MIT
"""Lens of the camera: depth of field and panoramas, as in Cycles."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
import pytest

from shlight_blender.compare.places import Finder
from shlight_blender.export.camera import aperture_of
from shlight_blender.report import ExportError

SLOW = pytest.mark.slow


def set_up(studio: Any, **lens: Any) -> Any:
    """Boxes all around, before and behind what is in focus; returns the camera's data."""
    material = studio.material(Color=(0.8, 0.6, 0.4))
    studio.plane(8.0, material, location=(0, 0, -1))
    for i in range(8):
        angle, turn = i * math.pi / 4, i * math.pi / 4 + 0.3
        place = 2 * math.cos(angle), 2 * math.sin(angle), 0.1 * i - 0.5
        studio.box((0.5, 0.3, 0.4 + 0.2 * i), material, location=place, rotation_euler=(0, 0.1 * i, turn))
    studio.lamp("AREA", 200, (1, -1, 3), size=1.0)
    camera = studio.camera(location=(0.2, -0.1, 0.3), target=(1, 0.3, 0.1), **lens)
    studio.scene.cycles.samples = 512
    studio.scene.shlight.min_samples = 16
    return camera.data


APERTURES: dict[str, dict[str, Any]] = {
    "disk": {},
    "blades": {"aperture_blades": 3, "aperture_rotation": 0.4, "aperture_ratio": 2.0},
}


@pytest.mark.parametrize("aperture", APERTURES)
@pytest.mark.parametrize("kind", ["PERSP", pytest.param("ORTHO", marks=SLOW), pytest.param("PANO", marks=SLOW)])
def test_depth_of_field(studio: Any, kind: str, aperture: str) -> None:
    data = set_up(studio, type=kind, ortho_scale=4.0, clip_start=0.05)
    data.dof.use_dof = True
    data.dof.aperture_fstop = 2.0 if kind == "ORTHO" else 0.1
    data.dof.focus_distance = 1.3
    for name, value in APERTURES[aperture].items():
        setattr(data.dof, name, value)
    studio.compare(mean=5e-3, error=4e-3)
    assert studio.messages() == []


def test_focus_is_on_an_object(studio: Any) -> None:
    data = set_up(studio)
    rig = studio.link("Rig", bpy.data.armatures.new("Rig"), (0, 0, 0))
    camera = studio.scene.camera
    camera.matrix_world = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (1, 2, 3, 1))  # looks down
    rig.location = (0, 7, -1.5)
    data.dof.use_dof, data.dof.focus_object, data.dof.aperture_fstop = True, rig, 2.0
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = camera.evaluated_get(depsgraph)
    aperture = aperture_of(evaluated.data, np.array(evaluated.matrix_world), depsgraph)
    assert abs(aperture["focus_distance"] - 4.5) <= 1e-6
    assert abs(aperture["aperture_size"] - 0.5 * 1e-3 * data.lens / 2.0) <= 1e-9


PANORAMAS = ["EQUIRECTANGULAR", "FISHEYE_EQUISOLID", "MIRRORBALL", "FISHEYE_EQUIDISTANT", "FISHEYE_LENS_POLYNOMIAL"]
PANORAMAS += ["EQUIANGULAR_CUBEMAP_FACE", "CENTRAL_CYLINDRICAL"]


@pytest.mark.parametrize("panorama", [PANORAMAS[0], *(pytest.param(name, marks=SLOW) for name in PANORAMAS[1:])])
@pytest.mark.parametrize("transparent", [True, pytest.param(False, marks=SLOW)])
def test_panorama(studio: Any, panorama: str, transparent: bool) -> None:
    data = set_up(studio, type="PANO", sensor_width=30.0, shift_x=0.1, shift_y=-0.03)
    if panorama not in data.bl_rna.properties["panorama_type"].enum_items:
        pytest.skip("this Blender does not have it")
    data.panorama_type = panorama
    data.longitude_min, data.longitude_max, data.latitude_min, data.latitude_max = -2.0, 2.7, -1.0, 1.2
    data.fisheye_fov = 3.0
    if panorama == "CENTRAL_CYLINDRICAL":
        data.central_cylindrical_range_u_min, data.central_cylindrical_range_v_max = -1.5, 1.7
        data.central_cylindrical_radius = 1.3
    render = studio.scene.render
    render.resolution_x, render.resolution_y = 96, 72
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.1, 0.95, 0.0, 0.9
    render.film_transparent = transparent
    studio.compare(mean=2e-3, error=1e-3, alpha=2e-3)
    assert studio.messages() == []


def test_window_coordinates_of_a_panorama_are_named(studio: Any) -> None:
    data = set_up(studio, type="PANO")
    material = bpy.data.materials["Material"]
    coordinates = material.node_tree.nodes.new("ShaderNodeTexCoord")
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    material.node_tree.links.new(coordinates.outputs["Window"], shader.inputs["Color"])
    assert any("'Window' coordinates are not supported here" in line for line in studio.messages())
    # Coordinates of the camera agree with Cycles.
    data.panorama_type = "EQUIRECTANGULAR"
    material.node_tree.links.new(coordinates.outputs["Camera"], shader.inputs["Color"])
    studio.compare(mean=5e-3, error=2e-3)
    assert studio.messages() == []


def test_no_object_is_taken_for_what_a_panorama_shows(studio: Any) -> None:
    set_up(studio, type="PANO")
    assert Finder(studio.scene, bpy.context.view_layer).seen_at(32, 24).place == "Camera 'Camera'"


def test_spherical_stereo_is_named(studio: Any) -> None:
    data = set_up(studio, type="PANO")
    studio.scene.render.use_multiview = data.stereo.use_spherical_stereo = True
    assert any("spherical stereo is not supported" in line for line in studio.messages())


def test_cameras_of_other_types_are_errors(studio: Any) -> None:
    data = set_up(studio)
    if "CUSTOM" not in data.bl_rna.properties["type"].enum_items:
        pytest.skip("this Blender has no others")
    data.type = "CUSTOM"
    with pytest.raises(ExportError, match="custom cameras are not supported"):
        studio.messages()
