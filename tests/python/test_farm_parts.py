# SPDX-License-Identifier: MIT
"""Parts of the farm that need no Blender and no scheduler."""

from __future__ import annotations

import runpy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import shlight
from shlight import images
from shlight.farm import Outcome, Picture, Rendered, command, files, parse_frames
from shlight.farm.frames import file_of
from shlight.farm.pictures import boxes_of, picture_of
from shlight.farm.tls import is_loopback

PIXELS = np.random.default_rng(1).random((100, 130, 5), dtype=np.float32)
WHOLE = Picture(3, "", Path(), (130, 100), "abc", (None,))


def test_frames_and_files() -> None:
    assert parse_frames("7") == [7]
    assert parse_frames("1-10:4,2") == [1, 2, 5, 9]
    for text in ("", "5-3", "1-", "a", "1-5:0", "-1", "1-9999999"):
        with pytest.raises(ValueError, match="frames must be"):
            parse_frames(text)
    assert file_of("a/x_###.exr", 7, "_L") == Path("a/x_007_L.exr")
    assert file_of("x#", 12, "") == Path("x12.exr")


def test_tiles_cover_a_picture_once() -> None:
    seen = np.zeros((100, 130), dtype=int)
    for box in boxes_of((130, 100), 64):
        assert box is not None
        seen[box[1] : box[3], box[0] : box[2]] += 1
    assert (seen == 1).all()
    assert len(boxes_of((16384, 4096), None)) == 64


def test_what_decides_about_pixels_is_in_a_files_key() -> None:
    source: Any = SimpleNamespace(key="scene", size=(130, 100))
    other: Any = SimpleNamespace(key="other scene", size=(130, 100))
    asked = [(source, 1, "", None), (other, 1, "", None), (source, 2, "", None), (source, 1, "R", None)]
    asked.append((source, 1, "", 64))
    assert len({picture_of(own, frame, view, Path("x.exr"), tile).key for own, frame, view, tile in asked}) == 5


@pytest.mark.parametrize("tile", [0, 64])
def test_files_are_known_when_they_are_whole(tmp_path: Path, tile: int) -> None:
    picture = replace(WHOLE, path=tmp_path / "x.exr", boxes=boxes_of((130, 100), tile))
    assert not files.is_whole(picture)
    names = ("A.R", "A.G", "A.B", "A.A", "A.Z")
    if tile:
        tiled = files.TiledFile(picture)
        for box in reversed(picture.boxes):
            assert box is not None
            assert not picture.path.exists()
            tiled.add(box, Rendered(names, PIXELS[box[1] : box[3], box[0] : box[2]]))
    else:
        files.write(picture.path, files.encode(picture, Rendered(names, PIXELS)))
    np.testing.assert_array_equal(images.read_exr(picture.path), PIXELS)
    assert files.is_whole(picture)
    assert not files.is_whole(replace(picture, key="abd"))
    picture.path.write_bytes(picture.path.read_bytes()[:-50])
    assert not files.is_whole(picture)


def test_a_full_disk_leaves_nothing(tmp_path: Path) -> None:
    """The system refuses files of more than 64 KB, as it does on a disk without room."""
    code = """if True:
        import resource, sys, numpy as np
        from pathlib import Path
        from shlight.farm import files
        resource.setrlimit(resource.RLIMIT_FSIZE, (65536, 65536))
        try:
            files.write(Path(sys.argv[1]) / "x.exr", bytes(200000))
        except OSError as error:
            print(error.strerror)
    """
    run = subprocess.run([sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=True)
    assert run.stdout == "File too large\n"
    assert not list(tmp_path.iterdir())


def test_a_large_scale_is_no_forgotten_percent_sign(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    scales: list[float] = []

    def render_frames(*_: Any, scale: float, **__: Any) -> Outcome:
        scales.append(scale)
        return Outcome()

    monkeypatch.setattr(command, "render_frames", render_frames)
    options = ["x.blend", "--frames", "1", "--out", "x.exr", "--scale"]
    assert command.main([*options, "25"]) == 2
    assert "for percent write 25%, or --force" in capsys.readouterr().err
    assert command.main([*options, "wide"]) == 2
    assert "'wide' is no factor such as 0.5 or 50%" in capsys.readouterr().err
    for given in (["25%"], ["4"], ["400%"], ["25", "--force"]):
        assert command.main([*options, *given]) == 0
    assert scales == [0.25, 4, 4, 25]


def test_the_farm_without_dask() -> None:
    code = "import sys; sys.modules['distributed'] = None; from shlight.farm.command import main; sys.exit(main())"
    options = ["x.blend", "--frames", "1-2", "--workers", "2", "--out", "x#.exr"]
    run = subprocess.run([sys.executable, "-c", code, *options], capture_output=True, text=True)
    assert run.returncode == 1
    assert run.stderr == "shlight render: Dask distributed is missing: pip install 'shlight[farm]'\n"


def test_coefficients_of_the_example() -> None:
    pytest.importorskip("distributed")
    example = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "lights_on_a_cluster.py"))
    spheres = example["lights"](5000).rechunk((1000, 4))
    found = example["coefficients"](spheres).compute(scheduler="sync")
    values = spheres.compute(scheduler="sync")
    np.testing.assert_array_equal(found, shlight.sphere_coefficients(values[:, :3], values[:, 3], 4, dtype=np.float32))


@pytest.mark.parametrize(
    ("address", "own"),
    [
        ("tcp://127.0.0.1:8786", True),
        ("localhost:8786", True),
        ("tls://[::1]:8786", True),
        ("inproc://1/2", True),
        ("tcp://127.0.0.1.farm.example:8786", False),
        ("tcp://192.168.0.2:8786", False),
        ("tcp://farm:8786", False),
        ("", False),
    ],
)
def test_schedulers_on_this_machine_are_known(address: str, own: bool) -> None:
    assert is_loopback(address) == own
