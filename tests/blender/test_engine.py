# SPDX-License-Identifier: MIT
"""The engine inside Blender: results, errors, cancelling, settings, panels, registering and leaving."""

from __future__ import annotations

import importlib
import itertools
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import OpenImageIO as oiio
import pytest

import shlight
import shlight_blender
from shlight.images import read_exr
from shlight.metrics import rel_mse
from shlight_blender import compat, record
from shlight_blender.engine import ShlightRenderEngine


def test_an_error_is_reported_and_nothing_is_saved(studio: Any) -> None:
    studio.simple_scene()
    studio.scene.camera.scale = (1, 0, 1)
    studio.scene.render.filepath = str(studio.folder / "dark.exr")
    with pytest.raises(RuntimeError, match="scale 0"):
        bpy.ops.render.render(write_still=True)
    assert not (studio.folder / "dark.exr").exists()


def test_an_animation_goes_on_after_a_dark_frame(studio: Any) -> None:
    studio.simple_scene()
    lamp = bpy.data.objects["Area"].data
    for frame, energy in ((1, 0.0), (2, 150.0)):
        lamp.energy = energy
        lamp.keyframe_insert("energy", frame=frame)
    render = studio.scene.render
    studio.scene.frame_start, studio.scene.frame_end = 1, 2
    render.film_transparent = True
    render.filepath = str(studio.folder / "frame_")
    bpy.ops.render.render(animation=True)
    dark, lit = (read_exr(studio.folder / f"frame_{frame:04}.exr") for frame in (1, 2))
    assert not dark[..., :3].any()
    assert lit[..., :3].any()
    assert 0.0 < dark[..., 3].mean() < 1.0
    np.testing.assert_array_equal(dark[..., 3], lit[..., 3])


def test_unexpected_exceptions_are_reported(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*args: Any, **named: Any) -> None:
        raise MemoryError("no room")

    studio.simple_scene()
    monkeypatch.setattr(shlight, "render", fails)
    with pytest.raises(RuntimeError, match="MemoryError: no room"):
        studio.render("SHLIGHT")


@pytest.mark.parametrize("goes_on", [True, False])
def test_progress_goes_from_0_to_1_and_cancelling_leaves_an_empty_picture(
    studio: Any, monkeypatch: pytest.MonkeyPatch, goes_on: bool
) -> None:
    studio.simple_scene()
    studio.scene.shlight.pixel_samples = 64 if goes_on else 4096
    seen: list[float] = []
    original = ShlightRenderEngine._progress

    def progress(self: Any, fraction: float) -> bool:
        seen.append(fraction)
        return original(self, fraction) and goes_on

    monkeypatch.setattr(ShlightRenderEngine, "_progress", progress)
    assert studio.render("SHLIGHT").any() == goes_on
    assert seen
    assert seen == sorted(seen)
    assert 0.0 <= seen[0] <= seen[-1] <= 1.0


def test_every_view_layer_gets_its_own_picture(studio: Any) -> None:
    studio.simple_scene()
    scene = studio.scene
    other = bpy.data.collections.new("Other")
    scene.collection.children.link(other)
    box = bpy.data.objects["Box"]
    scene.collection.objects.unlink(box)
    other.objects.link(box)
    second = scene.view_layers.new("Second")
    second.layer_collection.children["Other"].exclude = True
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # Blender 5, where a part of the file for each pass is the rule
        settings.media_type = "MULTI_LAYER_IMAGE"
        settings.use_exr_interleave = True
    settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.filepath = str(studio.folder / "layers.exr")
    bpy.ops.render.render(write_still=True)
    source = oiio.ImageInput.open(scene.render.filepath)
    assert source is not None
    names, pixels = list(source.spec().channelnames), np.asarray(source.read_image("float"))
    layers = [
        pixels[..., [names.index(f"{layer.name}.Combined.{channel}") for channel in "RGBA"]]
        for layer in scene.view_layers
    ]
    source.close()
    assert all(layer[..., :3].any() for layer in layers)
    assert not np.array_equal(*layers)


def test_all_view_layers_are_reported_and_the_weightiest_warning_last(
    studio: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    """The first layer's counts more than the second's; a render after that starts anew."""
    studio.simple_scene()
    scene = studio.scene
    other = bpy.data.collections.new("Other")
    scene.collection.children.link(other)
    sun = studio.lamp("SUN", 3, (0, 0, 3), scale=(0, 0, 0))
    scene.collection.objects.unlink(sun)
    other.objects.link(sun)
    second = scene.view_layers.new("Second")
    second.layer_collection.children["Other"].exclude = True
    second.use_pass_vector = True
    scene.render.use_motion_blur, scene.shlight.motion_times = True, 2
    scene.cycles.rolling_shutter_type = "TOP"
    heavy, middle, slight = "its scale is 0", "rolling shutter", "passes that are not supported"
    for keeps_the_engine in (False, True, True):
        scene.render.use_persistent_data = keeps_the_engine
        capfd.readouterr()
        bpy.ops.render.render()
        texts = [str(message["text"]) for message in record.last.messages]
        assert [part for text in texts for part in (heavy, middle, slight) if part in text] == [heavy, middle, slight]
        assert [message["places"] for message in record.last.messages][-1] == ["View layer 'Second'"]
        warnings = [line for line in capfd.readouterr().out.splitlines() if "shlight: " in line]
        shown = [part for line in warnings for part in (heavy, middle, slight) if part in line]
        assert shown == [middle, heavy, slight, heavy]


@pytest.mark.parametrize("format", ["STEREO_3D", "MULTIVIEW"])
def test_views_are_seen_as_cycles_sees_them(studio: Any, format: str) -> None:
    """The eyes of one camera that converge by shift, and a camera for each view."""
    studio.simple_scene()
    render = studio.scene.render
    render.use_multiview, render.views_format = True, format
    render.image_settings.views_format = "INDIVIDUAL"
    stereo = studio.scene.camera.data.stereo
    stereo.convergence_mode, stereo.convergence_distance, stereo.interocular_distance = "OFFAXIS", 4.0, 0.5
    if format == "MULTIVIEW":
        studio.scene.camera.name = "Camera_L"
        studio.camera(location=(4, -5, 3)).name = "Camera_R"
    studio.scene.shlight.pixel_samples = 16
    pictures = {}
    for engine in ("SHLIGHT", "CYCLES"):
        render.engine = engine
        render.filepath = str(studio.folder / f"{engine}.exr")
        bpy.ops.render.render(write_still=True)
        pictures[engine] = [read_exr(path)[..., :3] for path in sorted(studio.folder.glob(f"{engine}*.exr"))]
    assert len(pictures["SHLIGHT"]) == 2
    for seen, expected in zip(pictures["SHLIGHT"], pictures["CYCLES"], strict=True):
        assert rel_mse(seen, expected) <= 2e-3  # noise of Cycles' 256 samples
    assert rel_mse(*pictures["SHLIGHT"]) > 0.05


@pytest.mark.parametrize("eyes", [1, 2])
def test_freestyle_draws_the_lines_that_cycles_draws(studio: Any, eyes: int) -> None:
    studio.simple_scene()
    render = studio.scene.render
    render.use_multiview = eyes == 2
    style = bpy.data.linestyles.new("Lines")
    style.thickness, style.color, style.alpha = 4.0, (0.1, 0.5, 0.9), 0.7
    freestyle = studio.scene.view_layers[0].freestyle_settings
    (freestyle.linesets[0] if freestyle.linesets else freestyle.linesets.new("Lines")).linestyle = style
    pictures = []
    for engine, lines in itertools.product(("SHLIGHT", "CYCLES"), (False, True)):
        render.engine, render.use_freestyle = engine, lines
        render.filepath = str(studio.folder / f"{engine}{lines}.exr")
        bpy.ops.render.render(write_still=True)
        pictures.append(np.array([read_exr(path) for path in sorted(studio.folder.glob(f"{engine}{lines}*.exr"))]))
    plain, lines_on, _, expected = pictures
    assert len(lines_on) == eyes
    for view in range(eyes):
        assert rel_mse(lines_on[view], expected[view]) <= 5e-3
        assert rel_mse(plain[view], expected[view]) >= 0.05
    assert studio.messages() == []


def test_settings_reach_the_renderer(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    studio.simple_scene()
    scene = studio.scene
    given: dict[str, Any] = {}
    original = shlight.render

    def render(*args: Any, **named: Any) -> Any:
        given.update(named)
        return original(*args, **named)

    monkeypatch.setattr(shlight, "render", render)
    scene.shlight.order = "12"
    scene.shlight.tolerance = 0.02
    scene.shlight.shadow_rays = 3
    scene.shlight.noise_threshold, scene.shlight.time_limit, scene.shlight.pixel_samples = 0.05, 100.0, 0
    scene.shlight.min_samples, scene.shlight.max_samples = 8, 64
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 2.5
    scene.shlight.max_bounces, scene.shlight.glossy_bounces, scene.shlight.transmission_bounces = 4, 3, 2
    scene.cycles.transparent_max_bounces, scene.cycles.film_exposure, scene.cycles.blur_glossy = 5, 0.5, 1.5
    scene.cycles.sample_clamp_indirect = 4.0
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    studio.render("SHLIGHT")
    passed = {name: value for name, value in given.items() if name not in {"progress", "on_update", "return_report"}}
    assert callable(given["progress"])
    assert passed == {
        "order": 12,
        "tolerance": pytest.approx(0.02),
        "exposure": 0.5,
        "noise_threshold": pytest.approx(0.05),
        "min_samples": 8,
        "max_samples": 64,
        "pixel_samples": None,
        "time_limit": 100.0,
        "pixel_filter": "gaussian",
        "filter_width": 2.5,
        "shadow_rays": 3,
        "transparent_bounces": 5,
        "max_bounces": 4,
        "glossy_bounces": 3,
        "transmission_bounces": 2,
        "filter_glossy": 1.5,
        "clamp_indirect": 4.0,
        "darken_doubled": True,
        "threads": 1,
    }
    scene.shlight.order, scene.shlight.use_shadows, scene.render.threads_mode = "AUTO", False, "AUTO"
    scene.shlight.pixel_samples = 4  # as in files of older versions
    studio.render("SHLIGHT")
    assert (given["pixel_samples"], given["min_samples"], given["max_samples"]) == (4, None, None)
    assert (given["order"], given["shadow_rays"], given["threads"]) == ("auto", 0, 0)


def test_order_takes_auto_and_every_number_up_to_64(studio: Any) -> None:
    settings = studio.scene.shlight
    for order in ("AUTO", "1", "7", "64"):
        settings.order = order
        assert settings.order == order
    for wrong in ("0", "65", "auto"):
        with pytest.raises(TypeError):
            settings.order = wrong


def test_blenders_own_panels_and_unregistering(studio: Any) -> None:
    def shared() -> set[str]:
        return {
            panel.__name__
            for panel in bpy.types.Panel.__subclasses__()
            if "SHLIGHT" in getattr(panel, "COMPAT_ENGINES", ()) and not panel.__name__.startswith("SHLIGHT")
        }

    joined = shared()
    assert {"DATA_PT_lens", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface", "RENDER_PT_format"} <= joined
    assert not {"DATA_PT_light", "DATA_PT_EEVEE_light"} & joined
    assert not [name for name in joined if "_gpencil" in name or "_grease_pencil" in name]
    shlight_blender.unregister()
    shlight_blender.unregister()
    try:
        assert shared() == set()
        assert not hasattr(bpy.types.Scene, "shlight")
        assert not hasattr(bpy.types, "SHLIGHT_RENDER_PT_light")
        with pytest.raises(TypeError):
            bpy.context.scene.render.engine = "SHLIGHT"
    finally:
        shlight_blender.register()
        shlight_blender.register()
    assert shared() == joined


INSTALL = """
import sys, bpy
bpy.ops.extensions.package_install_files(filepath=sys.argv[-1], repo="user_default", enable_on_install=True)
bpy.context.scene.render.engine = "SHLIGHT"
"""


def test_a_second_copy_is_refused(studio: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two copies may come from two repositories of extensions: the second one must not affect the first."""
    shutil.copytree(Path(shlight_blender.__file__).parent, tmp_path / "second_copy")
    monkeypatch.syspath_prepend(str(tmp_path))
    second = importlib.import_module("second_copy")
    with pytest.raises(RuntimeError, match="shlight is enabled already, as shlight_blender; disable that"):
        second.register()
    second.unregister()
    assert bpy.types.RenderEngine.bl_rna_get_subclass_py("SHLIGHT") is ShlightRenderEngine
    studio.simple_scene()
    assert studio.render("SHLIGHT").any()


def test_an_extension_leaves_without_a_traceback(tmp_path: Path) -> None:
    if not compat.IS_BLENDER_4:
        pytest.skip("this version of Blender has no extensions")
    addon = Path(shlight_blender.__file__).parent
    archive = shutil.make_archive(str(tmp_path / "addon"), "zip", addon)
    command = [sys.executable, "-c", INSTALL, archive]
    environment = {**os.environ, "HOME": str(tmp_path), "BLENDER_USER_RESOURCES": str(tmp_path)}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stdout + done.stderr, done.stderr
