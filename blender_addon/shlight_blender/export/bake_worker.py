# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender that bakes a world for `bake`.

The folder holds world.blend, and the pixels of images whose changes are in no file. Written is picture.npy, float32
(width / 2, width, 3) with the mapping of `shlight.Scene.set_environment`; the figures are "suns", a list of
{"direction", "angle", "irradiance"} as `bake.Sun` has them.

A sky's sun disc is narrower than a few texels. It is left out of the picture, and its irradiance is that of two renders
with and without it, of a small part of the sky at 128 x 128 pixels.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Euler, Vector
from numpy.typing import NDArray

from ..background import last_picture, leave_plain, load_unsaved_images, set_threads, use_cycles
from ..worker_process import Channel, serve

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
BRIGHTEST = 65504.0  # what is infinite becomes this

# Outputs of a Light Path node for a diffuse ray; other outputs are 0.
DIFFUSE_RAY = {"Is Diffuse Ray": 1.0, "Is Reflection Ray": 1.0, "Ray Depth": 1.0, "Diffuse Depth": 1.0}


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

    def bake(self) -> tuple[Picture, list[dict[str, Any]]]:
        """The picture without narrow suns, and these."""
        suns = [node for tree in self._trees for node in tree.nodes if _has_narrow_sun(node)]
        for node in suns:
            node.sun_disc = False
        picture = self._panorama(self._width, PICTURE_SAMPLES)
        measured = [self._measure(node) for node in suns]
        return picture, [sun for sun in measured if sun is not None]

    def _panorama(self, width: int, samples: int) -> Picture:
        """The world all around: +x in the middle, +y to its left, +z on top."""
        camera = self._camera.data
        camera.type = "PANO"
        (camera if hasattr(camera, "panorama_type") else camera.cycles).panorama_type = "EQUIRECTANGULAR"
        self._camera.rotation_euler = Euler((0.5 * math.pi, 0.0, -0.5 * math.pi))
        return self._render(width, width // 2, samples)

    def _measure(self, node: Any) -> dict[str, Any] | None:
        """The sun of a sky texture, whose disc is off; None if it gives no light."""
        angle = node.sun_size
        texel = 2.0 * math.pi / SEARCH_WIDTH
        dark = self._panorama(SEARCH_WIDTH, SEARCH_SAMPLES)
        node.sun_disc, node.sun_size = True, max(angle, NARROWEST_SOUGHT * texel)
        around = self._panorama(SEARCH_WIDTH, SEARCH_SAMPLES) - dark
        width = 2.0 * node.sun_size + texel
        node.sun_disc, node.sun_size = False, angle
        towards = _weighted_mean(around, *_panorama_directions(*around.shape[:2]))
        return None if towards is None else self._close_in(node, towards, width)

    def _close_in(self, node: Any, towards: NDArray[np.float64], width: float) -> dict[str, Any]:
        """The sun within half `width` of `towards`, looked at ever closer until it fills half the picture."""
        angle = max(node.sun_size, NARROWEST_SUN)
        while True:
            node.sun_disc = True
            lit = self._close_up(towards, width)
            node.sun_disc = False
            sun = lit - self._close_up(towards, width)
            directions, solid_angles = _close_up_directions(width, np.array(self._camera.matrix_world)[:3, :3])
            centre = _weighted_mean(sun, directions, solid_angles)
            if centre is None:
                raise RuntimeError(f"the sun of '{node.name}' was found and then not met")
            if width <= 2.0 * angle:
                irradiance = np.maximum(np.einsum("ijc,ij->c", sun, solid_angles), 0.0)
                return {"direction": (-centre).tolist(), "angle": angle, "irradiance": irradiance.tolist()}
            towards, width = centre, max(2.0 * angle, width / ZOOM)

    def _close_up(self, towards: NDArray[np.float64], width: float) -> Picture:
        camera = self._camera.data
        camera.type = "PERSP"
        camera.sensor_fit = "AUTO"
        camera.lens_unit = "FOV"
        # Not `angle`, whose least value is wider than a narrow sun.
        camera.sensor_width, camera.lens = 1.0, 0.5 / math.tan(0.5 * width)
        self._camera.rotation_euler = Vector(towards).to_track_quat("-Z", "Y").to_euler()
        bpy.context.view_layer.update()
        return self._render(SUN_SIZE, SUN_SIZE, SUN_SAMPLES)

    def _render(self, width: int, height: int, samples: int) -> Picture:
        """RGB (height, width, 3), row 0 on top."""
        render = self._scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
        use_cycles(self._scene, samples, SEED, NO_BOUNCES)
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


def _panorama_directions(height: int, width: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions (height, width, 3) and solid angles (height, width) of a panorama's texels."""
    longitude = math.pi * (1.0 - 2.0 * (np.arange(width) + 0.5) / width)
    latitude = math.pi * (0.5 - (np.arange(height) + 0.5) / height)[:, None]
    flat = np.cos(latitude)
    sines = np.broadcast_to(np.sin(latitude), (height, width))
    directions = np.stack([flat * np.cos(longitude), flat * np.sin(longitude), sines], axis=-1)
    return directions, np.broadcast_to(flat * (2.0 * math.pi / width) * (math.pi / height), (height, width))


def _close_up_directions(
    width: float, to_world: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions and solid angles of the pixels of a square perspective picture `width` [rad] wide."""
    half = math.tan(0.5 * width)
    across = half * (2.0 * (np.arange(SUN_SIZE) + 0.5) / SUN_SIZE - 1.0)
    x, y = np.meshgrid(across, -across)
    rays = np.stack([x, y, np.full_like(x, -1.0)], axis=-1)
    lengths = np.linalg.norm(rays, axis=-1)
    return (rays / lengths[..., None]) @ to_world.T, (2.0 * half / SUN_SIZE) ** 2 / lengths**3


def _weighted_mean(
    picture: Picture, directions: NDArray[np.float64], solid_angles: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """The mean direction of the picture's light; None if there is none."""
    mean = np.einsum("ij,ijk->k", np.maximum(picture.sum(axis=-1), 0.0) * solid_angles, directions)
    length = float(np.linalg.norm(mean))
    return mean / length if length > 0.0 else None


def bake(request: dict[str, Any], folder: Path, _: Channel) -> dict[str, Any]:
    """Bakes what is asked for."""
    picture, suns = Baker(folder, request).bake()
    np.save(folder / "picture.npy", np.ascontiguousarray(picture, dtype=np.float32))
    return {"suns": suns}


def main(arguments: list[str]) -> None:
    """Serves the request of a folder; see `serving`."""
    serve(bake, arguments)
