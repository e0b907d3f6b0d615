# SPDX-License-Identifier: MIT
"""The module keeps to its own Embree, whatever else lives in the process, and to the best instruction set."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from shlight import _core

# A floor that a sphere light overhead lights, with a small plate between: rays that miss leave it black, rays that are
# never blocked leave it without a shadow.
RENDER = """
import numpy as np, shlight
quad = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
faces = [[0, 1, 2], [0, 2, 3]]
scene = shlight.Scene()
scene.add_mesh(quad, faces)
scene.add_mesh(quad * 0.2 + np.float32([0, 0, 0.5]), faces)
scene.add_sphere_light([0, 0, 2], 0.2, [1, 1, 1])
to_world = np.eye(4)
to_world[:3, 3] = 0.9, 0.0, 1.5
to_world[:3, :3] = [[0.86, 0, 0.51], [0, 1, 0], [-0.51, 0, 0.86]]
scene.set_camera(to_world, 1.2)
image = shlight.render(scene, 32, 32, pixel_samples=4, max_bounces=0)
lit = image[..., 3] == 1
print(int(lit.sum()), float(image[lit, 0].max()), float(image[lit, 0].min()), image.tobytes().hex()[:4096])
"""


def run(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1]


def bpy_folder() -> Path:
    spec = importlib.util.find_spec("bpy")
    if spec is None or not spec.submodule_search_locations:
        pytest.skip("bpy is not installed")
    return Path(spec.submodule_search_locations[0])


@pytest.fixture(scope="module")
def alone() -> str:
    result = run(RENDER)
    covered, brightest, darkest = result.split()[:3]
    assert int(covered) > 500
    assert float(brightest) > 5e-3
    assert float(darkest) <= 1e-6
    return result


def test_renders_with_another_embree_in_the_global_scope(alone: str) -> None:
    library = bpy_folder() / "lib" / "libembree4.so.4"
    if not library.exists():
        pytest.skip("this bpy brings no libembree4.so.4")
    assert run(f"import ctypes; ctypes.CDLL({str(library)!r}, ctypes.RTLD_GLOBAL)\n{RENDER}") == alone


@pytest.mark.parametrize("imports", ["import bpy, shlight", "import shlight, bpy"])
def test_renders_beside_bpy(alone: str, imports: str) -> None:
    bpy_folder()
    assert run(f"{imports}\n{RENDER}") == alone


def test_dlopen_flags_are_restored() -> None:
    assert run("import sys; before = sys.getdlopenflags(); import shlight; print(before == sys.getdlopenflags())") == (
        "True"
    )


def test_the_best_target_is_in_use_unless_another_is_forced() -> None:
    def printed(**variables: str) -> subprocess.CompletedProcess[str]:
        environment = {key: value for key, value in os.environ.items() if key != "SHLIGHT_KERNEL_TARGET"}
        path = os.pathsep.join(part for part in sys.path if part)
        return subprocess.run(
            [sys.executable, "-c", "from shlight import _core; print(_core.kernel_target())"],
            env={**environment, "PYTHONPATH": path, **variables},
            capture_output=True,
            text=True,
            check=False,
        )

    targets = _core.kernel_targets()
    assert printed().stdout.strip() == targets[0]
    for name in targets:
        assert printed(SHLIGHT_KERNEL_TARGET=name).stdout.strip() == name
    named = f"SHLIGHT_KERNEL_TARGET: this build has {', '.join(targets)} for this machine, not MMX"
    assert named in printed(SHLIGHT_KERNEL_TARGET="MMX").stderr
