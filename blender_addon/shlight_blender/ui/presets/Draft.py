# SPDX-License-Identifier: GPL-3.0-or-later
"""To see where light falls: some noise in penumbrae."""

import bpy

settings = bpy.context.scene.shlight
settings.noise_threshold = 0.05
settings.min_samples = 1
settings.max_samples = 16
settings.tolerance = 0.01
settings.pixel_samples = 0
settings.order = "AUTO"
settings.shadow_rays = 16
