# SPDX-License-Identifier: MIT
"""Every property of Blender and of Cycles that the exporter reads has a control while shlight is the engine."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy

import shlight_blender
from shlight_blender import compat
from shlight_blender.ui import data, panels

SOURCE = Path(shlight_blender.__file__).parent
READERS = ("export/*.py", "compat.py", "passes.py", "frame.py", "motion_blur.py", "catchers.py")
# The sources have these names for other things, such as shlight's own settings.
OF_OTHERS = {"name", "use_nodes", "angle", "time_limit", "use_denoising"}
OF_OTHERS |= {"max_bounces", "glossy_bounces", "transmission_bounces"}
# The sources have these for other things too, or their controls stand in no panel of the Properties editor.
NO_CONTROL = {
    "RenderSettings": {"use_freestyle", "filter_size", "border_min_x", "border_min_y", "border_max_x", "border_max_y"},
    "Object": {"dimensions", "matrix_world"},
    "Camera": {"sensor_height"},  # shown for another sensor fit
    "CameraDOFSettings": {"focus_subtarget"},  # shown for armatures
    "WorldMistSettings": {"intensity", "height"},
    "Material": {"alpha_threshold", "metallic"},
    "ViewLayer": {"use_freestyle", "use_pass_cryptomatte_accurate", "use_pass_combined", "samples"},
    "CyclesWorldSettings": {"use_shadows"},
    "CyclesRenderSettings": {
        "rolling_shutter_type",
        "shading_system",  # read to name them, and of scripts
        "samples",
        "seed",
        "sample_offset",
        "sample_subset_length",
        "use_sample_subset",  # of comparisons
        "caustics_reflective",
        "caustics_refractive",  # read to name them
    },
    # Blender's modifier panel shows it; the second is an older name of what an own panel shows.
    "CyclesObjectSettings": {
        "use_adaptive_subdivision",
        "dicing_rate",
        "shadow_terminator_offset",
        "shadow_terminator_geometry_offset",
    },
}


Property = tuple[str, str]  # its owner's type, and its name


def kind_of(owner: Any) -> str:
    """The type of an owner of properties; all lamps are of one."""
    rna = owner.bl_rna
    return str((rna.base if rna.base is not None and rna.base.identifier == "Light" else rna).identifier)


class Notes:
    """A layout that notes which properties it shows, and takes everything else."""

    def __init__(self) -> None:
        self.shown: set[Property] = set()

    def prop(self, owner: Any, name: str, *_: Any, **__: Any) -> None:
        self.shown.add((kind_of(owner), name))

    prop_search = prop

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: self


def contexts(studio: Any) -> Iterator[SimpleNamespace]:
    """A context of the Properties editor for each object, and for each type of lamps and cameras."""
    kinds = {"LIGHT": ("POINT", "SUN", "SPOT", "AREA"), "CAMERA": ("PERSP", "ORTHO", "PANO", *data.PANORAMAS)}
    material = bpy.data.materials[0]
    for shown in bpy.data.objects:
        for kind in kinds.get(shown.type, ("",)):
            if kind in data.PANORAMAS:
                with suppress(TypeError):  # this version of Blender has no such type
                    compat.panorama_settings(shown.data).panorama_type = kind
            elif kind:
                shown.data.type = kind
            owner = {"LIGHT": "light", "CAMERA": "camera", "MESH": "mesh"}[shown.type]
            own = dict.fromkeys(("light", "camera", "mesh", "curve", "curves", "texture"), None) | {owner: shown.data}
            space = SimpleNamespace(pin_id=None, use_pin_id=False, type="PROPERTIES", context="MATERIAL")
            yield SimpleNamespace(
                engine="SHLIGHT", scene=studio.scene, view_layer=bpy.context.view_layer, world=studio.scene.world,
                object=shown, active_object=shown, material=material, material_slot=None, space_data=space,
                preferences=bpy.context.preferences, region=SimpleNamespace(width=500), blend_data=bpy.data,
                window_manager=bpy.context.window_manager, window=None, area=None, **own,
            )  # fmt: skip


def drawn(panel: Any, context: SimpleNamespace) -> set[Property]:
    """The properties that a panel shows; many of Blender's ask for more than such a context has, and show none."""
    notes = Notes()
    own = {name: getattr(panel, name) for name in dir(panel) if not name.startswith("__") and name != "layout"}
    for draw in ("draw_header", "draw"):
        with suppress(Exception):
            getattr(panel, draw)(SimpleNamespace(**own, layout=notes), context)
    return notes.shown


def shown_properties(studio: Any) -> set[Property]:
    found: set[Property] = set()
    for context in contexts(studio):
        for panel in panels._panels():
            if "SHLIGHT" in getattr(panel, "COMPAT_ENGINES", {"SHLIGHT"}) and panel.bl_space_type == "PROPERTIES":
                with suppress(AttributeError, TypeError):
                    if not hasattr(panel, "poll") or panel.poll(context):
                        found |= drawn(panel, context)
    return found


def read_names() -> set[str]:
    """The names of attributes, and the strings that may be some, of the modules that read scenes."""
    nodes = [
        node for pattern in READERS for path in SOURCE.glob(pattern) for node in ast.walk(ast.parse(path.read_text()))
    ]
    strings = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    return strings | {node.attr for node in nodes if isinstance(node, ast.Attribute)}


def owners(studio: Any) -> Iterator[Any]:
    """Something of each type whose properties are looked for."""
    scene, thing, camera = studio.scene, bpy.data.objects["Box"], studio.scene.camera.data
    own = [scene, scene.render, thing, camera, camera.dof, scene.world, scene.world.mist_settings]
    own += [bpy.data.lights[0], bpy.data.materials[0], bpy.context.view_layer]
    yield from own
    yield from (each.cycles for each in own if hasattr(each, "cycles"))


def test_panels_of_cycles_that_have_shlights_settings_are_hidden(studio: Any) -> None:
    """Most of them share one set of engines."""
    assert "SHLIGHT" not in bpy.types.CYCLES_RENDER_PT_sampling.COMPAT_ENGINES
    assert "SHLIGHT" in bpy.types.CYCLES_RENDER_PT_filter.COMPAT_ENGINES


def test_properties_that_are_read_have_a_control(studio: Any) -> None:
    studio.simple_scene()
    studio.world((0.1, 0.1, 0.1))
    studio.scene.render.engine, studio.scene.cycles.pixel_filter_type = "SHLIGHT", "GAUSSIAN"
    names, shown = read_names(), shown_properties(studio)
    missing: dict[str, set[str]] = {}
    for owner in owners(studio):
        kind = kind_of(owner)
        read = {
            each.identifier
            for each in owner.bl_rna.properties
            if each.identifier in names - OF_OTHERS
            and not each.is_readonly
            and each.type not in {"POINTER", "COLLECTION"}
        }
        missing[kind] = {name for name in read if (kind, name) not in shown} - NO_CONTROL.get(kind, set())
    missing = {kind: names for kind, names in missing.items() if names}
    assert missing == {}, str(missing)
