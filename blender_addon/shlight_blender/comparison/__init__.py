# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands that compare shlight with Cycles share: opening scenes, rendering them with both, and the reference.

A command starts a `worker` in a process of its own, which alone imports bpy: whatever Blender prints, and even its
crash, then ends in one clear line, and Ctrl-C works while Blender renders.
"""
