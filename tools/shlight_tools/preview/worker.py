# SPDX-License-Identifier: MIT
"""The process that renders the scene of a command line with shlight and with Cycles; see shlight_blender.compare."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from shlight_blender.background import leave_plain, open_scene, set_threads
from shlight_blender.compare.render import Worker
from shlight_blender.worker_process import SceneError, serve

from .supervision import SceneRequest

DEFAULT_LONGER_SIDE = 512


class SceneWorker(Worker):
    """One scene with the settings of a command line."""

    _request: SceneRequest

    def _open(self) -> Any:
        return open_scene(Path(self._request.scene))

    def _set_up(self) -> None:
        prepare(self._scene, self._request)


def prepare(scene: Any, request: SceneRequest) -> None:
    """Settings that all renders share: frame, lamps, size, filter and shlight's, and nothing after the renderer."""
    if request.frame is not None:
        scene.frame_set(request.frame)
    if request.lights is not None:
        _leave_only(scene, request.lights)
    render = scene.render
    render.resolution_x, render.resolution_y = request.size or _default_size(render)
    render.resolution_percentage = 100
    render.use_border = False
    set_threads(render, request.threads)
    scene.cycles.pixel_filter_type = "BOX"  # both engines read it
    leave_plain(render)
    settings = scene.shlight
    for name in ("order", "tolerance", "pixel_samples", "max_bounces"):
        if (value := getattr(request, name)) is not None:
            setattr(settings, name, value)
    if request.render_seconds is not None:
        settings.time_limit = request.render_seconds
        settings.max_samples = max(settings.max_samples, request.samples)  # time and noise end it
    if request.shadow_rays is not None:
        settings.use_shadows = request.shadow_rays > 0
        settings.shadow_rays = max(request.shadow_rays, 1)


def _leave_only(scene: Any, names: list[str]) -> None:
    """Switches off all lamps but these."""
    lamps = {seen.name: seen for seen in scene.objects if seen.type == "LIGHT"}
    for name in names:
        if name not in lamps:
            raise SceneError(f"there is no lamp '{name}' in it, but {', '.join(lamps) or 'none'}")
    for name, lamp in lamps.items():
        lamp.hide_render = name not in names


def _default_size(render: Any) -> tuple[int, int]:
    scale = DEFAULT_LONGER_SIDE / max(render.resolution_x, render.resolution_y)
    return max(1, round(render.resolution_x * scale)), max(1, round(render.resolution_y * scale))


def serve_with(worker: type[SceneWorker], arguments: list[str]) -> None:
    """Serves the request of a folder."""
    serve(lambda given, folder, channel: worker(SceneRequest(**given), folder, channel).figures(), arguments)


if __name__ == "__main__":
    serve_with(SceneWorker, sys.argv[1:])
