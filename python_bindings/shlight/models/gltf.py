# SPDX-License-Identifier: MIT
"""glTF 2.0: trimesh reads its meshes and pictures; nodes, materials, lights and cameras are read here.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

from __future__ import annotations

import importlib.util
import io
import json
import math
import struct
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from shlight._core import Scene
from shlight.models.gltf_materials import EXTENSIONS, Materials
from shlight.models.parts import Floats, Model, Part, import_trimesh, read_scene
from shlight.photometry import LUMENS_PER_WATT

JSON_CHUNK = 0x4E4F534A
LIGHTS = "KHR_lights_punctual"
KEY = "shlight"  # in the extras of meshes, by which their primitives are found again
DRACO = "KHR_draco_mesh_compression"
KNOWN_EXTENSIONS = {*EXTENSIONS, LIGHTS, DRACO, "KHR_texture_transform"}
ASPECT = 16.0 / 9.0  # of a camera that has none


def read(path: Path) -> Model:
    """The contents of a .glb or .gltf file."""
    header, rest = _header(path)
    model = Model()
    primitives = _primitives(path, header, rest)
    materials = Materials(header, model.notes)
    nodes: dict[int, list[tuple[str, Floats]]] = {}
    cameras = []
    for node, to_world in _placed(header):
        if "mesh" in node:
            name = node.get("name") or header["meshes"][node["mesh"]].get("name") or f"mesh {node['mesh']}"
            nodes.setdefault(node["mesh"], []).append((name, to_world))
        if "camera" in node:
            cameras.append((header["cameras"][node["camera"]], to_world))
        light = node.get("extensions", {}).get(LIGHTS)
        if light is not None:
            _add_light(model, header["extensions"][LIGHTS]["lights"][light["light"]], to_world)
    for number, places in sorted(nodes.items()):
        transforms = np.stack([to_world for _, to_world in places])
        for mesh in primitives.get(number, []):
            material = str(getattr(getattr(mesh.visual, "material", None), "name", ""))
            look = materials.look(int(material), mesh) if material.isdigit() else materials.default(mesh)
            model.parts.append(Part(mesh, look, transforms, [name for name, _ in places]))
    if cameras:
        model.camera = partial(_set_camera, *cameras[0])
        if "perspective" in cameras[0][0] and not cameras[0][0]["perspective"].get("aspectRatio"):
            model.notes.append("a camera without aspectRatio (16:9 is used)")
    if len(cameras) > 1:
        model.notes.append(f"{len(cameras) - 1} more cameras (the first is used)")
    _note_the_rest(model, header)
    return model


def _header(path: Path) -> tuple[dict[str, Any], bytes | None]:
    """The JSON of a file, and of a .glb the chunks behind it."""
    data, rest = path.read_bytes(), None
    if data[:4] == b"glTF":
        length = int.from_bytes(data[12:16], "little")
        data, rest = data[20 : 20 + length], data[20 + length :]
    try:
        header = json.loads(data)
    except ValueError as error:
        raise ValueError(f"path: {path} is not glTF: {error}") from None
    version = header.get("asset", {}).get("version", "") if isinstance(header, dict) else ""
    if not str(version).startswith("2"):
        raise ValueError(f"path: {path} is not glTF 2.0")
    return header, rest


def _primitives(path: Path, header: dict[str, Any], rest: bytes | None) -> dict[int, list[Any]]:
    """The meshes of trimesh with triangles, by the number of the file's mesh; their materials have numbers as names."""
    trimesh = import_trimesh()
    if DRACO in header.get("extensionsUsed", []) and importlib.util.find_spec("DracoPy") is None:
        raise ValueError(f"path: {path} is compressed by Draco, which needs the module DracoPy")
    numbered = dict(header)
    numbered["materials"] = [{**own, "name": str(i)} for i, own in enumerate(header.get("materials", []))]
    numbered["meshes"] = [{**own, "extras": {KEY: i}} for i, own in enumerate(header.get("meshes", []))]
    data, kind = json.dumps(numbered).encode(), "gltf"
    if rest is not None:
        data += b" " * (-len(data) % 4)
        sizes = (20 + len(data) + len(rest), len(data), JSON_CHUNK)
        data, kind = struct.pack("<4sIIII", b"glTF", 2, *sizes) + data + rest, "glb"
    resolver = trimesh.resolvers.FilePathResolver(str(path))
    read = read_scene(path, io.BytesIO(data), file_type=kind, resolver=resolver)
    found: dict[int, list[Any]] = {}
    for mesh in read.geometry.values():
        if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces):
            found.setdefault(mesh.metadata[KEY], []).append(mesh)
    return found


def _placed(header: dict[str, Any]) -> Iterator[tuple[dict[str, Any], Floats]]:
    """The nodes of the scene and their transforms to it, each before its children."""
    nodes = header.get("nodes", [])
    scenes = header.get("scenes", [])
    roots = scenes[header.get("scene", 0)].get("nodes", []) if scenes else range(len(nodes))
    waiting = [(root, np.eye(4), 0) for root in reversed(roots)]
    while waiting:
        number, parent, depth = waiting.pop()
        if depth > len(nodes):
            raise ValueError("path: its nodes are a circle")
        node = nodes[number]
        to_world = parent @ _transform(node)
        yield node, to_world
        waiting += [(child, to_world, depth + 1) for child in reversed(node.get("children", []))]


def _transform(node: dict[str, Any]) -> Floats:
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    made: Floats = import_trimesh().transformations.quaternion_matrix((w, x, y, z))
    made[:3, :3] *= node.get("scale", (1.0, 1.0, 1.0))
    made[:3, 3] = node.get("translation", (0.0, 0.0, 0.0))
    return made


def _rigid(to_world: Floats) -> Floats:
    """The transform without its scale, for cameras."""
    made = to_world.copy()
    made[:3, :3] /= np.linalg.norm(made[:3, :3], axis=0)
    return made


def _set_camera(camera: dict[str, Any], to_world: Floats, scene: Scene, frame: Floats) -> None:
    placed = frame @ to_world
    if "orthographic" in camera:
        size = np.linalg.norm(placed[:3, :3], axis=0)
        x, y = size[0] * camera["orthographic"]["xmag"], size[1] * camera["orthographic"]["ymag"]
        scene.set_camera_window(_rigid(placed), -x, x, -y, y, orthographic=True)
        return
    lens = camera["perspective"]
    width = math.tan(0.5 * lens["yfov"]) * (lens.get("aspectRatio") or ASPECT)
    scene.set_camera(_rigid(placed), 2.0 * math.atan(width))


def _add_light(model: Model, light: dict[str, Any], to_world: Floats) -> None:
    """KHR_lights_punctual: https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_lights_punctual."""
    strength = np.array(light.get("color", (1.0, 1.0, 1.0)), float) * light.get("intensity", 1.0) / LUMENS_PER_WATT
    if "range" in light:
        model.notes.append("the range of lights")
    kind, cone = light["type"], light.get("spot", {})
    if kind not in ("directional", "spot", "point"):
        model.notes.append(f"lights of the type {kind}")
        return
    outer, inner = cone.get("outerConeAngle", 0.25 * math.pi), cone.get("innerConeAngle", 0.0)
    fades = min((math.cos(inner) - math.cos(outer)) / (1.0 - math.cos(outer)), 1.0)

    def placed(scene: Scene, frame: Floats) -> None:
        turned = _rigid(frame @ to_world)
        place, ahead = turned[:3, 3], -turned[:3, 2]
        if kind == "directional":
            scene.add_sun_light(ahead, 0.0, strength)
        elif kind == "spot":
            scene.add_spot_light(place, ahead, 2.0 * outer, fades, strength)
        else:
            scene.add_point_light(place, strength)

    model.lights.append(placed)


def _note_the_rest(model: Model, header: dict[str, Any]) -> None:
    for name, text in (("animations", "animations"), ("skins", "skins (meshes stand as they were bound)")):
        if header.get(name):
            model.notes.append(text)
    primitives = [own for mesh in header.get("meshes", []) for own in mesh["primitives"]]
    if any(own.get("targets") for own in primitives):
        model.notes.append("morph targets")
    if any(own.get("mode", 4) not in (4, 5) for own in primitives):
        model.notes.append("points, lines and triangle fans")
    if any("sparse" in own for own in header.get("accessors", [])):
        model.notes.append("sparse accessors (their values are left out)")
    model.notes += [name for name in header.get("extensionsUsed", []) if name not in KNOWN_EXTENSIONS]
