# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender that bakes a world for `bake`.

The folder holds world.blend, and the pixels of images whose changes are in no file. Written is a file of "picture",
float32 (width / 2, width, 3) with the mapping of `shlight.Scene.set_environment`, and of "suns" (n, 7).

A sky's sun disc is narrower than a few texels. It is left out of the picture, and its irradiance is that of two renders
with and without it, of a small part of the sky at 128 x 128 pixels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Euler, Vector
from numpy.typing import NDArray

from ..background import last_picture, leave_plain, load_unsaved_images, set_threads, use_cycles
from ..compat import panorama_settings
from ..worker_process import Channel, serve
from .bake import BAKED
from .images import BRIGHTEST
from .world import DIFFUSE_RAY

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

SEED, NO_BOUNCES = 0, (0, 0, 0)
PICTURE_SAMPLES = 16
SEARCH_WIDTH, SEARCH_SAMPLES = 512, 4
SUN_SAMPLES, SUN_SIZE = 64, 128
ZOOM = 16.0
NARROWEST_SUN = 5e-4  # [rad], to which Cycles widens narrower ones
WIDEST_SUN = math.radians(5.0)  # wider ones stay in the picture
NARROWEST_SOUGHT = 4.0  # texels of that width; narrower discs are widened while their direction is sought
SKIES_WITHOUT_SUN = {"PREETHAM", "HOSEK_WILKIE"}


@dataclass(frozen=True)
class Part:
    """A part of the sky in longitudes and latitudes, seen by a camera that is turned to its middle."""

    turn: Euler
    reach: tuple[float, float]  # of longitudes and of latitudes [rad] beside the middle
    size: tuple[int, int]  # width and height in pixels
    samples: int

    def directions(self) -> tuple[Array, Array]:
        """Directions (height, width, 3) in the world, and solid angles (height, width), of its pixels."""
        (width, height), (across, up) = self.size, self.reach
        longitude = across * (2.0 * (np.arange(width) + 0.5) / width - 1.0)
        latitude = up * (1.0 - 2.0 * (np.arange(height) + 0.5) / height)[:, None]
        flat = np.cos(latitude)
        sines = np.broadcast_to(np.sin(latitude), (height, width))
        seen = np.stack([flat * np.sin(longitude), sines, -flat * np.cos(longitude)], axis=-1)
        solid_angles = np.broadcast_to(flat * (4.0 * across * up / (width * height)), (height, width))
        return seen @ np.array(self.turn.to_matrix(), dtype=np.float64).T, solid_angles


def whole_sky(width: int, samples: int) -> Part:
    """The world all around: +x in the middle, +y to its left, +z on top."""
    turn = Euler((0.5 * math.pi, 0.0, -0.5 * math.pi))
    return Part(turn, (math.pi, 0.5 * math.pi), (width, width // 2), samples)


def close_up(towards: Array, width: float) -> Part:
    """A square `width` [rad] wide."""
    turn = Vector(towards).to_track_quat("-Z", "Y").to_euler()
    return Part(turn, (0.5 * width, 0.5 * width), (SUN_SIZE, SUN_SIZE), SUN_SAMPLES)


class Baker:
    """A scene of a camera in a world."""

    def __init__(self, folder: Path, request: dict[str, Any]) -> None:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.preferences.addon_enable(module="cycles")
        self._file = folder / "render.exr"
        self._width = int(request["width"])
        self._scene = bpy.context.scene
        self._camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        self._scene.collection.objects.link(self._camera)
        self._scene.camera = self._camera
        self._set_up_render(request["threads"])
        with bpy.data.libraries.load(str(folder / "world.blend")) as (_, wanted):
            wanted.worlds = [request["world"]]
        self._world = self._scene.world = wanted.worlds[0]
        self._trees = [self._world.node_tree, *bpy.data.node_groups]
        self._set_up_world()
        load_unsaved_images(request["images"], folder)
        self._scene.frame_set(request["frame"], subframe=request["subframe"])

    def _set_up_render(self, threads: int) -> None:
        leave_plain(self._scene.render)
        set_threads(self._scene.render, threads)
        self._scene.render.film_transparent = False
        self._scene.cycles.pixel_filter_type = "BOX"

    def _set_up_world(self) -> None:
        """Without volume, seen by the camera, and lit as diffuse rays see it."""
        visibility = getattr(self._world, "cycles_visibility", None)
        if visibility is not None:
            visibility.camera = True
        self._world.cycles.sampling_method = "NONE"  # which nothing here needs and takes time to prepare
        for tree in self._trees:
            for node in list(tree.nodes):
                if node.type == "OUTPUT_WORLD":
                    for link in list(node.inputs["Volume"].links):
                        tree.links.remove(link)
                elif node.type == "LIGHT_PATH":
                    _be_diffuse_ray(tree, node)

    def bake(self) -> tuple[Picture, list[Array]]:
        """The picture without narrow suns, and these."""
        suns = [node for tree in self._trees for node in tree.nodes if _has_narrow_sun(node)]
        for node in suns:
            node.sun_disc = False
        picture = self._render(whole_sky(self._width, PICTURE_SAMPLES))
        measured = [self._measure(node) for node in suns]
        return picture, [sun for sun in measured if sun is not None]

    def _measure(self, node: Any) -> Array | None:
        """The sun (7,) of a sky texture, whose disc is off; None if it gives no light.

        It is looked at ever closer until it fills half the picture.
        """
        angle, texel = node.sun_size, 2.0 * math.pi / SEARCH_WIDTH
        node.sun_size = max(angle, NARROWEST_SOUGHT * texel)
        width = 2.0 * node.sun_size + texel
        towards, _ = self._disc(node, whole_sky(SEARCH_WIDTH, SEARCH_SAMPLES))
        node.sun_size, angle = angle, max(angle, NARROWEST_SUN)
        while towards is not None:
            towards, irradiance = self._disc(node, close_up(towards, width))
            if towards is None:
                raise RuntimeError(f"the sun of '{node.name}' was found and then not met")
            if width <= 2.0 * angle:
                return np.array([*-towards, angle, *irradiance])
            width = max(2.0 * angle, width / ZOOM)
        return None

    def _disc(self, node: Any, part: Part) -> tuple[Array | None, Array]:
        """The mean direction of the light that a disc adds to a part of the sky (None: none), and its irradiance."""
        node.sun_disc = True
        lit = self._render(part)
        node.sun_disc = False
        added, (directions, solid_angles) = lit - self._render(part), part.directions()
        mean = np.einsum("ij,ijk->k", np.maximum(added.sum(axis=-1), 0.0) * solid_angles, directions)
        length = float(np.linalg.norm(mean))
        irradiance = np.maximum(np.einsum("ijc,ij->c", added, solid_angles), 0.0)
        return mean / length if length > 0.0 else None, irradiance

    def _render(self, part: Part) -> Picture:
        """RGB (height, width, 3), row 0 on top."""
        camera = self._camera.data
        camera.type = "PANO"
        panorama = panorama_settings(camera)
        panorama.panorama_type = "EQUIRECTANGULAR"
        for name, reach in zip(("longitude", "latitude"), part.reach, strict=True):
            setattr(panorama, f"{name}_min", -reach)
            setattr(panorama, f"{name}_max", reach)
        self._camera.rotation_euler = part.turn
        render = self._scene.render
        (render.resolution_x, render.resolution_y), render.resolution_percentage = part.size, 100
        use_cycles(self._scene, part.samples, SEED, NO_BOUNCES)
        bpy.ops.render.render()
        pixels = last_picture(self._scene, self._file)[..., :3]
        return np.nan_to_num(pixels, posinf=BRIGHTEST, neginf=-BRIGHTEST)


def _be_diffuse_ray(tree: Any, node: Any) -> None:
    for output in node.outputs:
        if output.is_linked:
            value = tree.nodes.new("ShaderNodeValue")
            value.outputs[0].default_value = DIFFUSE_RAY.get(output.name, 0.0)
            for link in list(output.links):
                tree.links.new(value.outputs[0], link.to_socket)


def _has_narrow_sun(node: Any) -> bool:
    return (
        node.type == "TEX_SKY"
        and node.sky_type not in SKIES_WITHOUT_SUN
        and node.sun_disc
        and node.sun_size <= WIDEST_SUN
        and not node.mute
    )


def bake(request: dict[str, Any], folder: Path, _: Channel) -> dict[str, Any]:
    """Bakes what is asked for."""
    picture, suns = Baker(folder, request).bake()
    np.savez(folder / BAKED, picture=picture, suns=np.reshape(suns, (-1, 7)))
    return {}


def main(arguments: list[str]) -> None:
    """Serves the request of a folder; see `worker_process.serve`."""
    serve(bake, arguments)
