# SPDX-License-Identifier: MIT
"""The studio, whose pictures of shlight and of Cycles tests compare."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

# Before shlight: of two libraries named libtbb the first one loaded serves both, and bpy 5.2 needs its own.
bpy = pytest.importorskip("bpy", reason="tests/blender needs bpy: ./dev setup installs it")

sys.path.append(str(Path(__file__).parent))
from studio import Studio as PlainStudio  # noqa: E402

from shlight.images import read_exr  # noqa: E402
from shlight.metrics import mean_ratio, rel_mse  # noqa: E402

Image = NDArray[np.float32]
# Properties of lamps and inputs of shaders that older versions of Blender lack.
SINCE_4_5 = {"normalize", "exposure", "use_temperature", "temperature", "Diffuse_Roughness"}


class Studio(PlainStudio):
    """Builds objects in the current file and compares its pictures."""

    def need(self, name: str) -> None:
        """Skips the test if this version of Blender has no property or input `name`."""
        if name in SINCE_4_5 and bpy.app.version < (4, 5, 0):
            pytest.skip(f"this version of Blender has no {name}")

    def render(self, engine: str, seed: int = 7) -> Image:
        """The picture of `engine` (height, width, 4), row 0 on top; `seed` is Cycles'."""
        return read_exr(self.write(engine, seed))

    def compare(self, *, mean: float = 5e-3, error: float = 5e-3, alpha: float = math.inf) -> tuple[Image, Image]:
        """Renders with both engines and compares mean, relMSE and alpha; returns both pictures (shlight, Cycles)."""
        image, reference = self.render("SHLIGHT"), self.render("CYCLES")
        assert image.shape == reference.shape
        ratio, mse = mean_ratio(image, reference), rel_mse(image, reference)
        print(f"mean {100 * (ratio - 1):+.3f} %, relMSE {mse:.2e}")
        assert abs(ratio - 1.0) <= mean
        assert mse <= error
        assert np.abs(image[..., 3] - reference[..., 3]).mean() <= alpha
        return image, reference

    def messages(self, most: int = 4, *, of_depths: bool = False) -> list[str]:
        """The report's lines after an export; of_depths: also what glass and metal lack at this Max Bounces."""
        from shlight_blender.export import export_scene

        lines = export_scene(bpy.context.evaluated_depsgraph_get()).report.lines(most)
        lacking = ("while Max Bounces is 0", "(caustics) is blurred")
        return [line for line in lines if of_depths or not line.endswith(lacking)]


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """Ends this process once all is reported, without the end of Python.

    Where anything still refers to the module then, Blender 4.5 waits for ever for its own thread for audio devices.
    """

    def end() -> None:
        session.config.get_terminal_writer().flush()
        os._exit(exitstatus)

    session.config.add_cleanup(end)


@pytest.fixture(scope="session")
def _addon() -> Iterator[None]:
    import shlight_blender

    shlight_blender.register()
    yield
    shlight_blender.unregister()


@pytest.fixture
def studio(_addon: None, tmp_path: Path) -> Studio:
    """An empty file with the add-on registered."""
    return Studio(tmp_path)
