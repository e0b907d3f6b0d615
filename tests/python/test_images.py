# SPDX-License-Identifier: MIT
from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from shlight import images


@pytest.fixture
def image() -> np.ndarray:
    return np.random.default_rng(1).standard_normal((5, 7, 4)).astype(np.float32)


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_exr_holds_the_rows_from_top_to_bottom_and_comes_back(tmp_path: Path, image: np.ndarray, channels: int) -> None:
    image = image[..., :channels]
    image[0, 0, 0] = 1e30
    images.write_exr(tmp_path / "a.exr", image)
    images.write_exr(tmp_path / "list.exr", image.astype(np.float64).tolist())
    for name in ("a.exr", "list.exr"):
        back = images.read_exr(tmp_path / name)
        assert back.dtype == np.float32
        np.testing.assert_array_equal(back, image)
    source = oiio.ImageInput.open(str(tmp_path / "a.exr"))
    assert "".join(source.spec().channelnames) == {1: "Y", 3: "RGB", 4: "RGBA"}[channels]
    np.testing.assert_array_equal(source.read_image("float").reshape(image.shape), image)
    source.close()


def test_png_holds_the_bytes_given(tmp_path: Path) -> None:
    pixels = np.random.default_rng(2).integers(0, 256, (6, 5, 4), dtype=np.uint8)
    images.write_png(tmp_path / "a.png", pixels)
    as_they_are = oiio.ImageSpec()
    as_they_are.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(tmp_path / "a.png"), as_they_are)
    np.testing.assert_array_equal(source.read_image("uint8"), pixels)
    source.close()


def test_srgb_curve() -> None:
    linear = np.array([[[0.0, 0.0031308, 0.18], [0.5, 1.0, 7.0], [-1.0, np.nan, np.inf]]])
    # 0.0031308 -> 0.04045, 0.18 -> 0.46136, 0.5 -> 0.73536 (IEC 61966-2-1), times 255
    expected = [[[0, 10, 118], [188, 255, 255], [0, 0, 255]]]
    np.testing.assert_array_equal(images.linear_to_srgb8(linear), expected)
    np.testing.assert_array_equal(images.linear_to_srgb8(linear / 4, exposure=2), expected)


def test_srgb_takes_premultiplied_colour_apart() -> None:
    pixels = images.linear_to_srgb8([[[0.25, 0.5, 0.0, 0.5], [0.3, 0.3, 0.3, 0.0]]])
    np.testing.assert_array_equal(pixels, [[[188, 255, 0, 128], [0, 0, 0, 0]]])


def test_a_missing_folder_is_named(tmp_path: Path, image: np.ndarray) -> None:
    with pytest.raises(FileNotFoundError) as caught:
        images.write_exr(tmp_path / "none" / "a.exr", image)
    assert caught.value.filename == str(tmp_path / "none" / "a.exr")


def test_writing_replaces_the_old_file_or_keeps_it(
    tmp_path: Path, image: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.exr"
    target.write_bytes(b"old")
    images.write_exr(target, image)
    np.testing.assert_array_equal(images.read_exr(target), image)

    def full(*_: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="no space left"):
        images.write_exr(target, image / 2)
    np.testing.assert_array_equal(images.read_exr(target), image)
    assert [p.name for p in tmp_path.iterdir()] == ["a.exr"]


def test_reading_what_is_no_exr_says_so(tmp_path: Path, image: np.ndarray) -> None:
    images.write_exr(tmp_path / "half.exr", np.tile(image, (40, 40, 1)))
    whole = (tmp_path / "half.exr").read_bytes()
    (tmp_path / "half.exr").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "text.exr").write_text("hello")
    images.write_png(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8))
    for name in ("half.exr", "text.exr", "a.png"):
        with pytest.raises(OSError, match=name):
            images.read_exr(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        images.read_exr(tmp_path / "missing.exr")


def test_environments_are_linear(tmp_path: Path) -> None:
    sky = np.random.default_rng(1).uniform(0, 5, (3, 6, 3)).astype(np.float32)
    images.write_exr(tmp_path / "sky.exr", sky)
    np.testing.assert_array_equal(images.read_environment(tmp_path / "sky.exr"), sky)
    images.write_png(tmp_path / "sky.png", np.full((3, 6, 1), 188, np.uint8))
    expected = np.full((3, 6, 3), ((188 / 255 + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(images.read_environment(tmp_path / "sky.png"), expected, rtol=1e-6)
