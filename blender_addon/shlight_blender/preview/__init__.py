# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a scene with shlight, with Cycles in the same time and with Cycles for long, and compares.

`command` is the program that the user starts; it starts `compare.worker`, which renders.
"""

from .command import main

__all__ = ["main"]
