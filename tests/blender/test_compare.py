# SPDX-License-Identifier: MIT
"""Compare with Cycles, inside Blender: the operator as scripts call it. The window is in test_debian_blender."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest
from numpy.typing import NDArray

from shlight_blender.background import last_picture
from shlight_blender.compare import job, measure, panel, places, results
from shlight_blender.compare.pictures import PALETTE, in_palette
from shlight_blender.shown_images import rendered_image

Image = NDArray[np.float32]


def files() -> set[Path]:
    """What is in Blender's temporary folder."""
    return set(Path(bpy.app.tempdir).rglob("*"))


def settings(scene: Any) -> list[Any]:
    """All that a render might change of a scene."""
    owners = (scene, scene.render, scene.render.image_settings, scene.cycles, scene.shlight, scene.view_layers[0])
    kinds = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}
    return [
        (prop.identifier, getattr(owner, prop.identifier))
        for owner in owners
        for prop in owner.bl_rna.properties
        if prop.type in kinds and not getattr(prop, "is_array", False)
    ]


def pixels(name: str) -> Image:
    """An image of Blender, row 0 at the bottom."""
    image = bpy.data.images[name]
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def rel_mse(image: Image, reference: Image) -> float:
    x, r = image[..., :3].astype(float), reference[..., :3].astype(float)
    return float(np.mean((x - r) ** 2 / (r**2 + 0.01 * r.mean() ** 2)))


@pytest.fixture
def still_life(studio: Any, tmp_path: Path) -> Iterator[Any]:
    """In a saved file with later changes: part of the frame, with a texture beside the file and one that is painted.

    shlight draws the ball of glass as diffuse.
    """
    studio.simple_scene()
    render = studio.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 192, 144, 50
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.05, 0.9, 0.1, 1.0
    studio.scene.shlight.pixel_samples = 0
    studio.scene.cycles.pixel_filter_type = "GAUSSIAN"
    glass = studio.material("ShaderNodeBsdfHair", name="Bottle", Color=(0.8, 0.8, 0.8))
    studio.ball(0.7, glass, location=(-0.3, -1.8, 0.7))
    beside = studio.picture([[(0.9, 0.1, 0.1), (0.1, 0.9, 0.1)]], is_float=False)
    beside.filepath_raw, beside.file_format = str(tmp_path / "beside.png"), "PNG"
    beside.save()
    painted = studio.picture([[(0.1, 0.2, 0.9), (0.9, 0.9, 0.1)]])
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "still_life.blend"))
    for image, x in ((beside, -3.0), (painted, 2.5)):
        material = studio.material(Color=(0.5, 0.5, 0.5))
        tree = material.node_tree
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        tree.links.new(node.outputs["Color"], tree.nodes["Diffuse BSDF"].inputs["Color"])
        plane = studio.plane(1.5, material, location=(x, -1, 0.01))
        plane.data.uv_layers.new()
    beside.filepath = "//beside.png"
    yield studio
    bpy.ops.shlight.remove_comparison()


def test_figures_pictures_and_places_are_true(still_life: Any) -> None:
    scene = still_life.scene
    scene.render.use_crop_to_border = True
    expected = still_life.render("SHLIGHT")[::-1]
    before, was_dirty, path = settings(scene), bpy.data.is_dirty, bpy.data.filepath
    files_before = files()
    assert bpy.ops.shlight.compare(reference_seconds=2.0) == {"FINISHED"}

    window_manager = bpy.context.window_manager
    window_manager.shlight_compare.split = 1.0
    shlight = pixels(results.COMPARISON)
    window_manager.shlight_compare.split = 0.0
    cycles, reference = pixels(results.COMPARISON), pixels(results.REFERENCE)
    window_manager.shlight_compare.split = 0.25
    half = pixels(results.COMPARISON)
    column = round(0.25 * shlight.shape[1])
    np.testing.assert_array_equal(half[:, :column], shlight[:, :column])
    np.testing.assert_array_equal(half[:, column:], cycles[:, column:])

    # The frame as F12 shows it, and Cycles' as bright.
    np.testing.assert_array_equal(shlight, expected)
    figures = results.last.figures
    assert figures["shlight"]["rel_mse_measured"] == pytest.approx(rel_mse(shlight, reference), rel=1e-4)
    assert figures["cycles_same_time"]["rel_mse_measured"] == pytest.approx(rel_mse(cycles, reference), rel=1e-4)
    assert abs(cycles[..., :3].mean() / reference[..., :3].mean() - 1) <= 0.1
    assert panel.lines(figures)[0] == "All pictures: direct light"
    assert f"relMSE {rel_mse(cycles, reference):.2e}" in " ".join(panel.lines(figures))

    # The difference is that of the pictures, in the palette.
    x, r = (picture[..., :3].astype(float) for picture in (shlight, reference))
    relative = np.mean((x - r) / np.sqrt(r**2 + 0.01 * r.mean() ** 2), axis=-1)
    shown = in_palette(100 * relative / results.last.limit)
    np.testing.assert_allclose(pixels(results.DIFFERENCE), shown, atol=0.51 / 255)

    print(figures["differences"])
    (place,) = figures["differences"]
    assert place["place"] == "Object 'Ball'"
    assert place["materials"] == ["Bottle"]
    assert any("Hair BSDF is not supported" in message for message in place["messages"])
    there = relative[int(place["y"]), int(place["x"])]
    assert there * place["difference"] > 0.1

    assert settings(scene) == before
    assert (bpy.data.is_dirty, bpy.data.filepath) == (was_dirty, path)
    bpy.ops.shlight.remove_comparison()
    assert files() == files_before
    assert not any(image.name.startswith("shlight ") for image in bpy.data.images)


def test_the_last_render_may_have_another_name(studio: Any, tmp_path: Path) -> None:
    studio.plane(4, studio.material("ShaderNodeEmission", "Bright", Strength=2))
    studio.camera()
    studio.render("SHLIGHT")
    rendered = rendered_image()
    assert rendered is not None
    rendered.name = "park"
    assert last_picture(studio.scene, tmp_path / "picture.exr")[..., :3].max() == 2


def test_without_a_reference_both_are_compared(studio: Any) -> None:
    """In a file that was never saved, without anything that shlight draws otherwise; with bounces, then without."""
    studio.simple_scene()
    studio.scene.shlight.max_bounces = 1
    assert bpy.ops.shlight.compare() == {"FINISHED"}
    found = results.last
    assert results.REFERENCE not in bpy.data.images
    assert found.figures["rel_mse_of_both"] == pytest.approx(rel_mse(found.shlight, found.cycles), rel=1e-4)
    assert f"No reference; between the two: relMSE {found.figures['rel_mse_of_both']:.2e}" in panel.lines(found.figures)
    assert found.figures["differences"] == []
    assert panel.lines(found.figures)[0] == "All pictures: 1 bounce"
    assert bpy.ops.shlight.compare(light="DIRECT") == {"FINISHED"}
    assert panel.lines(results.last.figures)[0] == "All pictures: direct light"
    assert results.last.cycles.mean() < found.cycles.mean()
    strong = {**found.figures, "rel_mse_of_both": 35.7}
    assert "No reference; between the two: differs strongly" in panel.lines(strong)
    bpy.ops.wm.read_homefile(use_empty=True)
    assert results.last is None
    assert not list(Path(bpy.app.tempdir).glob("shlight_*"))


def test_cycles_is_denoised_where_it_can(studio: Any) -> None:
    studio.simple_scene()
    assert bpy.ops.shlight.compare() == {"FINISHED"}
    noisy = results.last
    assert bpy.ops.shlight.compare(denoise=True) == {"FINISHED"}
    calm = results.last
    assert calm.figures["cycles_same_time"]["samples"] <= noisy.figures["cycles_same_time"]["samples"]
    assert rel_mse(calm.cycles, calm.shlight) <= 0.8 * rel_mse(noisy.cycles, noisy.shlight)
    bpy.ops.shlight.remove_comparison()


@pytest.mark.parametrize("runs", [True, False])
def test_texts_of_the_file_run_where_the_preferences_let_them(studio: Any, tmp_path: Path, runs: bool) -> None:
    studio.simple_scene()
    text = bpy.data.texts.new("start.py")
    text.use_module = True
    text.write(f"open({str(tmp_path / 'ran')!r}, 'w').close()")
    files = bpy.context.preferences.filepaths
    files.use_scripts_auto_execute, before = runs, files.use_scripts_auto_execute
    try:
        assert bpy.ops.shlight.compare() == {"FINISHED"}
    finally:
        files.use_scripts_auto_execute = before
    assert (tmp_path / "ran").exists() == runs


def test_the_palette_is_matplotlibs() -> None:
    colormaps = pytest.importorskip("matplotlib").colormaps
    values = np.linspace(-1, 1, 256)
    np.testing.assert_allclose(in_palette(values), colormaps[PALETTE]((values + 1) / 2), atol=2e-3)


# --- where pictures differ


def noisy_halves(truth: Image, seed: int) -> tuple[Image, Image]:
    """Few samples of which each is zero most of the time."""
    random = np.random.default_rng(seed)
    first, second = (truth * random.poisson(3.0, truth.shape) / 3.0 for _ in range(2))
    return first.astype(np.float32), second.astype(np.float32)


def plain_picture() -> Image:
    """Dark on one side, with an edge that runs through a column of pixels."""
    truth = np.full((120, 160, 3), 0.5, np.float32)
    truth[:, :80] = 0.025
    truth[:, 80] = 0.25
    return truth


@pytest.mark.parametrize("seed", range(8))
def test_noise_and_edges_alone_are_no_difference(seed: int) -> None:
    truth = plain_picture()
    aliased = truth.copy()
    aliased[:, 80] = truth[:, 79]
    assert measure.largest_differences(aliased, noisy_halves(truth, seed)) == []


def test_the_largest_differences_come_first_and_apart() -> None:
    truth = plain_picture()
    image = truth.copy()
    image[24:36, 114:126] *= 1.6
    image[80:100, 20:40] *= 0.5
    image[90:100, 120:130] *= 1.5
    found = measure.largest_differences(image, noisy_halves(truth, 1))
    centres = [(119.5, 29.5), (124.5, 94.5), (29.5, 89.5)]
    for each, (x, y), sign in zip(found, centres, (1, 1, -1), strict=True):
        assert max(abs(each.x - 0.5 - x), abs(each.y - 0.5 - y)) <= 6
        assert each.value * sign > 0
    assert [abs(each.value) for each in found] == sorted((abs(each.value) for each in found), reverse=True)


# --- what is seen there


def perspective(studio: Any) -> None:
    studio.scene.camera.data.sensor_fit = "VERTICAL"


def orthographic(studio: Any) -> None:
    studio.scene.camera.data.type, studio.scene.camera.data.ortho_scale = "ORTHO", 9.0


def shifted(studio: Any) -> None:
    studio.scene.camera.data.shift_x, studio.scene.camera.data.shift_y = 0.1, -0.07


def with_border(studio: Any) -> None:
    render = studio.scene.render
    render.use_border = True
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.1, 0.95, 0.2, 0.9


@pytest.mark.parametrize("change", [perspective, orthographic, shifted, with_border])
def test_a_ray_through_a_pixel_meets_what_is_seen_there(studio: Any, change: Callable[[Any], None]) -> None:
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    studio.camera()
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = 320, 200
    change(studio)
    things = [
        studio.ball(0.2, studio.material(name=f"M{x}{y}"), location=(x, y, 0.5)) for x in (-1, 0, 1) for y in (-1, 1)
    ]
    things[0].hide_viewport = True
    screen = studio.plane(20, location=(0, 0, 3), rotation_euler=(1.0, 0, 0))
    screen.visible_camera = False
    turned = (studio.scene.camera.location - Vector((0.3, 0.2, 1.2))).to_track_quat("-Z", "Y").to_euler()
    lamp = studio.area(size=0.2, location=(0.3, 0.2, 1.2), rotation_euler=turned, visible_camera=True)
    bpy.context.view_layer.update()
    border = studio.scene.render
    left, bottom = (int(border.border_min_x * 320), int(border.border_min_y * 200)) if border.use_border else (0, 0)
    places.show_what_is_rendered(bpy.context.view_layer)
    finder = places.Finder(studio.scene, bpy.context.view_layer)
    for thing in (*things, lamp):
        at = world_to_camera_view(studio.scene, studio.scene.camera, thing.matrix_world.translation)
        seen = finder.seen_at(320 * at.x - left, 200 * at.y - bottom)
        assert seen.place == ("Light" if thing is lamp else "Object") + f" '{thing.name}'"
        assert seen.materials == tuple(slot.material.name for slot in thing.material_slots)
    assert finder.seen_at(3, 150).place == "Background"


def test_a_place_has_what_the_report_says_of_it() -> None:
    from shlight_blender.report import ExportReport

    report = ExportReport()
    report.add("Material 'Wood', node 'Noise Texture'", "noise is not supported")
    report.add("Object 'Table'", "it is sheared")
    report.add("Object 'Chair'", "it is hidden")
    report.add("Light 'Lamp'", "its light varies")
    table = places.Seen("Object 'Table'", ("Wood",)).to_data(report)
    assert table["messages"] == ["noise is not supported", "it is sheared"]
    assert table["of_light"] == ["Light 'Lamp': its light varies"]
    assert places.Seen("Object 'Floor'").to_data(report)["messages"] == []
    lamp = places.Seen("Light 'Lamp'").to_data(report)
    assert (lamp["messages"], lamp["of_light"]) == (["its light varies"], [])


# --- what can go wrong


def refusal() -> str:
    """What is said of a comparison that fails, which leaves nothing."""
    before = files()
    with pytest.raises(RuntimeError) as error:
        bpy.ops.shlight.compare()
    assert files() == before
    assert job.session.job is None
    assert results.last is None
    return str(error.value)


def test_errors_are_one_line(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    studio.simple_scene()
    studio.scene.camera = None
    assert "shlight: scene 'Scene' has no camera" in refusal()
    studio.camera()
    studio.scene.render.engine = "CYCLES"
    assert "choose shlight as the scene's render engine first" in refusal()
    studio.scene.render.engine = "SHLIGHT"
    studio.scene.objects["Area"].data.energy = 0.0
    assert "no light" in refusal()
    bpy.ops.preferences.addon_disable(module="cycles")
    assert "Cycles is not there" in refusal()
    bpy.ops.preferences.addon_enable(module="cycles")
    monkeypatch.setattr(job, "command", lambda *_: ["/nowhere/blender"])
    assert "No such file or directory: '/nowhere/blender'" in refusal()
    monkeypatch.setattr(
        job, "command", lambda *_: [sys.executable, "-c", "import os; print('out', flush=1); os.abort()"]
    )
    assert "Blender ended unexpectedly with signal SIGABRT; its last words: out" in refusal()

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(job, "save_unsaved_images", full)
    assert "No space left on device" in refusal()


def test_only_one_runs_and_its_end_leaves_nothing(studio: Any) -> None:
    import shlight_blender

    studio.simple_scene()
    ways: dict[str, Callable[[], Any]] = {
        "cancel": lambda: bpy.ops.shlight.cancel_comparison(),
        "another file": lambda: bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True),
        "the add-on's removal": shlight_blender.unregister,
    }
    for way, end in ways.items():
        if way == "the add-on's removal":
            studio.__init__(studio.folder)
            studio.simple_scene()
        before = files()
        running = job.session.job = job.Job(bpy.context, denoise=False, reference_seconds=0.0)
        with pytest.raises(RuntimeError, match="a comparison is running"):
            bpy.ops.shlight.compare()
        assert running.worker.result(60.0) is None
        assert running.folder.is_dir()
        end()
        assert files() == before, way
        assert running.worker._process.returncode is not None
    shlight_blender.register()


def test_the_panel_shows_progress_and_what_was_found(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    studio.simple_scene()
    said: list[str] = []
    layout = SimpleNamespace(
        label=lambda text, **_: said.append(text),
        operator=lambda name, text="", **_: said.append(text) or SimpleNamespace(),
        prop=lambda owner, name, **_: said.append(name),
    )
    layout.column = layout.row = layout.box = lambda **_: layout
    context = SimpleNamespace(
        scene=studio.scene,
        window_manager=bpy.context.window_manager,
        region=SimpleNamespace(width=4000),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
    )
    drawn = SimpleNamespace(layout=layout)
    stage = SimpleNamespace(name="Reference", seconds=3.0, share=0.25)
    running = SimpleNamespace(worker=SimpleNamespace(stage=stage))
    monkeypatch.setattr(job.session, "job", running)
    panel.comparison.draw(drawn, context)
    assert said == ["Reference (3 s), 25%", "Cancel"]
    monkeypatch.setattr(job.session, "job", None)
    part = {"seconds": 1.0, "samples": 7, "settings": {"max_bounces": 4}}
    there = {"place": "Object 'Box'", "difference": -0.5, "messages": [], "of_light": []}
    figures = {"shlight": part, "cycles_same_time": part, "rel_mse_of_both": 0.5, "differences": [there]}
    black = np.zeros((2, 2, 4), np.float32)
    monkeypatch.setattr(results, "last", results.Results("Scene", figures, Path(), black, black, black[..., 0]))
    said.clear()
    panel.comparison.draw(drawn, context)
    assert {"denoise", "reference_seconds", "split", "Comparison", "Difference"} <= set(said)
    assert {"Cycles: 1.00 s, 7 samples", "1  Object 'Box': -50 %", "The report names nothing here"} <= set(said)
    assert "Reference" not in said
