# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene settings of the render engine: `scene.shlight`."""

from __future__ import annotations

import bpy

HIGHEST_ORDER = 64

# Blender keeps no reference to the strings of an enum.
ORDER_ITEMS = [
    ("AUTO", "Automatic", "For every point and light the cheapest way that meets the tolerance"),
    *(
        (str(order), str(order), f"Spherical harmonics of order {order} for every light")
        for order in range(1, HIGHEST_ORDER + 1)
    ),
]


class SHLIGHT_SceneSettings(bpy.types.PropertyGroup):
    """Settings of a scene for final renders."""

    order: bpy.props.EnumProperty(
        name="Order",
        description="Order of the spherical harmonics: number of bands that describe how a surface reflects",
        items=ORDER_ITEMS,
        default="AUTO",
    )
    tolerance: bpy.props.FloatProperty(
        name="Tolerance",
        description="Error that the automatic order may make: of what a point reflects, relative to that, or to a "
        "tenth of the picture's mean",
        default=1e-3,  # shlight.DEFAULT_TOLERANCE
        min=1e-6,
        max=0.5,
        soft_min=1e-5,
        soft_max=0.1,
        precision=5,
        step=0.1,
    )
    pixel_samples: bpy.props.IntProperty(
        name="Pixel Samples",
        description="Least number of camera rays per pixel; where they disagree, at edges, more are taken",
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
    world_width: bpy.props.IntProperty(
        name="World Width",
        description="Width of the picture that a world of other nodes than one colour or a picture is baked to",
        default=2048,
        min=64,
        max=16384,
        subtype="PIXEL",
    )


def are_registered() -> bool:
    """Whether Blender knows `scene.shlight`."""
    return bool(SHLIGHT_SceneSettings.is_registered)


def register() -> None:
    """Adds `scene.shlight`."""
    bpy.utils.register_class(SHLIGHT_SceneSettings)
    bpy.types.Scene.shlight = bpy.props.PointerProperty(type=SHLIGHT_SceneSettings)


def unregister() -> None:
    """Removes `scene.shlight`."""
    del bpy.types.Scene.shlight
    bpy.utils.unregister_class(SHLIGHT_SceneSettings)
