# SPDX-License-Identifier: MIT
"""A studio: small scenes built in a fresh Blender file. Needs nothing that Blender's own Python may lack."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


class Studio:
    """Builds objects in the current file and renders it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.preferences.addon_enable(module="cycles")
        self.scene = bpy.context.scene
        self.prepare()

    def prepare(self) -> None:
        """Settings that make Cycles' picture a reference for direct light, and both pictures comparable."""
        scene = self.scene = bpy.context.scene
        render = scene.render
        render.resolution_x, render.resolution_y, render.resolution_percentage = 48, 36, 100
        render.image_settings.file_format = "OPEN_EXR"
        render.image_settings.color_mode = "RGBA"
        render.image_settings.color_depth = "32"
        render.image_settings.exr_codec = "ZIP"
        render.use_compositing = render.use_sequencer = False
        cycles = scene.cycles
        cycles.samples = 256
        cycles.use_adaptive_sampling = cycles.use_denoising = False
        cycles.max_bounces = 0
        if hasattr(scene, "shlight"):
            scene.shlight.max_bounces = scene.shlight.preview_max_bounces = 0
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
        cycles.light_sampling_threshold = 0.0
        cycles.blur_glossy = 0.0
        cycles.pixel_filter_type = "BOX"
        cycles.filter_width = 1.0
        scene.world = None

    def need(self, name: str) -> None:
        """Is told each property or input that not every version of Blender has."""

    # --- objects

    def link(self, name: str, data: Any, location: Sequence[float] = (0, 0, 0), **properties: Any) -> Any:
        """A new object with `data` in the scene; `properties` are set on it."""
        made = bpy.data.objects.new(name, data)
        made.location = location
        for key, value in properties.items():
            setattr(made, key, value)
        self.scene.collection.objects.link(made)
        return made

    def mesh(self, name: str, vertices: Any, faces: Any, material: Any = None, **properties: Any) -> Any:
        """A mesh object of polygons."""
        data = bpy.data.meshes.new(name)
        data.from_pydata([tuple(v) for v in vertices], [], [tuple(f) for f in faces])
        if material is not None:
            data.materials.append(material)
        return self.link(name, data, **properties)

    def plane(self, size: float = 8.0, material: Any = None, name: str = "Plane", **properties: Any) -> Any:
        """A square in the xy-plane, facing +Z."""
        h = size / 2
        return self.mesh(name, [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)], [(0, 1, 2, 3)], material, **properties)

    def box(self, size: Sequence[float] = (1, 1, 1), material: Any = None, name: str = "Box", **properties: Any) -> Any:
        """A box around its origin."""
        x, y, z = (0.5 * s for s in size)
        vertices = [(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return self.mesh(name, vertices, faces, material, **properties)

    def ball(
        self, radius: float = 1.0, material: Any = None, smooth: bool = True, rings: int = 16, **properties: Any
    ) -> Any:
        """A sphere of 2 `rings` by `rings` faces."""
        segments = 2 * rings
        phi = 2 * np.pi * np.arange(segments) / segments
        theta = np.pi * np.arange(1, rings) / rings
        x = radius * np.outer(np.sin(theta), np.cos(phi))
        y = radius * np.outer(np.sin(theta), np.sin(phi))
        z = radius * np.outer(np.cos(theta), np.ones(segments))
        vertices = [*np.stack([x, y, z], -1).reshape(-1, 3), (0, 0, radius), (0, 0, -radius)]
        top, bottom = len(vertices) - 2, len(vertices) - 1
        faces: list[tuple[int, ...]] = []
        for j in range(segments):
            k = (j + 1) % segments
            faces.append((top, j, k))
            for i in range(rings - 2):
                a, b = i * segments, (i + 1) * segments
                faces.append((a + j, b + j, b + k, a + k))
            last = (rings - 2) * segments
            faces.append((bottom, last + k, last + j))
        made = self.mesh("Ball", vertices, faces, material, **properties)
        made.data.polygons.foreach_set("use_smooth", [smooth] * len(made.data.polygons))
        return made

    def terminator(self, shown: Any, geometry: float, shading: float) -> None:
        """An object's Shadow Terminator offsets, which are Cycles' own before Blender 4.2."""
        own = hasattr(shown, "shadow_terminator_geometry_offset")
        settings, name = (shown, "shading_offset") if own else (shown.cycles, "offset")
        settings.shadow_terminator_geometry_offset = geometry
        setattr(settings, f"shadow_terminator_{name}", shading)

    def lamp(self, kind: str, energy: float, location: Sequence[float], **properties: Any) -> Any:
        """A lamp; properties of its data and of the object may be mixed."""
        data = bpy.data.lights.new(kind.title(), kind)
        data.energy = energy
        made = self.link(kind.title(), data, location)
        for key, value in properties.items():
            self.need(key)
            setattr(data if hasattr(data, key) else made, key, value)
        return made

    def area(self, energy: float = 100.0, location: Sequence[float] = (1.5, -1, 3), **properties: Any) -> Any:
        """An area lamp, looking down unless it is rotated."""
        return self.lamp("AREA", energy, location, **properties)

    def camera(self, location: Sequence[float] = (3, -6, 4), target: Sequence[float] = (0, 0, 0.4), **lens: Any) -> Any:
        """The scene's camera, looking at `target`."""
        from mathutils import Vector

        made = self.link("Camera", bpy.data.cameras.new("Camera"), location)
        made.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
        for key, value in lens.items():
            setattr(made.data, key, value)
        self.scene.camera = made
        return made

    def material(self, shader: str = "ShaderNodeBsdfDiffuse", name: str = "Material", **inputs: Any) -> Any:
        """A material of one shader node; `inputs` are sockets by name, "_" for a space, other names its properties."""
        made = bpy.data.materials.new(name)
        made.use_nodes = True
        tree = made.node_tree
        tree.nodes.clear()
        node = tree.nodes.new(shader)
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(node.outputs[0], output.inputs["Surface"])
        for key, value in inputs.items():
            self.need(key)
            socket = node.inputs.get(key.replace("_", " "))
            if socket is None:
                setattr(node, key, value)
            elif isinstance(value, tuple) and socket.type == "RGBA":
                socket.default_value = (*value, 1.0)
            else:
                socket.default_value = value
        return made

    def lit_floor(self) -> None:
        """A diffuse floor under a square lamp, and the camera."""
        self.plane(material=self.material())
        self.area(150, size=0.8)
        self.camera()

    def on_points(self, points: Any, faces: Any, instance: Callable[[Any], Any], **inputs: Any) -> None:
        """A mesh of points with what `instance` makes of its tree of geometry nodes on each; `inputs` as Scale."""
        host = self.mesh("Host", points, faces)
        tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
        for direction in ("INPUT", "OUTPUT"):
            tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
        new, link = tree.nodes.new, tree.links.new
        start, end, spread = new("NodeGroupInput"), new("NodeGroupOutput"), new("GeometryNodeInstanceOnPoints")
        link(start.outputs[0], spread.inputs["Points"])
        link(instance(tree), spread.inputs["Instance"])
        for name, value in inputs.items():
            spread.inputs[name].default_value = value
        link(spread.outputs[0], end.inputs[0])
        host.modifiers.new("Nodes", "NODES").node_group = tree

    def still_life(self) -> None:
        """An asymmetric group of boxes on a plane, coloured, under a rectangular area lamp."""
        self.plane(material=self.material(Color=(0.7, 0.7, 0.6)))
        self.box((1, 1, 2), self.material(Color=(0.8, 0.2, 0.1)), location=(-1.2, 0.5, 1))
        self.box((0.6, 1.4, 0.8), self.material(Color=(0.1, 0.3, 0.8)), location=(1.0, -0.6, 0.4))
        self.box((0.4, 0.4, 0.4), self.material(Color=(0.2, 0.7, 0.2)), location=(0.2, 1.6, 0.2))
        self.area(energy=150, shape="RECTANGLE", size=1.5, size_y=0.6, rotation_euler=(0.3, 0.4, 0.2))

    def simple_scene(self) -> None:
        """A plane, boxes, a lamp and a camera, which shlight renders quickly."""
        self.still_life()
        self.camera()
        self.scene.render.engine = "SHLIGHT"
        self.scene.shlight.pixel_samples = 1

    def world(self, color: Sequence[float] | None = None, strength: float = 1.0) -> Any:
        """A fresh world of one Background node, by default in Blender's grey; returns that node."""
        made = self.scene.world = bpy.data.worlds.new("World")
        made.use_nodes = True
        made.cycles.sampling_method, made.cycles.sample_map_resolution = "MANUAL", 256  # a larger map takes Cycles long
        node = next(node for node in made.node_tree.nodes if node.type == "BACKGROUND")
        if color is not None:
            node.inputs["Color"].default_value = (*color, 1)
        node.inputs["Strength"].default_value = strength
        return node

    def plain_world(self, color: Sequence[float]) -> None:
        """The scene's world, fresh if there is none, in one colour and without nodes."""
        if self.scene.world is None:
            self.scene.world = bpy.data.worlds.new("World")
            self.scene.world.use_nodes = False
        world = self.scene.world
        world.color = color
        if world.node_tree is not None:  # from Blender 5.0 on its colour is that of a node
            background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
            background.inputs["Color"].default_value = (*color, 1)

    def ball_in_view_of_the_world(self) -> None:
        """A diffuse ball and a mirror, with much of the world around them."""
        self.ball(material=self.material(Color=(0.8, 0.8, 0.8)), rings=32)
        mirror = self.material("ShaderNodeBsdfAnisotropic", Color=(0.9, 0.9, 0.9), Roughness=0.0)
        self.ball(radius=0.6, material=mirror, rings=32, location=(-1.8, 0, 0))
        self.camera((0.5, -4, 0.6), (0, 0, 0), angle=1.6)

    def all_around(self, width: int) -> None:
        """A camera that sees everything: +x in the middle, +y to its left, +z on top."""
        from shlight_blender.compat import panorama_settings

        lens = bpy.data.cameras.new("Panorama")
        lens.type = "PANO"
        panorama_settings(lens).panorama_type = "EQUIRECTANGULAR"
        made = self.link("Panorama", lens)
        made.rotation_euler = (np.pi / 2, 0.0, -np.pi / 2)
        self.scene.camera = made
        self.resolution(width, width // 2)

    def floors(self) -> None:
        """A diffuse floor and a glossy plate, and a camera that sees nothing else; many samples."""
        self.plane(material=self.material(Color=(0.7, 0.7, 0.6)))
        glossy = self.material("ShaderNodeBsdfAnisotropic", Color=(0.8, 0.8, 0.8), Roughness=0.3, distribution="GGX")
        self.plane(2.2, glossy, location=(0.3, -0.6, 0.05))
        self.camera(location=(1.5, -4, 3.5), target=(0.2, -0.9, 0), lens=60)
        self.resolution(32, 24)
        self.scene.cycles.samples = 1024

    # --- pictures

    def resolution(self, width: int, height: int) -> None:
        """Sets the size of the pictures."""
        self.scene.render.resolution_x, self.scene.render.resolution_y = width, height

    def picture(self, pixels: Any, *, is_float: bool = True) -> Any:
        """An image of pixels (height, width, 3), row 0 at the bottom; bytes are encoded as sRGB."""
        height, width = np.shape(pixels)[:2]
        made = bpy.data.images.new("Picture", width, height, float_buffer=is_float)
        values = np.ones((height, width, 4), dtype=np.float32)
        values[..., :3] = pixels
        made.pixels.foreach_set(values.ravel())
        made.update()
        return made

    def write(self, engine: str, seed: int = 7) -> Path:
        """Renders the picture of `engine` to a file; `seed` is Cycles'."""
        render = self.scene.render
        path = self.folder / f"{engine.lower()}.exr"
        render.engine, render.filepath = engine, str(path)
        self.scene.cycles.seed = seed
        bpy.ops.render.render(write_still=True)
        return path
