# SPDX-License-Identifier: MIT
"""Renders all scenes of a folder with shlight and with Cycles, and tells how far they differ.

`command` is the program that the user starts; it starts a `worker` for each file, so that what befalls one file is
that file's line.
"""

from .command import main

__all__ = ["main"]
