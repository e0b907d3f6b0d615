# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in which the supported Blender versions differ: 3.4 on one side, 4.2 and later on the other.

The differences are in constants and in functions on meshes and results, which ask for the attribute they need instead
of the version, so that no other module knows a version number.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import bpy
import numpy as np
from numpy.typing import NDArray

from .names import name_of

VERSION: tuple[int, int, int] = bpy.app.version
IS_BLENDER_4 = VERSION >= (4, 0, 0)
# Whether Cycles' adaptive subdivision gives smooth meshes another shape and other normals, as before Blender 4.5.
DICES_OTHERWISE = VERSION < (4, 5, 0)


class Lamps:
    """How Cycles turns a lamp's power S [W] into emitted radiance."""

    area = 1.0 / math.pi if IS_BLENDER_4 else 0.25  # rectangle of area A: radiance = area * S / A
    point_is_always_disk = not IS_BLENDER_4  # a point lamp is the disk that faces the shading point, whatever is set
    spot_is_scaled = IS_BLENDER_4  # a scaled spot lamp has an elliptical cone
    spot_times_cosine = not IS_BLENDER_4  # a spot lamp's light falls with the cosine of the angle to its axis too
    sun_is_tangent = not IS_BLENDER_4  # a sun is even on the plane tangent to the sphere of directions, not on that
    area_has_uvs = IS_BLENDER_4  # textures of an area lamp find coordinates on it by default, as if it had a UV map
    instancer_hides = VERSION >= (4, 5, 0)  # what hides the object that shows a lamp's instance hides the lamp


class Noise:
    """How Cycles' noise differs between versions."""

    repeats = IS_BLENDER_4  # after 100 000 cells, where floats begin to lack fractions
    roughness_is_clamped = VERSION < (4, 1, 0)  # to 0 … 1, of nodes other than Musgrave Texture


# An orthographic camera's lens lies in the near clip plane, or where the camera is.
LENS_IS_AT_NEAR_PLANE = not IS_BLENDER_4


def panorama_settings(lens: Any) -> Any:
    """The owner of a camera's panorama settings. AttributeError if that is Cycles and its add-on is off."""
    return lens if IS_BLENDER_4 else lens.cycles


def has_panorama_settings(lens: Any) -> bool:
    """Whether the owner of a camera's panorama settings is there."""
    return IS_BLENDER_4 or hasattr(lens, "cycles")


# The Principled BSDF has a specular layer over the diffuse base, or is a plain sum of both.
PRINCIPLED_IS_LAYERED = IS_BLENDER_4
# Cycles' thin films by name of `nodes.principled`.
THIN_FILM_MODEL: Literal["spectral", "gaussians"] = "spectral" if VERSION >= (5, 0, 0) else "gaussians"
# Fresnel's curve of metals by name of `nodes.conductor`.
FRESNEL_MODEL: Literal["exact", "large_index"] = "exact" if VERSION >= (5, 0, 0) else "large_index"
# The colour of a Glossy BSDF dims what its microfacets reflect of each other once more.
BOUNCES_ARE_DIMMED = not IS_BLENDER_4
# Rough diffuse surfaces return the light that the first bounce loses.
DIFFUSE_KEEPS_ENERGY = VERSION >= (4, 3, 0)
# How much of it, by name of `nodes.oren_nayar`.
DIFFUSE_MODEL: Literal["dimmed", "openpbr"] = "openpbr" if VERSION >= (5, 3, 0) else "dimmed"
# Diffuse normals, too, are turned until the mirror image of the viewer is above the surface.
TURNS_DIFFUSE_NORMALS = not IS_BLENDER_4
# The shadow that bumps throw on themselves by name of `Shader.with_bump_shadow`.
BUMP_SHADOW: Literal["ggx", "cubic"] = "ggx" if VERSION >= (4, 5, 0) else "cubic"
_SubsurfaceMethod = Literal["burley", "random_walk", "random_walk_skin", "random_walk_van_de_hulst"]
# Methods of subsurface scattering by Blender's names, of which "Random Walk" is another one in each.
SUBSURFACE_METHODS: dict[str, _SubsurfaceMethod] = {"BURLEY": "burley"}
if not IS_BLENDER_4:
    SUBSURFACE_METHODS |= {"RANDOM_WALK_FIXED_RADIUS": "random_walk", "RANDOM_WALK": "random_walk_skin"}
elif VERSION < (5, 2, 0):
    SUBSURFACE_METHODS |= {"RANDOM_WALK": "random_walk", "RANDOM_WALK_SKIN": "random_walk_skin"}
else:
    SUBSURFACE_METHODS |= {"RANDOM_WALK": "random_walk_van_de_hulst", "RANDOM_WALK_SKIN": "random_walk_skin"}
    SUBSURFACE_METHODS |= {"RANDOM_WALK_LEGACY": "random_walk"}
# The least mean cosine of a direction that is scattered below a surface.
LEAST_ANISOTROPY = -0.99 if VERSION >= (5, 2, 0) else 0.0
# Light enters bodies from all sides, or is bent by their surface.
SUBSURFACE_ENTRY_IS_DIFFUSE = not IS_BLENDER_4
# The definition of a Voronoi Texture, as `nodes.voronoi` numbers them.
CELLS = 3 if not IS_BLENDER_4 else 4 if VERSION < (5, 0, 0) else 5
# A Magic Texture brings coordinates into one turn after it has scaled them, or before.
MAGIC_WRAPS_SCALED = VERSION >= (5, 2, 0)
# Tangents of a mesh without a UV map go across the seam of its angles, or turn back there.
ANGLES_TURN = VERSION >= (5, 0, 0)
# The normal of a tangent space has length 1, or that of what is interpolated between the normals of corners.
TANGENT_SPACE_IS_UNIT = VERSION >= (5, 1, 0)
# A missing picture is one of a pixel: it fades towards its edges where the texture is clipped there, and is black in a
# colour space that Cycles converts.
MISSING_PICTURE_IS_PIXEL = VERSION < (5, 2, 0)
# An IES Texture interpolates at the edges of its table with the values there beyond them, or with 0.
IES_KEEPS_EDGES = VERSION >= (5, 0, 1)
# Faces without material have a Principled BSDF as a new node is, or a Diffuse BSDF of albedo 0.8.
DEFAULT_IS_PRINCIPLED = VERSION >= (5, 0, 0)
# An object's own empty slot is without material, or has that of the object's data.
EMPTY_SLOT_IS_DEFAULT = VERSION >= (5, 2, 0)


def slot_materials(evaluated: Any) -> tuple[Any, ...]:
    """The materials that Cycles draws for the slots of an evaluated object; None: the default surface."""
    materials = [slot.material for slot in evaluated.material_slots]
    if EMPTY_SLOT_IS_DEFAULT:
        # The evaluated slots show the materials of the object's data there.
        for number, slot in enumerate(evaluated.original.material_slots[: len(materials)]):
            if slot.link == "OBJECT" and slot.material is None:
                materials[number] = None
    return tuple(materials)


def sky_aerosols(node: Any) -> float:
    """The density of aerosols in a Sky Texture, which is called dust before Blender 5.0."""
    return float(node.aerosol_density if hasattr(node, "aerosol_density") else node.dust_density)


_LONG_PASS_NAMES = VERSION >= (5, 0, 0)


def _pass_name(long: str, short: str) -> str:
    return long if _LONG_PASS_NAMES else short


# For each switch of a view layer: the name of its pass, its channels, their kind, and its name in `shlight.render`.
PASSES: dict[str, tuple[str, str, str, str]] = {
    "use_pass_z": ("Depth", "Z", "VALUE", "depth"),
    "use_pass_mist": ("Mist", "Z", "VALUE", "mist"),
    "use_pass_position": ("Position", "XYZ", "VECTOR", "position"),
    "use_pass_normal": ("Normal", "XYZ", "VECTOR", "normal"),
    "use_pass_uv": ("UV", "UVA", "VECTOR", "uv"),
    "use_pass_object_index": (_pass_name("Object Index", "IndexOB"), "X", "VALUE", "object_index"),
    "use_pass_material_index": (_pass_name("Material Index", "IndexMA"), "X", "VALUE", "material_index"),
    **{
        f"use_pass_{light}_{part}": (
            _pass_name(f"{light} {part}".title(), short + short_part),
            "RGB",
            "COLOR",
            f"{light}_{part}",
        )
        for light, short in {"diffuse": "Diff", "glossy": "Gloss", "transmission": "Trans"}.items()
        for part, short_part in {"direct": "Dir", "indirect": "Ind", "color": "Col"}.items()
    },
    "use_pass_emit": (_pass_name("Emission", "Emit"), "RGB", "COLOR", "emission"),
    "use_pass_environment": (_pass_name("Environment", "Env"), "RGB", "COLOR", "environment"),
}

# Passes that Cycles adds to its denoising data, and shlight does not have.
DENOISING_LEFT_OUT = ("Denoising Specular Albedo", "Denoising Roughness") if VERSION >= (5, 2, 0) else ()


def aov_name(node: Any) -> str:
    """The pass that an AOV Output node writes."""
    return name_of(node, "aov_name" if "aov_name" in node.bl_rna.properties else "name")


REC709 = "Linear Rec.709"


def lets_light_through(material: Any) -> bool:
    """Whether shadow rays pass a material where it is transparent; otherwise only camera rays do."""
    return bool(getattr(material_owner(material, "use_transparent_shadow"), "use_transparent_shadow", True))


def material_owner(material: Any, name: str) -> Any:
    """The material or its settings of Cycles, whichever has a setting; None if neither has it."""
    owners = (material, getattr(material, "cycles", None))
    return next((owner for owner in owners if hasattr(owner, name)), None)


def corrects_bumps(material: Any) -> bool:
    """Whether Cycles softens the shadows of a material's bumps."""
    owner = material_owner(material, "use_bump_map_correction")
    return owner is None or bool(owner.use_bump_map_correction)


def has_own_terminator(shown: Any) -> bool:
    """Whether an object has Shadow Terminator offsets that are not Cycles' own."""
    return hasattr(shown, "shadow_terminator_geometry_offset")


def terminator_offsets(shown: Any) -> tuple[float, float]:
    """An object's Shadow Terminator offsets, Geometry and Shading.

    Cycles reads the object's own where it has them (since Blender 4.2), else its add-on's; 0.1 and 0 by default.
    """
    if has_own_terminator(shown):
        return shown.shadow_terminator_geometry_offset, shown.shadow_terminator_shading_offset
    own = getattr(shown, "cycles", None)
    return getattr(own, "shadow_terminator_geometry_offset", 0.1), getattr(own, "shadow_terminator_offset", 0.0)


def working_space() -> str:
    """The file's working colour space; since Blender 5.0 it may be another one than Rec. 709."""
    colors = getattr(bpy.data, "colorspace", None)
    return REC709 if colors is None else str(colors.working_space)


def lamp_tint(lamp: Any) -> NDArray[np.float64]:
    """RGB factor on a lamp's power: its colour and, where Blender has them (4.5), temperature and exposure."""
    tint = np.array(lamp.color, dtype=np.float64)
    if getattr(lamp, "use_temperature", False):
        tint *= np.array(lamp.temperature_color, dtype=np.float64)
    return tint * 2.0 ** float(getattr(lamp, "exposure", 0.0))


def lamp_is_normalized(lamp: Any) -> bool:
    """True: the power is spread over the lamp's surface; False (4.5 only): it is the power of a unit surface."""
    return bool(getattr(lamp, "normalize", True))


def shadow_switch(lamp: Any) -> tuple[Any, str] | None:
    """The owner of the switch for a lamp's shadows, and the switch's name.

    It is Cycles' own in 3.4, None without its add-on, and Blender's in 4.2 and later; EEVEE alone reads that in 3.4.
    """
    if IS_BLENDER_4:
        return lamp, "use_shadow"
    settings = getattr(lamp, "cycles", None)
    return None if settings is None else (settings, "cast_shadow")


def lamp_casts_shadows(lamp: Any) -> bool:
    """True unless the lamp's shadows are switched off."""
    switch = shadow_switch(lamp)
    return switch is None or bool(getattr(*switch))


def point_is_disk(lamp: Any) -> bool:
    """True if a point lamp shades as the disk that faces the shading point, False for the sphere itself."""
    return Lamps.point_is_always_disk or bool(getattr(lamp, "use_soft_falloff", False))


@dataclass(frozen=True)
class Triangles:
    """A mesh's vertices (n, 3), and corners (m, 3), corner vertices (m, 3), polygon and material of its triangles."""

    vertices: NDArray[np.float32]
    corners: NDArray[np.int32]
    corner_vertices: NDArray[np.int32]
    polygons: NDArray[np.int32]
    materials: NDArray[np.int32]


def mesh_triangles(mesh: Any) -> Triangles:
    """The triangles of an evaluated mesh.

    Attributes, and the corners of triangles as the unsigned numbers that they are, are handed over at once, other
    values one by one, which takes some 0.2 s for a million of them. Only the first are asked for where both are there,
    which is since Blender 4.1.
    """
    mesh.calc_loop_triangles()
    corners = values_of(mesh.loop_triangles, "loops", np.uint32, 3).view(np.int32)
    position, corner_vertex = mesh.attributes.get("position"), mesh.attributes.get(".corner_vert")
    if position is None or corner_vertex is None or not hasattr(mesh, "loop_triangle_polygons"):
        vertices = values_of(mesh.vertices, "co", np.float32, 3)
        vertex_of_corner = values_of(mesh.loops, "vertex_index", np.int32)
        polygons = values_of(mesh.loop_triangles, "polygon_index", np.int32)
        materials = values_of(mesh.polygons, "material_index", np.int32)
    else:
        vertices = values_of(position.data, "vector", np.float32, 3)
        vertex_of_corner = values_of(corner_vertex.data, "value", np.int32)
        polygons = values_of(mesh.loop_triangle_polygons, "value", np.int32)
        own = mesh.attributes.get("material_index")  # missing where all are the first
        materials = np.zeros(len(mesh.polygons), np.int32) if own is None else values_of(own.data, "value", np.int32)
    return Triangles(vertices, corners, vertex_of_corner[corners], polygons, materials[polygons])


def values_of(collection: Any, name: str, dtype: Any, size: int = 1) -> NDArray[Any]:
    """A property of all items of a collection: (n,), or (n, size) of vectors."""
    values = np.empty(len(collection) * size, dtype=dtype)
    collection.foreach_get(name, values)
    return values.reshape(-1, size) if size > 1 else values


def pixels_of(image: Any) -> NDArray[np.float32]:
    """Pixels of an image as Blender keeps them (height, width, channels), row 0 on top."""
    width, height = image.size
    values = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, -1)[::-1] if len(values) else np.empty((height, width, 0), np.float32)


def uv_coordinates(layer: Any) -> NDArray[np.float32]:
    """Coordinates (corners, 2) of a UV map, handed over at once where they are an attribute's, which is since 3.5."""
    if hasattr(layer, "uv"):
        return values_of(layer.uv, "vector", np.float32, 2)
    return values_of(layer.data, "uv", np.float32, 2)


def smooth_vertex_normals(mesh: Any) -> NDArray[np.float32] | None:
    """Normals of all vertices (vertices, 3) where those are the normals of all corners; None if that is not known."""
    if getattr(mesh, "normals_domain", "") != "POINT":
        return None
    return values_of(mesh.vertex_normals, "vector", np.float32, 3)


def smooth_corner_normals(mesh: Any) -> NDArray[np.float32] | None:
    """Normals of all corners (loops, 3) with smooth and custom shading applied; None if every face is flat."""
    if hasattr(mesh, "corner_normals"):
        return None if mesh.normals_domain == "FACE" else values_of(mesh.corner_normals, "vector", np.float32, 3)
    if not values_of(mesh.polygons, "use_smooth", bool).any() and not mesh.has_custom_normals:
        return None
    mesh.calc_normals_split()
    return values_of(mesh.loops, "normal", np.float32, 3)


def keeps_a_normal_per_vertex(mesh: Any) -> bool:
    """Whether Cycles has one normal for all corners of a vertex that no sharp edge splits, where they differ.

    Known of versions from 4.1, which has normals_domain, to 4.5.
    """
    return VERSION < (5, 0, 0) and getattr(mesh, "normals_domain", "") == "CORNER"


# Displaced meshes whose normals differ at a vertex keep their vertices and corners their own normals, to which what
# displacement changes at the vertex is added; before, vertices are split, see splits_vertices.
DISPLACED_KEEP_CORNERS = VERSION >= (5, 1, 0)
# The bump of a displacement bends the normal of the displaced mesh, or that from before; on flat faces, too, that was
# the one of the vertices at first.
BENDS_OLD_NORMAL = VERSION >= (5, 0, 0)
BENDS_VERTEX_NORMAL = (5, 0, 0) <= VERSION < (5, 1, 0)
# The bump of a displacement compares heights as far beside the hit as the place before displacement moves in the mean,
# or as far as the displaced place moves.
COMPARES_AT_MEAN_STEPS = VERSION < (5, 0, 0)
# The distance, in pixels, over which the bump of a displacement compares heights.
DISPLACEMENT_FILTER_WIDTH = 0.1 if VERSION >= (4, 4, 0) else 1.0


def filter_width(bump: Any) -> float:
    """The same of a Bump node, whose input for it older versions lack."""
    given = bump.inputs.get("Filter Width")
    return 1.0 if given is None else min(max(given.default_value, 1e-3), 1e3)


def splits_vertices(mesh: Any) -> str:
    """How Cycles splits a mesh: along its sharp "edges" and around flat faces, wherever "normals" differ, or ""."""
    if hasattr(mesh, "use_auto_smooth"):
        return "normals" if mesh.use_auto_smooth else ""
    return "edges" if mesh.normals_domain == "CORNER" and not DISPLACED_KEEP_CORNERS else ""


def displacement_method(material: Any) -> str:
    """Whether displacement bends normals ("BUMP"), moves vertices ("DISPLACEMENT") or does "BOTH".

    Before Blender 4.1 the setting is that of Cycles' add-on.
    """
    return str(getattr(material_owner(material, "displacement_method"), "displacement_method", "BUMP"))


class Dicing(NamedTuple):
    """How Cycles divides a mesh by what the camera sees of it, see export/dicing.py."""

    length: float  # of the edges that are wanted: in pixels, or in the frame of the object
    in_pixels: bool
    curved: bool  # to the limit of Catmull and Clark's subdivision
    levels: int  # how often edges are halved at most
    offscreen: float  # how many times as long edges are at a picture's half-diagonal beside it, or thereabouts


def is_preview(depsgraph: Any) -> bool:
    """Whether a depsgraph has the settings of viewports, not those of renders."""
    return bool(depsgraph.mode == "VIEWPORT")


def dicing_settings(depsgraph: Any) -> tuple[float, int, float, bool]:
    """Cycles' settings of all dicing: length, levels, length beside the picture, whether features are experimental."""
    cycles = getattr(depsgraph.scene_eval, "cycles", None)  # its add-on may be off
    rate = "preview_dicing_rate" if is_preview(depsgraph) else "dicing_rate"
    return (
        getattr(cycles, rate, 1.0),
        getattr(cycles, "max_subdivisions", 12),
        getattr(cycles, "offscreen_dicing_scale", 4.0),
        getattr(cycles, "feature_set", "") == "EXPERIMENTAL",
    )


def dicing_of(shown: Any, depsgraph: Any) -> Dicing | None:
    """The adaptive subdivision of an object, None without.

    The switch is the last modifier's, or before Blender 5.0 the object's, and read with experimental features alone.
    """
    own = shown.original  # the evaluated one does not follow its switch
    last = own.modifiers[-1] if len(own.modifiers) else None
    if last is None or last.type != "SUBSURF":
        return None
    rate, levels, offscreen, is_experimental = dicing_settings(depsgraph)
    owner: Any = last if hasattr(last, "use_adaptive_subdivision") else is_experimental and getattr(own, "cycles", None)
    curved = last.subdivision_type == "CATMULL_CLARK"
    is_shown = last.show_viewport if is_preview(depsgraph) else last.show_render
    if not is_shown or not getattr(owner, "use_adaptive_subdivision", False):
        return None
    if getattr(owner, "adaptive_space", "PIXEL") == "OBJECT":
        return Dicing(owner.adaptive_object_edge_length * rate, False, curved, levels, offscreen)
    pixels = owner.adaptive_pixel_size if owner == last else owner.dicing_rate
    return Dicing(max(pixels * rate, 0.1), True, curved, levels, offscreen)


def cage_of(shown: Any) -> Any:
    """The object with the mesh that its only modifier subdivides; where others are before that, what they all make."""
    own = shown.original
    is_plain = own.type == "MESH" and own.mode == "OBJECT" and own.data.shape_keys is None
    return own if is_plain and len(own.modifiers) == 1 else shown


def write_pass(render_pass: Any, pixels: NDArray[np.float32]) -> None:
    """Copies (height * width, channels) float32 pixels, bottom row first, into a render pass."""
    pixels = np.ascontiguousarray(pixels, dtype=np.float32)
    render_pass.rect.foreach_set(pixels.ravel() if IS_BLENDER_4 else pixels)


def choose_layers(settings: Any) -> None:
    """Image settings of an OpenEXR file with a layer for each pass, in floats."""
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"


def set_sample_range(cycles: Any, first: int, count: int, of: int) -> None:
    """The next render of Cycles takes `count` samples from number `first` on of a sequence laid out for `of`.

    Before Blender 4.5 the sequence is laid out for `count`: ranges of one sequence then are merely independent.
    """
    cycles.sample_offset = first
    if hasattr(cycles, "use_sample_subset"):
        cycles.use_sample_subset = True
        cycles.samples, cycles.sample_subset_length = of, count
    else:
        cycles.samples = count


# Radii of hair curves and point clouds that have none of their own.
DEFAULT_RADII = {"CURVES": 0.005, "POINTCLOUD": 0.01} if IS_BLENDER_4 else {"CURVES": 0.0, "POINTCLOUD": 0.0}


def shutter_position(scene: Any) -> str:
    """Whether the frame is the START, CENTER or END of the time for which the shutter is open; Cycles' before 4.2."""
    return str(getattr(position_owner(scene), "motion_blur_position", "CENTER"))


def position_owner(scene: Any) -> Any:
    """The owner of that setting; None: Cycles' add-on is off."""
    return scene.render if hasattr(scene.render, "motion_blur_position") else getattr(scene, "cycles", None)


def curve_settings(scene: Any) -> dict[str, Any]:
    """The arguments of `shlight.Scene.add_curves` that Cycles' settings of curves give."""
    own = getattr(scene, "cycles_curves", None)  # its add-on may be off
    levels = getattr(own, "subdivisions", 2)
    return {"ribbons": getattr(own, "shape", "RIBBONS") == "RIBBONS", "subdivisions": min(1 << min(levels, 4), 15) + 1}


# Options of a property with a path that may begin with "//", the folder of the file.
RELATIVE_PATH = {"PATH_SUPPORTS_BLEND_RELATIVE"} if VERSION >= (4, 5, 0) else set()

FLAT_SHADER = "UNIFORM_COLOR" if IS_BLENDER_4 else "2D_UNIFORM_COLOR"  # of module gpu


def draw_progress(layout: Any, text: str, share: float) -> None:
    """A bar with text, or where Blender has no bars (before 4.0) the share in percent."""
    if hasattr(layout, "progress"):
        layout.progress(text=text, factor=share)
    else:
        layout.label(text=f"{text}, {share:.0%}" if share > 0 else text)


def has_node_switch(owner: Any) -> bool:
    """True if `use_nodes` of a material, world or lamp is read.

    Nothing reads it once Blender has declared it obsolete: of materials and worlds in 5.0, of lamps later.
    """
    switch = owner.bl_rna.properties.get("use_nodes")
    return switch is not None and not getattr(switch, "is_deprecated", False)


def uses_nodes(owner: Any) -> bool:
    """True if a material, world or lamp is defined by its node tree."""
    return owner.node_tree is not None and (not has_node_switch(owner) or bool(owner.use_nodes))


def compositing_nodes(scene: Any) -> Any:
    """The node tree that the compositor runs, None without one; it is a group of its own since Blender 5.0."""
    if hasattr(scene, "compositing_node_group"):
        return scene.compositing_node_group
    return scene.node_tree if scene.use_nodes else None


def nodes_by_engine() -> Iterator[Any]:
    """Items of the Shader editor's Add menu that are shown under a condition.

    The menu is made of items in 3.4 alone, where most conditions name Blender's own engines.
    """
    menu = sys.modules.get("nodeitems_builtins")
    for category in getattr(menu, "shader_node_categories", ()):
        yield from (item for item in category.items(None) if item.poll is not None)
