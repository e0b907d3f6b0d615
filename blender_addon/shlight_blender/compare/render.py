# SPDX-License-Identifier: GPL-3.0-or-later
"""The process in which Blender renders a scene with shlight, with Cycles in the same time, and with Cycles for long.

It leaves shlight.npy, cycles_same_time.npy and reference.npy in its folder: float32 (height, width, 4), linear, row 0
on top. Its figures are "shlight", "cycles_same_time" and "reference"; shlight's are known, and its picture is there,
before Cycles renders. `serving` has the messages.

The panel's also leaves difference.npy (height, width), and its figures have "differences". Where no time is given for
a reference there is none, and "rel_mse_of_both".
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import bpy
import numpy as np

from shlight import metrics

from .. import record
from .. import register as register_addon
from ..background import (
    Bounces,
    few_pixels,
    kept,
    last_picture,
    leave_plain,
    load_unsaved_images,
    open_blend,
    use_cycles,
    use_denoiser,
)
from ..export.materials import read_material
from ..export.nodes import Surroundings
from ..names import name_of
from ..report import ExportReport
from ..running import ENGINE
from ..worker_process import Channel, SceneError, serve
from .measure import Image, add_measurements, largest_differences
from .places import Finder, show_what_is_rendered
from .reference import Request, SampleTime, calibrate, render_halves, rounds_for

# Random seeds; no two pictures of Cycles may share one.
SEED_SAME_TIME, SEEDS_OF_HALVES = 0, (1, 2)
# Rays that find an object in their way, other than the camera's.
LIGHT_RAYS = ("visible_diffuse", "visible_glossy", "visible_shadow")
MOST_MARKERS = 5
# Samples from which two pictures tell their noise, and the time that each of them may take for so many.
ENOUGH_FOR_NOISE, NOISE_SECONDS = 16, 5.0


class Worker:
    """One scene, the folder for its pictures, and the channel to whoever asked for them."""

    REFUSES_DARK = True  # scenes in which shlight finds no light

    def __init__(self, request: Request, folder: Path, channel: Channel) -> None:
        self._request = request
        self._folder = folder
        self._channel = channel
        self._scene: Any = None
        self.pictures: dict[str, Image] = {}

    def figures(self) -> dict[str, Any]:
        """Renders and measures all, and returns the figures."""
        self._channel.stage("Opening the scene")
        self._scene = self._open()
        bpy.ops.preferences.addon_enable(module="cycles")
        register_addon()
        self._set_up()
        figures = self._circumstances()
        figures["shlight"] = self._shlight()
        height, width = self.pictures["shlight"].shape[:2]
        figures["size"] = [width, height]
        time_of = self._same_time(figures)
        halves = self._halves(figures, time_of)
        self._channel.stage("Measuring")
        try:
            self._measure(figures, halves)
        except ValueError as error:  # black or not finite
            raise RuntimeError(str(error)) from error
        return figures

    def _circumstances(self) -> dict[str, Any]:
        return {
            "scene": {"name": name_of(self._scene), "frame": self._scene.frame_current},
            "threads": self._scene.render.threads,
            "blender": bpy.app.version_string,
        }

    def _open(self) -> Any:
        """Opens the scene."""
        raise NotImplementedError

    def _set_up(self) -> None:
        """Settings that all renders share."""
        leave_plain(self._scene.render)

    def _shlight(self) -> dict[str, Any]:
        """shlight's picture, and what it reports of it. A first render of few pixels fills its tables."""
        self._channel.stage("Rendering with shlight")
        try:
            with few_pixels(self._scene.render):
                warm_up_seconds = self._render_shlight()
            seconds = self._render_shlight()
        except RuntimeError as error:
            if record.last.scene_error:
                raise SceneError(record.last.scene_error) from error
            raise
        if record.last.dark and self.REFUSES_DARK:
            raise SceneError(record.last.dark)
        self._take("shlight")
        figures = {**described(record.last), "warm_up_seconds": warm_up_seconds, "times": [seconds], "seconds": seconds}
        self._channel.known(shlight=figures)
        return figures

    def _same_time(self, figures: dict[str, Any]) -> SampleTime:
        """Cycles at the samples that take shlight's time; what takes little time is repeated in turns."""
        ours = figures["shlight"]["times"]
        target = ours[0]
        self._channel.stage("Cycles, finding the samples for the same time", target / 2)
        time_of = calibrate(self._render_same_time, target, self._request.samples)
        samples = min(time_of.samples(target), self._request.samples)
        rounds = rounds_for(target)
        again = f", and in turns with shlight {rounds - 1} times more" if rounds > 1 else ""
        self._channel.stage(f"Cycles, same time: {samples} samples{again}", (2 * rounds - 1) * target)
        theirs = [self._render_same_time(samples)]
        self._take("cycles_same_time")
        for _ in range(rounds - 1):
            ours.append(self._render_shlight())
            theirs.append(self._render_same_time(samples))
        time_of.add(samples, median(theirs))
        figures["shlight"]["seconds"] = median(ours)
        figures["cycles_same_time"] = {"samples": samples, "seconds": median(theirs), "times": theirs}
        return time_of

    def _halves(self, figures: dict[str, Any], time_of: SampleTime) -> list[Image]:
        """The reference, as two independent pictures of Cycles, which tell its noise."""
        request = self._request
        expected = 2 * time_of.seconds((request.samples + 1) // 2)
        seconds = min(expected, request.reference_seconds or expected)
        self._channel.stage(f"Reference, at most {request.samples} samples", seconds)
        with _kept_scene(self._scene.render):
            halves, figures["reference"] = render_halves(
                self._part_of_half, time_of, request.samples, request.reference_seconds, request.noise
            )
        figures["reference"]["seeds"] = SEEDS_OF_HALVES
        return halves

    def _measure(self, figures: dict[str, Any], halves: list[Image]) -> None:
        """Leaves the reference, and adds the errors to the figures. ValueError if it is black or not finite."""
        self._leave("reference", add_measurements(figures, self.pictures, (halves[0], halves[1])))

    def _render_shlight(self) -> float:
        self._scene.render.engine = ENGINE
        return _render()

    def _render_same_time(self, samples: int) -> float:
        return self._render_cycles(samples, SEED_SAME_TIME, denoise=self._request.denoise)

    def _render_cycles(self, samples: int, seed: int, **further: Any) -> float:
        use_cycles(self._scene, samples, seed, bounces_of(self._scene), **further)
        with nullcontext() if self._scene.shlight.use_shadows else without_shadows():
            return _render()

    def _part_of_half(self, half: int, first: int, samples: int) -> tuple[float, Image]:
        """See reference.Render. The time that it takes to hand the picture out counts too."""
        start = time.perf_counter()
        self._render_cycles(samples, SEEDS_OF_HALVES[half], first=first, of=(self._request.samples + 1) // 2)
        image = self._picture()
        return time.perf_counter() - start, image

    def _picture(self) -> Image:
        """The picture of the last render."""
        return last_picture(self._scene, self._folder / "picture.exr")

    def _take(self, name: str) -> None:
        """Leaves the picture of the last render."""
        self._leave(name, self._picture())

    def _leave(self, name: str, picture: Image) -> None:
        self.pictures[name] = picture
        np.save(self._folder / f"{name}.npy", picture)


def described(made: record.RenderRecord) -> dict[str, Any]:
    """What is known of a render with shlight."""
    statistics = made.statistics
    figures = {
        "settings": made.settings,
        "unsupported": made.messages,
        "export_seconds": made.export_seconds,
        "order_shares": {str(order): share for order, share in statistics.order_shares.items()},
        "operations": made.operations,
        "texture_bytes": made.texture_bytes,
    }
    same = ("build_seconds", "render_seconds", "stage_seconds", "cubature_share", "mirror_share", "over_tolerance")
    return figures | {name: getattr(statistics, name) for name in (*same, "hits", "shadow_rays")}


def _render() -> float:
    """Blender's own render call: wall time from the scene in Blender to the finished picture."""
    start = time.perf_counter()
    bpy.ops.render.render()
    return time.perf_counter() - start


def bounces_of(scene: Any) -> Bounces:
    """The bounces that shlight renders."""
    settings = scene.shlight
    return settings.max_bounces, settings.glossy_bounces, settings.transmission_bounces


@contextmanager
def _kept_scene(render: Any) -> Iterator[None]:
    """Cycles builds its scene once for all renders within."""
    before, render.use_persistent_data = render.use_persistent_data, True
    try:
        yield
    finally:
        render.use_persistent_data = before


@contextmanager
def without_shadows() -> Iterator[None]:
    """Meanwhile surfaces that do not glow are seen by the camera alone, and no light that Cycles follows meets them."""
    surfaces = [seen for seen in bpy.data.objects if seen.type != "LIGHT" and not _glows(seen)]
    with kept(surfaces, *LIGHT_RAYS):
        for seen in surfaces:
            seen.visible_diffuse = seen.visible_glossy = seen.visible_shadow = False
        yield


def _glows(seen: Any) -> bool:
    materials = (slot.material for slot in seen.material_slots)
    return any(read_material(material, ExportReport(), Surroundings()).emits() for material in materials)


@dataclass(frozen=True, kw_only=True)
class PanelRequest(Request):
    """A request of the panel; `scene` is its copy of the file."""

    scene_name: str
    view_layer: str
    use_scripts: bool  # of the file
    light: str = "ALL"  # or DIRECT
    images: dict[str, str] = field(default_factory=dict)  # see background.save_unsaved_images
    measured: dict[str, str] = field(default_factory=dict)  # files by names of materials


class PanelWorker(Worker):
    """A frame as F12 would render it; the scene is a copy of the file."""

    _request: PanelRequest

    def _open(self) -> Any:
        request = self._request
        open_blend(Path(request.scene), use_scripts=request.use_scripts)
        load_unsaved_images(request.images, self._folder)
        scene = bpy.context.window.scene = bpy.data.scenes[request.scene_name]
        bpy.context.window.view_layer = scene.view_layers[request.view_layer]
        for layer in scene.view_layers:
            layer.use = layer.name == request.view_layer
        return scene

    def _set_up(self) -> None:
        super()._set_up()
        for material in bpy.data.materials:
            if path := self._request.measured.get(name_of(material)):
                material.shlight.measured_file = path
        self._scene.render.use_crop_to_border = True
        if self._request.light == "DIRECT":
            self._scene.shlight.max_bounces = 0
        if self._request.denoise:
            use_denoiser(self._scene.cycles)  # its absence is said before anything is rendered

    def _halves(self, figures: dict[str, Any], time_of: SampleTime) -> list[Image]:
        """The reference, or two pictures that take as long as shlight's or longer and tell Cycles' noise."""
        if self._request.reference_seconds > 0:
            return super()._halves(figures, time_of)
        same = figures["cycles_same_time"]["samples"]
        samples = max(same, min(ENOUGH_FOR_NOISE, time_of.samples(NOISE_SECONDS)))
        is_half = samples == same and not self._request.denoise
        halves = [self.pictures["cycles_same_time"]] if is_half else []
        seeds = SEEDS_OF_HALVES[len(halves) :]
        self._channel.stage("Cycles' noise", len(seeds) * time_of.seconds(samples))
        for seed in seeds:
            self._render_cycles(samples, seed)
            halves.append(self._picture())
        return halves

    def _measure(self, figures: dict[str, Any], halves: list[Image]) -> None:
        shlight, against = self.pictures["shlight"], self.pictures["cycles_same_time"]
        if "reference" in figures:
            super()._measure(figures, halves)
            against = self.pictures["reference"]
        else:
            figures["rel_mse_of_both"] = metrics.rel_mse(shlight, against)
        self._leave("difference", metrics.relative_difference(shlight, against).astype(np.float32))
        figures["differences"] = self._places(shlight, halves)

    def _places(self, shlight: Image, halves: list[Image]) -> list[dict[str, Any]]:
        """The largest differences, one for each thing that is seen there."""
        layer = bpy.context.window.view_layer
        show_what_is_rendered(layer)
        finder = Finder(self._scene, layer)
        found: dict[str, dict[str, Any]] = {}
        for difference in largest_differences(shlight[::-1], (halves[0][::-1], halves[1][::-1])):
            seen = finder.seen_at(difference.x, difference.y)
            place = {"x": difference.x, "y": difference.y, "difference": difference.value}
            found.setdefault(seen.place, place | seen.to_data(record.last.report))
        return list(found.values())[:MOST_MARKERS]


def main(arguments: list[str]) -> None:
    """Serves the request of a folder."""
    serve(
        lambda given, folder, channel: PanelWorker(PanelRequest(**given), folder, channel).figures(),
        arguments,
    )
