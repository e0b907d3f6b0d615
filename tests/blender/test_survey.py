# SPDX-License-Identifier: MIT
"""The command `./dev survey`. Each file of a folder starts a Blender; one run over all of them serves most tests."""

from __future__ import annotations

import contextlib
import io
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest
from studio import Studio

from shlight import images, metrics
from shlight_tools.survey import command, main, records
from shlight_tools.survey.features import features_of
from shlight_tools.survey.staging import add_camera, add_lamps

# The command with the worker below.
COMMAND = [
    sys.executable,
    "-c",
    "import sys; from shlight_tools.survey import command; command.WORKER = 'faulty_worker'; "
    "sys.exit(command.main(sys.argv[1:]))",
]
TIME_LIMIT = 30  # s: several times what a file takes beside other tests

# A worker that crashes or hangs where shlight renders a file of such a name.
FAULTY_WORKER = """
import os, sys, time
from shlight_tools.survey import worker
render = worker.SurveyWorker._render_shlight
def _render_shlight(self):
    if "crash" in self._request.scene:
        os.abort()
    if "hang" in self._request.scene:
        time.sleep(1000)
    return render(self)
worker.SurveyWorker._render_shlight = _render_shlight
worker.serve_with(worker.SurveyWorker, sys.argv[1:])
"""


def save(path: Path) -> None:
    path.parent.mkdir(exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)


def fill(folder: Path) -> None:
    """Files that agree with Cycles, files that lack something, and files that fail."""
    studio = Studio(folder)
    studio.still_life()
    studio.camera()
    save(folder / "agrees.blend")
    for name in ("crash", "hang"):
        save(folder / "faults" / f"{name}.blend")
    studio = Studio(folder)
    studio.ball(material=studio.material("ShaderNodeBsdfGlass"))
    studio.plane(4, studio.material(Color=(0.8, 0.4, 0.2)), location=(9, 0, 0))
    save(folder / "no_camera_no_light.blend")
    studio = Studio(folder)
    studio.box(material=studio.material("ShaderNodeBsdfPrincipled", Base_Color=(0.1, 0.5, 0.2)))
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    bpy.ops.export_scene.gltf(filepath=str(folder / "box.glb"))
    (folder / "broken.blend").write_bytes((folder / "agrees.blend").read_bytes()[:9999])
    (folder / "broken.gltf").write_text("{")
    (folder / "notes.txt").write_text("no scene")


@pytest.fixture(scope="module")
def run(_addon: None, tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """A survey of a folder with every kind of file."""
    folder, out = tmp_path_factory.mktemp("scenes"), tmp_path_factory.mktemp("results") / "new"
    fill(folder)
    (out.parent / "faulty_worker.py").write_text(FAULTY_WORKER)
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(io.StringIO()) as said:
        patch.setattr(command, "WORKER", "faulty_worker")
        patch.setenv("PYTHONPATH", str(out.parent), prepend=os.pathsep)
        arguments = ["--size", "64x48", "--jobs", "2", "--time-limit", str(TIME_LIMIT)]
        assert main([str(folder), "--out", str(out), *arguments]) == 0
    data = json.loads((out / "survey.json").read_text())
    files = {record["file"]: record for record in data["files"]}
    return SimpleNamespace(folder=folder, out=out, said=said.getvalue(), files=files)


@pytest.mark.slow
def test_every_file_has_a_record_and_a_line(run: SimpleNamespace) -> None:
    assert list(run.files) == [
        "agrees.blend",
        "box.glb",
        "broken.blend",
        "broken.gltf",
        "faults/crash.blend",
        "faults/hang.blend",
        "no_camera_no_light.blend",
    ]
    lines = run.said.splitlines()
    assert lines[0] == records.HEADING
    assert sorted(lines[1:8]) == sorted(records.line(record) for record in run.files.values())
    assert "7 files: " in lines[9]


@pytest.mark.slow
def test_a_file_agrees_with_cycles(run: SimpleNamespace) -> None:
    record = run.files["agrees.blend"]
    assert abs(record["rel_mse"]) <= records.WITHIN
    assert record["mean_ratio"] == pytest.approx(1, abs=5e-3)
    assert record["noise_rel_mse"] <= 2e-4
    assert (record["stopped_by"], record["max_bounces"]) == ("noise", 0)
    assert (record["added"], record["features"], record["report"]) == ([], [], [])
    assert record["versions"]["blender"] == bpy.app.version_string
    ours, theirs = (
        images.read_exr(run.out / "pictures" / f"agrees.blend.{name}.exr") for name in ("shlight", "cycles")
    )
    assert ours.shape == theirs.shape == (48, 64, 4)
    assert record["rel_mse_measured"] == pytest.approx(metrics.rel_mse(ours, theirs), rel=1e-4)


@pytest.mark.slow
def test_what_a_file_lacks_is_added(run: SimpleNamespace) -> None:
    record = run.files["no_camera_no_light.blend"]
    assert record["added"] == ["camera", "lamps"]
    assert record["features"] == ["transmission"]
    assert "T     no_camera_no_light.blend: added: camera, lamps" in records.line(record)
    assert record["report"]
    box = run.files["box.glb"]
    assert box["added"] == ["camera", "lamps"]
    assert box["mean_ratio"] == pytest.approx(1, abs=0.02)


@pytest.mark.slow
def test_what_befalls_a_file_is_its_line(run: SimpleNamespace) -> None:
    def problem(name: str) -> str:
        record = run.files[name]
        assert not records.is_measured(record)
        assert not (run.out / "pictures" / f"{name}.png").exists()
        return str(record["problem"])

    assert problem("broken.blend").startswith("Blender cannot read it")
    assert problem("broken.gltf")
    assert problem("faults/crash.blend").startswith("Blender ended unexpectedly with signal SIGABRT")
    assert problem("faults/hang.blend") == f"no answer after {TIME_LIMIT} s: Rendering with shlight"
    assert run.files["faults/hang.blend"]["seconds"] < 2 * TIME_LIMIT


@pytest.mark.slow
def test_the_summary_counts(run: SimpleNamespace) -> None:
    counted = "6 without transmission, volume and subsurface: 2 within 0.001 (33.3%), 0 not, 4 failed"
    assert counted in run.said
    assert "1 with one of these: " in run.said


@pytest.mark.slow
def test_the_contact_sheet_shows_failures_first(run: SimpleNamespace) -> None:
    pytest.importorskip("matplotlib")
    from matplotlib.image import imread

    sheet = imread(run.out / "contact_sheet.png")
    assert np.allclose(sheet[30:78, 8:200, :3], 128 / 255, atol=1e-3)
    strip = imread(run.out / "pictures" / "agrees.blend.png")
    assert strip.shape[:2] == (48, 3 * 64)


@pytest.mark.slow
def test_resuming_does_what_is_left(run: SimpleNamespace, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def survey(*arguments: str) -> int:
        return main([str(run.folder), "--out", str(tmp_path), "--resume", *arguments])

    data = json.loads((run.out / "survey.json").read_text())
    kept = [record for record in data["files"] if record["file"] != "broken.blend"]
    (tmp_path / "survey.json").write_text(json.dumps(data | {"files": kept}))
    assert survey("--size", "64x48", "--worst", "1") == 0
    said = capsys.readouterr().out
    assert next(line for line in said.splitlines() if "broken.blend" in line).startswith("failed")
    after = json.loads((tmp_path / "survey.json").read_text())["files"]
    assert [record for record in after if record["file"] != "broken.blend"] == kept
    assert len(after) == len(kept) + 1
    assert survey("--size", "64x47") == 2
    assert "other options" in capsys.readouterr().err
    (tmp_path / "survey.json").write_text("{}")
    assert survey() == 2


@pytest.mark.slow
def test_interrupting_keeps_what_is_done(run: SimpleNamespace, tmp_path: Path) -> None:
    for name in ("a", "hang"):
        os.link(run.folder / "agrees.blend", tmp_path / f"{name}.blend")
    (tmp_path / "faulty_worker.py").write_text(FAULTY_WORKER)
    pipes: dict[str, Any] = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    path = os.pathsep.join(filter(None, (str(tmp_path), os.environ.get("PYTHONPATH"))))
    arguments = [str(tmp_path), "--out", str(tmp_path / "out"), "--size", "16x16"]
    with subprocess.Popen([*COMMAND, *arguments], text=True, env=os.environ | {"PYTHONPATH": path}, **pipes) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert any("a.blend" in line for line in process.stdout)
        process.send_signal(signal.SIGINT)
        try:
            assert process.wait(timeout=10) == 130
        finally:
            process.kill()
        assert "1 of 2 files are done" in process.stderr.read()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.blend", "faulty_worker.py", "hang.blend", "out"]
    assert [record["file"] for record in json.loads((tmp_path / "out" / "survey.json").read_text())["files"]] == [
        "a.blend"
    ]


def test_requests_that_cannot_be_met(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.blend").touch()
    (tmp_path / "empty").mkdir()
    taken = str(tmp_path / "a.blend")
    for arguments in ([], ["no such folder"], [taken], [str(tmp_path / "empty")], [str(tmp_path), "--out", taken]):
        assert main(arguments) == 2
        assert capsys.readouterr().err.startswith("./dev survey: ")
    assert main([str(tmp_path), "--jobs", "0"]) == 2


def test_features(tmp_path: Path) -> None:
    studio = Studio(tmp_path)
    material = studio.material("ShaderNodeBsdfPrincipled")
    studio.ball(material=material)
    tree = material.node_tree
    tree.nodes.new("ShaderNodeBsdfGlass")  # of no use
    hidden = studio.box(material=studio.material("ShaderNodeSubsurfaceScattering"), hide_render=True)
    assert features_of(studio.scene) == []
    hidden.hide_render = False
    tree.nodes["Principled BSDF"].inputs["Transmission Weight"].default_value = 0.1
    assert features_of(studio.scene) == ["transmission", "subsurface"]
    studio.world()
    world = studio.scene.world.node_tree
    output = world.get_output_node("CYCLES")
    world.links.new(world.nodes.new("ShaderNodeVolumeScatter").outputs[0], output.inputs["Volume"])
    assert features_of(studio.scene) == ["transmission", "volume", "subsurface"]


def test_the_camera_and_the_lamps_suit_what_is_seen(tmp_path: Path) -> None:
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    studio = Studio(tmp_path)
    scale = 1e-2
    boxes = [studio.box((scale, 3 * scale, scale), location=(7 + x * scale, 0, 0)) for x in (0, 5)]
    add_camera(studio.scene)
    add_lamps(studio.scene)
    bpy.context.view_layer.update()
    corners = [
        world_to_camera_view(studio.scene, studio.scene.camera, seen.matrix_world @ Vector(corner))
        for seen in boxes
        for corner in seen.bound_box
    ]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    assert (low[:2] >= 0).all()
    assert (high[:2] <= 1).all()
    assert (high - low)[:2].max() >= 0.85
    assert low[2] >= studio.scene.camera.data.clip_start
    for lamp in (seen for seen in studio.scene.objects if seen.type == "LIGHT"):
        towards = Vector((7 + 2.5 * scale, 0, 0)) - lamp.location
        assert towards.length <= 20 * scale
        facing = -(lamp.matrix_world.to_3x3() @ Vector((0, 0, 1)))
        assert facing.dot(towards.normalized()) == pytest.approx(1, abs=1e-4)
