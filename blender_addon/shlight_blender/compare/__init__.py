# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare with Cycles: `render` renders a scene with both in a process of its own, and measures.

In Blender, `panel` has `job` write a copy of the file and start the process, which also finds the largest differences.
`results` makes images of what it leaves, which `overlay` draws on.
"""
