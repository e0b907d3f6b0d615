# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface shader as shlight sees it, and the walk over the nodes that define one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import shlight

from ..report import Effect, ExportReport
from .nodes import RGB, ConstantReader, origin, rgb
from .textures import ImageTexture, UvOwner, read_image_texture


def _black() -> RGB:
    return np.zeros(3)


@dataclass(frozen=True)
class TexturedEmission:
    """Radiance (RGB) that varies over a surface: a constant times the product of textures."""

    factor: RGB
    textures: tuple[ImageTexture, ...]

    def radiance(self, uvs: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Linear RGB (n, 3) at n places, (n, 2) in each UV map that the textures name."""
        product = np.ones((len(next(iter(uvs.values()))), 3)) * self.factor
        for texture in self.textures:
            product *= texture.sample(uvs[texture.uv_map])
        return product


@dataclass
class Surface:
    """What a shader does to light: reflection (None: none) and the radiance it emits on both sides (RGB).

    The radiance is `emission`, the same all over, plus all of `textured`.
    """

    bsdf: shlight.Bsdf | None = None
    emission: RGB = field(default_factory=_black)
    textured: tuple[TexturedEmission, ...] = ()

    def scaled(self, factor: float) -> Surface:
        """The surface under a constant weight."""
        if factor == 0.0:
            return Surface()
        if factor == 1.0:
            return self
        textured = tuple(replace(glow, factor=factor * glow.factor) for glow in self.textured)
        return Surface(None if self.bsdf is None else factor * self.bsdf, factor * self.emission, textured)

    def plus(self, other: Surface) -> Surface:
        """Both surfaces at once."""
        if self.bsdf is None or other.bsdf is None:
            bsdf = other.bsdf if self.bsdf is None else self.bsdf
        else:
            bsdf = self.bsdf + other.bsdf
        return Surface(bsdf, self.emission + other.emission, self.textured + other.textured)

    def emits(self) -> bool:
        """True if it may give light."""
        return bool(self.emission.any() or self.textured)

    def radiance(self, uvs: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """What it emits at n places (n, 3); see `TexturedEmission.radiance`."""
        total = np.broadcast_to(self.emission, (len(next(iter(uvs.values()))), 3)).copy()
        for glow in self.textured:
            total += glow.radiance(uvs)
        return total

    def opaque_bsdf(self) -> shlight.Bsdf:
        """The reflection, black where there is none."""
        return shlight.Bsdf.lambert(0.0) if self.bsdf is None else self.bsdf


def lambert(albedo: RGB) -> shlight.Bsdf | None:
    """Lambert's reflection, or None for black."""
    return shlight.Bsdf.lambert(rgb(albedo)) if albedo.any() else None


class SurfaceReader(ConstantReader):
    """Walks the shader nodes of one tree; `shaders` says how a node of each type is read.

    uvs_of: what textures of the emission are looked up on; None: they are reported as other varying values.
    """

    def __init__(
        self,
        place: str,
        report: ExportReport,
        shaders: Mapping[str, ReadShader],
        *,
        uvs_of: UvOwner | None = None,
    ) -> None:
        super().__init__(place, report)
        self._shaders = shaders
        self._uvs_of = uvs_of

    def surface(self, socket: Any, groups: tuple[Any, ...] = ()) -> Surface:
        """The surface that a shader socket receives; black where nothing is linked."""
        source = origin(socket, groups)
        if source.node is None:
            return Surface()
        read = self._shaders.get(source.node.type)
        if read is not None:
            return read(self, source.node, source.groups)
        return self._unsupported(source.node, source.groups)

    def emitter(self, node: Any, color: str, strength: str, groups: tuple[Any, ...]) -> Surface:
        """What a node emits whose inputs are named `color` and `strength`."""
        textures = {name: self._texture(node, name, groups, name == strength) for name in (color, strength)}
        factor = np.ones(3)
        if textures[strength] is None:
            number = self.number(node, strength, groups)
            if number < 0.0:
                self.report.add(
                    self.at(node), f"negative {strength} is not supported; nothing is emitted", Effect.LIGHT
                )
            factor *= max(number, 0.0)
        if textures[color] is None:
            factor *= self.color(node, color, groups)
        found = tuple(texture for texture in textures.values() if texture is not None)
        if not found:
            return Surface(emission=factor)
        return Surface(textured=(TexturedEmission(factor, found),)) if factor.any() else Surface()

    def _texture(self, node: Any, name: str, groups: tuple[Any, ...], is_number: bool) -> ImageTexture | None:
        if self._uvs_of is None:
            return None
        return read_image_texture(self, origin(node.inputs[name], groups), self._uvs_of, is_number)

    def _unsupported(self, node: Any, groups: tuple[Any, ...]) -> Surface:
        kind = node.bl_label or node.bl_idname
        if node.type in SEE_THROUGH or "Color" not in node.inputs:
            self.report.add(self.at(node), f"{kind} is not supported; drawn black", Effect.THING)
            return Surface()
        self.report.add(self.at(node), f"{kind} is not supported; drawn as Diffuse BSDF of its colour")
        return Surface(lambert(self.color(node, "Color", groups)))

    def remarks(self, node: Any, effect: Effect = Effect.LOOK) -> Callable[[str], None]:
        """A function that adds its text to the report, about this node."""
        return lambda text: self.report.add(self.at(node), text, effect)

    def ignore_linked(self, node: Any, groups: tuple[Any, ...], *names: str) -> None:
        """Reports inputs for directions that are linked, for instance to a Normal Map."""
        for name in names:
            socket = node.inputs.get(name)
            if socket is not None and origin(socket, groups).node is not None:
                self.report.add(self.at(node), f"'{name}' is not supported; the mesh's own is used")

    def ignore_unless(self, node: Any, groups: tuple[Any, ...], name: str, neutral: float) -> None:
        """Reports an input that is not supported, unless it has the value at which it does nothing."""
        if name not in node.inputs:
            return
        quiet = ConstantReader(self.place, ExportReport())
        value = quiet.number(node, name, groups)
        if len(quiet.report) or value != neutral:
            self.report.add(self.at(node), f"'{name}' is not supported; {neutral:g} is used")


ReadShader = Callable[[SurfaceReader, Any, tuple[Any, ...]], Surface]
SEE_THROUGH = {"BSDF_TRANSPARENT", "BSDF_REFRACTION", "HOLDOUT"}
