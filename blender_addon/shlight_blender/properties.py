# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the render engine: `scene.shlight`, and `material.shlight`."""

from __future__ import annotations

from typing import Any

import bpy

from .compat import RELATIVE_PATH

HIGHEST_ORDER = 64

# Blender keeps no reference to the strings of an enum.
ORDER_ITEMS = [
    ("AUTO", "Automatic", "For every point and light the cheapest way that meets the tolerance"),
    *(
        (str(order), str(order), f"Spherical harmonics of order {order} for every light")
        for order in range(1, HIGHEST_ORDER + 1)
    ),
]


def _noise_threshold(default: float, pixel: str) -> Any:
    return bpy.props.FloatProperty(
        name="Noise Threshold",
        description=f"Estimated error at which {pixel} has enough camera rays: of its value, relative to that, or to a "
        "tenth of the picture's mean. At 0 all pixels get Max Samples",
        default=default,
        min=0.0,
        max=1.0,
        soft_min=0.001,
        precision=4,
        step=1,
    )


def _samples(which: str, default: int, description: str) -> Any:
    return bpy.props.IntProperty(
        name=f"{which} Samples", description=description, default=default, min=1, max=1 << 20, soft_max=4096
    )


def _time_limit(picture: str) -> Any:
    return bpy.props.FloatProperty(
        name="Time Limit",
        description=f"Passes over {picture} that would end later are left out. At 0 all are made",
        default=0.0,
        min=0.0,
        soft_max=3600.0,
        unit="TIME_ABSOLUTE",
        step=100,
    )


def _bounces(which: str, default: int, description: str) -> Any:
    return bpy.props.IntProperty(
        name=f"{which} Bounces", description=description, default=default, min=0, max=1024, soft_max=32
    )


def _denoising(picture: str) -> Any:
    return bpy.props.BoolProperty(
        name="Denoise",
        description=f"Take the noise that is left out of {picture} by Open Image Denoise, once it is rendered",
        default=False,
    )


def _mixed(row: Any, context: Any) -> None:
    from .ui.light_mixer import show_mix

    show_mix(context)


class SHLIGHT_LightMix(bpy.types.PropertyGroup):
    """A row of the light mixer; its name is that of a lamp."""

    on: bpy.props.BoolProperty(name="On", description="Whether the lamp shines", default=True, update=_mixed)
    power: bpy.props.FloatProperty(
        name="Power",
        description="Factor of the lamp's power",
        default=1.0,
        min=0.0,
        soft_max=4.0,
        step=5,
        update=_mixed,
    )
    color: bpy.props.FloatVectorProperty(
        name="Color",
        description="Factor of the lamp's colour",
        subtype="COLOR",
        size=3,
        default=(1.0, 1.0, 1.0),
        min=0.0,
        soft_max=1.0,
        update=_mixed,
    )


def _switched(settings: Any, context: Any) -> None:
    from .light_mix import follow_lamps

    if settings.use_light_mixer:
        follow_lamps(settings.id_data, context.view_layer)
    _mixed(None, context)


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
    noise_threshold: _noise_threshold(0.01, "a pixel")
    min_samples: _samples("Min", 4, "Least number of camera rays per pixel")
    max_samples: _samples("Max", 256, "Largest number of camera rays per pixel, rounded down to 1 or 4, 8, 16 …")
    time_limit: _time_limit("the picture")
    use_denoising: _denoising("the picture")
    preview_noise_threshold: _noise_threshold(0.02, "a pixel of a viewport")
    preview_min_samples: _samples("Min", 1, "Least number of camera rays per pixel of a viewport")
    preview_max_samples: _samples(
        "Max", 64, "Largest number of camera rays per pixel of a viewport, rounded down to 1 or 4, 8, 16 …"
    )
    preview_time_limit: _time_limit("a viewport's picture")
    preview_use_denoising: _denoising("a viewport's picture")
    pixel_samples: bpy.props.IntProperty(
        name="Pixel Samples",
        description="Camera rays of every pixel in the first pass, as files of older versions have them: in place of "
        "Min Samples, and Max Samples is 16 times as many. At 0 it is unused",
        default=0,
        min=0,
        max=4096,
        options={"HIDDEN"},
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
    max_bounces: _bounces(
        "Max", 4, "Surfaces that light is reflected by before the one that the camera sees. At 0 light is direct"
    )
    preview_max_bounces: _bounces("Max", 4, "Max Bounces of a viewport")
    # Cycles has the same defaults.
    glossy_bounces: _bounces("Glossy", 4, "Bounces by glossy surfaces and mirrors, at most, within Max Bounces")
    transmission_bounces: _bounces("Transmission", 12, "Bounces through glass, at most, within Max Bounces")
    motion_times: bpy.props.IntProperty(
        name="Times",
        description="Times while the shutter is open of which a picture is rendered; the mean of these is blurred",
        default=32,
        min=2,
        max=1024,
        soft_max=128,
    )
    use_pass_lights: bpy.props.BoolProperty(
        name="Lights",
        description="A pass for what each lamp gives to the picture, one for surfaces that shine and one for the world",
        default=False,
    )
    use_light_mixer: bpy.props.BoolProperty(
        name="Light Mixer",
        description="Multiply the light of each lamp by factors, which can be changed after the picture is rendered",
        default=False,
        update=_switched,
    )
    light_mix: bpy.props.CollectionProperty(type=SHLIGHT_LightMix)
    light_mix_row: bpy.props.IntProperty(options={"HIDDEN"})
    world_width: bpy.props.IntProperty(
        name="World Width",
        description="Width of the picture that a world of other nodes than one colour or a picture becomes",
        default=2048,
        min=64,
        max=16384,
        subtype="PIXEL",
    )


class SHLIGHT_MaterialSettings(bpy.types.PropertyGroup):
    """Settings of a material."""

    measured_file: bpy.props.StringProperty(
        name="File",
        description="A measured BRDF, which is drawn in the place of the nodes: a .bin file of UTIA's database or a "
        ".binary file of MERL's",
        subtype="FILE_PATH",
        options=RELATIVE_PATH,
        update=lambda settings, context: settings.id_data.update_tag(),
    )
    tints_measured: bpy.props.BoolProperty(
        name="Tint by Base Color",
        description="Multiply what was measured by the colour of the material's Principled or Diffuse BSDF, with what "
        "is linked to it",
        default=False,
        update=lambda settings, context: settings.id_data.update_tag(),
    )


CLASSES = {SHLIGHT_SceneSettings: bpy.types.Scene, SHLIGHT_MaterialSettings: bpy.types.Material}


def are_registered() -> bool:
    """Whether Blender knows `scene.shlight`."""
    return bool(SHLIGHT_SceneSettings.is_registered)


def register() -> None:
    bpy.utils.register_class(SHLIGHT_LightMix)
    for settings, owner in CLASSES.items():
        bpy.utils.register_class(settings)
        owner.shlight = bpy.props.PointerProperty(type=settings)


def unregister() -> None:
    for settings, owner in CLASSES.items():
        del owner.shlight
        bpy.utils.unregister_class(settings)
    bpy.utils.unregister_class(SHLIGHT_LightMix)
