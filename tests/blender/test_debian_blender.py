# SPDX-License-Identifier: MIT
"""The same add-on inside Debian's Blender 3.4: in the background against Cycles, and in a real window."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest

from shlight.images import read_exr
from shlight.metrics import mean_ratio, rel_mse

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BLENDER = shutil.which("blender")


def blender_is_usable() -> str:
    """Why Debian's Blender cannot run the add-on here; empty if it can."""
    if BLENDER is None:
        return "no program named blender is installed"
    if sys.version_info[:2] != (3, 11):
        return "the native module is built for another Python than Debian's Blender has"
    found = subprocess.run(["/usr/bin/python3.11", "-c", "import numpy"], capture_output=True, check=False)
    return "" if found.returncode == 0 else "Debian's python3-numpy is not installed"


WHY_NOT = blender_is_usable()
pytestmark = pytest.mark.skipif(bool(WHY_NOT), reason=WHY_NOT or "-")


def run_blender(
    *arguments: str,
    script: str,
    folder: Path,
    before: tuple[str, ...] = (),
    after: tuple[str, ...] = (),
    seconds: float = 240,
) -> subprocess.CompletedProcess[str]:
    """Runs Blender with the source tree's add-on on its path and nothing of the user's configuration."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "BLENDER"))}
    environment |= {
        "HOME": str(folder),
        "LIBGL_ALWAYS_SOFTWARE": "1",
    }
    paths = [str(ROOT / "python_bindings"), str(ROOT / "blender_addon")]
    command = [
        *before, str(BLENDER), *arguments, "--factory-startup", "--python-exit-code", "1",
        "--python-expr", f"import sys; sys.path[:0] = {paths!r}", "--python", str(HERE / script),
        "--", str(folder), *after,
    ]  # fmt: skip
    pipe = subprocess.PIPE
    with subprocess.Popen(
        command, stdout=pipe, stderr=pipe, text=True, env=environment, start_new_session=True
    ) as process:
        try:
            output, errors = process.communicate(timeout=seconds)
        except BaseException as stop:
            os.killpg(process.pid, signal.SIGKILL)  # the screen too
            if isinstance(stop, subprocess.TimeoutExpired):
                output, errors = process.communicate()
                pytest.fail(f"{script} did not end:\n{output}{errors}")
            raise
    return subprocess.CompletedProcess(command, process.returncode, output, errors)


def spoken(done: Any) -> str:
    """Output of Blender without its lines of progress."""
    return "\n".join(line for line in (done.stdout + done.stderr).splitlines() if not line.startswith("Fra:"))


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Runs all background scenes once; returns what the script says of them."""
    folder = tmp_path_factory.mktemp("debian")
    done = run_blender("-b", script="debian_scenes.py", folder=folder)
    # Blender's exit code is 1 after any operator's error, the expected one of the flat camera too.
    assert done.returncode in {0, 1}, spoken(done)
    assert (folder / "results.json").is_file(), spoken(done)
    results: dict[str, Any] = json.loads((folder / "results.json").read_text())
    return results


LAMPS = ["point", "area", "spot", "small_spot", "small_point", "sun", "small_sun", "spread", "textured"]

OTHERS = [
    "smooth",
    "coarse",
    "displaced",
    "glossy",
    "metal",
    "brushed",
    "principled",
    "several_bounces",
    "satin",
    "lacquer",
    "velvet",
    "translucent",
    "transmission",
    "curves",
    "noise",
    "sky",
    "panoramic",
    "orthographic",
    "simplified",
]


@pytest.mark.parametrize("scene", [*LAMPS, *OTHERS])
def test_pictures_against_cycles(pictures: dict[str, Any], scene: str) -> None:
    result = pictures[scene]
    lacking = ("while Max Bounces is 0", "(caustics) is blurred", "spreads light as since Blender 4")
    assert [line for line in result["messages"] if not line.endswith(lacking)] == []
    image, reference = read_exr(result["SHLIGHT"]), read_exr(result["CYCLES"])
    assert image.shape == reference.shape
    ratio, mse = mean_ratio(image, reference), rel_mse(image, reference)
    print(f"mean {100 * (ratio - 1):+.3f} %, relMSE {mse:.2e}")
    assert abs(ratio - 1.0) <= (4e-2 if scene == "several_bounces" else 5e-3)  # 0.14 of GGX alone
    assert mse <= 1e-2


def test_lamps_have_no_uv_map(pictures: dict[str, Any]) -> None:
    result = pictures["textured_by_default"]
    assert len(result["messages"]) == 1
    assert "a lamp has no UV map in this version of Blender" in result["messages"][0]
    assert abs(mean_ratio(read_exr(result["SHLIGHT"]), read_exr(result["CYCLES"])) - 1.0) <= 5e-3


def test_example_scenes_are_built(tmp_path: Path) -> None:
    script = tmp_path / "count.py"
    names = ("example_scene", "glossy_balls", "glossy_floor", "roughness_ramp")
    script.write_text(
        f"import runpy\nimport bpy\nfor name in {names}:\n"
        f"    runpy.run_path({str(ROOT / 'examples')!r} + f'/{{name}}.py', run_name='__main__')\n"
        "    kinds = [shown.type for shown in bpy.context.scene.objects]\n"
        "    print('built', bpy.context.scene.camera is not None, *(kinds.count(kind) for kind in ('MESH', 'LIGHT')))\n"
    )
    said = spoken(run_blender("-b", script=str(script), folder=tmp_path))
    assert len(re.findall(r"^built True [1-9]\d* [1-9]\d*$", said, re.MULTILINE)) == len(names), said


def test_errors_do_not_crash(pictures: dict[str, Any]) -> None:
    assert "scale 0" in pictures["flat_camera"]["error"]


def test_a_dark_frame_is_black(pictures: dict[str, Any]) -> None:
    image, reference = (read_exr(pictures["dark"][engine]) for engine in ("SHLIGHT", "CYCLES"))
    assert not image[..., :3].any()
    assert 0.0 < image[..., 3].mean() < 1.0
    assert abs(image[..., 3] - reference[..., 3]).mean() <= 5e-3
    # Messages are ordered by their effect on the picture.
    parts = ("no light that shlight can render", "Hair BSDF")
    assert all(part in line for part, line in zip(parts, pictures["dark"]["messages"], strict=True))


def test_the_menu_of_nodes_is_left_as_it_was(pictures: dict[str, Any]) -> None:
    assert pictures["left_menu"]


def run_in_window(
    *arguments: str,
    script: str,
    folder: Path,
    size: tuple[int, int] = (1280, 800),
    after: tuple[str, ...] = (),
    seconds: float = 240,
) -> tuple[int, str]:
    """Runs Blender with a window of this size; returns its exit code and what it says."""
    if shutil.which("xvfb-run") is None:
        pytest.skip("xvfb-run is not installed")
    window = ("-noaudio", "--window-geometry", "0", "0", *map(str, size), *arguments)
    # Without a given authority xvfb-run makes a folder, and exits with 5 where it cannot remove it.
    authority = folder / "Xauthority"
    authority.touch()
    screen = ("xvfb-run", "-a", "-f", str(authority), "-s", "-screen 0 1280x800x24 +extension GLX")
    for _ in range(2):
        done = run_blender(*window, script=script, folder=folder, before=screen, after=after, seconds=seconds)
        if WRITE_REFUSED not in done.stderr and not READ_ONLY.search(spoken(done)):
            break
    return done.returncode, spoken(done)


# Blender's errors where scripts must not write; debian_walk.py explains them. A timer's step cannot evade the first.
# The other leaves Blender's own add-ons half registered, and Blender may crash later for that.
WRITE_REFUSED = "Writing to ID classes in this context is not allowed"
READ_ONLY = re.compile(r"(?:Error: )?Traceback.*\n(?:  .*\n)*RuntimeError: .* can't run in readonly state.*")


@pytest.mark.parametrize("steps", [12, pytest.param(1000, marks=pytest.mark.slow)])
def test_a_walk_in_the_window(tmp_path: Path, steps: int) -> None:
    """Random steps during renders: other files, undo, the add-on and Cycles disabled, scripts reloaded."""
    addons = tmp_path / ".config/blender/3.4/scripts/addons"
    addons.mkdir(parents=True)
    (addons / "shlight_blender").symlink_to(ROOT / "blender_addon/shlight_blender")
    walk = (os.environ.get("SHLIGHT_SEED", "1"), str(steps))
    code, output = run_in_window(
        "--enable-event-simulate",
        script="debian_walk.py",
        folder=tmp_path,
        size=(640, 480),
        after=walk,
        seconds=60 + 3 * steps,
    )
    output = READ_ONLY.sub("", output)
    assert code in {0, 1}, output  # 1 after a render that was stopped, which is an operator's error
    assert "step 0: quit" in output, output
    assert "Traceback" not in output, output
    stopped = {f"Error: shlight: the render was stopped because {name} was disabled" for name in ("shlight", "Cycles")}
    stopped.add("Error: Can't reload with running modal operators")
    assert {line for line in output.splitlines() if line.startswith("Error")} <= stopped, output


def test_without_numpy_one_line_says_what_to_install(tmp_path: Path) -> None:
    addons = tmp_path / ".config/blender/3.4/scripts/addons"
    addons.mkdir(parents=True)
    (addons / "shlight_blender").symlink_to(ROOT / "blender_addon/shlight_blender")
    script = tmp_path / "enable.py"
    script.write_text(
        "import sys\nimport bpy\nsys.modules['numpy'] = None\n"
        "for switch in ('enable', 'disable', 'enable'):\n"
        "    getattr(bpy.ops.preferences, f'addon_{switch}')(module='shlight_blender')\n"
    )
    done = run_blender("-b", script=str(script), folder=tmp_path)
    assert done.returncode == 0, spoken(done)
    assert "Traceback" not in spoken(done)
    text = (
        "shlight: Blender's Python lacks numpy: install it ('apt install python3-numpy' on Debian) and restart Blender"
    )
    assert spoken(done).count(text) == 2


def test_window(tmp_path: Path) -> None:
    """A real window: the engine selected, its panels and previews drawn, a rendered viewport, and final renders.

    They run beside the window, as with F12, in a world of a sky.
    """
    green = np.zeros((3, 6, 48, 6, 48))  # as in a file of UTIA's database
    green[1] = 0.8 / np.pi
    green.tofile(tmp_path / "green.bin")
    code, output = run_in_window(script="debian_window.py", folder=tmp_path, size=(800, 600))
    assert code == 0, output
    assert "Traceback" not in output, output
    drawn = json.loads((tmp_path / "found.json").read_text())
    shown = {
        "RENDER_PT_sampling",
        "RENDER_PT_report",
        "RENDER_PT_shadows",
        "WORLD_PT_picture",
        "LIGHT_PT_light",
        "LIGHT_PT_nodes",
    }
    assert {f"SHLIGHT_{name}" for name in shown} <= set(drawn["panels"])
    shaders = {"BsdfPrincipled", "BsdfDiffuse", "BsdfGlossy", "Emission", "MixShader", "AddShader", "OutputLight"}
    assert {f"ShaderNode{name}" for name in shaders} <= set(drawn["nodes"]["SHLIGHT"])
    assert "ShaderNodeEeveeSpecular" not in drawn["nodes"]["SHLIGHT"]
    assert drawn["nodes"]["SHLIGHT"] == drawn["nodes"]["CYCLES"]
    assert "ShaderNodeEmission" not in drawn["nodes"]["BLENDER_WORKBENCH"]
    assert drawn["viewport_updates"] >= 1
    (red, _, no_blue), (no_red, _, blue), (measured_red, measured_green, _) = drawn["previews"]
    assert red > 2 * no_blue
    assert blue > 2 * no_red
    assert measured_green > 2 * measured_red
    assert drawn["messages"] == [[], []]
    assert drawn["redrawn"] == [True, True]
    assert drawn["undone"] == ["Render: an undo or redo has stopped it; its picture is unfinished"]
    first, second = (read_exr(tmp_path / f"final_{i}.exr")[..., :3] for i in range(2))
    assert first.any()
    assert (first == second).all()


PARTS = {
    "move a lamp": "Lamps",
    "lamp's power": "Lamps",
    "move an object": "Lamps, Objects",
    "colour": "Materials",
    "texture": "Materials",
    "world": "World, Lamps",
    "vertex": "Lamps, Objects",
    "hide": "Lamps, Objects",
    "show": "Lamps, Objects",
    "frame": "Lamps, Objects",
    "orbit": "",
    "orthographic": "",
    "camera": "",
    "local view": "Lamps, Objects",
}


def test_the_rendered_viewport(tmp_path: Path) -> None:
    """It follows whatever changes, exports no more than that, and shows what a final render shows."""
    # Small, since each change draws a picture of the whole viewport.
    code, output = run_in_window(script="debian_viewport.py", folder=tmp_path, size=(640, 480), seconds=480)
    assert code == 0, output
    assert "Traceback" not in output, output
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["updated"].pop("select") is None
    assert {name: found["updated"][name] for name in PARTS} == PARTS
    same = {name for name, difference in found["differs"].items() if difference == 0.0}
    assert same == {"select", "undo"}
    assert found["anew"], "after all changes the picture is not that of a viewport that has just been opened"
    # The corners of pixels' squares are rounded otherwise, which a few rays at edges tell.
    seen = np.load(tmp_path / "viewport.npy")[::-1]
    assert rel_mse(seen, read_exr(tmp_path / "final.exr")) <= 1e-4
    first, *moved, lit = found["gathered"]
    assert max(moved) <= 0.25 * first, found["gathered"]
    assert lit >= 0.5 * first, found["gathered"]
    assert found["lit anew"], "light from before a lamp was changed is left"
    (dimmed_jobs, dimmed), (bright_jobs, bright) = found["mixed"]
    assert (dimmed_jobs, bright_jobs) == (0, 1)
    assert 0.2 < dimmed < 0.95
    assert bright > 2.0
    assert found["viewports"] == 1
    assert found["threads"] == 0
    check_screen(tmp_path, found["region"])


@pytest.mark.slow
def test_a_viewport_that_stays_open(tmp_path: Path) -> None:
    """It is never blank in ten minutes of edits, and takes no more memory in the last than after two."""
    seconds = 600
    arguments = (os.environ.get("SHLIGHT_SEED", "1"), str(seconds))
    code, output = run_in_window(
        script="debian_edits.py", folder=tmp_path, size=(640, 480), after=arguments, seconds=4 * seconds
    )
    assert code == 0, output
    assert "Traceback" not in output, output
    found = json.loads((tmp_path / "found.json").read_text())
    x, y, width, height = found["region"]
    for picture in sorted(tmp_path.glob("*.png")):
        window = oiio.ImageBuf(str(picture)).get_pixels(oiio.FLOAT)[::-1]
        middle = window[y + height // 3 : y + 2 * height // 3, x + width // 3 : x + 2 * width // 3, :3]
        assert np.ptp(middle) >= 0.1, picture
    whole = len(found["resident"]) // 20 * 20
    resident = np.median(np.reshape(found["resident"][:whole], (-1, 20)), axis=1)  # of each 20 seconds
    print("MB:", *(resident / 2**20).round())
    assert resident[-1] <= 1.02 * resident[5]


def check_screen(folder: Path, region: list[int]) -> None:
    """The window shows the picture, which has half as many pixels, where the viewport is, without header and tools."""
    x, y, width, height = region
    window = oiio.ImageBuf(str(folder / "window.png")).get_pixels(oiio.FLOAT)[::-1]
    screen = window[y : y + height, x : x + width, :3]
    shown = np.clip(np.load(folder / "shown.npy")[..., :3], 0.0, 1.0)
    at = [(2 * np.arange(length // 3, 2 * length // 3)) for length in shown.shape[:2]]
    expected = shown[np.ix_(*(each // 2 for each in at))]
    # Bytes, and edges between pixels that are drawn linearly.
    assert np.abs(screen[np.ix_(*at)] - expected).mean() <= 0.01


def test_comparing_in_the_window(tmp_path: Path) -> None:
    """Compares next to the window, with results shown, dragged and kept over undo; an end leaves nothing behind."""
    code, output = run_in_window(
        "--enable-event-simulate", script="debian_compare.py", folder=tmp_path, size=(800, 600)
    )
    assert code == 0, output
    assert "Traceback" not in output, output
    found = json.loads((tmp_path / "found.json").read_text())
    assert "a comparison is running" in found["twice"]
    assert any(stage.startswith("Reference") for stage in found["stages"])
    assert found["is_dirty"] == found["was_dirty"] is True
    assert found["unsaved_images"] == found["unsaved_after_drag"] == []
    assert found["shown"] == "shlight Comparison"
    assert found["places"][0][0] == "Object 'Cube'"
    assert any("Hair BSDF is not supported" in message for message in found["places"][0][1])
    assert abs(found["split"] - 0.25) <= 0.01
    assert found["corner_on_screen"] == found["corner"]
    assert found["marker"] == 255
    assert found["kept"]
    assert found["shown_after_undo"] == "shlight Difference"
    assert set(found["ends"]) == {"press_escape", "press_cancel", "undo", "close_file", "disable"}
    for way, end in found["ends"].items():
        assert end == {"running": True, "job": False, "process": False, "files": []}, way
    assert found["after_file"] == [False, False]
    assert not found["operator_left"]
