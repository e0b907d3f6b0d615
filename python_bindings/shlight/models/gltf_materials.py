# SPDX-License-Identifier: MIT
"""Materials of glTF: metallic-roughness with its pictures, and extensions of it, as `nodes.principled`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from shlight import nodes
from shlight.models.parts import COLORS, TANGENTS, Floats, Look, colors_of
from shlight.models.pictures import Pictures
from shlight.nodes.values import Color, Value, Vector, color

# What is read of each extension; pictures of theirs are not.
EXTENSIONS = (
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_clearcoat",
    "KHR_materials_specular",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
)
WRAPS = {33071: "extend", 33648: "mirror"}  # of a sampler, by OpenGL's numbers
NEAREST = 9728


class Materials:
    """The materials of a file; each is made once for meshes with colours, and once for those without."""

    def __init__(self, header: dict[str, Any], notes: list[str]) -> None:
        self._header, self._notes = header, notes
        self._pictures = Pictures()
        self._made: dict[tuple[int, bool], Look] = {}

    def look(self, number: int, mesh: Any) -> Look:
        """A material as a mesh of trimesh has it."""
        key = number, colors_of(mesh) is not None
        if key not in self._made:
            self._made[key] = _Reader(self._header, self._notes, self._pictures, number, mesh).look()
        return self._made[key]

    def default(self, mesh: Any) -> Look:
        """The look of a mesh without a material."""
        return Look(nodes.principled(_vertex_color(mesh), metallic=1.0, roughness=1.0))


def _vertex_color(mesh: Any) -> Color:
    """The factor that a mesh's vertices have for the base colour."""
    return color(1.0) if colors_of(mesh) is None else nodes.attribute(COLORS)


class _Reader:
    """One material."""

    def __init__(self, header: dict[str, Any], notes: list[str], pictures: Pictures, number: int, mesh: Any) -> None:
        self._header, self._notes, self._pictures, self._mesh = header, notes, pictures, mesh
        self._data: dict[str, Any] = header["materials"][number]
        self._name = self._data.get("name") or f"material {number}"
        self._extensions: dict[str, Any] = self._data.get("extensions", {})

    def look(self) -> Look:
        pbr = self._data.get("pbrMetallicRoughness", {})
        *rgb, opacity = pbr.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0))
        by_vertex = _vertex_color(self._mesh)
        base, alpha = color(by_vertex * rgb), by_vertex.alpha * opacity
        if picture := self._picture(pbr, "baseColorTexture", "srgb"):
            base, alpha = color(base * picture[0]), alpha * picture[0].alpha
        metallic, roughness = nodes.values.number(pbr.get("metallicFactor", 1.0)), pbr.get("roughnessFactor", 1.0)
        if picture := self._picture(pbr, "metallicRoughnessTexture", "linear"):
            metallic, roughness = metallic * picture[0].z, roughness * picture[0].y
        glow, light = self._emission()
        if "KHR_materials_unlit" in self._extensions:
            return Look(nodes.emission(base), None, self._name)
        normal = self._normal()
        self._note_the_rest()
        shader = nodes.principled(
            base,
            metallic=metallic,
            roughness=roughness,
            alpha=self._alpha(alpha),
            emission_color=glow,
            emission_strength=1.0,
            at=normal,
            **self._extended(),
        )
        return Look(shader, light if light.any() else None, self._name, normal is not None)

    def _picture(self, owner: dict[str, Any], name: str, encoding: str) -> tuple[Color, Floats] | None:
        """A picture as an expression, and the mean of its pixels; None: there is none."""
        info = owner.get(name)
        if info is None:
            return None
        pixels = getattr(self._mesh.visual.material, name, None)
        if pixels is None or self._mesh.visual.uv is None:
            self._note(f"the {name}, which cannot be read")
            return None
        if info.get("texCoord", 0) != 0:
            self._note(f"the second texture coordinates of its {name} (the first are used)")
        number = self._header["textures"][info["index"]].get("sampler")
        sampler = {} if number is None else self._header["samplers"][number]
        across, along = (WRAPS.get(sampler.get(axis, 0), "repeat") for axis in ("wrapS", "wrapT"))
        if across != along:
            self._note(f"different wrapS and wrapT of its {name} (wrapS is used)")
        interpolation = "closest" if sampler.get("magFilter") == NEAREST else "linear"
        place = _transformed(info.get("extensions", {}).get("KHR_texture_transform"))
        return self._pictures.image(pixels, place, encoding, interpolation, across)

    def _emission(self) -> tuple[Color, Floats]:
        """The radiance that the camera sees, and its mean, which lights other surfaces."""
        strength = self._extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
        factor = np.array(self._data.get("emissiveFactor", (0.0, 0.0, 0.0)), float) * strength
        picture = self._picture(self._data, "emissiveTexture", "srgb") if factor.any() else None
        if picture is None:
            return color(factor), factor
        self._note("light of an emissiveTexture that varies (surfaces are lit by its mean)")
        return color(picture[0] * factor), picture[1] * factor

    def _normal(self) -> Vector | None:
        picture = self._picture(self._data, "normalTexture", "linear")
        if picture is None:
            return None
        return nodes.normal_map(picture[0], self._data["normalTexture"].get("scale", 1.0), tangents=TANGENTS)

    def _alpha(self, alpha: Value) -> Value | float:
        mode = self._data.get("alphaMode", "OPAQUE")
        if mode == "MASK":
            return alpha >= self._data.get("alphaCutoff", 0.5)
        return alpha if mode == "BLEND" else 1.0

    def _extended(self) -> dict[str, Any]:
        """Arguments of `nodes.principled` from extensions."""
        found: dict[str, Any] = {}
        for name, key, argument, factor in (
            ("ior", "ior", "ior", 1.0),
            ("transmission", "transmissionFactor", "transmission_weight", 1.0),
            ("clearcoat", "clearcoatFactor", "coat_weight", 1.0),
            ("clearcoat", "clearcoatRoughnessFactor", "coat_roughness", 1.0),
            ("specular", "specularFactor", "specular_ior_level", 0.5),
        ):
            own = self._extensions.get(f"KHR_materials_{name}")
            if own is not None:
                absent = {"ior": 1.5, "specularFactor": 1.0}.get(key, 0.0)
                found[argument] = factor * own.get(key, absent)
        specular = self._extensions.get("KHR_materials_specular", {})
        if "specularColorFactor" in specular:
            found["specular_tint"] = specular["specularColorFactor"]
        return found

    def _note_the_rest(self) -> None:
        if "occlusionTexture" in self._data:
            self._note("the occlusionTexture (what stands in the way of light is known)")
        for name, own in self._extensions.items():
            if any(key.endswith("Texture") for key in own):
                self._note(f"pictures of {name}")

    def _note(self, text: str) -> None:
        self._notes.append(f"material '{self._name}': {text}")


def _transformed(transform: dict[str, Any] | None) -> Vector | None:
    """Texture coordinates after KHR_texture_transform, whose v runs down."""
    if transform is None:
        return None
    (x, y), (width, height) = transform.get("offset", (0.0, 0.0)), transform.get("scale", (1.0, 1.0))
    sine, cosine = (function(transform.get("rotation", 0.0)) for function in (math.sin, math.cos))
    u, v = nodes.uv().x * width, (1.0 - nodes.uv().y) * height
    return Vector(u * cosine + v * sine + x, 1.0 - (v * cosine - u * sine + y), 0.0)
