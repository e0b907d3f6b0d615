# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands and the panel share that compare shlight with Cycles: renders of both, and the reference.

A `worker` renders in a process of its own: whatever Blender prints, and even its crash, then ends in one clear line. Of
a command it alone imports bpy, and Ctrl-C works while Blender renders.
"""
