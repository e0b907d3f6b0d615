# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands share that compare shlight with Cycles: opening scenes, renders of both, and the reference.

A command starts a `worker` in a process of its own, which alone imports bpy: whatever Blender prints, and even its
crash, then ends in one clear line, and Ctrl-C works while Blender renders.
"""
