# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of `shlight preview`."""

from __future__ import annotations

import argparse
import re
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from shlight.commands import Parser

DEFAULT_SCENE = "example_scene"
LARGEST_SIDE = 16384


@dataclass(frozen=True)
class Options:
    """What to render and how; None: as the scene has it."""

    scene: str  # a Blender file, a script with a function build_scene(), or the name of an example, as it was given
    out: str  # folder of the results
    lights: list[str] | None  # names of the lamps that shine
    size: tuple[int, int] | None
    frame: int | None
    samples: int  # of the reference, at most
    reference_seconds: float  # for the reference; 0: as long as the samples take
    threads: int  # 0: all
    order: str | None
    tolerance: float | None
    pixel_samples: int | None
    shadow_rays: int | None

    @property
    def scene_name(self) -> str:
        """Name of the scene in captions and of its folder of results."""
        return Path(self.scene).stem

    @property
    def scene_file(self) -> Path:
        """The file of the scene: `scene` itself unless that is no file but the name of an example."""
        given = Path(self.scene)
        example = _examples() / f"{self.scene}.py"
        return example if not given.is_file() and self.scene.isidentifier() and example.is_file() else given

    def to_data(self) -> dict[str, Any]:
        """The options as plain data."""
        return asdict(self)


def parse(argv: list[str]) -> Options:
    """The options of a command line; prints the reason and raises SystemExit(2) where it is not understood."""
    values = vars(_parser().parse_args(argv))
    if values["out"] is None:
        values["out"] = str(Path("out") / "preview" / Path(values["scene"]).stem)
    return Options(**values)


def _examples() -> Path:
    """The folder examples/ of the source tree, or the copy of it that is installed with the package."""
    here = Path(__file__).resolve()
    folders = (here.parents[3] / "examples", here.parents[1] / "examples")
    return next(folder for folder in folders if (folder / f"{DEFAULT_SCENE}.py").is_file())


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="shlight preview",
        description="Renders a scene with shlight, with Cycles in about the same time, and with Cycles at many "
        "samples as the reference; writes the pictures, a comparison and all figures. shlight's picture is in place, "
        "and named, before Cycles starts.",
    )
    add = parser.add_argument
    add(
        "scene",
        nargs="?",
        default=DEFAULT_SCENE,
        help="a Blender file, a script with a function build_scene(), or the name of an example: "
        "%(default)s (the default), glossy_balls, glossy_floor, roughness_ramp",
    )
    add("--size", type=_size, metavar="WxH", help="pixels (default: the scene's shape, 512 on the longer side)")
    add("--out", metavar="DIR", help="folder of the results (default: out/preview/<scene name>)")
    add(
        "--light",
        action="append",
        dest="lights",
        metavar="NAME",
        help="a lamp that shines, the others do not; may be given several times (default: all shine)",
    )
    add("--frame", type=int, metavar="N", help="frame of the animation (default: the scene's current one)")
    add(
        "--samples",
        type=_whole(2),
        default=4096,
        metavar="N",
        help="samples of the reference, at most (default: %(default)s)",
    )
    add(
        "--reference-seconds",
        type=_seconds,
        default=30.0,
        metavar="S",
        help="time for the reference, which then ends with the samples it has; 0: no limit (default: %(default)g)",
    )
    add("--threads", type=_whole(0), default=0, metavar="N", help="threads of all renders (default: 0, all cores)")
    group = parser.add_argument_group("settings of shlight (default: the scene's)")
    add = group.add_argument
    add("--order", type=_order, metavar="N", help="harmonics of order 1 to 64, or auto: the cheapest way")
    add("--tolerance", type=_tolerance, metavar="X", help="error of auto, ÷ (light's radiance × albedo)")
    add("--pixel-samples", type=_whole(1), metavar="N", help="camera rays per pixel, at least")
    add("--shadow-rays", type=_whole(0), metavar="N", help="rays towards each light, 0: no shadows, in Cycles neither")
    return parser


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", text)
    if not match or not all(1 <= int(side) <= LARGEST_SIDE for side in match.groups()):
        raise argparse.ArgumentTypeError(f"'{text}' is no size such as 640x480 (each side 1 to {LARGEST_SIDE})")
    return int(match[1]), int(match[2])


def _whole(least: int) -> Any:
    def parse_whole(text: str) -> int:
        if not re.fullmatch(r"\d{1,9}", text) or int(text) < least:
            raise argparse.ArgumentTypeError(f"'{text}' is no whole number of at least {least}")
        return int(text)

    return parse_whole


def _seconds(text: str) -> float:
    if not re.fullmatch(r"\d{1,9}(\.\d{1,9})?", text):
        raise argparse.ArgumentTypeError(f"'{text}' is no number of seconds, 0 or more")
    return float(text)


def _order(text: str) -> str:
    if text.upper() == "AUTO":
        return "AUTO"
    if re.fullmatch(r"\d{1,2}", text) and 1 <= int(text) <= 64:
        return str(int(text))
    raise argparse.ArgumentTypeError(f"'{text}' is neither auto nor an order from 1 to 64")


def _tolerance(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1e-6 <= value <= 0.5:
        raise argparse.ArgumentTypeError(f"'{text}' is no number from 1e-6 to 0.5")
    return value
