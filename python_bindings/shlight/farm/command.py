# SPDX-License-Identifier: MIT
"""Renders frames of a scene to OpenEXR files, in processes on this machine or on a farm, or a model to a picture."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from shlight.commands import CommandError, Parser, run_command
from shlight.farm.frames import parse_frames
from shlight.farm.render import render_frames
from shlight.farm.tls import Tls
from shlight.stills import SIZE, is_still, render_still

LARGEST_FACTOR = 4.0  # a larger one is taken for a percentage whose sign was forgotten


def main(argv: list[str] | None = None) -> int:
    """Runs the command; its exit code: 2 for a request that cannot be met, 1 where frames failed."""
    arguments = sys.argv[1:] if argv is None else argv
    return run_command(
        "shlight render", lambda: _work(arguments), when_interrupted="the files that are there are whole"
    )


def _work(arguments: list[str]) -> None:
    values = vars(_parser().parse_args(arguments))
    size, environment = values.pop("size"), values.pop("environment")
    if is_still(scene := Path(values["scene"])):
        _render_still(scene, values, size, environment)
        return
    if size or environment:
        raise CommandError("--size and --environment are for models and scripts that use shlight", 2)
    tls = [values.pop(name) for name in ("tls_ca", "tls_cert", "tls_key")]
    if any(tls) and not all(tls):
        raise CommandError("--tls-ca, --tls-cert and --tls-key belong together", 2)
    try:
        outcome = render_frames(
            values.pop("scene"),
            values.pop("frames"),
            values.pop("out"),
            views=[name for names in values.pop("views") for name in names.split(",")],
            settings=dict(values.pop("settings")),
            scale=_scale(values.pop("scale"), values["force"]),
            tls=Tls(*tls) if all(tls) else None,
            **values,
        )
    except ValueError as error:
        raise CommandError(str(error), 2) from None
    if outcome.failed:
        raise CommandError(f"{len(outcome.failed)} failed; the same command renders them again", 1)


def _render_still(scene: Path, values: dict[str, Any], size: tuple[int, int] | None, environment: str | None) -> None:
    scale = _scale(values["scale"], values["force"])
    width, height = (max(1, round(side * scale)) for side in size or SIZE)
    try:
        render_still(
            scene,
            Path(values["out"]),
            size=(width, height),
            environment=None if environment is None else Path(environment),
            settings=dict(values["settings"]),
            threads=values["threads"] or 0,
        )
    except (ValueError, ImportError) as error:
        raise CommandError(str(error), 2) from None


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit() and int(width) > 0 and int(height) > 0):
        raise argparse.ArgumentTypeError(f"'{text}' is no size such as 1280x720")
    return int(width), int(height)


def _frames(text: str) -> list[int]:
    try:
        return parse_frames(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _setting(text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    if not name or not sign:
        raise argparse.ArgumentTypeError(f"'{text}' is no setting such as shlight.noise_threshold=0.005")
    return name, value


def _scale(text: str, force: bool) -> float:
    percent = text.endswith("%")
    try:
        factor = float(text.removesuffix("%")) / (100.0 if percent else 1.0)
    except ValueError:
        raise CommandError(f"--scale: '{text}' is no factor such as 0.5 or 50%", 2) from None
    if factor > LARGEST_FACTOR and not percent and not force:
        raise CommandError(
            f"--scale {text} is {text} times the width and height; for percent write {text}%, or --force", 2
        )
    return factor


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="shlight render",
        description="Renders frames of a Blender scene to OpenEXR or PNG files: in processes on this machine, or on "
        "the workers of a Dask scheduler. Frames whose files are whole and of this scene and these settings are kept. "
        "Of a model (.glb, .gltf, .obj, .ply), or a script that builds a shlight.Scene, it renders one picture.",
    )
    add: Any = parser.add_argument
    add("scene", help="a Blender file, a script with a function build_scene(), or a model")
    add("--frames", type=_frames, metavar="A-B[:STEP]", help="frames such as 7, 1-250, 1-250:10 or 1,5,9 (default: "
        "the one at which the file was saved)")  # fmt: skip
    add("--out", required=True, metavar="FILE", help="files such as shot_####.exr; #### becomes the frame. .png: for "
        "display, with the scene's view transform")  # fmt: skip
    add("--size", type=_size, metavar="WxH", help="of the picture of a model, in pixels (default: 960x640)")
    add("--environment", metavar="FILE", help="a picture of all directions around a model, such as sky.exr or sky.hdr")
    add("--views", action="append", default=[], metavar="NAME,…", help="views of the scene, or cameras (default: all "
        "views, or the scene's camera)")  # fmt: skip
    add("--scale", default="1", metavar="X", help="of width and height, such as 0.5 or 50%%; above 4 as percent only")
    add("--set", type=_setting, action="append", default=[], dest="settings", metavar="NAME=VALUE", help="a property "
        "of the scene, such as shlight.noise_threshold=0.005; of a model a keyword of shlight.render")  # fmt: skip
    add("--tile", type=int, metavar="N", help="side of the tiles of a picture, 0: none (default: 1024 for more than "
        "2^24 pixels)")  # fmt: skip
    add("--force", action="store_true", help="render frames whose files are whole too, at any --scale")
    add("--retries", type=int, default=1, metavar="N", help="of a frame that has failed (default: %(default)s)")
    add(
        "--threads",
        type=int,
        metavar="N",
        help="of each worker (default: all cores, shared by workers here)",
    )
    group: Any = parser.add_argument_group("workers").add_argument
    group("--workers", type=int, metavar="N", help="processes on this machine, 0: one without Dask "
          "(default: one for each core, and none for a single picture)")  # fmt: skip
    group("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://host:8786 or tls://host:8786")
    group("--insecure", action="store_true", help="reach a scheduler elsewhere without TLS, in a network of your own")
    group("--send", action="store_true", help="send the file, its textures and libraries to workers")
    for name, text in (("ca", "authority that has signed"), ("cert", "own certificate"), ("key", "its key")):
        group(f"--tls-{name}", metavar="FILE", help=f"{text}, PEM; all connections are encrypted")
    return parser
