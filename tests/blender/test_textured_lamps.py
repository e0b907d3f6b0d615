# SPDX-License-Identifier: MIT
"""Area lamps whose emission is an image texture: parts that shine evenly, and pictures compared with Cycles."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import shlight
from shlight_blender.export.textured_lamps import cut_square

Array = NDArray[np.float64]
SLOW = pytest.mark.slow


def picture(high: int = 16, wide: int = 24) -> Array:
    """A texture whose colours grow differently to the right and to the top, so that every flip and rotation shows."""
    v, u = (np.mgrid[:high, :wide] + 0.5) / np.array([high, wide]).reshape(2, 1, 1)
    return np.stack([0.1 + u + 0.3 * v, 0.1 + 0.9 * v**2, 0.3 + 0.0 * u], axis=-1)


def texture_of(lamp: Any, image: Any, **options: Any) -> Any:
    """Lets a lamp emit `image`, without repeating it; returns the Image Texture node."""
    lamp.data.use_nodes = True
    tree = lamp.data.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.extension = image, "EXTEND"
    for name, value in options.items():
        setattr(node, name, value)
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    return node


def place(node: Any, kind: str, output: str, mapped: bool = False, **properties: Any) -> None:
    """Links the coordinates of a new node of type `kind` to an Image Texture, through a Mapping node if asked."""
    tree = node.id_data
    coordinates = tree.nodes.new(kind)
    for name, value in properties.items():
        setattr(coordinates, name, value)
    socket = coordinates.outputs[output]
    if mapped:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Location"].default_value = (0.3, -0.15, 0.1)
        mapping.inputs["Rotation"].default_value = (0.2, 0.0, 0.5)
        mapping.inputs["Scale"].default_value = (0.9, 0.7, 1.0)
        tree.links.new(socket, mapping.inputs["Vector"])
        socket = mapping.outputs["Vector"]
    tree.links.new(socket, node.inputs["Vector"])


def hang(studio: Any, **properties: Any) -> Any:
    """An area lamp close over the floors, turned and of uneven scale."""
    values = {"rotation_euler": (0.4, 0.2, 0.3), "scale": (1.2, 0.8, 1.0), "visible_camera": False, **properties}
    return studio.area(60.0, (0.3, -0.4, 0.9), **values)


RECTANGLE = {"shape": "RECTANGLE", "size": 1.5, "size_y": 1.2}
MIRRORED = {"scale": (-1.2, 0.8, 1.0)}
TURNED_OVER = {"scale": (1.2, 0.8, -1.0), "rotation_euler": (math.pi - 0.4, 0.2, 0.3)}
UV = ("ShaderNodeTexCoord", "UV")
PARAMETRIC = ("ShaderNodeNewGeometry", "Parametric")
CASES: dict[str, tuple[dict[str, Any], tuple[Any, ...]]] = {
    "square": ({"shape": "SQUARE", "size": 1.3}, ()),
    "rectangle": (RECTANGLE, UV),
    "mirrored": (RECTANGLE | MIRRORED, PARAMETRIC),
    "turned_over": (RECTANGLE | TURNED_OVER, ()),
    "mapped": (RECTANGLE, (*PARAMETRIC, True)),
    "uv_map": (RECTANGLE, ("ShaderNodeUVMap", "UV", True)),
    "spread": (RECTANGLE | {"spread": 1.4}, ()),
    "unnormalized": (RECTANGLE | {"normalize": False}, ()),
    "disk": ({"shape": "DISK", "size": 1.5}, PARAMETRIC),
    "disk_spread": ({"shape": "DISK", "size": 1.5, "spread": 1.4}, ()),
    "ellipse": (RECTANGLE | MIRRORED | {"shape": "ELLIPSE"}, (*UV, True)),
}


def told_differences(studio: Any) -> list[str]:
    """The report's lines, except for the deviation of the parts from the texture."""
    return [line for line in studio.messages() if "which differ from it by" not in line]


@pytest.mark.parametrize("case", [name if name == "mapped" else pytest.param(name, marks=SLOW) for name in CASES])
def test_it_lights_floors_as_in_cycles(studio: Any, case: str) -> None:
    properties, coordinates = CASES[case]
    node = texture_of(hang(studio, **properties), studio.picture(picture()))
    if coordinates:
        place(node, *coordinates)
    studio.floors()
    assert told_differences(studio) == []
    studio.compare(mean=3e-3, error=2e-3)


@pytest.mark.parametrize("interpolation", ["Closest", pytest.param("Linear", marks=SLOW)])
def test_bytes_with_edges(studio: Any, interpolation: str) -> None:
    random = np.random.default_rng(8).random((3, 5, 3)) ** 3
    lamp = hang(studio, **RECTANGLE)
    texture_of(lamp, studio.picture(random, is_float=False), interpolation=interpolation)
    studio.floors()
    assert told_differences(studio) == []
    studio.compare(mean=3e-3, error=5e-3)


@pytest.mark.parametrize("shape", ["RECTANGLE", pytest.param("ELLIPSE", marks=SLOW)])
def test_the_camera_sees_the_parts(studio: Any, shape: str) -> None:
    lamp = studio.area(60.0, (0.1, 0.05, 0.2), shape=shape, size=1.5, size_y=1.2, visible_camera=True)
    lamp.rotation_euler = (0.2 - math.pi / 2, 0.1, 0.3)
    texture_of(lamp, studio.picture(picture()))
    studio.camera(location=(0, -4, 0.2), target=(0, 0, 0.1), lens=80)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 40
    image, reference = studio.compare(mean=5e-3, error=2e-2)
    for flipped in (reference[::-1], reference[:, ::-1], np.swapaxes(reference, 0, 1)):
        assert np.square(image - flipped).mean() > 4 * np.square(image - reference).mean()
    lamp.visible_camera = False
    assert not studio.render("SHLIGHT")[..., :3].any()


# --- without Cycles


@pytest.mark.parametrize(("shape", "kind"), [("SQUARE", "polygon"), ("DISK", "disk")])
def test_nearly_one_color_is_a_plain_lamp(studio: Any, monkeypatch: pytest.MonkeyPatch, shape: str, kind: str) -> None:
    made: list[tuple[str, Any]] = []

    class Scene(shlight.Scene):
        def add_polygon_light(self, vertices: Any, radiance: Any, **_: Any) -> None:
            made.append(("polygon", radiance))

        def add_disk_light(self, center: Any, u: Any, v: Any, radiance: Any, **_: Any) -> None:
            made.append(("disk", radiance))

    monkeypatch.setattr(shlight, "Scene", Scene)
    texture_of(studio.area(10.0, shape=shape, size=1.0), studio.picture(0.5 + 0.02 * picture()))
    studio.camera()
    assert studio.messages() == []
    ((found, radiance),) = made
    assert found == kind
    area = 1.0 if shape == "SQUARE" else math.pi / 4
    mean = 0.5 + 0.02 * np.array([0.75, 0.4, 0.3])
    np.testing.assert_allclose(radiance, 10.0 / math.pi / area * mean, rtol=1e-3)


def test_cells_leave_out_what_they_say() -> None:
    pixels = np.random.default_rng(6).random((8, 8, 3)) ** 2

    def radiance(places: Array) -> Array:
        column, row = (places * 8).astype(int).T
        return pixels[row, column]

    cells = cut_square(radiance, (256, 256), 20)
    assert len(cells.bounds) == 20
    drawn, seen = np.zeros((256, 256, 3)), np.zeros((256, 256), dtype=int)
    for (left, bottom, right, top), color in zip(np.rint(cells.bounds * 256).astype(int), cells.radiance, strict=True):
        drawn[bottom:top, left:right] = color
        seen[bottom:top, left:right] += 1
    assert (seen == 1).all()
    exact = np.kron(pixels, np.ones((32, 32, 1)))
    assert cells.error == pytest.approx(np.sqrt(((drawn - exact) ** 2).sum() / (exact**2).sum()), rel=1e-6)


def test_what_is_not_supported_is_named(studio: Any) -> None:
    lamp = hang(studio, **RECTANGLE)
    node = texture_of(lamp, studio.picture(np.kron(np.eye(8), np.ones((4, 4)))[..., None] * np.ones(3)))
    studio.camera()
    (line,) = studio.messages()
    assert "Light 'Area': its texture is drawn as" in line
    place(node, "ShaderNodeUVMap", "UV", uv_map="Other")
    (line,) = studio.messages()
    assert "a lamp has no UV map 'Other'" in line
    for output in ("Object", "Generated"):
        place(node, "ShaderNodeTexCoord", output)
        (line,) = studio.messages()
        assert "Light 'Area': a lamp has no" in line
    place(node, *UV)
    tree = lamp.data.node_tree
    emission = next(node for node in tree.nodes if node.type == "EMISSION")
    tree.links.new(tree.nodes.new("ShaderNodeAmbientOcclusion").outputs["Color"], emission.inputs["Color"])
    (line,) = studio.messages()
    assert "node 'Ambient Occlusion': Ambient Occlusion is not supported" in line


@pytest.mark.parametrize("kind", ["POINT", "SPOT", "SUN"])
def test_textures_of_other_lamps_are_named(studio: Any, kind: str) -> None:
    texture_of(studio.lamp(kind, 10.0, (0, 0, 2)), studio.picture(picture()))
    studio.camera()
    (line,) = studio.messages()
    assert "light that varies over the lamp is not supported" in line
