# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws docs/images/osl.jpg: one sample of Cycles with lamps, and with them in materials; prints times.

PYTHONPATH=python_bindings:blender_addon .venv/bin/python docs/figures/osl_figure.py        (two minutes)

The two pictures to the left have direct light alone, those to the right a bounce more.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import bpy
import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests" / "blender"))
from studio import Studio  # noqa: E402

import shlight_blender  # noqa: E402
from shlight.images import read_layers  # noqa: E402
from shlight.metrics import rel_mse  # noqa: E402
from shlight_blender import compat  # noqa: E402

WIDTH, HEIGHT, SAMPLES = 320, 200, 17
LAMPS = [((-1.6, -0.8, 1.9), (1.0, 0.75, 0.5)), ((2.2, -1.0, 2.4), (0.5, 0.7, 1.0)), ((0.2, 2.2, 2.6), (0.8, 1.0, 0.8))]


def build(studio: Any) -> None:
    """A floor with a pattern and three balls under three lamps without shadows."""
    floor = studio.material(Color=(0.6, 0.6, 0.6))
    pattern = floor.node_tree.nodes.new("ShaderNodeTexChecker")
    pattern.inputs["Scale"].default_value = 12.0
    pattern.inputs["Color1"].default_value, pattern.inputs["Color2"].default_value = (0.7,) * 4, (0.35,) * 4
    floor.node_tree.links.new(pattern.outputs[0], floor.node_tree.nodes[0].inputs["Color"])
    studio.plane(12.0, floor)
    for number, roughness in enumerate((0.3, 0.45, 0.6)):
        metal = studio.material("ShaderNodeBsdfGlossy", Color=(0.9, 0.75, 0.5), Roughness=roughness)
        studio.ball(0.6, metal, rings=48, location=(1.4 * (number - 1), 0.0, 0.6))
    for place, color in LAMPS:
        studio.lamp("POINT", 150.0, place, color=color, shadow_soft_size=0.4, visible_camera=False, use_shadow=False)
    studio.camera((0.5, -5.5, 3.0), (0.0, 0.0, 0.3), lens=55)
    studio.resolution(WIDTH, HEIGHT)
    studio.scene.view_layers[0].use_pass_emit = True
    compat.choose_layers(studio.scene.render.image_settings)


def rendered(studio: Any, samples: int, bounces: int) -> dict[str, Any]:
    """The passes of a picture, and the seconds of processors that it took."""
    studio.scene.cycles.samples, studio.scene.cycles.max_bounces = samples, bounces
    begin = time.process_time()
    path = studio.write("CYCLES")
    return {"seconds": time.process_time() - begin, **read_layers(path)}


def main() -> None:
    shlight_blender.register()
    with tempfile.TemporaryDirectory() as folder:
        studio = Studio(Path(folder))
        build(studio)
        truth = [rendered(studio, 256, bounces)["combined"][..., :3] for bounces in (0, 1)]
        lamps = [rendered(studio, 1, 0), rendered(studio, 1, 1)]
        seconds = {"lamps": [lamps[1]["seconds"], rendered(studio, SAMPLES, 1)["seconds"]]}
        for each in studio.scene.objects:
            each.select_set(True)
        bpy.ops.shlight.osl_insert()
        # Rays that end still see what emits, so that lamps need a bounce more for the same light.
        emitted = rendered(studio, 1, 0)
        seconds["in materials"] = [emitted["seconds"], rendered(studio, SAMPLES, 0)["seconds"]]
    for name, (one, many) in seconds.items():
        each = (many - one) / (SAMPLES - 1) / (WIDTH * HEIGHT)
        print(f"{name}: {one:.2f} s for one sample, {1e6 * each:.2f} µs for each further one of a pixel")
    pictures = (lamps[0]["combined"], emitted["emission"], lamps[1]["combined"], emitted["combined"])
    mpl.rcParams["font.size"] = 9
    figure = Figure((9.6, 1.9), layout="constrained")
    for number, (axis, picture) in enumerate(zip(figure.subplots(1, 4), pictures, strict=True)):
        error = rel_mse(picture[..., :3], truth[number // 2])
        axis.imshow(np.clip(picture[..., :3], 0.0, 1.0) ** (1 / 2.2))
        axis.set_title(f"{('sampled', 'in materials')[number % 2]}, relMSE {error:.0e}")
        axis.axis("off")
    figure.savefig(ROOT / "docs" / "images" / "osl.jpg", dpi=130, pil_kwargs={"quality": 90})


if __name__ == "__main__":
    main()
