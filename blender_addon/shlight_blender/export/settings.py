# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a Blender scene: those that shlight takes over, and a report of those it does not know."""

from __future__ import annotations

from typing import Any

import bpy

from shlight import has_denoiser

from ..compat import DENOISING_LEFT_OUT, PASSES, REC709, working_space
from ..frame import frame_of
from ..names import name_of
from ..passes import CRYPTOMATTES, SHADOW_CATCHER, stores_denoising_data
from ..report import Effect, ExportReport
from .nodes import all_nodes

PASSES_WRITTEN = {"use_pass_combined", f"use_pass_{SHADOW_CATCHER}", *PASSES}
PASSES_WRITTEN |= {f"use_pass_cryptomatte_{kind}" for kind in CRYPTOMATTES}
# Says how precise another pass is, and is no pass itself.
PASS_OPTIONS = {"use_pass_cryptomatte_accurate"}
# Rays for a picture of strokes, which take some seconds.
STROKE_RAYS = 1 << 27


def filter_glossy(scene: Any) -> float:
    """Cycles' Filter Glossy."""
    return float(getattr(getattr(scene, "cycles", None), "blur_glossy", 1.0))


def render_settings(scene: Any) -> dict[str, Any]:
    """Arguments of `shlight.render`: `scene.shlight`, `scene.render`'s threads, and Cycles' filter and exposure."""
    settings = scene.shlight
    render = scene.render
    cycles = getattr(scene, "cycles", None)  # its add-on may be off
    older = int(settings.pixel_samples)
    return {
        "order": "auto" if settings.order == "AUTO" else int(settings.order),
        "tolerance": float(settings.tolerance),
        "noise_threshold": float(settings.noise_threshold),
        "min_samples": None if older else min(int(settings.min_samples), int(settings.max_samples)),
        "max_samples": None if older else int(settings.max_samples),
        "pixel_samples": older or None,
        "time_limit": float(settings.time_limit) or None,
        "pixel_filter": str(getattr(cycles, "pixel_filter_type", "BLACKMAN_HARRIS")).lower(),
        "filter_width": float(getattr(cycles, "filter_width", render.filter_size)),
        "shadow_rays": int(settings.shadow_rays) if settings.use_shadows else 0,
        "transparent_bounces": int(getattr(cycles, "transparent_max_bounces", 8)),
        "max_bounces": int(settings.max_bounces),
        "glossy_bounces": int(settings.glossy_bounces),
        "transmission_bounces": int(settings.transmission_bounces),
        "filter_glossy": filter_glossy(scene),
        "clamp_indirect": float(getattr(cycles, "sample_clamp_indirect", 10.0)),
        "darken_doubled": True,
        "exposure": float(getattr(cycles, "film_exposure", 1.0)),
        "threads": int(render.threads) if render.threads_mode == "FIXED" else 0,
    }


def viewport_settings(scene: Any) -> dict[str, Any]:
    """`render_settings` with the viewport's settings in place of those of final renders."""
    own = scene.shlight
    return render_settings(scene) | {
        "noise_threshold": float(own.preview_noise_threshold),
        "min_samples": min(int(own.preview_min_samples), int(own.preview_max_samples)),
        "max_samples": int(own.preview_max_samples),
        "pixel_samples": None,
        "time_limit": float(own.preview_time_limit) or None,
        "max_bounces": int(own.preview_max_bounces),
    }


def preview_settings(scene: Any) -> dict[str, Any]:
    """Settings of a small picture in a panel, which must appear at once."""
    return render_settings(scene) | {
        "tolerance": 0.01,
        "noise_threshold": 0.1,
        "min_samples": 1,
        "max_samples": 16,
        "pixel_samples": None,
        "time_limit": 0.15,
        "threads": 0,  # Blender asks for one
    }


def stroke_settings(scene: Any) -> dict[str, Any]:
    """Settings of Freestyle's strokes, which shine evenly: samples are for their edges, and black ones show no noise by
    which more could be asked for."""
    frame = frame_of(scene.render)
    samples = min(max(STROKE_RAYS // (frame.width * frame.height), 32), 256)
    own = {"min_samples": samples, "max_samples": samples, "pixel_samples": None, "time_limit": None}
    return render_settings(scene) | own | {"max_bounces": 0}


def report_unsupported_settings(scene: Any, view_layer: Any, report: ExportReport) -> None:
    """Notes settings of the scene and its view layer that change Cycles' picture and not shlight's."""
    place = f"Scene '{name_of(scene)}'"
    render = scene.render
    if (scene.shlight.use_denoising or scene.shlight.preview_use_denoising) and not has_denoiser():
        report.add(place, "this Blender comes without Open Image Denoise; noise stays", Effect.SLIGHT)
    if render.use_motion_blur and getattr(getattr(scene, "cycles", None), "rolling_shutter_type", "NONE") != "NONE":
        report.add(place, "a rolling shutter is not supported; all of the picture is taken at the same times")
    cycles = getattr(scene, "cycles", None)
    if render.use_simplify and getattr(cycles, "texture_resolution_render", 1.0) < 1.0 and bpy.data.images:
        report.add(place, "Simplify's Texture Resolution is not supported; textures keep their size", Effect.SLIGHT)
    kinds = [kind for kind in ("Reflective", "Refractive") if not getattr(cycles, f"caustics_{kind.lower()}", True)]
    if kinds and scene.shlight.max_bounces > 0:
        report.add(place, f"{' and '.join(kinds)} Caustics are off, which is not supported; they are drawn")
    limit = getattr(cycles, "texture_limit_render", "OFF")
    if render.use_simplify and limit != "OFF" and any(max(image.size) > int(limit) for image in bpy.data.images):
        report.add(place, "Simplify's Texture Limit is not supported; textures keep their size", Effect.SLIGHT)
    if working_space() != REC709:
        report.add(place, f"working space {working_space()} is not supported; skies and pictures stay Rec. 709")
    tree = getattr(scene.world, "node_tree", None)
    if tree is not None and any(node.type == "OUTPUT_AOV" for node in all_nodes(tree)):
        report.add(f"World '{name_of(scene.world)}'", "AOVs of worlds are not supported; left out", Effect.SLIGHT)
    place = f"View layer '{name_of(view_layer)}'"
    passes = ", ".join(_passes_not_written(view_layer))
    if passes:
        report.add(place, f"passes that are not supported: {passes}", Effect.SLIGHT)


def _passes_not_written(view_layer: Any) -> list[str]:
    flags = sorted(
        name
        for owner in (view_layer, getattr(view_layer, "cycles", None))
        for name in dir(owner)
        if name.startswith("use_pass_") and getattr(owner, name)
    )
    passes = [flag.removeprefix("use_pass_") for flag in flags if flag not in PASSES_WRITTEN | PASS_OPTIONS]
    return passes + list(DENOISING_LEFT_OUT if stores_denoising_data(view_layer) else ())


def world_of(scene: Any, view_layer: Any) -> Any:
    """The world of a view layer, which may override the scene's or have none."""
    world = getattr(view_layer, "world_override", None) or scene.world
    return world if view_layer.use_sky else None
