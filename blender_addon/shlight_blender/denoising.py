# SPDX-License-Identifier: GPL-3.0-or-later
"""The Denoise switches: pictures without the noise that is left in them, by `shlight.denoise`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .passes import Arrays


def with_features(passes: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of `shlight.render` that ask for what `denoised` needs, too."""
    from shlight.denoising import FEATURES

    return {**passes, "passes": list(dict.fromkeys([*passes.get("passes", ()), *FEATURES]))}


def denoised(arrays: Arrays, quality: str, threads: int, goes_on: Callable[[float], bool]) -> Arrays:
    """The arrays of a render, and in place of "combined" what Open Image Denoise makes of it.

    goes_on: False leaves the picture as it is.
    """
    import shlight
    from shlight.denoising import FEATURES

    features = (arrays[name] for name in FEATURES)
    try:
        combined = shlight.denoise(arrays["combined"], *features, quality=quality, threads=threads, progress=goes_on)
    except shlight.RenderCancelled:
        return arrays
    return {**arrays, "combined": combined}
