# SPDX-License-Identifier: MIT
"""Scenes from files of models: glTF, OBJ and PLY, whose meshes and pictures trimesh and Pillow read."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from pathlib import Path

from shlight._arrays import checked_name, checked_number
from shlight._core import Scene
from shlight.images import checked_path
from shlight.models import gltf, plain
from shlight.models.parts import Model, import_trimesh

__all__ = ["SUFFIXES", "load"]

READERS: dict[str, Callable[[Path], Model]] = {
    ".glb": gltf.read,
    ".gltf": gltf.read,
    ".obj": plain.read_obj,
    ".ply": plain.read_ply,
}
SUFFIXES = tuple(READERS)


def load(path: str | os.PathLike[str], *, up: str | None = None, scale: float = 1.0) -> Scene:
    """A Scene of a glTF (.glb, .gltf), OBJ or PLY file, with a camera. It needs `pip install 'shlight[files]'`.

    up: "y" or "z", the axis of the file that becomes the scene's z; None: "y" for glTF and OBJ, of whose points
        (x, y, z) become (x, -z, y), and "z" for PLY, as Blender has them.
    scale: metres per unit of the file, which is 1 for glTF.

    Meshes keep their vertices, normals, texture coordinates and instances; without normals triangles are flat. glTF's
    metallic-roughness materials become `nodes.principled` with their pictures, normal maps, alpha, and the extensions
    ior, transmission, clearcoat, specular, emissive_strength and unlit; materials of OBJ become that, too, as Blender
    reads them. Emission [W/m²/sr] is the file's number: strength 1 is as bright as an environment of 1.
    Lights (KHR_lights_punctual) in candela and lux are divided by 683 lm/W (`luminous` gives them back), and the
    camera is the first of the file; a file without one gets one that sees all of it.

    Warns (UserWarning) of all that is in the file and not supported. Raises ValueError naming the argument, OSError
    where the file cannot be read, and ImportError without trimesh or Pillow.
    """
    file = checked_path(path)
    suffix = file.suffix.lower()
    if suffix not in READERS:
        raise ValueError(f"path must end in {', '.join(SUFFIXES)}, got {os.fspath(path)!r}")
    size = checked_number("scale", scale)
    if not 1e-6 <= size <= 1e6:
        raise ValueError(f"scale must be 1e-6 … 1e6, got {size}")
    upright = ("z" if suffix == ".ply" else "y") if up is None else checked_name("up", up, ("y", "z"))
    with file.open("rb"):  # the usual FileNotFoundError, PermissionError or IsADirectoryError
        pass
    import_trimesh()
    model = READERS[suffix](file)
    if not model.parts:
        raise ValueError(f"path: there are no triangles in {file}")
    scene = model.scene(is_y_up=upright == "y", scale=size)
    if model.notes:
        warnings.warn(f"{file.name}: not supported: {'; '.join(dict.fromkeys(model.notes))}", stacklevel=2)
    return scene
