# SPDX-License-Identifier: MIT
"""The examples, run as their first lines say."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import shlight
from shlight import images

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
sys.path.append(str(ROOT / "docs" / "tasks"))

import build  # noqa: E402


def test_render_in_blender_writes_its_picture_and_ends(tmp_path: Path) -> None:
    # Python waits for ever at its end if something still holds bpy, as typing does by functions with typing.overload.
    subprocess.run(
        [sys.executable, EXAMPLES / "render_in_blender.py", tmp_path / "a.png", "5"],
        check=True,
        capture_output=True,
        timeout=120,
    )
    import OpenImageIO as oiio

    picture = oiio.ImageBuf(str(tmp_path / "a.png"))
    assert (picture.spec().width, picture.spec().height) == (32, 20)
    assert 0.1 < np.mean(picture.get_pixels("float")[..., :3]) < 0.9


def test_render_from_python_shows_a_lit_ball(tmp_path: Path) -> None:
    spec = importlib.util.spec_from_file_location("example", EXAMPLES / "render_from_python.py")
    assert spec is not None
    assert spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    image = shlight.render(example.build(), 48, 32, pixel_samples=4, max_bounces=0)
    red, green, blue = image[16, 24, :3]
    assert red > 2 * green > 0
    assert red > 2 * blue > 0
    assert image[28, 4, 1] == pytest.approx(image[28, 4, 0], rel=0.3)  # the grey floor
    images.write_png(tmp_path / "a.png", images.linear_to_srgb8(image))


@pytest.mark.slow
def test_textured_obj_shows_its_picture(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
    )
    halves = np.zeros((4, 4, 3), dtype=np.uint8)
    halves[:, :2, 0] = halves[:, 2:, 2] = 200
    images.write_png(tmp_path / "a.png", halves)
    arguments = [tmp_path / "a.obj", tmp_path / "a.png", tmp_path / "b.png"]
    subprocess.run([sys.executable, EXAMPLES / "textured_obj.py", *arguments], check=True, timeout=120)
    picture = images.read_texture(tmp_path / "b.png")
    left, right = (picture[200, column, :3].astype(int) for column in (120, 280))
    assert left[0] > 2 * left[2]
    assert right[2] > 2 * right[0]


def test_the_code_of_the_page_start_renders(studio: Any) -> None:
    studio.camera()
    studio.resolution(16, 16)
    studio.scene.render.filepath = str(studio.folder / "a.exr")
    build.built(ROOT / "docs" / "start.md")
    assert images.read_exr(studio.folder / "a.exr").shape[:2] == (16, 16)
