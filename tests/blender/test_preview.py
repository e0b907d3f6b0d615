# SPDX-License-Identifier: MIT
"""The command `shlight preview`, run as users run it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest

from shlight import images, metrics
from shlight_blender.preview import options, picture, timing
from shlight_blender.preview.command import RESULTS
from shlight_blender.preview.progress import Progress
from shlight_blender.preview.scene import LIGHT_RAYS, open_scene, prepare, without_shadows

COMMAND = [
    sys.executable,
    "-c",
    "import sys; from shlight_blender.preview import main; sys.exit(main(sys.argv[1:]))",
]
SETTINGS = ["--shadow-rays", "4", "--pixel-samples", "2", "--tolerance", "0.01"]
QUICK = ["--size", "24x16", "--samples", "8", *SETTINGS]


def start(*arguments: str | Path, folder: Path, **changes: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        cwd=folder,
        env=os.environ | changes,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def preview(*arguments: str | Path, folder: Path) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of the command, run in `folder`."""
    with start(*arguments, folder=folder) as process:
        out, err = process.communicate(timeout=300)
    return process.returncode, out, err


@pytest.fixture
def empty_scene() -> Iterator[bpy.types.Scene]:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    yield bpy.context.scene
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def add_camera(scene: bpy.types.Scene) -> None:
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)


def add_negative_lamp(scene: bpy.types.Scene) -> None:
    lamp = bpy.data.lights.new("dark lamp", "POINT")
    lamp.energy = -1.0
    scene.collection.objects.link(bpy.data.objects.new("dark lamp", lamp))


def saved(path: Path) -> Path:
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, tuple[int, str, str]]:
    """Folder in which the example's preview ran, and how that ended."""
    folder = tmp_path_factory.mktemp("example")
    return folder, preview(*QUICK, folder=folder)


def test_the_example_needs_no_file(example: tuple[Path, tuple[int, str, str]]) -> None:
    folder, (code, out, err) = example
    assert (code, err) == (0, "")
    results = folder / "out" / "preview" / "example_scene"
    assert sorted(path.name for path in results.iterdir()) == sorted(RESULTS)
    assert [path.name for path in folder.iterdir()] == ["out"]
    assert out.splitlines()[0] == "Opening the scene"
    assert "Cycles, same time" in out


def test_the_figures_are_those_of_the_pictures(example: tuple[Path, tuple[int, str, str]]) -> None:
    results = example[0] / "out" / "preview" / "example_scene"
    figures = json.loads((results / "figures.json").read_text())
    ours, cycles, reference = (images.read_exr(results / name) for name in RESULTS[:3])
    assert ours.shape == cycles.shape == reference.shape == (16, 24, 4)
    assert figures["size"] == [24, 16]
    assert figures["shlight"]["rel_mse"] == pytest.approx(metrics.rel_mse(ours, reference), rel=1e-4)
    assert figures["cycles_same_time"]["rel_mse"] == pytest.approx(metrics.rel_mse(cycles, reference), rel=1e-4)
    assert figures["shlight"]["mean_ratio"] == pytest.approx(metrics.mean_ratio(ours, reference), rel=1e-4)
    assert 0 <= figures["shlight"]["within_3_standard_errors"] <= 1
    assert figures["reference"]["samples"] == 8
    assert figures["reference"]["noise_rel_mse"] > 0


def test_the_figures_tell_how_they_came_about(example: tuple[Path, tuple[int, str, str]]) -> None:
    figures = json.loads((example[0] / "out" / "preview" / "example_scene" / "figures.json").read_text())
    settings = figures["shlight"]["settings"]
    assert (settings["shadow_rays"], settings["pixel_samples"]) == (4, 2)
    assert settings["tolerance"] == pytest.approx(0.01)
    shares = figures["shlight"]
    ways = [*shares["order_shares"].values(), shares["cubature_share"], shares["mirror_share"]]
    assert sum(ways) == pytest.approx(1)
    assert figures["shlight"]["unsupported"] == []
    for name in ("shlight", "cycles_same_time"):
        times = figures[name]["times"]
        assert figures[name]["seconds"] == sorted(times)[len(times) // 2] > 0
    assert figures["versions"]["blender"].startswith(bpy.app.version_string[:3])
    assert figures["cycles_same_time"]["samples"] >= 1


def test_the_picture_of_shlight_is_near_the_reference(example: tuple[Path, tuple[int, str, str]]) -> None:
    results = example[0] / "out" / "preview" / "example_scene"
    ours, reference = (images.read_exr(results / name) for name in ("shlight.exr", "reference.exr"))
    assert metrics.mean_ratio(ours, reference) == pytest.approx(1, abs=0.1)
    # Away from every mirror image and transposition by far.
    error = metrics.rel_mse(ours, reference)
    assert error <= 0.2 * metrics.rel_mse(ours[::-1], reference)
    assert error <= 0.2 * metrics.rel_mse(ours[:, ::-1], reference)


def test_what_is_not_supported_is_named(tmp_path: Path, empty_scene: bpy.types.Scene) -> None:
    scene = open_scene(options.parse([]).scene_file)
    add_negative_lamp(scene)
    material = bpy.data.materials["matt grey"]
    noise = material.node_tree.nodes.new("ShaderNodeTexNoise")
    principled = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(noise.outputs["Color"], principled.inputs["Base Color"])
    path = saved(tmp_path / "with dark lamp.blend")
    code, out, err = preview(path, *QUICK, "--out", tmp_path / "new" / "folder", folder=tmp_path)
    assert (code, err) == (0, "")
    assert "Light 'dark lamp'" in out
    assert "'matt grey'" in out
    assert "Noise Texture" in out
    figures = json.loads((tmp_path / "new" / "folder" / "figures.json").read_text())
    assert any("Light 'dark lamp'" in message["places"] for message in figures["shlight"]["unsupported"])
    assert figures["scene"]["file"] == str(path)


@pytest.mark.parametrize("name", ["example_scene", "glossy_balls", "glossy_floor", "roughness_ramp"])
def test_an_example_has_a_name(name: str, empty_scene: bpy.types.Scene) -> None:
    chosen = options.parse([name])
    assert chosen.out == f"out/preview/{name}"
    scene = open_scene(chosen.scene_file)
    assert bpy.context.scene == scene
    assert {seen.type for seen in scene.objects} == {"CAMERA", "LIGHT", "MESH"}


def test_a_file_comes_before_an_example_of_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert options.parse(["glossy_balls"]).scene_file.is_absolute()
    (tmp_path / "glossy_balls").touch()
    assert options.parse(["glossy_balls"]).scene_file == Path("glossy_balls")


def test_a_script_under_one_lamp_without_shadows(tmp_path: Path) -> None:
    script = tmp_path / "table.py"
    script.write_text(
        "import bpy\n"
        "def build_scene():\n"
        "    bpy.ops.wm.read_factory_settings(use_empty=True)\n"
        "    bpy.ops.mesh.primitive_plane_add(size=9)\n"
        "    bpy.ops.mesh.primitive_plane_add(size=3, location=(0, 0, 1))\n"  # all that the camera sees is below it
        "    bpy.ops.object.light_add(type='AREA', location=(0, 0, 3))\n"
        "    bpy.ops.object.light_add(type='POINT', location=(0, 0, 3))\n"
        "    bpy.ops.object.camera_add(location=(0, 0, 0.9))\n"
        "    bpy.context.scene.camera = bpy.context.object\n"
        "    return bpy.context.scene\n"
    )
    chosen = ["--light", "Area", "--out", tmp_path, "--size", "24x16", "--samples", "64"]
    code, out, err = preview(script, *chosen, "--shadow-rays", "0", folder=tmp_path)
    assert (code, err) == (0, "")
    assert "not supported" not in out
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert figures["shlight"]["mean_ratio"] == pytest.approx(1, abs=0.01)
    assert refused(script, tmp_path, "--light", "Sun").endswith("there is no lamp 'Sun' in it, but Area, Point\n")


def test_without_shadows_is_over_afterwards(empty_scene: bpy.types.Scene) -> None:
    scene = open_scene(options.parse([]).scene_file)
    scene.objects["floor"].visible_shadow = False

    def seen_by_light() -> dict[str, list[bool]]:
        return {seen.name: [getattr(seen, flag) for flag in LIGHT_RAYS] for seen in scene.objects}

    before = seen_by_light()
    with without_shadows():
        blocking = {name for name, flags in seen_by_light().items() if any(flags)}
    assert blocking == {"window", "bulb", "glowing strip"}
    assert seen_by_light() == before


def test_the_lamps_that_are_not_named_are_off(empty_scene: bpy.types.Scene) -> None:
    chosen = options.parse(["glossy_balls", "--light", "quad", "--light", "small"])
    scene = open_scene(chosen.scene_file)
    prepare(scene, chosen)
    assert [seen.name for seen in scene.objects if seen.type == "LIGHT" and not seen.hide_render] == ["quad", "small"]


def refused(path: str | Path, folder: Path, *arguments: str | Path) -> str:
    """The one line that says why a scene is refused; nothing may be left behind."""
    before = sorted(folder.rglob("*"))
    code, _, err = preview(path, *QUICK, *arguments, folder=folder)
    assert code == 2
    assert err.count("\n") == 1
    assert err.startswith("shlight preview: ")
    assert sorted(folder.rglob("*")) == before
    return err


def test_a_missing_file(tmp_path: Path) -> None:
    assert refused("no.blend", tmp_path) == "shlight preview: no.blend: No such file or directory\n"


def test_a_folder_instead_of_a_file(tmp_path: Path) -> None:
    assert refused(tmp_path, tmp_path) == f"shlight preview: {tmp_path}: Is a directory\n"


def test_a_text_named_blend(tmp_path: Path) -> None:
    (tmp_path / "text.blend").write_text("not a scene\n")
    assert "text.blend: Blender cannot read it" in refused("text.blend", tmp_path)


def test_an_empty_file(tmp_path: Path) -> None:
    (tmp_path / "empty.blend").touch()
    assert "empty.blend: Blender cannot read it" in refused("empty.blend", tmp_path)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "there is no function build_scene() in it"),
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("def build_scene(): return", "there is no scene in it"),
        ("def build_scene(): raise SystemExit('no,\\n no')", "SystemExit: no, no"),
    ],
)
def test_a_script_that_makes_no_scene(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "wrong.py").write_text(text + "\n")
    assert refused("wrong.py", tmp_path) == f"shlight preview: wrong.py: {reason}\n"


@pytest.mark.parametrize("share", [0.2, 0.9])
def test_a_truncated_file(tmp_path: Path, empty_scene: bpy.types.Scene, share: float) -> None:
    path = saved(tmp_path / "cut.blend")
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    assert "cut.blend: Blender cannot read it" in refused(path, tmp_path)


def test_a_scene_without_camera(tmp_path: Path, empty_scene: bpy.types.Scene) -> None:
    assert refused(saved(tmp_path / "a.blend"), tmp_path).endswith("a.blend: scene 'Scene' has no camera\n")


def test_a_scene_without_light(tmp_path: Path, empty_scene: bpy.types.Scene) -> None:
    add_camera(empty_scene)
    assert "no light" in refused(saved(tmp_path / "a.blend"), tmp_path)


def test_a_scene_with_unsupported_light_only(tmp_path: Path, empty_scene: bpy.types.Scene) -> None:
    add_camera(empty_scene)
    add_negative_lamp(empty_scene)
    line = refused(saved(tmp_path / "a.blend"), tmp_path)
    assert "no light" in line
    assert "'dark lamp'" in line


def test_a_file_in_place_of_the_folder_of_results(tmp_path: Path, empty_scene: bpy.types.Scene) -> None:
    (tmp_path / "taken").touch()
    scene = saved(tmp_path / "a.blend")
    assert "taken is a file" in refused(scene, tmp_path, "--out", "taken")
    assert "taken" in refused(scene, tmp_path, "--out", "taken/below")


def test_a_folder_that_takes_no_files(tmp_path: Path) -> None:
    line = refused("no.blend" if os.geteuid() else "/dev/null", tmp_path, "--out", "/proc/preview")
    assert line.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--size", "0x5"], "0x5"),
        (["--size", "big"], "big"),
        (["--samples", "1"], "--samples"),
        (["--order", "65"], "--order"),
        (["--tolerance", "nan"], "--tolerance"),
        (["--threads", "-1"], "--threads"),
        (["--unknown"], "--unknown"),
        (["a.blend", "b.blend"], "b.blend"),
    ],
)
def test_options_that_are_not_understood(arguments: list[str], word: str, capsys: pytest.CaptureFixture[str]) -> None:
    from shlight_blender.preview import main

    assert main(arguments) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert word in err


@pytest.mark.parametrize(("sent", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupting_leaves_nothing(tmp_path: Path, sent: signal.Signals, code: int) -> None:
    with start(*QUICK, "--samples", "100000000", "--out", "results", folder=tmp_path) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        for line in process.stdout:
            if line.startswith("reference"):
                break
        time.sleep(0.3)
        process.send_signal(sent)
        try:
            assert process.wait(timeout=20) == code
        finally:
            process.kill()
        assert process.stderr.read().count("\n") <= 1
    assert list(tmp_path.iterdir()) == []


def test_a_crash_of_blender_is_one_line(tmp_path: Path) -> None:
    # A worker that ends at once stands for a Blender that crashes.
    package = tmp_path / "broken" / "bpy"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("import os; print('Blender is tired', flush=True); os.abort()\n")
    (tmp_path / "work").mkdir()
    with start(*QUICK, folder=tmp_path / "work", PYTHONPATH=str(package.parent)) as process:
        _, err = process.communicate(timeout=60)
    assert process.returncode == 1
    assert err == (
        "shlight preview: example_scene: Blender ended unexpectedly with signal SIGABRT; "
        "its last words: Blender is tired\n"
    )
    assert list((tmp_path / "work").iterdir()) == []


def test_missing_bpy_is_one_line(tmp_path: Path) -> None:
    code = (
        "import importlib.util as u, sys; find = u.find_spec\n"
        "u.find_spec = lambda name, *a: None if name == 'bpy' else find(name, *a)\n"
        "from shlight_blender.preview import main; sys.exit(main([]))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, check=False)
    assert run.returncode == 1
    assert run.stderr == b"shlight preview: the Python module bpy is missing: pip install 'shlight[blender]'\n"


def test_the_default_folder_is_named_after_the_scene() -> None:
    assert options.parse(["some/where/cornell.blend"]).out == "out/preview/cornell"
    assert options.parse([]).out == "out/preview/example_scene"
    assert options.parse(["--size", "640x480"]).size == (640, 480)


def test_calibration_finds_the_samples() -> None:
    calls = []

    def render(samples: int) -> float:
        calls.append(samples)
        return 0.05 + 0.003 * samples

    found = timing.calibrate(render, 1.25, 100000)
    assert found.samples(1.25) == 400
    assert found.seconds(4096) == pytest.approx(0.05 + 0.003 * 4096)
    assert len(calls) <= 4
    assert max(calls) <= 400
    # A target shorter than one sample takes.
    assert timing.calibrate(render, 0.01, 100000).samples(0.01) == 1


def test_turns_alternate() -> None:
    order = []
    first, second = timing.alternate(lambda: order.append("a") or 1.0, lambda: order.append("b") or 2.0, 3)
    assert order == ["a", "b"] * 3
    assert (first, second) == ([1.0] * 3, [2.0] * 3)


class Terminal:
    """A stream that says it is a terminal."""

    def __init__(self) -> None:
        self.text = ""

    def write(self, text: str) -> None:
        self.text += text

    def flush(self) -> None:
        pass

    def isatty(self) -> bool:
        return True


def test_a_terminal_shows_a_bar_that_is_full_only_at_the_end() -> None:
    stream = Terminal()
    progress = Progress(stream)
    progress.stage("reference", expected_seconds=1e-6)
    progress.tick()
    progress.end()
    assert "[#######################.]" in stream.text
    assert stream.text.endswith("s  reference\n")


def test_exposure_brings_the_bright_parts_up() -> None:
    dim = np.full((10, 10, 3), 0.1, np.float32)
    assert picture.common_exposure(dim) == pytest.approx(3)
    assert picture.common_exposure(0 * dim) == 0


@pytest.mark.parametrize(("share", "limit"), [(0.012, 2.0), (0.02, 2.0), (0.049, 5.0), (0.08, 10.0), (0.0, 0.1)])
def test_colour_scale_ends_at_a_round_number(share: float, limit: float) -> None:
    assert picture.difference_limit(np.full((8, 8), -share)) == pytest.approx(limit)


@pytest.mark.skipif(sys.platform != "linux", reason="asks the system for the processes of a session")
def test_a_killed_command_takes_the_worker_with_it(tmp_path: Path) -> None:
    with start(*QUICK, "--samples", "100000000", "--out", "results", folder=tmp_path) as process:
        assert process.stdout is not None
        assert any(line.startswith("reference") for line in process.stdout)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        process.kill()
    assert len(children) == 1
    worker = Path(f"/proc/{children[0]}")
    deadline = time.monotonic() + 5
    while worker.exists() and "State:\tZ" not in (worker / "status").read_text() and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not worker.exists() or "State:\tZ" in (worker / "status").read_text()
