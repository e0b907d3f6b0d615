# SPDX-License-Identifier: GPL-3.0-or-later
"""A world of any nodes as a lat-long picture and suns, rendered by Cycles in a Blender of its own.

A render cannot start another one in the same process. `bake_worker` runs in the other one and says how it measures.
What was baked is kept as long as Blender runs; `bake_key` says what a world must share with it.
"""

from __future__ import annotations

import atexit
import tempfile
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..background import command, environment, save_unsaved_images
from ..names import one_line
from ..worker_process import WorkerError, WorkerProcess
from .bake_key import bake_key
from .nodes import all_nodes

WORKER = "export.bake_worker"
BAKED = "baked.npz"  # the file that it leaves; rows of suns are their directions, angles and irradiances
LONGEST_SECONDS = 1800.0
TICK_SECONDS = 0.1
MOST_KEPT_BYTES = 2**28  # ten pictures 2048 texels wide; the last one is kept whatever its size

# Called with what is being done while time passes; False: stop it.
Waiting = Callable[[str], bool]


class BakeError(Exception):
    """The world was not baked; the message says why."""


@dataclass(frozen=True)
class Sun:
    """The disc of a sky: what `shlight.Scene.add_sun_light` takes."""

    direction: NDArray[np.float64]  # (3,), the way its light travels
    angle: float  # its diameter [rad]
    irradiance: NDArray[np.float64]  # RGB [W m^-2], at right angles to its direction


@dataclass(frozen=True)
class Baked:
    """A world without its suns, and these."""

    picture: NDArray[np.float32]  # (width / 2, width, 3), as `shlight.Scene.set_environment` takes it
    suns: list[Sun] = field(default_factory=list)


kept: OrderedDict[bytes, Baked] = OrderedDict()  # by their keys, the last used at the end


def bake_world(world: Any, scene: Any, waiting: Waiting | None = None) -> Baked | None:
    """The world at the scene's current frame, `scene.shlight.world_width` texels wide; None if `waiting` stopped it.

    A world that is kept is not baked again; its picture must not be written to.
    Raises BakeError if the other Blender cannot be started, fails, or takes longer than half an hour.
    """
    key = bake_key(world, scene)
    if (found := _found(key)) is not None:
        return found
    with tempfile.TemporaryDirectory(prefix="shlight_world_") as name:
        baked = _baked(_request(Path(name), world, scene), Path(name), waiting)
    # Edits during the bake may be in the picture and not in the key.
    if baked is not None and key is not None and bake_key(world, scene) == key:
        _keep(key, baked)
    return baked


def _keep(key: bytes, baked: Baked) -> None:
    baked.picture.flags.writeable = False
    kept[key] = baked
    while len(kept) > 1 and sum(each.picture.nbytes for each in kept.values()) > MOST_KEPT_BYTES:
        kept.popitem(last=False)


def _found(key: bytes | None) -> Baked | None:
    if key is None or key not in kept:
        return None
    kept.move_to_end(key)
    return kept[key]


def kept_world(world: Any, scene: Any) -> Baked | None:
    """The world if it is kept."""
    return _found(bake_key(world, scene))


class _Background:
    """The bake that goes on while Blender is used."""

    def __init__(self, key: bytes, world: Any, scene: Any) -> None:
        self.key = key
        self.ended: list[Callable[[], None]] = []  # called from its thread
        self.error = ""
        self._stopped = False
        self._folder = tempfile.TemporaryDirectory(prefix="shlight_world_")
        self._request = _request(Path(self._folder.name), world, scene)
        self._thread = threading.Thread(target=self._run, name="shlight world", daemon=True)
        self._thread.start()
        atexit.register(self._end)  # else the other Blender would go on

    def stop(self) -> None:
        self._stopped = True

    def _end(self) -> None:
        self.stop()
        self._thread.join()

    def _run(self) -> None:
        with self._folder as name:
            try:
                baked = _baked(self._request, Path(name), lambda _: not self._stopped)
            except BakeError as error:
                baked, self.error = None, str(error)
        atexit.unregister(self._end)
        if baked is not None:
            _keep(self.key, baked)
        for call in self.ended if not self._stopped else ():
            call()


_background: _Background | None = None  # the latest


def bake_in_background(world: Any, scene: Any, ended: Callable[[], None]) -> Baked | None:
    """The world if it is kept; None while it is baked beside Blender, which ends the bake of another one.

    ended: called from another thread once it has been baked, or could not be.
    Raises BakeError if it cannot be baked, or is not known again.
    """
    global _background
    key = bake_key(world, scene)
    if key is None:
        raise BakeError("it uses something whose changes cannot be told; final renders bake it each time")
    if (found := _found(key)) is not None:
        return found
    if _background is None or _background.key != key:
        if _background is not None:
            _background.stop()
        _background = _Background(key, world, scene)
    if _background.error:
        raise BakeError(_background.error)
    _background.ended.append(ended)
    return None


def _request(folder: Path, world: Any, scene: Any) -> dict[str, Any]:
    """The request to the other Blender, whose files are written to `folder`."""
    try:
        bpy.data.libraries.write(str(folder / "world.blend"), {world.original}, path_remap="ABSOLUTE")
        images = {node.image.original for node in all_nodes(world.node_tree) if getattr(node, "image", None)}
        return {
            "world": world.original.name,
            "frame": scene.frame_current,
            "subframe": scene.frame_subframe,
            "width": scene.shlight.world_width,
            "threads": scene.render.threads if scene.render.threads_mode == "FIXED" else 0,
            "images": save_unsaved_images(images, folder),
        }
    except UnicodeDecodeError as error:
        raise BakeError("its name, or that of an image in it, is not UTF-8; rename it") from error
    except (OSError, RuntimeError, ValueError) as error:
        raise BakeError(one_line(error)) from error


def _baked(request: dict[str, Any], folder: Path, waiting: Waiting | None) -> Baked | None:
    """The other Blender's answer to the request; None if `waiting` stopped it."""
    end = time.monotonic() + LONGEST_SECONDS
    try:
        worker = WorkerProcess(command(WORKER), request, folder, environment())
        try:
            while worker.result(TICK_SECONDS) is None:
                if waiting is not None and not waiting("Baking the world"):
                    return None
                if time.monotonic() > end:
                    raise BakeError(f"it takes longer than {LONGEST_SECONDS:.0f} s")
        finally:
            worker.end()
        with np.load(folder / BAKED, allow_pickle=False) as found:
            return Baked(found["picture"], [Sun(row[:3], float(row[3]), row[4:]) for row in found["suns"]])
    except (WorkerError, OSError, ValueError) as error:
        raise BakeError(one_line(error)) from error
