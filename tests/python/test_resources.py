# SPDX-License-Identifier: MIT
"""What happens where the disk, the memory or the time of a process ends: nothing that is half, no crash, no hang."""

from __future__ import annotations

import errno
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene_cases import lit_floor

import shlight
from shlight import images
from shlight.farm import Picture, Rendered, command, files
from shlight.farm.pictures import boxes_of

PIXELS = np.random.default_rng(1).random((70, 130, 4), dtype=np.float32)
TILED = Picture(1, "", Path(), (130, 70), "key", boxes_of((130, 70), 64))
SETTINGS: dict[str, Any] = {"pixel_samples": 4, "max_bounces": 1}
SECONDS = 60  # for another process to end


def write_tiles(path: Path, pixels: np.ndarray) -> None:
    target = files.TiledFile(replace(TILED, path=path))
    try:
        for left, top, right, bottom in filter(None, TILED.boxes):
            target.add((left, top, right, bottom), Rendered(("R", "G", "B", "A"), pixels[top:bottom, left:right]))
    finally:
        target.drop()


def write_frame(path: Path, pixels: np.ndarray) -> None:
    whole = replace(TILED, path=path, boxes=(None,))
    files.write(path, files.encode(whole, Rendered(("R", "G", "B", "A"), pixels)))


WRITERS: dict[str, Callable[[Path, np.ndarray], None]] = {
    "image.exr": images.write_exr,
    "image.png": lambda path, pixels: images.write_png(path, images.linear_to_srgb8(pixels)),
    "layers.exr": lambda path, pixels: images.write_layers(path, {"combined": pixels, "depth": pixels[..., :1]}),
    "tiles.exr": write_tiles,
    "frame.exr": write_frame,
}


@contextmanager
def room(size: int) -> Iterator[None]:
    """Files can be no longer than this, as on a disk with no more room."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("name", WRITERS)
def test_a_full_disk_leaves_what_was_there(tmp_path: Path, name: str) -> None:
    """Also where only the last byte has no room, which OpenImageIO would not say."""
    path = tmp_path / name
    WRITERS[name](path, PIXELS)
    whole = path.stat().st_size
    path.write_bytes(b"before")
    for size in (whole - 1, whole // 2, 100, 0):
        with room(size), pytest.raises(OSError, match=rf"{name}|{os.strerror(errno.EFBIG)}"):
            WRITERS[name](path, PIXELS)
        assert path.read_bytes() == b"before"
        assert [each.name for each in tmp_path.iterdir()] == [name]


def test_a_folder_that_is_read_only_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    own = os.geteuid()
    with tempfile.TemporaryDirectory() as folder:
        script, target = Path(folder, "scene.py"), Path(folder, "a.png")
        script.write_text("from scene_cases import lit_floor as build\nimport shlight\n")
        Path(folder).chmod(0o555)
        os.seteuid(own or 65534)  # root may write everywhere
        try:
            code = command.main([str(script), "--out", str(target), "--size", "8x8", "--set", "pixel_samples=1"])
        finally:
            os.seteuid(own)
        assert list(Path(folder).iterdir()) == [script]
    assert code == 2
    assert capsys.readouterr().err == f"shlight render: {target}: {os.strerror(errno.EACCES)}\n"


def start(code: str, *arguments: object) -> subprocess.Popen[str]:
    """Python with these lines, which know the tests' helpers."""
    path = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    given = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.Popen(
        given, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**os.environ, "PYTHONPATH": path}
    )


def ended(code: str, *arguments: object) -> tuple[int, str]:
    """The exit code and what was said."""
    process = start(code, *arguments)
    try:
        said, _ = process.communicate(timeout=SECONDS)
    finally:
        process.kill()
    return process.returncode, said


KILLED = """if True:
    import itertools, sys, numpy as np
    from shlight import images
    for number in itertools.count(1):
        images.write_exr(sys.argv[1], np.full((300, 300, 4), number, np.float32))
"""


def test_a_killed_process_leaves_whole_files(tmp_path: Path) -> None:
    path = tmp_path / "a.exr"
    for wait in (0.0, 0.013, 0.05):
        path.unlink(missing_ok=True)
        process = start(KILLED, path)
        while not path.exists():
            time.sleep(0.002)
        time.sleep(wait)
        process.kill()
        process.communicate()
        pixels = images.read_exr(path)
        assert pixels.shape == (300, 300, 4)
        assert (pixels == pixels[0, 0, 0]).all()


LITTLE_MEMORY = """if True:
    import resource
    from pathlib import Path
    import numpy as np, shlight
    from scene_cases import lit_floor
    directions = np.tile(np.float32([0, 0, 3]), (400000, 1))
    radii = np.full(400000, 0.5, np.float32)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + (60 << 20), -1))
    for call in (
        lambda: shlight.sh_basis(directions, 40),
        lambda: shlight.sphere_coefficients(directions, radii, 30),
        lambda: shlight.render(lit_floor(), 8000, 8000, max_bounces=0),
        lambda: shlight.render(lit_floor(), 32, 32, max_bounces=0, pixel_samples=1),
    ):
        try:
            print(call().shape)
        except MemoryError:
            print("MemoryError")
"""


def test_memory_that_is_too_little_is_an_error() -> None:
    """Also for Embree, and what follows has the memory that there is."""
    assert ended(LITTLE_MEMORY) == (0, 3 * "MemoryError\n" + "(32, 32, 4)\n")


FORKED = """if True:
    import os, signal, numpy as np, shlight
    from scene_cases import lit_floor
    def draw():
        return np.asarray(shlight.render(lit_floor(), 32, 32, pixel_samples=4, max_bounces=1))
    def child(expected=None):
        if (process := os.fork()) == 0:
            signal.alarm(20)
            os._exit(0 if expected is None or np.array_equal(draw(), expected) else 1)
        return os.waitpid(process, 0)[1]
    print(child(), child(draw()), draw().shape)
"""


def test_a_forked_process_renders() -> None:
    """After the import alone, and after a render; and the parent does afterwards."""
    assert ended(FORKED) == (0, "0 0 (32, 32, 4)\n")


def test_threads_and_nested_calls_do_not_change_a_bit() -> None:
    expected = np.asarray(shlight.render(lit_floor(), 16, 16, **SETTINGS))
    shared, found = lit_floor(), []

    def draw(*_: object) -> None:
        found.extend(np.asarray(shlight.render(scene, 16, 16, **SETTINGS)) for scene in (shared, lit_floor()))

    threads = [threading.Thread(target=draw) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(SECONDS)
    assert len(found) == 16
    for callback in ("on_update", "progress"):
        callbacks: Any = {callback: lambda *given: draw() if len(found) < 30 else None}
        found.append(np.asarray(shlight.render(shared, 16, 16, **SETTINGS, **callbacks)))
    assert len(found) >= 22
    for picture in found:
        np.testing.assert_array_equal(picture, expected)


DAEMON = """if True:
    import sys, threading, numpy as np, shlight
    from scene_cases import lit_floor
    started = threading.Semaphore(0)
    def draw():
        shlight.render(lit_floor(), 4000, 4000, pixel_samples=256, progress=lambda share: started.release())
    def evaluate():
        while True:
            shlight.sh_basis(np.tile(np.float32([0, 0, 1]), (100000, 1)), 30)
            started.release()
    for work in (draw, evaluate):
        threading.Thread(target=work, daemon=True).start()
    for _ in range(3):
        started.acquire()
    sys.exit(int(sys.argv[1]))
"""


@pytest.mark.parametrize("code", [0, 3])
def test_python_ends_while_daemon_threads_work(code: int) -> None:
    start_time = time.monotonic()
    assert ended(DAEMON, code) == (code, "")
    assert time.monotonic() - start_time < 20


@pytest.mark.parametrize(("threads", "first"), [(1, 50), pytest.param(0, 6000, marks=pytest.mark.slow)])
def test_renders_leave_no_memory_behind(threads: int, first: int, resident: Callable[[], int]) -> None:
    """first: renders until oneTBB has all that it keeps for threads to come, 32 MB."""
    before = 0
    for number in range(first + 200 + first // 4):
        shlight.render(lit_floor(), 16, 16, pixel_samples=1, max_bounces=0, threads=threads)
        if number == first:
            before = resident()
    assert resident() <= 1.03 * before
