# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `shlight preview`: a scene rendered by shlight, by Cycles in the same time, and by Cycles for long.

`command` is the program that the user starts; it starts `worker`, which renders.
"""

from .command import main

__all__ = ["main"]
