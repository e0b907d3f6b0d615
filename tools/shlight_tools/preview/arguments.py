# SPDX-License-Identifier: MIT
"""The arguments of command lines that say what a scene is rendered with."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable
from typing import Any

LARGEST_SIDE = 16384


def size(text: str) -> tuple[int, int]:
    """Pixels such as 640x480."""
    match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", text)
    if not match or not all(1 <= int(side) <= LARGEST_SIDE for side in match.groups()):
        raise argparse.ArgumentTypeError(f"'{text}' is no size such as 640x480 (each side 1 to {LARGEST_SIDE})")
    return int(match[1]), int(match[2])


def whole(least: int) -> Callable[[str], int]:
    """The type of whole numbers from `least` on."""
    return _number(int, least, 999_999_999, f"whole number of at least {least}")


def _number(kind: type, least: float, most: float, text: str) -> Any:
    def parse(given: str) -> Any:
        try:
            value = kind(given)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(f"'{given}' is no {text}")
        return value

    return parse


seconds = _number(float, 0.0, 1e9, "number of seconds, 0 or more")
tolerance = _number(float, 1e-6, 0.5, "number from 1e-6 to 0.5")


def order(text: str) -> str:
    """An order of harmonics, or AUTO."""
    if text.upper() == "AUTO":
        return "AUTO"
    if re.fullmatch(r"\d{1,2}", text) and 1 <= int(text) <= 64:
        return str(int(text))
    raise argparse.ArgumentTypeError(f"'{text}' is neither auto nor an order from 1 to 64")
