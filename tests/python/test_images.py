# SPDX-License-Identifier: MIT
from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from shlight import images


@pytest.fixture
def image() -> np.ndarray:
    return np.random.default_rng(1).standard_normal((5, 7, 4)).astype(np.float32)


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_exr_comes_back_bit_for_bit(tmp_path: Path, image: np.ndarray, channels: int) -> None:
    image = image[..., :channels]
    image[0, 0, 0] = 1e30
    images.write_exr(tmp_path / "a.exr", image)
    back = images.read_exr(tmp_path / "a.exr")
    assert back.dtype == np.float32
    np.testing.assert_array_equal(back, image)


def test_exr_rows_go_from_top_to_bottom_and_channels_are_named(tmp_path: Path) -> None:
    import OpenImageIO as oiio

    image = np.zeros((2, 3, 4), np.float32)
    image[0, :, 1] = 1
    images.write_exr(tmp_path / "a.exr", image)
    source = oiio.ImageInput.open(str(tmp_path / "a.exr"))
    assert tuple(source.spec().channelnames) == ("R", "G", "B", "A")
    np.testing.assert_array_equal(source.read_scanline(0, 0, "float").reshape(3, 4)[:, 1], 1)
    source.close()


def test_a_list_and_float64_are_accepted(tmp_path: Path) -> None:
    images.write_exr(tmp_path / "a.exr", [[[0.1, 0.2, 0.3]]])
    np.testing.assert_array_equal(images.read_exr(tmp_path / "a.exr"), np.float32([[[0.1, 0.2, 0.3]]]))


@pytest.mark.parametrize("bad", [np.zeros((4, 4)), np.zeros((4, 4, 2)), np.zeros((0, 4, 3)), [["a"]], None])
def test_what_is_no_image_is_refused_by_name(tmp_path: Path, bad: object) -> None:
    with pytest.raises(ValueError, match="image"):
        images.write_exr(tmp_path / "a.exr", bad)
    assert list(tmp_path.iterdir()) == []


def test_png_holds_the_bytes_given(tmp_path: Path) -> None:
    import OpenImageIO as oiio

    pixels = np.random.default_rng(2).integers(0, 256, (6, 5, 4), dtype=np.uint8)
    images.write_png(tmp_path / "a.png", pixels)
    source = oiio.ImageInput.open(str(tmp_path / "a.png"), unassociated())
    np.testing.assert_array_equal(source.read_image("uint8"), pixels)
    source.close()


def unassociated() -> object:
    import OpenImageIO as oiio

    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    return config


def test_png_of_floats_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="image_srgb_uint8"):
        images.write_png(tmp_path / "a.png", np.zeros((2, 2, 3)))


def test_srgb_curve() -> None:
    linear = np.array([[[0.0, 0.0031308, 0.18], [0.5, 1.0, 7.0], [-1.0, np.nan, np.inf]]])
    # 0.0031308 -> 0.04045, 0.18 -> 0.46136, 0.5 -> 0.73536 (IEC 61966-2-1), times 255
    expected = [[[0, 10, 118], [188, 255, 255], [0, 0, 255]]]
    np.testing.assert_array_equal(images.linear_to_srgb8(linear), expected)
    np.testing.assert_array_equal(images.linear_to_srgb8(linear / 4, exposure=2), expected)


def test_srgb_takes_premultiplied_colour_apart() -> None:
    pixels = images.linear_to_srgb8([[[0.25, 0.5, 0.0, 0.5], [0.3, 0.3, 0.3, 0.0]]])
    np.testing.assert_array_equal(pixels, [[[188, 255, 0, 128], [0, 0, 0, 0]]])


def test_writing_replaces_and_leaves_nothing_beside(tmp_path: Path, image: np.ndarray) -> None:
    target = tmp_path / "a.exr"
    target.write_bytes(b"old")
    images.write_exr(target, image)
    np.testing.assert_array_equal(images.read_exr(target), image)
    assert [p.name for p in tmp_path.iterdir()] == ["a.exr"]


def test_a_missing_folder_is_named(tmp_path: Path, image: np.ndarray) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        images.write_exr(tmp_path / "none" / "a.exr", image)
    assert caught.value.filename == str(tmp_path / "none" / "a.exr")


def test_a_failed_write_keeps_the_old_file(tmp_path: Path, image: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "a.exr"
    target.write_bytes(b"old")

    def full(*_: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="no space left"):
        images.write_exr(target, image)
    assert target.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.exr"]


@pytest.mark.skipif(os.geteuid() == 0 or not Path("/proc").is_dir(), reason="root may write everywhere")
def test_a_folder_without_permission_is_named(tmp_path: Path, image: np.ndarray) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(PermissionError) as caught:
        images.write_exr(tmp_path / "a.exr", image)
    assert caught.value.filename == str(tmp_path / "a.exr")


def test_reading_what_is_no_exr_says_so(tmp_path: Path) -> None:
    (tmp_path / "text.exr").write_text("hello")
    images.write_png(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8))
    for name in ("text.exr", "a.png"):
        with pytest.raises(OSError, match=name):
            images.read_exr(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        images.read_exr(tmp_path / "missing.exr")


def test_a_truncated_exr_is_an_error(tmp_path: Path, image: np.ndarray) -> None:
    images.write_exr(tmp_path / "a.exr", np.tile(image, (40, 40, 1)))
    whole = (tmp_path / "a.exr").read_bytes()
    (tmp_path / "a.exr").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(OSError, match=r"a\.exr"):
        images.read_exr(tmp_path / "a.exr")
