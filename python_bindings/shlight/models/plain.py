# SPDX-License-Identifier: MIT
"""OBJ with its MTL, and PLY."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from shlight import nodes
from shlight.models.parts import COLORS, Look, Model, Part, colors_of, import_trimesh, read_scene
from shlight.models.pictures import Pictures
from shlight.nodes.values import Color, color

GREATEST_EXPONENT = 900.0  # of MTL's Ns, at which Blender takes a surface for smooth
# Keys of MTL that are read or say nothing; the others are named to the user.
READ = {"kd", "ks", "ke", "ns", "ni", "d", "tr", "pr", "pm", "map_kd", "illum", "ka", "newmtl"}


def read_obj(path: Path) -> Model:
    """The contents of an OBJ file, a part for each material."""
    model = Model()
    pictures, looks = Pictures(), dict[int, Look]()
    for name, mesh, places in _meshes(path, group_material=True):
        material = getattr(mesh.visual, "material", None)
        if id(material) not in looks:
            looks[id(material)] = _obj_look(material, getattr(material, "name", None) or name, pictures, model.notes)
        model.parts.append(Part(mesh, looks[id(material)], places, [name] * len(places)))
    return model


def read_ply(path: Path) -> Model:
    """The contents of a PLY file; colours of its vertices are sRGB, as Blender takes them."""
    model = Model()
    for name, mesh, places in _meshes(path):
        shade = Look() if colors_of(mesh) is None else Look(nodes.lambert(_from_srgb(nodes.attribute(COLORS))))
        model.parts.append(Part(mesh, shade, places, [name] * len(places)))
    return model


def _meshes(path: Path, **options: Any) -> list[tuple[str, Any, Any]]:
    """Name, mesh of trimesh and places (i, 4, 4) of all that has triangles."""
    scene = read_scene(path, str(path), **options)
    places: dict[str, list[Any]] = {}
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        places.setdefault(name, []).append(matrix)
    return [
        (name, mesh, np.stack(places[name]))
        for name, mesh in scene.geometry.items()
        if isinstance(mesh, import_trimesh().Trimesh) and len(mesh.faces) and name in places
    ]


def _from_srgb(encoded: Color) -> Color:
    def linear(value: Any) -> Any:
        return nodes.select(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)

    return Color(linear(encoded.x), linear(encoded.y), linear(encoded.z), encoded.alpha)


def _obj_look(material: Any, name: str, pictures: Pictures, notes: list[str]) -> Look:
    """A material of MTL, whose exponent and index become what Blender makes of them."""
    written = {key.lower(): value for key, value in (getattr(material, "kwargs", None) or {}).items()}
    if not written:
        return Look(name=name)

    def numbers(key: str, absent: Any) -> Any:
        return np.atleast_1d(np.array(written.get(key, absent), float))

    base = color(np.broadcast_to(numbers("kd", 0.8), 3))
    if getattr(material, "image", None) is not None:
        base = pictures.image(material.image, None, "srgb", "linear", "repeat")[0]
    elif "map_kd" in written:
        notes.append(f"material '{name}': its picture {written['map_kd']}, which cannot be read")
    notes += [f"material '{name}': {key}" for key in written if key not in READ]
    smooth = math.sqrt(min(float(numbers("ns", 250.0)[0]), GREATEST_EXPONENT) / GREATEST_EXPONENT)
    emission = np.broadcast_to(numbers("ke", 0.0), 3).astype(float)
    opacity = float(numbers("d", 1.0)[0]) if "d" in written else 1.0 - float(numbers("tr", 0.0)[0])
    shader = nodes.principled(
        base,
        roughness=float(numbers("pr", 1.0 - smooth)[0]),
        metallic=float(numbers("pm", 0.0)[0]),
        ior=float(numbers("ni", 1.5)[0]),
        specular_ior_level=float(numbers("ks", 0.5).mean()),
        alpha=opacity,
        emission_color=color(emission),
        emission_strength=1.0,
    )
    return Look(shader, emission if emission.any() else None, name)
