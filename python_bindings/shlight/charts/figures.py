# SPDX-License-Identifier: MIT
"""All figures, in the order of the page."""

from __future__ import annotations

from . import growth
from .figure import Figure

FIGURES = [
    Figure("growth", "Time against order", growth.draw),
]
