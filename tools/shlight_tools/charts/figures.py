# SPDX-License-Identifier: MIT
"""All figures, in the order of the page."""

from __future__ import annotations

from . import growth, order_error, pictures, speed_error, stability, which_method
from .figure import Figure

FIGURES = [
    Figure("speed_error", "Time against error", speed_error.draw),
    Figure("stability", "Where methods fail", stability.draw),
    Figure("growth", "Time against order", growth.draw),
    Figure("order_error", "Order against error, for each material", order_error.draw),
    Figure("which_method", "Which method where", which_method.draw),
    Figure("pictures", "Equal time and equal quality", pictures.draw),
]
