# SPDX-License-Identifier: MIT
"""All figures of a preview: measured from its pictures, and shown as a table."""

from __future__ import annotations

import os
import platform
from dataclasses import asdict
from importlib import metadata
from typing import Any

import numpy as np

from shlight_blender.compare.measure import error_text
from shlight_blender.record import light_name

from .options import Options


def add_circumstances(figures: dict[str, Any], options: Options) -> None:
    """Adds where, with what and with which options the figures came about."""
    figures["scene"]["file"] = options.request.scene
    figures["options"] = asdict(options.request) | {"scene": options.scene, "out": str(options.out)}
    figures["versions"] = {
        "shlight": metadata.version("shlight"),
        "blender": figures.pop("blender"),
        "python": platform.python_version(),
        "numpy": np.__version__,
    }
    figures["machine"] = {"processors": os.cpu_count(), "system": platform.platform()}


def table(figures: dict[str, Any]) -> str:
    """The figures that matter, for a terminal."""
    shlight, cycles, reference = (figures[name] for name in ("shlight", "cycles_same_time", "reference"))
    rows = [
        ("", "seconds", "samples", "relMSE", "as measured", "mean/ref.", "within 3 s.e."),
        (
            "shlight",
            f"{shlight['seconds']:.3f}",
            "",
            error_text(shlight),
            f"{shlight['rel_mse_measured']:.2e}",
            f"{shlight['mean_ratio']:.4f}",
            f"{shlight['within_3_standard_errors']:.1%}",
        ),
        (
            "Cycles, same time",
            f"{cycles['seconds']:.3f}",
            str(cycles["samples"]),
            error_text(cycles),
            f"{cycles['rel_mse_measured']:.2e}",
            f"{cycles['mean_ratio']:.4f}",
            "",
        ),
        (
            "reference (Cycles)",
            f"{reference['seconds']:.1f}",
            str(reference["samples"]),
            "",
            f"{reference['noise_rel_mse']:.2e}",
            "",
            "",
        ),
    ]
    lines = [f"{row[0]:18}{row[1]:>9}{row[2]:>9}" + "".join(f"{cell:>17}" for cell in row[3:]) for row in rows]
    lines.append(f"All have {light_name(shlight['settings']['max_bounces'])}.")
    lines.append("relMSE is without the noise of the reference, which its two halves tell; ± one standard error.")
    if reference["stopped_by"] == "seconds":
        lines.append("The reference ended when its time was over; --reference-seconds gives it more.")
    lines.extend(_details(shlight))
    return "\n".join(line.rstrip() for line in lines)


def _details(shlight: dict[str, Any]) -> list[str]:
    orders = sorted((int(order), share) for order, share in shlight["order_shares"].items())
    shares = [(f"order {order}", share) for order, share in orders]
    shares += [("cubature", shlight["cubature_share"]), ("mirrors", shlight["mirror_share"])]
    shaded = ", ".join(f"{name}: {share:.1%}" for name, share in shares if share > 0)
    lines = [f"shaded by {shaded or 'nothing'}; over tolerance: {shlight['over_tolerance']:.2%}"]
    if shlight.get("operations"):
        most = max(shlight["operations"], key=shlight["operations"].get)
        lines.append(
            f"materials that vary: {len(shlight['operations'])}, at most {shlight['operations'][most]} operations a hit"
            f" ('{most}'); textures: {shlight['texture_bytes'] / 1e6:.0f} MB"
        )
    if shlight["unsupported"]:
        lines.append("not supported by shlight:")
    for message in shlight["unsupported"]:
        lines.append(f"  {', '.join(message['places'])}: {message['text']}")
    return lines
