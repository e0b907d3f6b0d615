# SPDX-License-Identifier: MIT
"""Renders a scene with shlight, with Cycles in the same time and with Cycles for long, and compares.

`command` is the program that the user starts; it starts `worker`, which renders.
"""

from .command import main

__all__ = ["main"]
