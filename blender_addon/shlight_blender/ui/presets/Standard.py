# SPDX-License-Identifier: GPL-3.0-or-later
"""The eye does not tell it from a converged picture; these are the defaults."""

import bpy

settings = bpy.context.scene.shlight
settings.noise_threshold = 0.01
settings.min_samples = 4
settings.max_samples = 256
settings.tolerance = 0.001
settings.pixel_samples = 0
settings.order = "AUTO"
settings.shadow_rays = 16
