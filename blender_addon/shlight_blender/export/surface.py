# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface shader as shlight sees it, and the walk over the nodes that define one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import shlight

from ..report import ExportReport
from .nodes import RGB, ConstantReader, origin, rgb


def _black() -> RGB:
    return np.zeros(3)


@dataclass
class Surface:
    """What a shader does to light: reflection (None: none) and the radiance it emits on both sides (RGB)."""

    bsdf: shlight.Bsdf | None = None
    emission: RGB = field(default_factory=_black)

    def scaled(self, factor: float) -> Surface:
        """The surface under a constant weight."""
        if factor == 0.0:
            return Surface()
        if factor == 1.0:
            return self
        return Surface(None if self.bsdf is None else factor * self.bsdf, factor * self.emission)

    def plus(self, other: Surface) -> Surface:
        """Both surfaces at once."""
        if self.bsdf is None or other.bsdf is None:
            bsdf = other.bsdf if self.bsdf is None else self.bsdf
        else:
            bsdf = self.bsdf + other.bsdf
        return Surface(bsdf, self.emission + other.emission)

    def opaque_bsdf(self) -> shlight.Bsdf:
        """The reflection, black where there is none."""
        return shlight.Bsdf.lambert(0.0) if self.bsdf is None else self.bsdf


def lambert(albedo: RGB) -> shlight.Bsdf | None:
    """Lambert's reflection, or None for black."""
    return shlight.Bsdf.lambert(rgb(albedo)) if albedo.any() else None


class SurfaceReader(ConstantReader):
    """Walks the shader nodes of one tree; `shaders` says how a node of each type is read."""

    def __init__(self, place: str, report: ExportReport, shaders: Mapping[str, ReadShader]) -> None:
        super().__init__(place, report)
        self._shaders = shaders

    def surface(self, socket: Any, groups: tuple[Any, ...] = ()) -> Surface:
        """The surface that a shader socket receives; black where nothing is linked."""
        source = origin(socket, groups)
        if source.node is None:
            return Surface()
        read = self._shaders.get(source.node.type)
        if read is not None:
            return read(self, source.node, source.groups)
        return self._unsupported(source.node, source.groups)

    def _unsupported(self, node: Any, groups: tuple[Any, ...]) -> Surface:
        kind = node.bl_label or node.bl_idname
        if node.type in SEE_THROUGH or "Color" not in node.inputs:
            self.report.add(self.at(node), f"{kind} is not supported; drawn black")
            return Surface()
        self.report.add(self.at(node), f"{kind} is not supported; drawn as Diffuse BSDF of its colour")
        return Surface(lambert(self.color(node, "Color", groups)))

    def remarks(self, node: Any) -> Callable[[str], None]:
        """A function that adds its text to the report, about this node."""
        return lambda text: self.report.add(self.at(node), text)

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
