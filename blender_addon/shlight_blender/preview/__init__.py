# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `shlight preview`: a scene rendered by shlight, by Cycles in the same time, and by Cycles for long.

`command` is the program that the user starts. It starts `worker` in a process of its own, which alone imports bpy:
whatever Blender prints, and even its crash, then ends in one clear line, and Ctrl-C works while Blender renders.
"""

from .command import main

__all__ = ["main"]
