# SPDX-License-Identifier: MIT
"""Images as files: float32 OpenEXR and 8-bit PNG through OpenImageIO.

An image is an array (height, width, channels) with row 0 on top. A file appears under its name only when it is
complete: it is written beside it under a temporary name, then renamed.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from shlight._arrays import checked_array, checked_flag, checked_number

__all__ = [
    "linear_to_srgb8",
    "read_environment",
    "read_exr",
    "read_layers",
    "read_texture",
    "write_exr",
    "write_layers",
    "write_png",
]

_ROWS = 256  # that are read at once to see whether a file is whole
_PNG_END = b"IEND\xaeB`\x82"  # which readers do not ask for
_TEXTURE_NUMBERS = ("uint8", "uint16", "half", "float")
_CHANNEL_NAMES = {1: ("Y",), 3: ("R", "G", "B"), 4: ("R", "G", "B", "A")}
# Passes of `shlight.render` whose channels are not RGBA: what Blender's files call them, and their channels.
_PASS_CHANNELS = {
    "depth": ("Depth", "Z"),
    "mist": ("Mist", "Z"),
    "position": ("Position", "XYZ"),
    "normal": ("Normal", "XYZ"),
    "uv": ("UV", "UVA"),
    "object_index": ("IndexOB", "X"),
    "material_index": ("IndexMA", "X"),
    "denoising_normal": ("Denoising Normal", "XYZ"),
    "denoising_depth": ("Denoising Depth", "Z"),
}
_PASS_NAMES = {
    "combined": "Combined",
    "diffuse_direct": "DiffDir",
    "diffuse_indirect": "DiffInd",
    "diffuse_color": "DiffCol",
    "glossy_direct": "GlossDir",
    "glossy_indirect": "GlossInd",
    "glossy_color": "GlossCol",
    "transmission_direct": "TransDir",
    "transmission_indirect": "TransInd",
    "transmission_color": "TransCol",
    "emission": "Emit",
    "environment": "Env",
    "denoising_albedo": "Denoising Albedo",
}
_CRYPTOMATTES = {f"cryptomatte_{kind.lower()}": f"Crypto{kind}" for kind in ("Object", "Material", "Asset")}


def write_exr(path: str | os.PathLike[str], image: npt.ArrayLike) -> None:
    """Writes an image of 1, 3 or 4 channels as 32-bit float OpenEXR, compressed without loss.

    With 4 channels RGB is premultiplied by alpha, as OpenEXR asks and as `shlight.render` returns it.
    Raises ValueError for an array that is no such image and for a path that ends like another format's, OSError when
    the file cannot be written.
    """
    pixels = _checked_image("image", checked_array("image", image, np.float32))
    _write(checked_path(path), pixels, "openexr", "float", {"compression": "zip"})


def write_layers(
    path: str | os.PathLike[str], passes: Mapping[str, npt.ArrayLike], *, view_layer: str = "ViewLayer"
) -> None:
    """Writes passes as `shlight.render` returns them as one 32-bit float OpenEXR file, compressed without loss.

    Channels are named as in Blender's files of up to version 4.5, "ViewLayer.Depth.Z" for instance: light groups
    "Combined_NAME", AOVs NAME, and other names than those of passes as they are. view_layer: what names begin with.
    Raises ValueError for arrays that are no images of one size and for a path that ends like another format's, OSError
    when the file cannot be written.
    """
    if not isinstance(view_layer, str) or not view_layer or "\0" in view_layer:
        raise ValueError("view_layer must be a string that is not empty")
    try:
        given = dict(passes)
    except (TypeError, ValueError):
        given = {}
    if not given or not all(isinstance(name, str) for name in given):
        raise ValueError("passes must be a mapping of names to images, one at least")
    images = {name: _checked_layer(name, checked_array(name, image, np.float32)) for name, image in given.items()}
    if len({image.shape[:2] for image in images.values()}) != 1:
        raise ValueError("passes must be of the same height and width")
    names = [f"{view_layer}.{channel}" for name, image in images.items() for channel in _channels(name, image.shape[2])]
    pixels = np.concatenate(list(images.values()), axis=2)
    _write(checked_path(path), pixels, "openexr", "float", {"compression": "zip"}, tuple(names))


def _channels(name: str, count: int) -> list[str]:
    """The names of a pass's channels in a file."""
    if name in _CRYPTOMATTES:
        return [f"{_CRYPTOMATTES[name]}{i // 4:02d}.{'rgba'[i % 4]}" for i in range(count)]
    layer, channels = _PASS_CHANNELS.get(name, (_PASS_NAMES.get(name, name.removeprefix("aov_")), ""))
    if name.startswith("combined_"):
        layer = f"Combined_{name.removeprefix('combined_')}"
    if len(channels) != count:
        channels = "X" if count == 1 else "RGBA"[:count]
    return [f"{layer}.{channel}" for channel in channels]


def read_layers(path: str | os.PathLike[str], *, view_layer: str | None = None) -> dict[str, npt.NDArray[np.float32]]:
    """Reads the passes of an OpenEXR file of `write_layers`, `RenderResult.save` or Blender, by name.

    view_layer: whose passes; None: of the only one. Returns arrays (height, width, channels) float32 under the names of
    `shlight.render`: "combined", "depth", "combined_NAME" of light groups. AOVs and what else a file may hold have the
    names that they have there. A file of plain RGBA has "combined" alone.
    Raises ValueError naming view_layer, OSError when the file is missing or cannot be read.
    """
    if view_layer is not None and not isinstance(view_layer, str):
        raise ValueError(f"view_layer must be a string or None, got {type(view_layer).__name__}")
    found: dict[str, dict[str, dict[tuple[int, str], npt.NDArray[np.float32]]]] = {}
    for spec, pixels in image_parts(path, only="openexr"):
        for full_name, values in zip(spec.channelnames, np.moveaxis(pixels, 2, 0), strict=True):
            before, _, channel = full_name.rpartition(".")
            owner, dot, layer = before.partition(".")
            if not dot:
                owner, layer = "", before or "Combined"
            name, number = _pass_of(layer)
            found.setdefault(owner, {}).setdefault(name, {})[number, channel] = values
    if view_layer is None and len(found) == 1:
        view_layer = next(iter(found))
    if view_layer not in found:
        raise ValueError(f"view_layer must be one of {', '.join(map(repr, found))}, got {view_layer!r}")
    return {
        name: np.stack([parts[key] for key in sorted(parts, key=_channel_place)], axis=2)
        for name, parts in found[view_layer].items()
    }


def image_parts(
    path: str | os.PathLike[str], *, only: str | None = None, associate: bool = True
) -> Iterator[tuple[Any, npt.NDArray[np.float32]]]:
    """All parts of a picture's file: the oiio.ImageSpec of each, and its channels (height, width, n).

    only: the one format that is read. associate: as of `read_texture`.
    """
    source = _opened(path, associate=associate)
    try:
        suits = only in (None, source.format_name())
        part = 0
        while source.seek_subimage(part, 0):
            pixels = source.read_image(part, 0, 0, 10**4, "float") if suits else None
            if pixels is None:
                raise OSError(f"{path}: {source.geterror().strip() or 'not an OpenEXR image'}")
            yield source.spec(), np.atleast_3d(pixels)
            part += 1
    finally:
        source.geterror()  # of the part that is not there
        source.close()


def _pass_of(layer: str) -> tuple[str, int]:
    """The name that `shlight.render` gives what a file has under a name, and which of a Cryptomatte's layers it is."""
    for name, in_file in _CRYPTOMATTES.items():
        if (number := layer.removeprefix(in_file)).isdigit():
            return name, int(number)
    if layer.startswith("Combined_"):
        return f"combined_{layer.removeprefix('Combined_')}", 0
    names = {own: name for name, own in _PASS_NAMES.items()} | {own: name for name, (own, _) in _PASS_CHANNELS.items()}
    return names.get(layer, layer), 0


def _channel_place(key: tuple[int, str]) -> tuple[int, int, str]:
    """Sorts RGBA, XYZ and UVA by their place in a pixel."""
    return key[0], "RGBXYZUVA".find(key[1].upper()), key[1]


def read_exr(path: str | os.PathLike[str]) -> npt.NDArray[np.float32]:
    """Reads the first part of an OpenEXR file as float32 of shape (height, width, channels).

    Raises OSError when the file is missing or cannot be read.
    """
    return np.ascontiguousarray(_read(path, only="openexr"), dtype=np.float32)


def read_texture(path: str | os.PathLike[str], *, associate: bool = True) -> npt.NDArray[Any]:
    """Reads a picture of any format: (height, width, channels) of uint8, uint16, float16 or float32, as its file has.

    associate: colours are multiplied with alpha; or else they are as the file has them.
    Raises ValueError naming the argument, OSError when the file is missing or cannot be read.
    """
    pixels = _read(path, associate=checked_flag("associate", associate))
    return np.ascontiguousarray(pixels[..., : {2: 1}.get(pixels.shape[2], 4)])


def read_environment(path: str | os.PathLike[str]) -> npt.NDArray[np.float32]:
    """Reads a picture of all directions, such as an .exr or .hdr file, as `Scene.set_environment` takes it.

    Returns (height, width, 3) float32, linear; integers are taken for sRGB.
    Raises ValueError naming the argument, OSError when the file is missing or cannot be read.
    """
    rgb = read_texture(path)[..., :3]
    linear = decoded_srgb(rgb) if rgb.dtype.kind == "u" else rgb
    return np.ascontiguousarray(np.broadcast_to(linear, (*rgb.shape[:2], 3)), np.float32)


def decoded_srgb(pixels: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Linear light 0 … 1 of unsigned integers that hold sRGB (IEC 61966-2-1)."""
    encoded = pixels / np.iinfo(pixels.dtype).max
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def check_texture(path: str | os.PathLike[str]) -> None:
    """Raises OSError if `read_texture` does not know a file's format, or the file is missing."""
    _opened(path).close()


def _opened(path: str | os.PathLike[str], *, associate: bool = True) -> Any:
    import OpenImageIO as oiio

    path = checked_path(path)
    with path.open("rb"):  # the usual FileNotFoundError, PermissionError or IsADirectoryError
        pass
    wishes = oiio.ImageSpec()
    wishes["oiio:UnassociatedAlpha"] = 0 if associate else 1
    source = oiio.ImageInput.open(_as_it_is(path), wishes)
    if source is None:
        raise OSError(f"{path}: {oiio.geterror().strip()}")
    return source


def _read(path: str | os.PathLike[str], *, only: str | None = None, associate: bool = True) -> npt.NDArray[Any]:
    """Numbers of the file's type, floats where it is another than textures have; only: the one format that is read."""
    source = _opened(path, associate=associate)
    try:
        own = str(source.spec().format)
        suits = only in (None, source.format_name())
        pixels = source.read_image(own if own in _TEXTURE_NUMBERS else "float") if suits else None
        reason = source.geterror().strip() or "not an OpenEXR image"
    finally:
        source.close()
    if pixels is None:
        raise OSError(f"{path}: {reason}")
    return np.atleast_3d(pixels)


def write_png(path: str | os.PathLike[str], image_srgb_uint8: npt.ArrayLike) -> None:
    """Writes a uint8 image of 1, 3 or 4 channels, sRGB encoded, alpha not premultiplied, as PNG.

    Raises ValueError for an array that is no such image and for a path that ends like another format's, OSError when
    the file cannot be written.
    """
    if getattr(image_srgb_uint8, "dtype", None) != np.uint8:
        raise ValueError("image_srgb_uint8 must be of dtype uint8; linear_to_srgb8 makes it from linear light")
    pixels = _checked_image("image_srgb_uint8", np.ascontiguousarray(image_srgb_uint8))
    _write(checked_path(path), pixels, "png", "uint8", {"oiio:ColorSpace": "sRGB", "oiio:UnassociatedAlpha": 1})


def linear_to_srgb8(image: npt.ArrayLike, exposure: float = 0.0) -> npt.NDArray[np.uint8]:
    """Linear light to 8-bit sRGB (IEC 61966-2-1), brightened by `exposure` stops first; what is brighter than 1 clips.

    Of 4 channels the last is alpha: RGB is divided by it, and alpha itself stays linear. NaN becomes black.
    exposure: -500 … 500.
    """
    pixels = _checked_image("image", checked_array("image", image, np.float32))
    stops = checked_number("exposure", exposure)
    if not -500 <= stops <= 500:
        raise ValueError(f"exposure must be -500 … 500, got {stops}")
    linear = np.nan_to_num(pixels, nan=0.0).astype(np.float64)
    colour = linear[..., :3]
    if linear.shape[2] == 4:
        alpha = np.clip(linear[..., 3:], 0.0, 1.0)
        colour = np.divide(colour, alpha, out=np.zeros_like(colour), where=alpha > 0)
        linear[..., 3:] = alpha
    colour = np.clip(colour * 2.0**stops, 0.0, 1.0)
    linear[..., :3] = np.where(colour <= 0.0031308, 12.92 * colour, 1.055 * colour ** (1 / 2.4) - 0.055)
    srgb: npt.NDArray[np.uint8] = np.round(linear * 255).astype(np.uint8)
    return srgb


def _checked_image(name: str, pixels: npt.NDArray[Any]) -> npt.NDArray[Any]:
    if pixels.ndim != 3 or pixels.shape[2] not in _CHANNEL_NAMES or pixels.size == 0:
        raise ValueError(f"{name} must have shape (height, width, 1, 3 or 4), not {pixels.shape}")
    return pixels


def _checked_layer(name: str, pixels: npt.NDArray[Any]) -> npt.NDArray[Any]:
    if pixels.ndim != 3 or pixels.size == 0 or (pixels.shape[2] > 4 and name not in _CRYPTOMATTES):
        raise ValueError(f"{name} must have shape (height, width, channels), not {pixels.shape}")
    return pixels


def checked_path(path: str | os.PathLike[str]) -> Path:
    """The path, if it may name a file."""
    try:
        checked = Path(path)
    except TypeError:
        raise TypeError(f"path must be a string or a Path, got {type(path).__name__}") from None
    if "\0" in str(checked):
        raise ValueError("path must not contain a null character")
    if not checked.name:
        raise ValueError("path must name a file")
    return checked


def _check_suffix(path: Path, file_format: str, known: str) -> None:
    """known: suffixes of all formats, as "png:png;jpeg:jpg,jpeg"."""
    for entry in known.split(";"):
        other, _, suffixes = entry.partition(":")
        if other != file_format and path.suffix[1:].lower() in suffixes.split(","):
            raise ValueError(f"path must not end in {path.suffix}: the file is {file_format}, not {other}")


def _as_it_is(path: Path) -> Any:
    """A file's name for OpenImageIO; as bytes where it is not UTF-8. Raises OSError where this version takes none."""
    name = os.fspath(path)
    try:
        name.encode()
    except UnicodeEncodeError:
        import OpenImageIO as oiio

        given: Any = os.fsencode(path)
        try:
            oiio.ImageInput.open(given)
        except TypeError:
            raise OSError(f"{name!a}: OpenImageIO {oiio.VERSION_STRING} takes no name that is not UTF-8") from None
        return given
    return name


@contextmanager
def complete_or_absent(path: Path) -> Iterator[Path]:
    """A new empty file beside `path`, renamed to it when the block ends well and removed when not.

    It is on the disk before it is renamed, so that no crash of the machine leaves half of it under this name.
    """
    temporary = path.with_name(f".{secrets.token_hex(8)}{path.suffix}")
    try:
        temporary.touch(exist_ok=False)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from None
    try:
        yield temporary
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _write(
    path: Path,
    pixels: npt.NDArray[Any],
    file_format: str,
    channel_type: str,
    attributes: dict[str, str | int],
    names: tuple[str, ...] | None = None,
) -> None:
    import OpenImageIO as oiio

    _check_suffix(path, file_format, oiio.get_string_attribute("extension_list"))
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, channel_type)
    spec.channelnames = names or _CHANNEL_NAMES[channels]
    for name, value in attributes.items():
        spec.attribute(name, value)
    with complete_or_absent(path) as temporary:
        write_pixels(path, spec, pixels, file_format, temporary)


def write_pixels(path: Path, spec: Any, pixels: npt.NDArray[Any], file_format: str, place: Path) -> None:
    """Writes a file of an oiio.ImageSpec at `place`. OSError, which names `path`, where it cannot be written."""
    target = opened_output(path, spec, file_format, place)
    close_output(path, target, place, done=target.write_image(pixels))


def close_output(path: Path, target: Any, place: Path, *, done: bool = True) -> None:
    """Ends a file of `opened_output`. OSError, which names `path`, where it is not whole or what came before failed.

    It is read again: on a full disk OpenImageIO may lose the last bytes of a file and not say so.
    """
    import OpenImageIO as oiio

    if not (target.close() and done):
        raise OSError(f"{path}: {target.geterror().strip() or 'the file could not be written'}")
    source = oiio.ImageInput.open(_as_it_is(place))
    oiio.geterror()
    is_cut = source is None or (source.format_name() == "png" and not place.read_bytes().endswith(_PNG_END))
    if is_cut or not is_readable(source):
        raise OSError(f"{path}: the end of the file could not be written; the disk may be full")


def is_readable(source: Any) -> bool:
    """Whether all rows of an oiio.ImageInput can be read; closes it."""
    spec = source.spec()
    try:
        return all(_rows(source, spec, top) is not None for top in range(0, spec.height, _ROWS))
    finally:
        source.geterror()
        source.close()


def _rows(source: Any, spec: Any, top: int) -> npt.NDArray[Any] | None:
    end = min(top + _ROWS, spec.height)
    if spec.tile_width:
        return source.read_tiles(0, spec.width, top, end, 0, 1, 0, spec.nchannels, "float")
    return source.read_scanlines(top, end, 0, 0, spec.nchannels, "float")


def opened_output(path: Path, spec: Any, file_format: str, place: Path) -> Any:
    """An oiio.ImageOutput that writes at `place`. OSError, which names `path`, where it cannot be opened."""
    import OpenImageIO as oiio

    target = oiio.ImageOutput.create(file_format)
    if target is None or not target.open(_as_it_is(place), spec):
        raise OSError(f"{path}: {(target or oiio).geterror().strip()}")
    return target
