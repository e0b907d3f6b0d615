# SPDX-License-Identifier: MIT
"""What readers of models find, and the Scene that it makes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shlight import nodes
from shlight._core import Bsdf, Scene
from shlight.cameras import look_at

Floats = NDArray[np.float64]
Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])  # (x, y, z) to (x, -z, y)
COLORS, TANGENTS = "Color", "tangents"  # attributes of meshes that materials read
ANGLE_OF_VIEW = math.radians(40.0)


def import_trimesh() -> Any:
    """The module trimesh, where Pillow is there, too."""
    try:
        import PIL.Image  # noqa: F401
        import trimesh
    except ImportError as error:
        raise ImportError(f"shlight.load needs {error.name}: pip install 'shlight[files]'", name=error.name) from None
    return trimesh


def read_scene(path: Path, source: Any, **options: Any) -> Any:
    """The trimesh.Scene of what a file holds; ValueError naming the file where trimesh cannot read it."""
    try:
        return import_trimesh().load_scene(source, process=False, **options)
    except OSError:
        raise
    except Exception as error:
        raise ValueError(f"path: {path} cannot be read: {type(error).__name__}: {error}") from None


@dataclass
class Look:
    """A material."""

    bsdf: Bsdf | nodes.Shader = field(default_factory=lambda: Bsdf.lambert(0.8))
    emission: Floats | None = None  # (3,), the radiance by which it lights others
    name: str = ""
    reads_tangents: bool = False


@dataclass
class Part:
    """A mesh of one material, wherever it stands."""

    mesh: Any  # trimesh.Trimesh
    look: Look
    transforms: Floats  # (i, 4, 4)
    names: list[str]  # of its instances

    def corners(self) -> Floats:
        """The corners (i, 8, 3) of the boxes around its instances."""
        low, high = np.asarray(self.mesh.bounds)
        box = np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1).reshape(-1, 3)
        return np.asarray(box @ self.transforms[:, :3, :3].swapaxes(1, 2) + self.transforms[:, None, :3, 3])

    def arguments(self) -> dict[str, Any]:
        """Arguments of Scene.add_mesh, but for transforms."""
        mesh, visual = self.mesh, self.mesh.visual
        found: dict[str, Any] = {"bsdf": self.look.bsdf, "emission": self.look.emission, "object_names": self.names}
        if self.look.name:
            found["material_names"] = self.look.name
        if "vertex_normals" in mesh._cache.cache:  # or else trimesh would make some
            found["normals"] = mesh.vertex_normals
        uvs = getattr(visual, "uv", None)
        if uvs is not None and len(uvs) == len(mesh.vertices):
            found["uvs"] = uvs
            if self.look.reads_tangents:
                found["attributes"] = {TANGENTS: _tangents(mesh, np.asarray(uvs))}
        colors = colors_of(mesh)
        if colors is not None:
            found["colors"] = {COLORS: colors}
        return found


@dataclass
class Model:
    """A file's contents in the file's frame and unit."""

    parts: list[Part] = field(default_factory=list)
    lights: list[Callable[[Scene, Floats], None]] = field(default_factory=list)  # each adds one, by the file's frame
    camera: Callable[[Scene, Floats], None] | None = None
    notes: list[str] = field(default_factory=list)  # what is not supported

    def scene(self, *, is_y_up: bool, scale: float) -> Scene:
        """The scene, in metres, z up."""
        frame = (Y_UP if is_y_up else np.eye(4)) * [[scale], [scale], [scale], [1.0]]
        made = Scene()
        for part in self.parts:
            made.add_mesh(part.mesh.vertices, part.mesh.faces, transforms=frame @ part.transforms, **part.arguments())
        for add_light in self.lights:
            add_light(made, frame)
        if self.camera is not None:
            self.camera(made, frame)
        else:
            corners = np.concatenate([part.corners().reshape(-1, 3) for part in self.parts])
            _see_all(made, corners @ frame[:3, :3].T)
        return made


def _see_all(scene: Scene, points: Floats) -> None:
    """A camera before the points and a little above; pictures up to half again as wide as high show all of them."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, radius = 0.5 * (low + high), max(0.5 * float(np.linalg.norm(high - low)), 1e-6)
    distance = 1.5 * radius / math.sin(0.5 * ANGLE_OF_VIEW)
    away = np.array([0.4, -0.85, 0.35])
    scene.set_camera(look_at(middle + distance * away / np.linalg.norm(away), middle), ANGLE_OF_VIEW)


def colors_of(mesh: Any) -> NDArray[np.float32] | None:
    """The colours (n, 4) of a mesh's vertices as its file has them, 0 … 1."""
    colors = getattr(mesh.visual, "vertex_attributes", {}).get("color")
    if colors is None and mesh.visual.kind == "vertex":
        colors = mesh.visual.vertex_colors
    if colors is None:
        return None
    array = np.asarray(colors)
    largest = np.iinfo(array.dtype).max if array.dtype.kind in "ui" else 1.0
    made = np.ones((len(array), 4), np.float32)
    made[:, : array.shape[1]] = array / largest
    return made


def _tangents(mesh: Any, uvs: Floats) -> NDArray[np.float32]:
    """The direction in which u grows at each vertex, and the sign of v's: (n, 4), 0 where a mesh has no such direction.

    Means over the triangles of a vertex, by their area in the picture (as Lengyel's).
    """
    faces, vertices = np.asarray(mesh.faces), np.asarray(mesh.vertices)
    edge, other = (vertices[faces[:, i]] - vertices[faces[:, 0]] for i in (1, 2))
    (u1, v1), (u2, v2) = ((uvs[faces[:, i]] - uvs[faces[:, 0]]).T[..., None] for i in (1, 2))
    turn = np.sign(u1 * v2 - u2 * v1)
    sums = np.zeros((2, len(vertices), 3))
    for corner in range(3):
        np.add.at(sums[0], faces[:, corner], turn * (edge * v2 - other * v1))
        np.add.at(sums[1], faces[:, corner], turn * (other * u1 - edge * u2))
    normals = np.asarray(mesh.vertex_normals)
    along = sums[0] - normals * (normals * sums[0]).sum(axis=1, keepdims=True)
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.divide(along, length, out=np.zeros_like(along), where=length > 0)
    sign = np.where((np.cross(normals, along) * sums[1]).sum(axis=1, keepdims=True) < 0, -1.0, 1.0)
    return np.concatenate([along, sign], axis=1).astype(np.float32)
