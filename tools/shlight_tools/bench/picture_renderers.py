# SPDX-License-Identifier: MIT
"""The renderers of the picture bench: each renders a scene with a growing effort, or until a picture has converged."""

from __future__ import annotations

import importlib.util
import math
import os
import re
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

import shlight
from shlight.denoising import FEATURES
from shlight.quiet import quiet

from .picture_scenes import BallLamp, Light, PictureScene, Sun, Thing

Image = NDArray[np.float32]
LLVM_PATH = "DRJIT_LIBLLVM_PATH"
LEAST_LLVM = 17  # older ones fail where there is AVX-512
THREADS = 2
FIRST_LIMIT = 0.25  # seconds
# Settings of shlight's references, whose error is far below those of the compared pictures.
CONVERGED: dict[str, Any] = {"noise_threshold": 1e-3, "min_samples": 64, "max_samples": 1024}


class Renderer(Protocol):
    """A renderer with a scene in it."""

    name: str

    def pictures(self, seconds: float) -> Iterator[tuple[float, Image]]:
        """Pictures and the seconds that each took, with a growing effort until one takes longer than `seconds`."""

    def halves(self, seconds: float) -> tuple[Image, Image]:
        """Two independent pictures, each as good as the time allows."""


class Shlight:
    """Direct light: one render, whose pictures are those that it shows meanwhile.

    Light that bounces takes its share of a time limit: a render for each limit. `denoised` guides OpenImageDenoise by
    albedo and normals; there is a render for each limit, too.
    """

    def __init__(self, scene: PictureScene, size: int, *, denoised: bool = False) -> None:
        self.name = "shlight + OpenImageDenoise" if denoised else "shlight"
        self._scene, self._size, self.denoised = scene.for_shlight(), size, denoised
        self._has_limits = denoised or scene.max_bounces > 0
        self._options: dict[str, Any] = {"threads": THREADS, "max_bounces": scene.max_bounces}
        shlight.render(self._scene, 8, 8, **self._options)  # what is built once

    def pictures(self, seconds: float) -> Iterator[tuple[float, Image]]:
        if self._has_limits:
            yield from self._limited(seconds)
            return
        shown: list[tuple[float, Image]] = []
        start = time.perf_counter()

        def show(image: Image, report: shlight.RenderReport) -> bool:
            shown.append((time.perf_counter() - start, image))
            return shown[-1][0] < seconds

        last = shlight.render(self._scene, self._size, self._size, **self._options, on_update=show)
        yield from [*shown, (time.perf_counter() - start, last)]

    def _limited(self, seconds: float) -> Iterator[tuple[float, Image]]:
        limit, taken = FIRST_LIMIT, math.inf
        while limit <= seconds and taken > limit / 4:  # or else the one before was whole
            taken, image = self.picture(limit)
            yield taken, image
            limit *= 2

    def picture(self, seconds: float) -> tuple[float, Image]:
        """The picture that there is time for, and what it took."""
        start = time.perf_counter()
        features = FEATURES if self.denoised else ()
        made = shlight.render(self._scene, self._size, self._size, **self._options, time_limit=seconds, passes=features)
        if self.denoised:
            made = shlight.denoise(made["combined"], *(made[name] for name in features), quality="balanced")
        return time.perf_counter() - start, made

    def halves(self, seconds: float) -> tuple[Image, Image]:
        image = shlight.render(self._scene, self._size, self._size, **self._options, **CONVERGED, time_limit=seconds)
        return image, image


class Cycles:
    """Blender's Cycles through the module bpy; `denoised` guides OpenImageDenoise by albedo and normals."""

    def __init__(self, scene: PictureScene, size: int, *, denoised: bool) -> None:
        self.name = "Cycles + OpenImageDenoise" if denoised else "Cycles"
        self._scene, self._size, self.denoised = scene, size, denoised

    def pictures(self, seconds: float) -> Iterator[tuple[float, Image]]:
        taken, samples = 0.0, 1
        self._build()
        while taken < seconds:
            taken, image = self._render(samples, seed=samples)
            yield taken, image
            samples *= 2

    def halves(self, seconds: float) -> tuple[Image, Image]:
        self._build()
        taken, _ = self._render(16, seed=1, denoise=False)
        samples = max(16, int(16 * seconds / taken))
        first, second = (self._render(samples, seed=seed, denoise=False)[1] for seed in (11, 12))
        return first, second

    def _build(self) -> None:
        import bpy

        from shlight_blender.background import leave_plain, set_threads

        self._bpy = bpy
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        render = scene.render
        leave_plain(render)
        set_threads(render, THREADS)
        render.resolution_x = render.resolution_y = self._size
        render.resolution_percentage = 100
        scene.cycles.pixel_filter_type = "BOX"
        scene.cycles.blur_glossy = scene.cycles.sample_clamp_indirect = 0.0  # which other renderers do not have
        for thing in self._scene.things:
            _add_blender_mesh(bpy, thing)
        for lamp in self._scene.lamps:
            _add_blender_lamp(bpy, lamp)
        if self._scene.sky is not None:
            _set_blender_sky(bpy, self._scene.sky)
        camera = bpy.data.cameras.new("Camera")
        camera.sensor_fit, camera.angle = "HORIZONTAL", self._scene.fov
        scene.camera = bpy.data.objects.new("Camera", camera)
        scene.camera.matrix_world = self._scene.camera.T.tolist()
        scene.collection.objects.link(scene.camera)
        self._render(1, seed=0)  # what is loaded once

    def _render(self, samples: int, seed: int, denoise: bool | None = None) -> tuple[float, Image]:
        """denoise: None for as the renderer is named."""
        from shlight_blender.background import last_picture, use_cycles

        scene, most = self._bpy.context.scene, self._scene.max_bounces
        use_cycles(scene, samples, seed, (most, most, most), denoise=self.denoised if denoise is None else denoise)
        with quiet(), tempfile.TemporaryDirectory() as folder:
            start = time.perf_counter()
            self._bpy.ops.render.render()
            taken = time.perf_counter() - start
            return taken, last_picture(scene, Path(folder) / "picture.exr")


def _add_blender_mesh(bpy: Any, thing: Thing) -> None:
    mesh = bpy.data.meshes.new("Mesh")
    mesh.from_pydata(thing.mesh.vertices.tolist(), [], thing.mesh.triangles.tolist())
    mesh.shade_smooth()
    mesh.normals_split_custom_set_from_vertices(thing.mesh.normals.tolist())
    material = bpy.data.materials.new("Material")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    shader = _add_blender_shader(nodes, thing)
    links.new(shader.outputs[0], output.inputs["Surface"])
    if thing.picture is not None:
        layer = mesh.uv_layers.new(name="UVMap")
        layer.data.foreach_set("uv", np.asarray(thing.uvs, dtype=np.float32).ravel())
        texture = nodes.new("ShaderNodeTexImage")
        texture.image = _blender_image(bpy, thing.picture / 255.0, is_float=False)
        links.new(texture.outputs["Color"], shader.inputs["Color"])
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Mesh", mesh))


def _add_blender_shader(nodes: Any, thing: Thing) -> Any:
    if thing.emission is not None:
        shader = nodes.new("ShaderNodeEmission")
        shader.inputs["Color"].default_value = (*thing.emission, 1.0)
        return shader
    if thing.principled is not None:
        shader = nodes.new("ShaderNodeBsdfPrincipled")
        shader.distribution, shader.inputs["Base Color"].default_value = "GGX", (*thing.color, 1.0)
        for name, value in thing.principled.items():
            shader.inputs[name.replace("_", " ").title().replace("Ior", "IOR")].default_value = value
        return shader
    shader = nodes.new("ShaderNodeBsdfDiffuse" if thing.roughness is None else "ShaderNodeBsdfAnisotropic")
    if thing.roughness is not None:
        shader.distribution, shader.inputs["Roughness"].default_value = "GGX", thing.roughness
    shader.inputs["Color"].default_value = (*thing.color, 1.0)
    return shader


def _blender_image(bpy: Any, pixels: Any, *, is_float: bool) -> Any:
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("Picture", width, height, float_buffer=is_float)
    values = np.ones((height, width, 4), dtype=np.float32)
    values[..., :3] = pixels[::-1]
    image.pixels.foreach_set(values.ravel())
    image.pack()
    return image


def _add_blender_lamp(bpy: Any, lamp: Light) -> None:
    pose = np.eye(4)
    if isinstance(lamp, Sun):
        light = bpy.data.lights.new("Lamp", "SUN")
        strength, light.angle, unit = lamp.irradiance, lamp.angle, 1.0
        pose = shlight.look_at((0, 0, 0), lamp.direction)
    elif isinstance(lamp, BallLamp):
        light = bpy.data.lights.new("Lamp", "POINT")
        strength, light.shadow_soft_size = lamp.radiance, lamp.radius
        light.use_soft_falloff, unit = False, 4 * (math.pi * lamp.radius) ** 2
        pose[:3, 3] = lamp.center
    else:
        a, b, _, d = np.asarray(lamp.corners)
        light = bpy.data.lights.new("Lamp", "AREA")
        width, height = np.linalg.norm(b - a), np.linalg.norm(d - a)
        light.shape, light.size, light.size_y = "RECTANGLE", float(width), float(height)
        strength, unit = lamp.radiance, float(math.pi * width * height)
        x, y = (b - a) / width, (d - a) / height
        # It shines along -z, towards where the corners are seen counter-clockwise from.
        pose[:3, 0], pose[:3, 1], pose[:3, 2] = x, -y, -np.cross(x, y)
        pose[:3, 3] = np.mean(lamp.corners, axis=0)
    brightest = max(strength)
    light.color, light.energy = [value / brightest for value in strength], unit * brightest
    placed = bpy.data.objects.new("Lamp", light)
    placed.matrix_world, placed.visible_camera = pose.T.tolist(), False
    bpy.context.scene.collection.objects.link(placed)


def _set_blender_sky(bpy: Any, sky: Any) -> None:
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    if np.ndim(sky) == 1:
        background.inputs["Color"].default_value = (*sky, 1.0)
        return
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = _blender_image(bpy, np.asarray(sky), is_float=True)
    world.node_tree.links.new(texture.outputs["Color"], background.inputs["Color"])


class Mitsuba:
    """Mitsuba 3's integrator `path`, or `direct` for direct light, compiled by LLVM.

    Rendering only, without loading and compiling. `path` shows lamps to the camera, which the others do not.
    """

    @staticmethod
    def missing() -> str:
        """Why it cannot be used here; empty if it can."""
        if importlib.util.find_spec("mitsuba") is None:
            return "there is no module mitsuba; pip install mitsuba"
        if LLVM_PATH not in os.environ:
            found = [path for path in Path("/usr/lib").glob("*/libLLVM*.so*") if _llvm_version(path) >= LEAST_LLVM]
            if not found:
                return f"there is no libLLVM of version {LEAST_LLVM} or later; apt install libllvm19"
            os.environ[LLVM_PATH] = str(max(found, key=_llvm_version))
        return ""

    MOST_AT_ONCE = 64  # samples, whose rays are in memory together

    def __init__(self, scene: PictureScene, size: int) -> None:
        import mitsuba

        self.name = "Mitsuba path" if scene.max_bounces else "Mitsuba direct"
        mitsuba.set_variant("llvm_ad_rgb")
        import drjit

        drjit.set_thread_count(THREADS)
        self._mi = mitsuba
        self._scene = mitsuba.load_dict(_mitsuba_scene(mitsuba, scene, size))

    def pictures(self, seconds: float) -> Iterator[tuple[float, Image]]:
        taken, samples = 0.0, 1
        while taken < seconds:
            self._render(samples, 1)  # compiles
            taken, image = self._render(samples, samples)
            yield taken, image
            samples *= 4 if samples < 4 else 2

    def halves(self, seconds: float) -> tuple[Image, Image]:
        self._render(16, 1)
        taken, _ = self._render(16, 2)
        samples = max(16, int(16 * seconds / taken))
        return self._render(samples, 101)[1], self._render(samples, 50_001)[1]

    def _render(self, samples: int, seed: int) -> tuple[float, Image]:
        done, total = 0, np.zeros(1)
        start = time.perf_counter()
        while done < samples:
            count = min(samples - done, self.MOST_AT_ONCE)
            total = total + count * np.asarray(self._mi.render(self._scene, spp=count, seed=seed + done))
            done += count
        return time.perf_counter() - start, np.asarray(total / samples, dtype=np.float32)


def _llvm_version(path: Path) -> int:
    found = re.search(r"libLLVM(?:-|\.so\.)(\d+)", path.name)
    return int(found.group(1)) if found else 0


def _mitsuba_scene(mi: Any, scene: PictureScene, size: int) -> dict[str, Any]:
    # Mitsuba's camera looks along +z, x to the left.
    pose = scene.camera @ np.diag([-1.0, 1.0, -1.0, 1.0])
    made: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "direct", "hide_emitters": scene.sky is None},
        "sensor": {
            "type": "perspective",
            "fov": math.degrees(scene.fov),
            "fov_axis": "x",
            "to_world": mi.ScalarTransform4f(pose),
            "film": {
                "type": "hdrfilm",
                "width": size,
                "height": size,
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        },
    }
    if scene.max_bounces:
        made["integrator"] |= {"type": "path", "max_depth": scene.max_bounces + 2}
    for i, thing in enumerate(scene.things):
        made[f"thing{i}"] = _mitsuba_mesh(mi, thing)
    for i, lamp in enumerate(scene.lamps):
        made[f"lamp{i}"] = _mitsuba_lamp(mi, lamp)
    if scene.sky is not None and np.ndim(scene.sky) == 1:
        made["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": list(scene.sky)}}
    elif scene.sky is not None:
        up = mi.ScalarTransform4f().rotate([1, 0, 0], 90)
        made["sky"] = {"type": "envmap", "bitmap": mi.Bitmap(np.asarray(scene.sky, dtype=np.float32)), "to_world": up}
    return made


def _mitsuba_lamp(mi: Any, lamp: Light) -> dict[str, Any]:
    if isinstance(lamp, Sun):  # whose angle is small
        irradiance = {"type": "rgb", "value": list(lamp.irradiance)}
        return {"type": "directional", "direction": list(lamp.direction), "irradiance": irradiance}
    emitter = {"type": "area", "radiance": {"type": "rgb", "value": list(lamp.radiance)}}
    if isinstance(lamp, BallLamp):
        return {"type": "sphere", "center": list(lamp.center), "radius": lamp.radius, "emitter": emitter}
    a, b, _, d = np.asarray(lamp.corners)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1] = (b - a) / 2, (d - a) / 2
    pose[:3, 2] = np.cross(pose[:3, 0], pose[:3, 1])
    pose[:3, 3] = np.mean(lamp.corners, axis=0)
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(pose), "emitter": emitter}


def _mitsuba_bsdf(mi: Any, thing: Thing) -> dict[str, Any]:
    color = {"type": "rgb", "value": list(thing.color)}
    if thing.principled is not None:
        given = thing.principled
        bsdf = {"type": "principled", "base_color": color, "roughness": max(given.get("roughness", 0.5), 0.01)}
        bsdf |= {"spec_trans": given.get("transmission_weight", 0.0), "eta": given.get("ior", 1.5)}
        if bsdf["spec_trans"]:
            return bsdf
    elif thing.roughness is not None:
        bsdf = {"type": "roughconductor", "material": "none", "alpha": max(thing.roughness**2, 1e-4)}
        bsdf |= {"distribution": "ggx", "specular_reflectance": color}
    elif thing.picture is not None:
        bitmap = mi.Bitmap(np.ascontiguousarray(thing.picture))
        bsdf = {"type": "diffuse", "reflectance": {"type": "bitmap", "bitmap": bitmap}}
    else:
        bsdf = {"type": "diffuse", "reflectance": color}
    return {"type": "twosided", "bsdf": bsdf}


def _mitsuba_mesh(mi: Any, thing: Thing) -> Any:
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(_mitsuba_bsdf(mi, thing))
    if thing.emission is not None:
        radiance = {"type": "rgb", "value": list(thing.emission)}
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    faces = np.asarray(thing.mesh.triangles)
    vertices, normals = thing.mesh.vertices, thing.mesh.normals
    if thing.uvs is not None:  # vertices of each triangle apart
        vertices, normals = vertices[faces].reshape(-1, 3), normals[faces].reshape(-1, 3)
        faces = np.arange(3 * len(faces)).reshape(-1, 3)
    mesh = mi.Mesh(
        "mesh",
        len(vertices),
        len(faces),
        props=properties,
        has_vertex_normals=True,
        has_vertex_texcoords=thing.uvs is not None,
    )
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.ravel(vertices).astype(np.float32)
    parameters["vertex_normals"] = np.ravel(normals).astype(np.float32)
    parameters["faces"] = np.ravel(faces).astype(np.uint32)
    if thing.uvs is not None:
        parameters["vertex_texcoords"] = np.ravel(thing.uvs).astype(np.float32)
    parameters.update()
    return mesh
