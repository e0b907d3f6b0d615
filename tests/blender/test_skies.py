# SPDX-License-Identifier: MIT
"""Sky Textures of worlds, against Cycles: what is seen of them all around, and what they and their suns light."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest

from shlight_blender.export.nodes import Surroundings
from shlight_blender.export.world import World, world_of_nodes
from shlight_blender.report import ExportReport

KINDS = bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items.keys()
WITH_SUN = [kind for kind in KINDS if kind not in ("PREETHAM", "HOSEK_WILKIE")]
# Angles and turns without symmetry.
ELEVATION, TURN = 0.5, 0.8


def add_sky(studio: Any, kind: str = WITH_SUN[-1], strength: float = 0.1, **properties: Any) -> Any:
    """A world of a sky; returns the node."""
    lit = studio.world(strength=strength)
    sky = lit.id_data.nodes.new("ShaderNodeTexSky")
    sky.sky_type, sky.sun_elevation, sky.sun_rotation = kind, ELEVATION, TURN
    for name, value in properties.items():
        if name == "dust":
            setattr(sky, "aerosol_density" if hasattr(sky, "aerosol_density") else "dust_density", value)
        else:
            setattr(sky, name, value)
    lit.id_data.links.new(sky.outputs["Color"], lit.inputs["Color"])
    return sky


def looks_as_in_cycles(studio: Any, few: float = 0.01) -> None:
    """All around, where it is not dark: all but few pixels, in which light changes, within 1 %; and the mean."""
    studio.all_around(128)
    studio.scene.shlight.pixel_samples, studio.scene.cycles.samples = 16, 128
    studio.scene.world.cycles.sampling_method = "NONE"  # which takes Cycles time to prepare
    image, reference = (studio.render(engine)[..., :3] for engine in ("SHLIGHT", "CYCLES"))
    bright = reference.max(axis=-1) > 1e-2 * reference.max()
    error = np.abs(image - reference).max(axis=-1) / np.maximum(reference.max(axis=-1), 1e-6)
    assert np.quantile(error[bright], 1.0 - few) <= 0.01
    assert np.abs(image - reference).mean() <= 3e-3 * reference.mean()
    assert abs(image.mean() / reference.mean() - 1.0) <= 2e-3


@pytest.mark.slow
@pytest.mark.parametrize("kind", WITH_SUN)
@pytest.mark.parametrize(
    "air",
    [
        {},
        {"sun_elevation": math.radians(95.0)},
        {"sun_elevation": math.radians(-2.0)},
        {"altitude": 3000.0, "air_density": 2.0, "dust": 4.0, "ozone_density": 3.0},
    ],
)
def test_scattered_light(studio: Any, kind: str, air: dict[str, float]) -> None:
    add_sky(studio, kind, sun_disc=False, **air)
    looks_as_in_cycles(studio)
    assert studio.messages() == []


@pytest.mark.parametrize(
    ("sun", "turbidity"), [pytest.param((0.6, 0.3, 0.5), 2.2, marks=pytest.mark.slow), ((-0.7, 0.7, 0.05), 6.0)]
)
def test_the_sky_of_preetham(studio: Any, sun: tuple[float, float, float], turbidity: float) -> None:
    add_sky(studio, "PREETHAM", sun_direction=sun, turbidity=turbidity)
    looks_as_in_cycles(studio)
    assert studio.messages() == []


@pytest.mark.parametrize(
    ("sun", "turbidity", "ground"),
    [
        ((0.6, 0.3, 0.5), 2.2, 0.3),
        pytest.param((0, 0, 1), 1.0, 1.0, marks=pytest.mark.slow),
        pytest.param((-0.7, 0.7, 0.05), 6.5, 0.7, marks=pytest.mark.slow),
        pytest.param((0, 1, -0.3), 9.5, 0.0, marks=pytest.mark.slow),
    ],
)
def test_the_sky_of_hosek_and_wilkie(
    studio: Any, sun: tuple[float, float, float], turbidity: float, ground: float
) -> None:
    add_sky(studio, "HOSEK_WILKIE", sun_direction=sun, turbidity=turbidity, ground_albedo=ground)
    looks_as_in_cycles(studio)
    assert studio.messages() == []


@pytest.mark.parametrize("kind", WITH_SUN)
@pytest.mark.parametrize(
    "sun",
    [
        {},
        pytest.param({"sun_size": math.radians(0.05)}, marks=pytest.mark.slow),
        pytest.param({"sun_size": math.radians(4.0)}, marks=pytest.mark.slow),
        pytest.param({"sun_size": math.radians(8.0)}, marks=pytest.mark.slow),
        pytest.param({"sun_elevation": math.radians(0.1), "sun_intensity": 3.0}, marks=pytest.mark.slow),
    ],
)
def test_what_a_sky_and_its_sun_light(studio: Any, kind: str, sun: dict[str, float]) -> None:
    studio.plane(material=studio.material(Color=(0.7, 0.6, 0.5)))
    studio.ball(material=studio.material(Color=(0.8, 0.7, 0.6)), rings=48, location=(0, 0, 1))
    studio.camera(target=(0, 0, 0.8))
    studio.resolution(32, 24)
    studio.scene.shlight.shadow_rays, studio.scene.cycles.samples = 64, 512
    add_sky(studio, kind, sun_disc=True, **sun)
    studio.compare(error=2e-3)


def world_read(studio: Any) -> World:
    world, report = studio.scene.world, ExportReport()
    found = world_of_nodes(world, "World", 64, Surroundings(), report)
    assert report.lines() == []
    return found


def test_a_sun_of_its_own(studio: Any) -> None:
    """It stands where the node says, a mix and a strength dim its light, and links to Vector do nothing."""
    sky = add_sky(studio, strength=1.0)
    (plain,) = world_read(studio).suns
    assert plain.angle == pytest.approx(sky.sun_size)
    flat = math.cos(ELEVATION)
    towards = [flat * math.sin(TURN), flat * math.cos(TURN), math.sin(ELEVATION)]
    np.testing.assert_allclose(plain.direction, np.negative(towards), atol=1e-5)
    tree = sky.id_data
    mapping, mix = (tree.nodes.new(f"ShaderNode{name}") for name in ("Mapping", "MixShader"))
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, 1.1)
    tree.links.new(mapping.outputs["Vector"], sky.inputs[0])
    mix.inputs["Fac"].default_value = 0.25
    lit = tree.nodes["Background"]
    lit.inputs["Strength"].default_value = 3.0
    tree.links.new(lit.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    (mixed,) = world_read(studio).suns
    np.testing.assert_allclose(mixed.direction, plain.direction, atol=1e-6)
    np.testing.assert_allclose(mixed.irradiance, 0.75 * plain.irradiance, rtol=1e-5)


def test_a_turned_sky(studio: Any) -> None:
    sky = add_sky(studio, sun_disc=False)
    tree = sky.id_data
    place, mapping = (tree.nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "Mapping"))
    mapping.inputs["Rotation"].default_value, mapping.inputs["Scale"].default_value = (0.3, 0.2, 1.1), (1.0, 2.0, 1.0)
    tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], sky.inputs["Vector"])
    # Its horizon is a curve through the picture, at which the skies of Blender 5 change more.
    looks_as_in_cycles(studio, few=0.015 if bpy.app.version >= (5, 0, 0) else 0.01)


def test_the_same_sun_in_two_skies_is_one(studio: Any) -> None:
    """Two nodes mixed: each has a part of the light that is measured once."""
    sky = add_sky(studio, strength=1.0)
    (plain,) = world_read(studio).suns
    tree = sky.id_data
    other, mix = tree.nodes.new("ShaderNodeTexSky"), tree.nodes.new("ShaderNodeMixRGB")
    other.sky_type, other.sun_elevation, other.sun_rotation = sky.sky_type, ELEVATION, TURN
    tree.links.new(sky.outputs[0], mix.inputs[1])
    tree.links.new(other.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Background"].inputs["Color"])
    (both,) = world_read(studio).suns
    np.testing.assert_allclose(both.irradiance, plain.irradiance, rtol=1e-5)


@pytest.mark.parametrize("change", [{"sun_disc": False}, {"sun_elevation": -0.1}, {"sun_intensity": 0.0}])
def test_no_sun(studio: Any, change: dict[str, Any]) -> None:
    add_sky(studio, **change)
    assert world_read(studio).suns == []


def tell_rays_apart(sky: Any, output: str = "Is Glossy Ray") -> None:
    """Rays of a kind see red, others the sky."""
    tree = sky.id_data
    rays, mixed = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMixRGB")
    mixed.inputs["Color2"].default_value = (1, 0, 0, 1)
    tree.links.new(rays.outputs[output], mixed.inputs["Fac"])
    tree.links.new(sky.outputs[0], mixed.inputs["Color1"])
    tree.links.new(mixed.outputs["Color"], tree.nodes["Background"].inputs["Color"])


@pytest.mark.parametrize("hidden", [False, True])
def test_a_background_for_the_camera_alone(studio: Any, hidden: bool) -> None:
    """It sees red, or nothing, where the sky lights the scene and is seen in a mirror."""
    studio.still_life()
    studio.ball(0.7, studio.material("ShaderNodeBsdfAnisotropic", "Mirror", Roughness=0.0), location=(0.4, -1.6, 0.7))
    sky = add_sky(studio, strength=0.1, sun_disc=False)
    if hidden:
        studio.scene.world.cycles_visibility.camera = False
    else:
        tell_rays_apart(sky, "Is Camera Ray")
    studio.camera((0, -7, 1), (0, 0, 1))
    own, cycles = studio.compare(mean=3e-3, error=1e-3)
    np.testing.assert_allclose(own[0, 0, :3], (0, 0, 0) if hidden else (0.1, 0, 0), atol=1e-6)
    np.testing.assert_allclose(own[0, 0], cycles[0, 0], atol=1e-6)
    assert not studio.messages()


def as_coordinates_of_the_camera(sky: Any) -> None:
    """Looked up where the window is."""
    tree = sky.id_data
    sky.sun_disc = False
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Window"], sky.inputs["Vector"])


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (tell_rays_apart, "'Is Glossy Ray' of Light Path: mirrors see what diffuse rays see"),
        (as_coordinates_of_the_camera, "'Window' coordinates are not supported here; (0, 0, 0) is used"),
    ],
)
def test_what_a_picture_cannot_hold_is_named(studio: Any, change: Callable[[Any], None], text: str) -> None:
    change(add_sky(studio))
    studio.camera()
    (message,) = studio.messages()
    assert text in message


@pytest.mark.slow
def test_a_sky_on_a_surface(studio: Any) -> None:
    """A ball emits the sky of its generated coordinates, and the sun's disc is on it."""
    sky_kind = WITH_SUN[-1]
    material = studio.material("ShaderNodeEmission", Strength=0.05)
    tree = material.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type, sky.sun_size, sky.sun_elevation, sky.sun_rotation = sky_kind, 0.5, 0.9, math.pi
    sky.sun_intensity = 0.1
    tree.links.new(sky.outputs[0], tree.nodes["Emission"].inputs["Color"])
    studio.ball(material=material, rings=64)
    studio.camera((0, -4, 2), (0, 0, 0))
    studio.scene.shlight.pixel_samples = 64
    studio.compare(mean=2e-3, error=3e-4)
