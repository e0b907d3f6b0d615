# SPDX-License-Identifier: MIT
"""The command `./dev preview`. Whole runs are few: each starts a Blender."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest

from shlight import images, metrics
from shlight_blender.background import open_scene, use_cycles
from shlight_blender.compare.render import LIGHT_RAYS, bounces_of, without_shadows
from shlight_blender.worker_process import SceneError
from shlight_tools.preview import main, options
from shlight_tools.preview.command import FIRST_RESULTS, RESULTS
from shlight_tools.preview.worker import prepare

COMMAND = [sys.executable, "-c", "import sys; from shlight_tools.preview import main; sys.exit(main(sys.argv[1:]))"]
QUICK = ["--size", "24x16", "--samples", "8", "--shadow-rays", "4", "--pixel-samples", "2", "--tolerance", "0.01"]
QUICK += ["--max-bounces", "0"]
ENDLESS = ["--size", "24x16", "--samples", "10000000", "--reference-seconds", "0"]

# All that the camera sees is in the shadow of the upper plane; what shlight does not support is behind the camera.
TABLE = """
import bpy
def build_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_plane_add(size=9)
    bpy.ops.mesh.primitive_plane_add(size=3, location=(0, 0, 1))
    bpy.ops.mesh.primitive_plane_add(size=1, location=(0, 0, 9))
    material = bpy.data.materials.new("spotted")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    colour = nodes["Principled BSDF"].inputs["Base Color"]
    material.node_tree.links.new(nodes.new("ShaderNodeAmbientOcclusion").outputs["Color"], colour)
    bpy.context.object.data.materials.append(material)
    bpy.ops.object.light_add(type='AREA', location=(0, 0, 3))
    bpy.ops.object.light_add(type='POINT', location=(0, 0, 3))
    bpy.ops.object.camera_add(location=(0, 0, 0.9))
    bpy.context.scene.camera = bpy.context.object
    bpy.context.scene.shlight.max_bounces = 0
    return bpy.context.scene
"""


@pytest.fixture
def empty_scene() -> Iterator[bpy.types.Scene]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    yield bpy.context.scene
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """A run of the example over the results of an earlier one, and which were there when shlight's was named."""
    folder = tmp_path_factory.mktemp("example")
    results = folder / "out" / "preview" / "example_scene"
    results.mkdir(parents=True)
    for name in RESULTS:
        (results / name).write_text("of an earlier run")
    at_once: list[str] = []

    class Watch(io.StringIO):
        def write(self, text: str) -> int:
            if "shlight's picture" in text:
                at_once.extend(name for name in names(results) if name in RESULTS)
            return super().write(text)

    with contextlib.chdir(folder), contextlib.redirect_stdout(Watch()) as out:
        assert main(QUICK) == 0
    assert names(folder) == ["out"]
    figures = json.loads((results / "figures.json").read_text())
    return SimpleNamespace(results=results, out=out.getvalue(), at_once=at_once, figures=figures)


def test_shlights_picture_is_there_first_and_alone(example: SimpleNamespace) -> None:
    assert example.at_once == sorted(FIRST_RESULTS)
    assert names(example.results) == sorted(RESULTS)
    before, after = example.out.split("out/preview/example_scene/shlight.png")
    assert before.startswith("Starting Blender\n")
    assert "Cycles" not in before
    assert "out/preview/example_scene/preview.png" in after


def test_the_figures_are_those_of_the_pictures(example: SimpleNamespace) -> None:
    pictures = ("shlight.exr", "cycles_same_time.exr", "reference.exr")
    ours, cycles, reference = (images.read_exr(example.results / name) for name in pictures)
    assert ours.shape == cycles.shape == reference.shape == (16, 24, 4)
    for name, image in (("shlight", ours), ("cycles_same_time", cycles)):
        told = example.figures[name]
        assert told["rel_mse_measured"] == pytest.approx(metrics.rel_mse(image, reference), rel=1e-4)
        assert told["mean_ratio"] == pytest.approx(metrics.mean_ratio(image, reference), rel=1e-4)
        assert told["seconds"] == sorted(told["times"])[len(told["times"]) // 2] > 0
    # Near the reference, and away from every mirror image and transposition by far.
    assert metrics.mean_ratio(ours, reference) == pytest.approx(1, abs=0.1)
    error = metrics.rel_mse(ours, reference)
    assert error <= 0.2 * metrics.rel_mse(ours[::-1], reference)
    assert error <= 0.2 * metrics.rel_mse(ours[:, ::-1], reference)


def test_the_figures_tell_how_they_came_about(example: SimpleNamespace) -> None:
    ours, reference = example.figures["shlight"], example.figures["reference"]
    assert example.figures["size"] == [24, 16]
    assert (ours["settings"]["shadow_rays"], ours["settings"]["pixel_samples"]) == (4, 2)
    assert ours["settings"]["tolerance"] == pytest.approx(0.01)
    assert ours["settings"]["pixel_filter"] == "box", "not the filter of Cycles' pictures"
    assert sum([*ours["order_shares"].values(), ours["cubature_share"], ours["mirror_share"]]) == pytest.approx(1)
    assert [message["text"] for message in ours["unsupported"]] == [
        "it reflects lamps and the world, and no surface, while Max Bounces is 0"
    ]
    assert 0 <= ours["within_3_standard_errors"] <= 1
    assert (reference["samples"], reference["stopped_by"]) == (8, "samples")
    assert reference["noise_rel_mse"] > 0
    assert example.figures["versions"]["blender"].startswith(bpy.app.version_string[:3])


def test_a_script_under_one_lamp_without_shadows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script, results = tmp_path / "table.py", tmp_path / "new" / "folder"
    script.write_text(TABLE)
    short = ["--size", "24x16", "--samples", "100000", "--reference-seconds", "0.3"]
    assert main([str(script), *short, "--light", "Area", "--shadow-rays", "0", "--out", str(results)]) == 0
    said = json.loads((results / "figures.json").read_text())
    assert said["shlight"]["mean_ratio"] == pytest.approx(1, abs=0.01)
    assert said["reference"]["stopped_by"] == "seconds"
    assert 2 * sum(said["reference"]["chunks"]) == said["reference"]["samples"] < 100000
    assert said["scene"]["file"] == str(script)
    assert said["shlight"]["unsupported"][0]["places"] == ["Material 'spotted', node 'Ambient Occlusion'"]
    assert "'spotted'" in capsys.readouterr().out


def start(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    (folder / "table.py").write_text(TABLE)
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen([*COMMAND, "table.py", *arguments, "--out", "results"], cwd=folder, text=True, **pipes)


@pytest.mark.parametrize(
    ("sent", "code", "stage", "left", "said"),
    [
        (signal.SIGINT, 130, "Opening", ["table.py"], "interrupted; nothing was written"),
        (signal.SIGINT, 130, "Reference", ["results", "table.py"], "picture stays: results/shlight.png"),
        (signal.SIGTERM, 143, "Reference", ["results", "table.py"], ""),
    ],
)
def test_interrupting(tmp_path: Path, sent: signal.Signals, code: int, stage: str, left: list[str], said: str) -> None:
    with start(tmp_path, *ENDLESS) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert any(line.startswith(stage) for line in process.stdout)
        process.send_signal(sent)
        try:
            assert process.wait(timeout=20) == code
        finally:
            process.kill()
        err = process.stderr.read()
    assert said in err
    assert err.count("\n") == bool(said)
    assert names(tmp_path) == left
    assert "results" not in left or names(tmp_path / "results") == sorted(FIRST_RESULTS)


@pytest.mark.skipif(sys.platform != "linux", reason="asks the system for the processes of a session")
def test_a_killed_command_takes_the_worker_with_it(tmp_path: Path) -> None:
    with start(tmp_path, *ENDLESS) as process:
        assert process.stdout is not None
        assert any(line.startswith("Opening") for line in process.stdout)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        process.kill()
    assert len(children) == 1
    status = Path(f"/proc/{children[0]}/status")
    deadline = time.monotonic() + 5
    while status.exists() and "State:\tZ" not in status.read_text() and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not status.exists() or "State:\tZ" in status.read_text()


def refused(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """The one line that says why a request is refused; nothing may be left behind."""
    before = sorted(Path().rglob("*"))
    assert main([*map(str, arguments)]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert err.startswith("./dev preview: ")
    assert sorted(Path().rglob("*")) == before
    return err


def test_requests_that_cannot_be_met(
    tmp_path: Path, empty_scene: bpy.types.Scene, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert refused(capsys, "no.blend") == "./dev preview: no.blend: No such file or directory\n"
    assert refused(capsys, tmp_path) == f"./dev preview: {tmp_path}: Is a directory\n"
    Path("taken").touch()
    assert "taken is a file" in refused(capsys, "--out", "taken")
    assert "taken" in refused(capsys, "--out", "taken/below")
    refused(capsys, "--out", "/proc/preview")
    # A scene that only the render finds to be dark.
    empty_scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    lamp = bpy.data.lights.new("dark lamp", "POINT")
    lamp.energy = -1.0
    for seen in (empty_scene.camera, bpy.data.objects.new("dark lamp", lamp)):
        empty_scene.collection.objects.link(seen)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"), copy=True)
    line = refused(capsys, "a.blend")
    assert "no light" in line
    assert "'dark lamp'" in line


def test_options_that_are_not_understood(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    wrong = {"--size": ["0x5", "big"], "--samples": ["1"], "--reference-seconds": ["-1", "nan"], "--order": ["65"]}
    for option, values in (wrong | {"--tolerance": ["nan"], "--threads": ["-1"]}).items():
        for value in values:
            assert f"{option}: '{value}'" in refused(capsys, option, value)
    assert "--unknown" in refused(capsys, "--unknown")
    assert "b.blend" in refused(capsys, "a.blend", "b.blend")


def test_without_blender(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(importlib.util, "find_spec", lambda name: None)
        assert main([]) == 1
    missing = "./dev preview: the Python module bpy is missing: pip install 'shlight[blender]'\n"
    # A worker that ends at once stands for a Blender that crashes.
    Path("bpy.py").write_text("import os; print('Blender is tired', flush=True); os.abort()\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    assert main([]) == 1
    assert capsys.readouterr().err == missing + (
        "./dev preview: example_scene: Blender ended unexpectedly with signal SIGABRT; "
        "its last words: Blender is tired\n"
    )
    assert names(tmp_path) == ["bpy.py"]


def test_files_without_scene(tmp_path: Path, empty_scene: bpy.types.Scene) -> None:
    def reason(name: str, content: bytes) -> str:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(SceneError) as failure:
            open_scene(tmp_path / name)
        return str(failure.value)

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "whole.blend"), copy=True)
    whole = (tmp_path / "whole.blend").read_bytes()
    assert reason("whole.blend", whole) == "scene 'Scene' has no camera"
    for content in (b"", b"not a scene\n", whole[: len(whole) // 5], whole[: len(whole) * 9 // 10]):
        assert reason("a.blend", content).startswith("Blender cannot read it")
    assert reason("a.py", b"") == "there is no function build_scene() in it"
    chosen = b"import bpy\ndef build_scene():\n    bpy.context.scene.render.engine = 'SHLIGHT'\n"
    assert reason("a.py", chosen) == "there is no scene in it"  # and the engine is
    assert reason("a.py", b"1 / 0") == "ZeroDivisionError: division by zero"
    assert reason("a.py", b"def build_scene(): return") == "there is no scene in it"
    assert reason("a.py", b"def build_scene(): raise SystemExit('no,\\n no')") == "SystemExit: no, no"


def test_the_names_of_scenes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, empty_scene: bpy.types.Scene) -> None:
    for name in ("example_scene", "glossy_balls", "glossy_floor", "roughness_ramp"):
        chosen = options.parse([name])
        assert chosen.out == Path("out/preview") / name
        scene = open_scene(Path(chosen.request.scene))
        assert bpy.context.scene == scene
        assert {seen.type for seen in scene.objects} == {"CAMERA", "LIGHT", "MESH"}
    assert options.parse([]).scene == "example_scene"
    assert options.parse(["some/where/cornell.blend"]).out == Path("out/preview/cornell")
    monkeypatch.chdir(tmp_path)
    assert Path(options.parse(["glossy_balls"]).request.scene).is_absolute()
    (tmp_path / "glossy_balls").touch()  # a file comes before an example of its name
    assert options.parse(["glossy_balls"]).request.scene == "glossy_balls"


def test_the_lamps_that_are_not_named_are_off(empty_scene: bpy.types.Scene) -> None:
    chosen = options.parse(["glossy_balls", "--light", "quad", "--light", "small"])
    scene = open_scene(Path(chosen.request.scene))
    prepare(scene, chosen.request)
    assert [seen.name for seen in scene.objects if seen.type == "LIGHT" and not seen.hide_render] == ["quad", "small"]
    with pytest.raises(SceneError, match=r"^there is no lamp 'Sun' in it, but "):
        prepare(scene, options.parse(["--light", "Sun"]).request)


@pytest.mark.parametrize(("given", "bounces"), [([], 3), (["--max-bounces", "0"], 0), (["--max-bounces", "2"], 2)])
def test_cycles_has_as_many_bounces(empty_scene: bpy.types.Scene, given: list[str], bounces: int) -> None:
    scene = open_scene(Path(options.parse([]).request.scene))
    scene.shlight.max_bounces, scene.shlight.transmission_bounces = 3, 1
    scene.cycles.glossy_bounces, scene.cycles.caustics_reflective = 1, False
    scene.cycles.sample_clamp_direct, scene.cycles.sample_clamp_indirect = 5.0, 10.0
    prepare(scene, options.parse(given).request)
    use_cycles(scene, 4, 0, bounces_of(scene))
    cycles = scene.cycles
    kinds = (cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces, cycles.transmission_bounces)
    assert kinds == (*(bounces,) * 3, min(bounces, 1))
    assert scene.shlight.max_bounces == bounces
    assert (cycles.sample_clamp_direct, cycles.sample_clamp_indirect, cycles.caustics_reflective) == (0.0, 10.0, True)


def test_without_shadows_is_over_afterwards(empty_scene: bpy.types.Scene) -> None:
    scene = open_scene(Path(options.parse([]).request.scene))
    scene.objects["floor"].visible_shadow = False

    def seen_by_light() -> dict[str, list[bool]]:
        return {seen.name: [getattr(seen, flag) for flag in LIGHT_RAYS] for seen in scene.objects}

    before = seen_by_light()
    with without_shadows():
        blocking = {name for name, flags in seen_by_light().items() if any(flags)}
    assert blocking == {"window", "bulb", "glowing strip"}
    assert seen_by_light() == before
