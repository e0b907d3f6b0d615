# SPDX-License-Identifier: MIT
"""The command line of `./dev preview`."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from shlight.commands import Parser

from .arguments import order, seconds, size, tolerance, whole
from .supervision import SceneRequest

DEFAULT_SCENE = "example_scene"
EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


@dataclass(frozen=True)
class Options:
    """A preview: what is rendered, and the folder of the results."""

    request: SceneRequest
    scene: str  # as it was given: a Blender file, a script with build_scene(), or the name of an example
    out: Path

    @property
    def scene_name(self) -> str:
        """Name of the scene in captions and of its folder of results."""
        return Path(self.scene).stem


def parse(argv: list[str]) -> Options:
    """The options of a command line; prints the reason and raises SystemExit(2) where it is not understood."""
    values = vars(_parser().parse_args(argv))
    scene, out = values.pop("scene"), values.pop("out")
    request = SceneRequest(scene=str(_scene_file(scene)), **values)
    return Options(request, scene, Path(out or Path("out") / "preview" / Path(scene).stem))


def _scene_file(given: str) -> Path:
    """The file of the scene: what was given unless that is no file but the name of an example."""
    example = EXAMPLES / f"{given}.py"
    return example if not Path(given).is_file() and given.isidentifier() and example.is_file() else Path(given)


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="./dev preview",
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
    add("--size", type=size, metavar="WxH", help="pixels (default: the scene's shape, 512 on the longer side)")
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
        type=whole(2),
        default=4096,
        metavar="N",
        help="samples of the reference, at most (default: %(default)s)",
    )
    add(
        "--reference-seconds",
        type=seconds,
        default=30.0,
        metavar="S",
        help="time for the reference, which then ends with the samples it has; 0: no limit (default: %(default)g)",
    )
    add("--max-bounces", type=whole(0), metavar="N", help="bounces of light, 0: direct light (default: the scene's)")
    add("--threads", type=whole(0), default=0, metavar="N", help="threads of all renders (default: 0, all cores)")
    group = parser.add_argument_group("settings of shlight (default: the scene's)")
    add = group.add_argument
    add("--order", type=order, metavar="N", help="harmonics of order 1 to 64, or auto: the cheapest way")
    add("--tolerance", type=tolerance, metavar="X", help="error of auto, ÷ (light's radiance × albedo)")
    add("--pixel-samples", type=whole(1), metavar="N", help="camera rays per pixel, at least")
    add("--shadow-rays", type=whole(0), metavar="N", help="rays towards each light, 0: no shadows, in Cycles neither")
    return parser
