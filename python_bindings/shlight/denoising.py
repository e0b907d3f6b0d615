# SPDX-License-Identifier: MIT
"""Pictures with less noise, by Intel's Open Image Denoise (OIDN) where Blender or the system has it.

It is called through ctypes by its C interface, which versions 1 and 2 share but for three names: a wheel of it would be
three times as large as shlight's, and Blender, where it matters most, has loaded it already.
"""

from __future__ import annotations

import ctypes
import functools
import importlib.util
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shlight._arrays import (
    Floats,
    check_finite,
    check_last,
    checked_array,
    checked_callable,
    checked_name,
    checked_threads,
)
from shlight._core import RenderCancelled

__all__ = ["denoise", "has_denoiser"]

FEATURES = ("denoising_albedo", "denoising_normal")
"""The passes that `denoise` takes beside the picture, in their order."""

_NAMES = (
    "libOpenImageDenoise.so.2",
    "libOpenImageDenoise.so.1",
    "OpenImageDenoise.dll",
    "@rpath/libOpenImageDenoise.2.dylib",
)
_QUALITIES = {"fast": 4, "balanced": 5, "high": 6}  # OIDN_QUALITY_…, of version 2
_CPU, _FLOAT3, _CANCELLED = 1, 3, 6  # OIDN_DEVICE_TYPE_CPU, OIDN_FORMAT_FLOAT3, OIDN_ERROR_CANCELLED
_Monitor = ctypes.CFUNCTYPE(ctypes.c_bool, ctypes.c_void_p, ctypes.c_double)


def has_denoiser() -> bool:
    """Whether `denoise` finds Open Image Denoise: loaded by Blender, in the module bpy, or in the system."""
    return _library() is not None


def denoise(
    image: ArrayLike,
    albedo: ArrayLike | None = None,
    normal: ArrayLike | None = None,
    *,
    quality: str = "high",
    threads: int = 0,
    progress: Callable[[float], bool] | None = None,
) -> NDArray[np.float32]:
    """A rendered picture with the noise taken out that Open Image Denoise takes for noise.

    image: (height, width, 3 or more) linear, as `render` returns it; channels from the fourth on stay as they are.
    albedo, normal: (height, width, 3) the passes "denoising_albedo" and "denoising_normal" of the same render; they
        keep edges and textures sharp. A normal needs an albedo.
    quality: "fast", "balanced" or "high"; version 1 knows high alone.
    threads: at most; 0: all cores.
    progress: is called with the finished share, 0 … 1; returning False cancels.

    Returns (height, width, channels of the image) float32.
    Raises ValueError or TypeError naming the argument, RenderCancelled, and RuntimeError where Open Image Denoise is
    missing.
    """
    picture = np.array(_checked_picture("image", image, None))
    features = {"color": np.ascontiguousarray(picture[..., :3])}
    for name, feature in (("albedo", albedo), ("normal", normal)):
        if feature is not None:
            features[name] = _checked_picture(name, feature, picture.shape[:2])
    if normal is not None and albedo is None:
        raise ValueError("normal needs an albedo")
    if progress is not None:
        checked_callable("progress", progress)
    level = _QUALITIES[checked_name("quality", quality, _QUALITIES)]
    library = _library()
    if library is None:
        raise RuntimeError("Open Image Denoise was not found; Blender and the module bpy have it")
    picture[..., :3] = _Device(library, checked_threads(threads)).filtered(features, level, progress)
    return picture


def _checked_picture(name: str, value: ArrayLike, size: tuple[int, ...] | None) -> Floats:
    array = checked_array(name, value, np.float32)
    if array.ndim != 3 or array.size == 0 or (size is None and array.shape[2] < 3):
        raise ValueError(f"{name} must have shape (height, width, channels), got {array.shape}")
    check_finite(name, array, 1)
    if size is not None:
        check_last(name, array, 3)
        if array.shape[:2] != size:
            raise ValueError(f"{name} must have the image's height and width {size}, got {array.shape[:2]}")
    return array


@functools.cache
def _library() -> ctypes.CDLL | None:
    for name in _candidates():
        try:
            library = ctypes.CDLL(name)
        except OSError:
            continue
        for function in ("oidnNewDevice", "oidnNewFilter"):
            getattr(library, function).restype = ctypes.c_void_p
        return library
    return None


def _candidates() -> Iterator[str]:
    yield from _NAMES  # one that is loaded answers to its name
    module = importlib.util.find_spec("bpy")
    if module is not None and module.origin is not None:
        yield from map(str, sorted((Path(module.origin).parent / "lib").glob("libOpenImageDenoise.*")))


class _Device:
    """The processor, as Open Image Denoise sees it."""

    def __init__(self, library: ctypes.CDLL, threads: int) -> None:
        self._library = library
        self._device = ctypes.c_void_p(library.oidnNewDevice(_CPU))
        self._set("Device", self._device, "numThreads", ctypes.c_int(threads))
        self._set("Device", self._device, "setAffinity", ctypes.c_bool(False))  # renders share the cores
        library.oidnCommitDevice(self._device)

    def __del__(self) -> None:
        self._library.oidnReleaseDevice(self._device)

    def _set(self, kind: str, owner: ctypes.c_void_p, name: str, value: Any) -> None:
        """Sets a parameter by the function of whichever version."""
        new, old = ("Bool", "1b") if isinstance(value, ctypes.c_bool) else ("Int", "1i")
        for suffix in (new, old):
            if (function := getattr(self._library, f"oidnSet{kind}{suffix}", None)) is not None:
                function(owner, name.encode(), value)
                return

    def filtered(
        self, features: dict[str, Floats], quality: int, progress: Callable[[float], bool] | None
    ) -> NDArray[np.float32]:
        """features: (height, width, 3) contiguous, "color" among them."""
        library = self._library
        output = np.empty_like(features["color"])
        height, width = output.shape[:2]
        raised: list[BaseException] = []

        @_Monitor
        def goes_on(_: object, share: float) -> bool:
            try:
                return progress is None or bool(progress(share))
            except BaseException as error:  # ctypes would print it and go on
                raised.append(error)
                return False

        ray_filter = ctypes.c_void_p(library.oidnNewFilter(self._device, b"RT"))
        try:
            for name, array in {**features, "output": output}.items():
                data = ctypes.c_void_p(array.ctypes.data)
                sizes = map(ctypes.c_size_t, (width, height, 0, 0, 0))
                library.oidnSetSharedFilterImage(ray_filter, name.encode(), data, _FLOAT3, *sizes)
            self._set("Filter", ray_filter, "hdr", ctypes.c_bool(True))
            if hasattr(library, "oidnSetFilterInt"):
                self._set("Filter", ray_filter, "quality", ctypes.c_int(quality))
            library.oidnSetFilterProgressMonitorFunction(ray_filter, goes_on, None)
            library.oidnCommitFilter(ray_filter)
            library.oidnExecuteFilter(ray_filter)
        finally:
            library.oidnReleaseFilter(ray_filter)
        if raised:
            raise raised[0]
        message = ctypes.c_char_p()
        error = library.oidnGetDeviceError(self._device, ctypes.byref(message))
        if error == _CANCELLED:
            raise RenderCancelled("denoising was cancelled")
        if error:
            raise RuntimeError(f"Open Image Denoise: {(message.value or b'').decode()}")
        return output
