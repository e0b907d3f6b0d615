# SPDX-License-Identifier: MIT
"""Renders the pictures of docs/gallery.md, each with shlight and with Cycles, and writes the page.

.venv/bin/python docs/figures/gallery.py [scene ...]     all scenes where none is named; then the page is written, too
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from shlight.images import linear_to_srgb8
from shlight_tools.bench import bounced_scenes, picture_scenes
from shlight_tools.bench.picture_renderers import Cycles, Shlight

DOCS = Path(__file__).resolve().parents[1]
FOLDER = DOCS / "images" / "gallery"
SIZE = 240  # pixels of a picture's side
SECONDS = 6.0  # shlight ends then or before; Cycles doubles its samples until it has taken as long
DIRECT = ("fence", "textured", "100 lamps", "sky")
SCENES = {**bounced_scenes.BOUNCED_SCENES, **{name: picture_scenes.PICTURE_SCENES[name] for name in DIRECT}}
HEAD = """# Gallery

Left shlight, right Cycles without denoising: shlight renders for six seconds at most, Cycles doubles its samples until
a picture takes as long. They are to be looked at; [Performance](performance.md#pictures) measures.

    .venv/bin/python docs/figures/gallery.py NAME    # one picture; without a name all, and this page

`bounced_scenes.py` and `picture_scenes.py` in `tools/shlight_tools/bench` build the scenes.
"""


def picture_name(name: str) -> str:
    return f"{name.replace(' ', '_')}.jpg"


def draw(name: str) -> str:
    """Leaves the two pictures side by side; returns the scene's part of the page."""
    scene = SCENES[name]()
    took, own = list(Shlight(scene, SIZE).pictures(SECONDS))[-1]
    took_cycles, other = list(Cycles(scene, SIZE, denoised=False).pictures(SECONDS))[-1]
    bright = float(np.percentile(own[..., :3].max(axis=-1), 95))
    exposure = math.log2(0.8 / bright)
    pair = np.hstack([linear_to_srgb8(image[..., :3], exposure) for image in (own, other)])
    FOLDER.mkdir(exist_ok=True)
    Image.fromarray(pair).save(FOLDER / picture_name(name), quality=80, optimize=True)
    bounces = f"{scene.max_bounces} bounces" if scene.max_bounces else "Direct light"
    return f"""
## {name.capitalize()}

{SCENES[name].__doc__} {bounces}; shlight {took:.1f} s, Cycles {took_cycles:.1f} s. `gallery.py '{name}'`

![{name}: shlight and Cycles](images/gallery/{picture_name(name)})
"""


def main() -> None:
    """Draws what the command line names."""
    parts = [draw(name) for name in sys.argv[1:] or SCENES]
    if len(sys.argv) == 1:
        (DOCS / "gallery.md").write_text(HEAD + "".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
