# SPDX-License-Identifier: MIT
"""`render`, and what it returns: a picture that knows its passes and what it took."""

from __future__ import annotations

import inspect
import os
import tempfile
from collections.abc import Callable, ItemsView, KeysView, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from shlight import _core, images
from shlight._arrays import checked_flag
from shlight._calls import explained
from shlight._core import KeptLight, RenderReport, Scene

__all__ = ["RenderResult", "render"]

Pixels = NDArray[np.float32]
GROUP = "combined_"  # what the names of light groups begin with among layers
LIT_PASSES = ("direct", "indirect", "emission", "environment")  # ends of the names of passes that have light
LARGEST_FACTOR = 1e10


class RenderResult(np.ndarray[Any, np.dtype[np.float32]]):
    """The picture of a render: an array (height, width, 4) float32, linear, premultiplied, row 0 on top.

    passes: the passes that were asked for, (height, width, channels), and AOVs as "aov_NAME", by name.
    groups: the light of each light group by the group's name, (height, width, 3); "" holds that of no group.
    report: the RenderReport.

    What is computed of it or taken out of it is a plain array; copies keep what it knows. A string as index gives a
    layer: result["depth"].
    """

    passes: dict[str, Pixels]
    groups: dict[str, Pixels]
    report: RenderReport | None

    def __new__(cls, layers: Mapping[str, Pixels], report: RenderReport | None = None) -> RenderResult:
        """layers: as the property `layers` has them."""
        self = np.asarray(layers["combined"], np.float32).view(cls)
        self.groups = {name.removeprefix(GROUP): light for name, light in layers.items() if name.startswith(GROUP)}
        self.passes = {name: own for name, own in layers.items() if not name.startswith("combined")}
        self.report = report
        return self

    def __array_finalize__(self, source: Any) -> None:
        is_copy = isinstance(source, RenderResult) and source.shape == self.shape
        self.passes, self.groups = (source.passes, source.groups) if is_copy else ({}, {})
        self.report = source.report if is_copy else None

    def __array_wrap__(self, array: Any, *_: Any) -> Any:
        return self if array is self else np.asarray(array)[()]

    def __reduce__(self) -> Any:
        return RenderResult, (self.layers, self.report)

    @property
    def layers(self) -> dict[str, Pixels]:
        """All there is, as `images.write_layers` takes it: "combined", passes, and groups as "combined_NAME"."""
        groups = {GROUP + name: light for name, light in self.groups.items()}
        return {"combined": np.asarray(self), **self.passes, **groups}

    def __getitem__(self, key: Any) -> Any:
        return self.layers[key] if isinstance(key, str) else np.asarray(self)[key]

    def __contains__(self, value: Any) -> bool:
        return value in (self.layers if isinstance(value, str) else np.asarray(self))

    def keys(self) -> KeysView[str]:
        """The names of `layers`."""
        return self.layers.keys()

    def items(self) -> ItemsView[str, Pixels]:
        """The names and arrays of `layers`."""
        return self.layers.items()

    def mix(self, factors: Mapping[str, float | Sequence[float]]) -> RenderResult:
        """The picture as it would be if the lights of these groups gave this many times their light, bounces included.

        factors: by the group's name a number, or one for each of red, green and blue; others stay as they are.
        Alpha stays, and so do passes that have no light; the others are left out. Light is linear, so that nothing is
        rendered. Noise is multiplied as the light is.
        Raises ValueError for a name that is in no group, and factors that are not in 0 … 1e10.
        """
        if not isinstance(factors, Mapping):
            raise ValueError(f"factors must be a dict of numbers by the names of groups, got {type(factors).__name__}")
        layers = {name: own for name, own in self.passes.items() if not name.endswith(LIT_PASSES)}
        changes = {name: _checked_factor(name, factor, self.groups) for name, factor in factors.items()}
        groups = self.groups | {name: self.groups[name] * change for name, change in changes.items()}
        layers |= {GROUP + name: light for name, light in groups.items()}
        layers["combined"] = np.array(self)
        rgb = np.ascontiguousarray(layers["combined"][..., :3])  # sums of its rows are several times as fast
        for name in changes:
            rgb += groups[name] - self.groups[name]
        layers["combined"][..., :3] = np.maximum(rgb, 0) if changes else rgb
        return RenderResult(layers, self.report)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a file by its suffix: .png has the picture in 8-bit sRGB, .exr all layers, if there are any.

        Raises ValueError for another suffix, OSError where the file cannot be written.
        """
        suffix = images.checked_path(path).suffix.lower()
        if suffix == ".png":
            images.write_png(path, images.linear_to_srgb8(self))
        elif suffix != ".exr":
            raise ValueError(f"path must end in .png or .exr, got {suffix!r}")
        elif self.passes or self.groups:
            images.write_layers(path, self.layers)
        else:
            images.write_exr(path, self)

    def _repr_png_(self) -> bytes | None:
        """The picture as notebooks show it."""
        if self.ndim != 3 or self.shape[2] not in (1, 3, 4):
            return None
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "picture.png")
            images.write_png(path, images.linear_to_srgb8(self))
            return path.read_bytes()

    def __repr__(self) -> str:
        if self.ndim != 3:
            return repr(np.asarray(self))
        parts = [f"{self.shape[1]} × {self.shape[0]}"]
        parts += [f"{name}={list(own)}" for name, own in (("passes", self.passes), ("groups", self.groups)) if own]
        parts += [] if self.report is None else [repr(self.report)]
        return f"RenderResult({', '.join(parts)})"


def _checked_factor(name: str, factor: float | Sequence[float], groups: Mapping[str, Pixels]) -> Pixels:
    if name not in groups:
        known = ", ".join(map(repr, groups)) if groups else "none; `render` makes them with groups=True"
        named = repr(name) if isinstance(name, str) else f"of type {type(name).__name__}"
        raise ValueError(f"factors: there is no group {named}; the picture's groups are {known}")
    try:
        checked = np.asarray(factor, np.float64)
    except (TypeError, ValueError, OverflowError):
        checked = np.empty(0)
    if checked.shape not in {(), (3,)} or not ((checked >= 0) & (checked <= LARGEST_FACTOR)).all():
        raise ValueError(f"factors[{name!r}] must be 0 … {LARGEST_FACTOR:g}, or three such numbers")
    return checked.astype(np.float32)


class RenderOptions(TypedDict, total=False):
    """Keywords of `render`."""

    order: Literal["auto"] | int
    tolerance: float
    noise_threshold: float
    min_samples: int | None
    max_samples: int | None
    pixel_samples: int | None
    time_limit: float | None
    pixel_filter: Literal["box", "gaussian", "blackman_harris"]
    filter_width: float
    shadows: bool
    shadow_rays: int
    transparent_bounces: int
    max_bounces: int
    glossy_bounces: int | None
    transmission_bounces: int | None
    filter_glossy: float
    clamp_indirect: float
    darken_doubled: bool
    passes: Sequence[str]
    groups: bool
    aovs: bool
    alpha_threshold: float
    mist: tuple[float, float, float]
    cryptomatte_levels: int
    exposure: float
    threads: int
    seed: int
    kept_light: KeptLight | None
    progress: Callable[[float], object] | None
    on_update: Callable[[Pixels, RenderReport], object] | None


_render = explained(_core.render)


@overload
def render(
    scene: Scene, width: int, height: int, *, return_report: Literal[False] = ..., **options: Unpack[RenderOptions]
) -> RenderResult: ...
@overload
def render(
    scene: Scene, width: int, height: int, *, return_report: Literal[True], **options: Unpack[RenderOptions]
) -> tuple[RenderResult, RenderReport]: ...
def render(*given: Any, **named: Any) -> Any:
    wants_report = checked_flag("return_report", named.pop("return_report", False))
    layers, report = _render(*given, **named)
    result = RenderResult(layers, report)
    return (result, report) if wants_report else result


_own = inspect.Parameter("return_report", inspect.Parameter.KEYWORD_ONLY, default=False)
_known = inspect.signature(_render).parameters.values()
render.__signature__ = inspect.Signature([*_known, _own])  # type: ignore[attr-defined]
render.__doc__ = _render.__doc__
