# SPDX-License-Identifier: MIT
"""The command line of `./dev survey`."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shlight.commands import Parser

from ..preview.arguments import seconds, size, whole
from ..preview.supervision import SceneRequest

NOISE = 2e-4  # relMSE of the reference's own noise at which it ends
SUFFIXES = (".blend", ".gltf", ".glb")


@dataclass(frozen=True)
class Options:
    """A survey; `render` has what all files are rendered with."""

    folder: Path
    out: Path
    jobs: int
    time_limit: float
    worst: int
    resume: bool
    render: dict[str, Any]

    def of_file(self, path: Path) -> SceneRequest:
        """The request for the worker of this file."""
        return SceneRequest(scene=str(path), noise=NOISE, **self.render)


def parse(argv: list[str]) -> Options:
    """The options of a command line; prints the reason and raises SystemExit(2) where it is not understood."""
    values = vars(_parser().parse_args(argv))
    names = ("size", "threads", "max_bounces", "pixel_samples", "samples", "render_seconds", "reference_seconds")
    render = {name: values.pop(name) for name in names}
    folder = values.pop("folder")
    out = values.pop("out") or Path("out") / "survey" / (folder.name or folder.resolve().name)
    return Options(folder=folder, out=out, render=render, **values)


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="./dev survey",
        description="Renders every Blender and glTF file of a folder with shlight and with Cycles, "
        "and says of each how far the two differ. A file without camera or light gets one.",
    )
    add = parser.add_argument
    add("folder", type=Path, metavar="FOLDER", help=f"is searched, with the folders in it, for {', '.join(SUFFIXES)}")
    add("--size", type=size, default=(192, 192), metavar="WxH", help="pixels (default: 192x192)")
    add("--out", type=Path, metavar="DIR", help="folder of the results (default: out/survey/<folder's name>)")
    add("--resume", action="store_true", help="keep what the survey in --out has, and do the other files")
    add("--worst", type=whole(0), default=0, metavar="N", help="files on the contact sheet, at most; 0: all (default)")
    add("--jobs", type=whole(1), default=1, metavar="N", help="files at a time (default: %(default)s)")
    add("--max-bounces", type=whole(0), metavar="N", help="bounces of light, 0: direct light (default: the file's)")
    add("--threads", type=whole(0), default=0, metavar="N", help="threads of each render (default: 0, all cores)")
    add(
        "--time-limit",
        type=seconds,
        default=120.0,
        metavar="S",
        help="time for a file, which is given up after it; 0: no limit (default: %(default)g)",
    )
    add(
        "--render-seconds",
        type=seconds,
        default=40.0,
        metavar="S",
        help="time for shlight, whose picture then keeps the noise that it has; 0: no limit (default: %(default)g)",
    )
    add(
        "--samples", type=whole(1), dest="pixel_samples", metavar="N", help="camera rays of shlight per pixel, at least"
    )
    add(
        "--reference-samples",
        type=whole(2),
        dest="samples",
        default=4096,
        metavar="N",
        help="samples of Cycles, and camera rays of shlight per pixel, at most (default: %(default)s)",
    )
    add(
        "--reference-seconds",
        type=seconds,
        default=20.0,
        metavar="S",
        help=f"time for Cycles, which ends earlier once the relMSE of its noise is {NOISE:g}; 0: no limit "
        "(default: %(default)g)",
    )
    return parser
