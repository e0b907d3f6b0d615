# SPDX-License-Identifier: MIT
"""A textured OBJ file under a lamp and a sky.

usage: python examples/textured_obj.py model.obj texture.png [picture.png]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import shlight
from shlight import nodes


def read_obj(path: str) -> dict[str, np.ndarray]:
    """Vertices, triangles, and texture coordinates of each triangle's corners, of a file of `v`, `vt` and `f` lines."""
    lines = [line.split() for line in Path(path).read_text(encoding="utf-8").splitlines() if line.strip()]
    places, uvs = (np.array([line[1:] for line in lines if line[0] == kind], float) for kind in ("v", "vt"))
    faces = [[[int(n) - 1 for n in corner.split("/")[:2]] for corner in line[1:]] for line in lines if line[0] == "f"]
    corners = np.array([(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)])
    return {"vertices": places, "triangles": corners[..., 0], "uvs": uvs[corners[..., 1], :2]}


def build(model: dict[str, np.ndarray], texture: str) -> shlight.Scene:
    """The model, scaled to one metre and seen from the front."""
    low, high = model["vertices"].min(axis=0), model["vertices"].max(axis=0)
    model["vertices"] = (model["vertices"] - 0.5 * (low + high)) / (high - low).max()
    scene = shlight.Scene()
    color = nodes.image(texture, encoding="srgb")
    scene.add_mesh(**model, bsdf=shlight.Bsdf.principled(color, roughness=0.6 - 0.3 * color.as_number()))
    scene.add_sphere_light((1.0, 1.5, 2.0), 0.4, (40.0, 36.0, 30.0))
    scene.set_environment(np.full((8, 16, 3), (0.25, 0.3, 0.4)))
    to_world = np.eye(4)
    to_world[2, 3] = 2.5
    scene.set_camera(to_world, np.deg2rad(35.0))
    return scene


def main() -> None:
    """Renders the model into a file."""
    result = shlight.render(build(read_obj(sys.argv[1]), sys.argv[2]), 400, 400)
    result.save(sys.argv[3] if len(sys.argv) > 3 else "model.png")


if __name__ == "__main__":
    main()
