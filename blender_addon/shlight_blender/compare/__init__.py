# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare with Cycles, inside Blender: an operator and its panel, images with a split, and markers.

`operators` has `job` write a copy of the file and start another Blender with `start`, where `worker` renders, measures
and finds the largest differences. `results` makes images of what it leaves, which `overlay` draws on.
"""
