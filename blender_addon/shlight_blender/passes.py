# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes of a view layer: what its switches ask for, by Blender's names, and what `shlight.render` has for them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .compat import PASSES, write_pass
from .names import name_of, with_name

Arrays = Mapping[str, NDArray[np.float32]]

# Names of lights' parts are "lamp<SEPARATOR>light group"; either may be empty.
SEPARATOR = "\n"
WORLD, SURFACES = "World", "Surfaces"  # in the place of lamps
SHADOW_CATCHER = "shadow_catcher"  # an array that catchers.py makes
FALLOFFS = {"QUADRATIC": 2.0, "LINEAR": 1.0, "INVERSE_QUADRATIC": 0.5}
CRYPTOMATTES = {"object": "CryptoObject", "material": "CryptoMaterial", "asset": "CryptoAsset"}
DENOISING = (
    ("Denoising Normal", "XYZ", "VECTOR", "denoising_normal"),
    ("Denoising Albedo", "RGB", "COLOR", "denoising_albedo"),
    ("Denoising Depth", "Z", "VALUE", "denoising_depth"),
)


@dataclass(frozen=True)
class LayerPass:
    """A pass of a view layer."""

    name: str
    channels: str
    kind: str  # VALUE, VECTOR or COLOR
    source: str = ""  # the array that it is some channels of
    first: int = 0  # of these channels
    light: tuple[int, str] | None = (
        None  # or the lights that it is the sum of: lamp (0) or light group (1), and its name
    )

    def find(self, arrays: Arrays) -> NDArray[np.float32] | None:
        """The pass (height, width, channels); None where it is not among the arrays: black."""
        if self.light is None:
            array = arrays.get(self.source)
            return None if array is None else array[..., self.first : self.first + len(self.channels)]
        which, name = self.light
        parts = {key: key.removeprefix("combined_").split(SEPARATOR) for key in arrays if SEPARATOR in key}
        lights = [arrays[key] for key, names in parts.items() if names[which] == name]
        return None if not lights else np.sum(lights, axis=0)


def stores_denoising_data(view_layer: Any) -> bool:
    """Whether a view layer has denoising data: the switch is that of Cycles' add-on."""
    return bool(getattr(getattr(view_layer, "cycles", None), "denoising_store_passes", False))


def stores_shadows(view_layer: Any) -> bool:
    """Whether a view layer has a pass of what shadow catchers show: likewise."""
    return bool(getattr(getattr(view_layer, "cycles", None), "use_pass_shadow_catcher", False))


def layer_passes(scene: Any, view_layer: Any) -> list[LayerPass]:
    """All passes but Combined that the view layer asks for and shlight has."""
    found = [LayerPass(*row) for switch, row in PASSES.items() if getattr(view_layer, switch, False)]
    for kind, name in CRYPTOMATTES.items():
        if getattr(view_layer, f"use_pass_cryptomatte_{kind}"):
            for i in range((_levels(view_layer) + 1) // 2):
                found.append(LayerPass(f"{name}{i:02d}", "rgba", "COLOR", f"cryptomatte_{kind}", 4 * i))
    if stores_denoising_data(view_layer):
        found += [LayerPass(*row) for row in DENOISING]
    if stores_shadows(view_layer):
        found.append(LayerPass("Shadow Catcher", "RGB", "COLOR", SHADOW_CATCHER))
    for aov in view_layer.aovs:
        if aov.is_valid:
            channels, kind = ("X", "VALUE") if aov.type == "VALUE" else ("RGBA", "COLOR")
            found.append(LayerPass(name_of(aov), channels, kind, f"aov_{name_of(aov)}"))
    for group in view_layer.lightgroups:
        name = name_of(group)
        found.append(LayerPass(f"Combined_{name}", "RGB", "COLOR", light=(1, name)))
    if scene.shlight.use_pass_lights:
        for lamp in dict.fromkeys([*lamps_of(view_layer), SURFACES, WORLD]):
            found.append(LayerPass(f"Light_{lamp}", "RGB", "COLOR", light=(0, lamp)))
    return found


def _levels(view_layer: Any) -> int:
    return min(max(int(view_layer.pass_cryptomatte_depth), 2), 16)


def lamps_of(view_layer: Any) -> Iterator[str]:
    """Names of lamps of a view layer and of the collections that it shows instances of."""
    seen: set[str] = set()
    waiting = list(view_layer.objects)
    while waiting:
        shown = waiting.pop(0)
        if (name := name_of(shown)) in seen:
            continue
        seen.add(name)
        if shown.type == "LIGHT":
            yield name
        if shown.instance_type == "COLLECTION" and shown.instance_collection is not None:
            waiting += shown.instance_collection.all_objects


@dataclass(frozen=True)
class PassWishes:
    """Requirements of the requested passes on the export of a scene."""

    lamps: bool = False  # light is told apart by lamps
    groups: bool = False  # and by light groups
    uvs: bool = False
    aovs: Mapping[str, str] = field(default_factory=dict)  # COLOR or VALUE by name

    def light_part(self, lamp: str, group: str) -> str | None:
        """`group` of what `shlight.Scene.add_…_light` takes."""
        part = SEPARATOR.join([lamp if self.lamps else "", group if self.groups else ""])
        return None if part == SEPARATOR else part


def pass_wishes(scene: Any, view_layer: Any) -> PassWishes:
    """The requirements of a view layer's passes on the export."""
    return PassWishes(
        bool(scene.shlight.use_pass_lights or scene.shlight.use_light_mixer),
        len(view_layer.lightgroups) > 0,
        bool(view_layer.use_pass_uv),
        {name_of(aov): aov.type for aov in view_layer.aovs if aov.is_valid},
    )


def pass_arguments(scene: Any, view_layer: Any) -> dict[str, Any]:
    """Arguments of `shlight.render` for the passes of a view layer; none for Combined alone."""
    own_passes = [own for own in layer_passes(scene, view_layer) if own.source != SHADOW_CATCHER]
    wishes = pass_wishes(scene, view_layer)
    if not own_passes and not wishes.lamps:
        return {}
    sources = [own.source for own in own_passes if not own.source.startswith("aov_")]
    mist = getattr(scene.world, "mist_settings", None)
    reach = (0.0, 100.0, 1.0) if mist is None else (mist.start, mist.depth, FALLOFFS[mist.falloff])
    return {
        "passes": list(dict.fromkeys(source for source in sources if source)),
        "groups": wishes.lamps or wishes.groups,
        "aovs": bool(wishes.aovs),
        "alpha_threshold": float(view_layer.pass_alpha_threshold),
        "mist": reach,
        "cryptomatte_levels": _levels(view_layer),
    }


def stamp_cryptomattes(result: Any, view_layer: Any, names: Mapping[str, set[str]]) -> None:
    """Notes in a render result what names the identities of its Cryptomatte passes stand for."""
    from shlight._core import cryptomatte_hash

    for kind, name in CRYPTOMATTES.items():
        if getattr(view_layer, f"use_pass_cryptomatte_{kind}"):
            layer = f"{name_of(view_layer)}.{name}"
            prefix = f"cryptomatte/{cryptomatte_hash(layer):08x}"[: len("cryptomatte/") + 7]
            manifest = {own: f"{cryptomatte_hash(own):08x}" for own in sorted(names[kind])}
            result.stamp_data_add_field(f"{prefix}/name", layer)
            result.stamp_data_add_field(f"{prefix}/hash", "MurmurHash3_32")
            result.stamp_data_add_field(f"{prefix}/conversion", "uint32_to_float32")
            result.stamp_data_add_field(f"{prefix}/manifest", json.dumps(manifest, separators=(",", ":")))


def write_passes(layer: Any, passes: list[LayerPass], arrays: Arrays) -> None:
    """Writes arrays, row 0 on top, into the passes of a render layer that there are."""
    for own in passes:
        pixels = own.find(arrays)
        target = with_name(layer.passes, own.name)
        if pixels is not None and target is not None:
            write_pass(target, pixels[::-1].reshape(-1, len(own.channels)))


def with_features(passes: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of `shlight.render` that ask for what `denoised` needs, too."""
    from shlight.denoising import FEATURES

    return {**passes, "passes": list(dict.fromkeys([*passes.get("passes", ()), *FEATURES]))}


def denoised(arrays: Arrays, quality: str, threads: int, goes_on: Callable[[float], bool]) -> Arrays:
    """The arrays of a render, and in place of "combined" what Open Image Denoise makes of it.

    goes_on: False leaves the picture as it is.
    """
    import shlight
    from shlight.denoising import FEATURES

    features = (arrays[name] for name in FEATURES)
    try:
        combined = shlight.denoise(arrays["combined"], *features, quality=quality, threads=threads, progress=goes_on)
    except shlight.RenderCancelled:
        return arrays
    return {**arrays, "combined": combined}
