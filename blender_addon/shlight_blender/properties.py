# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene settings of the render engine: `scene.shlight`."""

from __future__ import annotations

import bpy

HIGHEST_ORDER = 64

# Blender keeps no reference to the strings of an enum.
ORDER_ITEMS = [
    ("AUTO", "Automatic", "For every point the lowest order that meets the tolerance"),
    *((str(order), str(order), f"Order {order} everywhere") for order in range(1, HIGHEST_ORDER + 1)),
]


class SHLIGHT_SceneSettings(bpy.types.PropertyGroup):
    """Settings of a scene for final renders."""

    order: bpy.props.EnumProperty(
        name="Order",
        description="Order of the spherical harmonics: the number of bands with which a reflection is described",
        items=ORDER_ITEMS,
        default="AUTO",
    )
    tolerance: bpy.props.FloatProperty(
        name="Tolerance",
        description="Relative error of a reflection that the automatic order may make",
        default=1e-3,
        min=1e-6,
        max=0.5,
        soft_min=1e-4,
        soft_max=0.1,
        precision=5,
        step=0.1,
    )
    pixel_samples: bpy.props.IntProperty(
        name="Pixel Samples",
        description="Camera rays per pixel; they smooth edges, the light itself has no noise",
        default=16,
        min=1,
        max=4096,
        soft_max=64,
    )
    use_shadows: bpy.props.BoolProperty(
        name="Shadows",
        description="Trace shadows; without them every light reaches every surface that faces it",
        default=True,
    )
    shadow_rays: bpy.props.IntProperty(
        name="Shadow Rays",
        description="Rays towards each light from a point; they smooth penumbrae",
        default=16,
        min=1,
        max=4096,
        soft_max=256,
    )


def register() -> None:
    """Adds `scene.shlight`."""
    bpy.utils.register_class(SHLIGHT_SceneSettings)
    bpy.types.Scene.shlight = bpy.props.PointerProperty(type=SHLIGHT_SceneSettings)


def unregister() -> None:
    """Removes `scene.shlight`."""
    del bpy.types.Scene.shlight
    bpy.utils.unregister_class(SHLIGHT_SceneSettings)
