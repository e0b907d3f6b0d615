# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare with Cycles: `worker` renders a scene with both in a process of its own, and measures.

`supervision` runs it for commands, which `arguments` reads. In Blender, `operators` has `job` write a copy of the file
and start `panel_worker`, which also finds the largest differences. `results` makes images of what it leaves, which
`overlay` draws on.
"""
