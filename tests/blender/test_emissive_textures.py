# SPDX-License-Identifier: MIT
"""Emission from image textures: means over triangles, the cut into even pieces, and pictures compared with Cycles."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from numpy.typing import NDArray

from shlight import nodes
from shlight_blender.export import Changes, ExportedScene, everything, meshes, whole_frame
from shlight_blender.export.emission import VaryingEmission
from shlight_blender.export.materials import read_material
from shlight_blender.export.nodes import Surroundings
from shlight_blender.export.textured_meshes import TOLERANCE, cut, sampling_levels, share_colors
from shlight_blender.report import ExportReport

Array = NDArray[np.float64]
TRIANGLES = np.array([[(0.1, -0.2), (1.3, 0.1), (0.9, 1.15)], [(0.1, -0.2), (0.9, 1.15), (-0.3, 0.6)]])


class Picture:
    """A picture over UV coordinates (n, 2)."""

    def __init__(self, pixels: Array, interpolation: str) -> None:
        self._glow = VaryingEmission(nodes.image(pixels, nodes.uv("Map"), interpolation=interpolation))

    @staticmethod
    def inputs(places: Array) -> Any:
        return {("attribute", "Map", i): places[:, i] for i in range(2)}

    def sample(self, places: Array) -> Array:
        return self._glow.radiance(self.inputs(places), len(places))

    def texels(self, places: Array) -> Array:
        (found,) = self._glow.texels(self.inputs(places.reshape(-1, 2)), places.size // 2)
        return found.reshape(places.shape)


def cut_all(texture: Picture, area: Array, most: int = 300) -> Any:
    return cut(texture.sample, TRIANGLES, sampling_levels(texture.texels(TRIANGLES)), area, most)


@pytest.mark.parametrize("interpolation", ["linear", "closest"])
def test_pieces_keep_area_and_light(interpolation: str) -> None:
    pixels, area = np.random.default_rng(3).random((11, 17, 3)).astype(np.float32), np.array([2.0, 1.0])
    texture = Picture(pixels, interpolation)
    whole, pieces, alone = (cut_all(texture, area, most) for most in (3, 300, 2))
    np.testing.assert_allclose(alone.radiance, whole.radiance, rtol=1e-3)
    assert alone.error == pytest.approx(whole.error, rel=1e-2)
    assert 290 <= len(pieces.area) <= 300
    assert pieces.area.sum() == pytest.approx(area.sum(), rel=1e-12)
    np.testing.assert_allclose(pieces.area @ pieces.radiance, area @ whole.radiance, rtol=1e-12)
    assert 0.0 < pieces.error < whole.error
    # The mean of each piece, from samples of its own.
    for index in (0, 100, 280):
        triangle = pieces.corners[index] @ TRIANGLES[pieces.triangle[index]]
        weights = np.random.default_rng(5).dirichlet((1, 1, 1), 40000)
        np.testing.assert_allclose(pieces.radiance[index], texture.sample(weights @ triangle).mean(axis=0), rtol=2e-2)


def test_colors_keep_the_light_and_black() -> None:
    random = np.random.default_rng(2)
    area = random.random(400)
    radiance = np.outer(random.random(400), (1.0, 0.7, 0.1))
    radiance[:50] = 0.0
    colors = share_colors(radiance, area, most=64)
    np.testing.assert_allclose(area @ colors.radiance[colors.color_of], area @ radiance, rtol=1e-12)
    assert not colors.radiance[colors.color_of[:50]].any()
    left = np.sqrt((area @ (colors.radiance[colors.color_of] - radiance) ** 2).sum() / (area @ radiance**2).sum())
    assert colors.error == pytest.approx(left, rel=1e-6)
    assert left <= TOLERANCE
    assert len(share_colors(radiance, area, most=3).radiance) == 4
    assert not share_colors(np.zeros((3, 3)), np.ones(3)).radiance.any()


# --- in Blender


def gradient() -> Array:
    """Brighter to the right and the top, so that it tells every flip, and of one colour."""
    v, u = np.mgrid[:16, :24] + 0.5
    return np.asarray((0.15 + u / 24 + 0.8 * (v / 16) ** 2)[..., None] * (1.0, 0.7, 0.4))


def checker() -> Array:
    row, column = np.mgrid[:4, :4]
    return np.where(((row + column) % 2 == 0)[..., None], (0.9, 0.6, 0.3), (0.1, 0.2, 0.5))


def screen(studio: Any, image: Any, coordinates: Any, strength: float = 5.0, **options: Any) -> Any:
    """A material that emits `image`, on a leaning rectangle."""
    material = studio.material("ShaderNodeEmission", name="Screen", Strength=strength)
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    for name, value in options.items():
        setattr(node, name, value)
    tree.links.new(node.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    corners = [(-1, -0.6, 0), (1, -0.6, 0), (1, 0.6, 0), (-1, 0.6, 0)]
    made = studio.mesh("Screen", corners, [(0, 1, 2, 3)], material)
    made.location, made.rotation_euler = (0.3, 0.8, 1.1), (1.2, 0.1, 0.3)
    for loop, place in zip(made.data.uv_layers.new(name="Map").data, coordinates, strict=True):
        loop.uv = place
    return made


OFF_CENTRE = [(0.1, 0.05), (0.95, 0.15), (0.85, 0.9), (0.05, 0.8)]


@pytest.mark.slow
@pytest.mark.parametrize(("pixels", "is_float"), [(gradient(), True), (checker(), False)])
def test_a_screen_lights_floors_as_in_cycles(studio: Any, pixels: Array, is_float: bool) -> None:
    interpolation = "Linear" if is_float else "Closest"
    screen(studio, studio.picture(pixels, is_float=is_float), OFF_CENTRE, interpolation=interpolation)
    studio.floors()
    studio.compare(mean=5e-3, error=2e-3)


@pytest.mark.parametrize("roughness", [0.02, 0.3])
def test_a_glossy_floor_shows_the_near_side_of_a_body(studio: Any, roughness: float) -> None:
    """What is darkest of the body is left out of the light, so that the rest encloses nothing and shines to its inside,
    which a mirror must not show.
    """
    material = studio.material("ShaderNodeEmission")
    tree = material.node_tree
    place, gradient = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeTexGradient")
    tree.links.new(place.outputs["Generated"], gradient.inputs["Vector"])
    tree.links.new(gradient.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    studio.box((2, 2, 2), material, location=(0, 0, 1.2), rotation_euler=(0, -0.6, 0.3))
    studio.plane(8, studio.material("ShaderNodeBsdfGlossy", "Floor", Roughness=roughness), name="Floor")
    studio.camera((3, -7, 4), (0, 0, 0.5))
    studio.compare(mean=5e-3, error=0.02)


def mapped(made: Any, vector_type: str, uv_map: str) -> None:
    """Puts a Mapping node that shifts, turns and scales between a UV map and the picture."""
    tree = made.data.materials[0].node_tree
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.vector_type = vector_type
    if vector_type != "VECTOR":
        mapping.inputs["Location"].default_value = (0.2, -0.35, 0.1)
    mapping.inputs["Rotation"].default_value = (0.2, 0.0, 0.5)
    mapping.inputs["Scale"].default_value = (1.4, 0.7, 1.0)
    coordinates = tree.nodes.new("ShaderNodeUVMap")
    coordinates.uv_map = uv_map
    tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], tree.nodes["Image Texture"].inputs["Vector"])


def looked_up(studio: Any, made: Any) -> tuple[Array, Array]:
    """Cycles' picture of an emissive rectangle, seen face to face, and the texture's means over its pixels (n, 3)."""
    made.location = made.rotation_euler = (0, 0, 0)
    studio.camera(location=(0, 0, 5), target=(0, 0, 0), type="ORTHO", ortho_scale=2.0)
    render, cycles = studio.scene.render, studio.scene.cycles
    render.resolution_x, render.resolution_y = 80, 48
    cycles.samples = 1024
    reference = studio.render("CYCLES")[::-1, :, :3].reshape(-1, 3)
    report = ExportReport()
    glow = read_material(made.data.materials[0], report, Surroundings()).varying
    assert glow is not None
    assert not len(report)
    x, y = np.meshgrid((np.arange(80 * 12) + 0.5) / 480 - 1, (np.arange(48 * 12) + 0.5) / 480 - 0.6)
    places = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3)
    (name,) = {str(index) for _, index, _ in glow.inputs}
    layer = made.data.uv_layers[name or "Map"]
    corners = [(*vertex.co[:2], 1) for vertex in made.data.vertices]
    to_uv = np.linalg.lstsq(np.array(corners), np.array([tuple(loop.uv) for loop in layer.data]), rcond=None)[0]
    at = places @ to_uv
    found = glow.radiance({("attribute", name, i): at[:, i] for i in range(2)}, len(at))
    return reference, found.reshape(48, 12, 80, 12, 3).mean(axis=(1, 3)).reshape(-1, 3)


@pytest.mark.parametrize(
    ("extension", "interpolation", "vector_type", "is_float"),
    [
        ("REPEAT", "Linear", "", False),
        pytest.param("EXTEND", "Linear", "POINT", True, marks=pytest.mark.slow),
        pytest.param("CLIP", "Linear", "TEXTURE", False, marks=pytest.mark.slow),
        ("CLIP", "Closest", "VECTOR", True),
        pytest.param("MIRROR", "Closest", "POINT", False, marks=pytest.mark.slow),
        pytest.param("MIRROR", "Linear", "", True, marks=pytest.mark.slow),
    ],
)
def test_lookups_as_in_cycles(
    studio: Any, extension: str, interpolation: str, vector_type: str, is_float: bool
) -> None:
    pixels = np.random.default_rng(4).random((3, 5, 3))
    # Beyond the picture on every side, by a map that keeps parallels.
    beyond = [(-0.6, -0.3), (1.2, -0.6), (1.6, 1.2), (-0.2, 1.5)]
    made = screen(
        studio, studio.picture(pixels, is_float=is_float), beyond, 1.0, extension=extension, interpolation=interpolation
    )
    if vector_type:
        second = made.data.uv_layers.new(name="Second")
        for loop, (u, v) in zip(second.data, beyond, strict=True):
            loop.uv = (v, u)
        mapped(made, vector_type, "Second")
    reference, found = looked_up(studio, made)
    difference = np.abs(found - reference).max(axis=1)
    assert difference.mean() <= 2e-3
    assert difference.max() <= 0.05  # where texels end within a pixel, Cycles' samples are few


def test_strength_from_a_picture_and_principled(studio: Any) -> None:
    made = screen(studio, studio.picture(gradient()), OFF_CENTRE)
    material = made.data.materials[0]
    tree = material.node_tree
    node, picture = tree.nodes["Emission"], tree.nodes["Image Texture"]
    tree.links.new(picture.outputs["Color"], node.inputs["Strength"])
    place = {("attribute", "", 0): np.array([0.3, 0.8]), ("attribute", "", 1): np.array([0.6, 0.2])}

    def shown() -> Array:
        glow = read_material(material, ExportReport(), Surroundings()).varying
        assert glow is not None
        return glow.radiance(place, 2)

    tinted = shown()
    node.inputs["Strength"].default_value = 1.0
    tree.links.remove(node.inputs["Strength"].links[0])
    values = shown()
    np.testing.assert_allclose(tinted, values * (values @ (0.2126729, 0.7151522, 0.072175))[:, None], rtol=1e-5)
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    name = "Emission Color" if "Emission Color" in shader.inputs else "Emission"
    shader.inputs["Emission Strength"].default_value = 3.0
    tree.links.new(picture.outputs["Color"], shader.inputs[name])
    tree.links.new(shader.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    np.testing.assert_allclose(shown(), 3.0 * values, rtol=1e-5)


def test_what_is_not_supported_is_named(studio: Any) -> None:
    made = screen(studio, studio.picture(checker()), OFF_CENTRE, interpolation="Closest")
    studio.lit_floor()
    studio.camera()
    (line,) = studio.messages()
    assert "Object 'Screen'" in line
    assert "pieces of even light" in line
    made.data.uv_layers.remove(made.data.uv_layers[0])
    made.data.update()
    (line,) = studio.messages()
    assert "has no UV map" in line
    tree = made.data.materials[0].node_tree
    tree.links.new(
        tree.nodes.new("ShaderNodeAmbientOcclusion").outputs["Color"], tree.nodes["Emission"].inputs["Color"]
    )
    assert any("node 'Ambient Occlusion'" in line for line in studio.messages())


def test_what_lights_nothing_is_not_cut(studio: Any) -> None:
    """The screen is cut once the clear plane before it is gray, and whole again once it is clear."""
    made = screen(studio, studio.picture(checker()), OFF_CENTRE, interpolation="Closest")
    clear = studio.plane(1.0, studio.material("ShaderNodeBsdfTransparent"), location=(0, 0, 2))
    studio.camera(location=(0.3, 0.3, 3.5), target=made.location)
    studio.resolution(32, 32)
    studio.compare(mean=3e-3, error=2e-3)
    exported, changes = ExportedScene(), everything()
    lines = {}
    for material in (clear.data.materials[0], studio.material(name="Grey"), clear.data.materials[0]):
        clear.material_slots[0].material = material
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        exported.look_from(depsgraph, frame=whole_frame(32, 32))
        exported.update(depsgraph, changes)
        lines[len(lines)] = [message.line() for message in exported.report]
        changes = Changes(objects=True)
    assert lines[0] == lines[2] == []
    (line,) = lines[1]
    assert "pieces of even light" in line


def test_the_camera_sees_the_picture(studio: Any) -> None:
    made = screen(studio, studio.picture(gradient()), OFF_CENTRE)
    made.rotation_euler = (0.4, 0, 0)
    made.data.polygons.foreach_set("use_smooth", [True])
    studio.camera(location=(0.3, 0.3, 3.5), target=made.location)
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = 40, 32
    image, reference = studio.compare(mean=5e-3, error=2e-2)
    for flipped in (reference[::-1], reference[:, ::-1]):
        assert np.square(image - flipped).mean() > 4 * np.square(image - reference).mean()


def test_instances_shine_as_their_places_have_it(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    material = studio.material("ShaderNodeEmission", name="Glow", Strength=8.0)
    tree = material.node_tree
    own = tree.nodes.new("ShaderNodeObjectInfo")
    tree.links.new(own.outputs["Location"], tree.nodes["Emission"].inputs["Color"])
    corners = [(-0.3, -0.3, 0), (-0.3, 0.3, 0), (0.3, 0.3, 0), (0.3, -0.3, 0)]
    first = studio.mesh("Glow", corners, [(0, 1, 2, 3)], material)
    first.location = (1.0, 0.1, 0.8)
    for place in ((0.2, 0.6, 0.8), (0.1, 1.4, 0.3)):
        other = first.copy()
        other.location = place
        studio.scene.collection.objects.link(other)
    studio.floors()
    studio.compare(mean=5e-3, error=2e-3)
    assert not studio.messages()
    monkeypatch.setattr(meshes, "MOST_SHINING_PLACES", 2)
    (line,) = studio.messages()
    assert "only 2 of its instances shine" in line
