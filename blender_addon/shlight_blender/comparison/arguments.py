# SPDX-License-Identifier: GPL-3.0-or-later
"""The arguments of command lines that say what a scene is rendered with."""

from __future__ import annotations

import argparse
import re
from typing import Any

LARGEST_SIDE = 16384


def size(text: str) -> tuple[int, int]:
    """Pixels such as 640x480."""
    match = re.fullmatch(r"(\d{1,6})[xX×](\d{1,6})", text)
    if not match or not all(1 <= int(side) <= LARGEST_SIDE for side in match.groups()):
        raise argparse.ArgumentTypeError(f"'{text}' is no size such as 640x480 (each side 1 to {LARGEST_SIDE})")
    return int(match[1]), int(match[2])


def whole(least: int) -> Any:
    """The type of whole numbers from `least` on."""

    def parse_whole(text: str) -> int:
        if not re.fullmatch(r"\d{1,9}", text) or int(text) < least:
            raise argparse.ArgumentTypeError(f"'{text}' is no whole number of at least {least}")
        return int(text)

    return parse_whole


def seconds(text: str) -> float:
    """A time, 0 or more."""
    if not re.fullmatch(r"\d{1,9}(\.\d{1,9})?", text):
        raise argparse.ArgumentTypeError(f"'{text}' is no number of seconds, 0 or more")
    return float(text)


def order(text: str) -> str:
    """An order of harmonics, or AUTO."""
    if text.upper() == "AUTO":
        return "AUTO"
    if re.fullmatch(r"\d{1,2}", text) and 1 <= int(text) <= 64:
        return str(int(text))
    raise argparse.ArgumentTypeError(f"'{text}' is neither auto nor an order from 1 to 64")


def tolerance(text: str) -> float:
    """A tolerance of shlight."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1e-6 <= value <= 0.5:
        raise argparse.ArgumentTypeError(f"'{text}' is no number from 1e-6 to 0.5")
    return value
