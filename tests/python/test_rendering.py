# SPDX-License-Identifier: MIT
"""What a render returns: an array that knows its passes, groups and report, and files of it."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene_cases import lit_floor

import shlight
from shlight import images, nodes


@pytest.fixture(scope="module")
def result() -> shlight.RenderResult:
    scene = lit_floor(object_names="floor", bsdf=nodes.lambert(0.5).with_aovs({"half": 0.5}))
    scene.set_environment((0.1, 0.2, 0.3), group="sky")
    names = ["depth", "normal", "uv", "diffuse_direct", "cryptomatte_object"]
    return shlight.render(scene, 8, 6, passes=names, groups=True, aovs=True, max_samples=1, max_bounces=0)


def test_the_result_is_the_picture_and_knows_the_rest(result: shlight.RenderResult) -> None:
    picture = np.asarray(result)
    assert type(picture) is np.ndarray
    assert (picture.shape, picture.dtype) == ((6, 8, 4), np.float32)
    assert set(result.passes) == {"depth", "normal", "uv", "diffuse_direct", "cryptomatte_object", "aov_half"}
    assert set(result.groups) == {"", "sky"}
    np.testing.assert_allclose(sum(result.groups.values()), picture[..., :3], atol=1e-6)
    assert result.report is not None
    assert result.report.hits == 48
    text = repr(result)
    assert len(text) < 400
    for word in ("8 × 6", "depth", "sky", "RenderReport(passes=1", "hits=48"):
        assert word in text


def test_old_forms_of_the_call_still_work(result: shlight.RenderResult) -> None:
    image, report = shlight.render(lit_floor(), 4, 4, return_report=True, max_bounces=0)
    assert repr(report) == repr(image.report)
    np.testing.assert_array_equal(result["combined"], result)
    assert "depth" in result
    assert dict(result).keys() == dict(result.items()).keys() == set(result.layers)
    np.testing.assert_array_equal(result["combined_sky"], result.groups["sky"])


def test_what_is_computed_of_a_result_is_a_plain_array(result: shlight.RenderResult) -> None:
    plain: dict[str, Callable[[Any], Any]] = {
        "slice": lambda x: x[..., :3],
        "product": lambda x: 2 * x,
        "maximum": lambda x: np.maximum(x, 0.5),
        "mean": lambda x: x.mean(axis=-1),
        "stack": lambda x: np.stack([x, x]),
    }
    for name, function in plain.items():
        found = function(result)
        assert type(found) is np.ndarray, name
        np.testing.assert_array_equal(found, function(np.asarray(result)))
    assert isinstance(result.mean(), np.float32)
    brighter = result.copy()
    brighter *= 2
    assert isinstance(brighter, shlight.RenderResult)
    assert result.reshape(-1, 4).passes == {}


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies_of_a_result_keep_what_it_knows(result: shlight.RenderResult, way: Callable[[Any], Any]) -> None:
    again = way(result)
    np.testing.assert_array_equal(again, result)
    assert repr(again) == repr(result)
    np.testing.assert_array_equal(again.passes["depth"], result.passes["depth"])


def test_saved_layers_are_read_by_name(result: shlight.RenderResult, tmp_path: Path) -> None:
    result.save(tmp_path / "layers.EXR")
    layers = images.read_layers(tmp_path / "layers.EXR")
    assert {name.removeprefix("aov_") for name in result.layers} == set(layers)
    for name, expected in result.layers.items():
        np.testing.assert_array_equal(layers[name.removeprefix("aov_")], expected, err_msg=name)
    with pytest.raises(ValueError, match=r"^view_layer must be one of 'ViewLayer', got 'other'"):
        images.read_layers(tmp_path / "layers.EXR", view_layer="other")
    plain = shlight.render(lit_floor(), 4, 3, max_bounces=0)
    plain.save(tmp_path / "plain.exr")
    np.testing.assert_array_equal(images.read_exr(tmp_path / "plain.exr"), plain)
    np.testing.assert_array_equal(images.read_layers(tmp_path / "plain.exr")["combined"], plain)
    with pytest.raises(ValueError, match=r"^path must end in .png or .exr"):
        plain.save(tmp_path / "plain.jpg")
    plain.save(tmp_path / "plain.png")
    with pytest.raises(OSError, match="not an OpenEXR"):
        images.read_layers(tmp_path / "plain.png")


def test_a_mix_is_the_picture_of_lamps_of_other_power() -> None:
    """It compares a scene of two lamps and a sky, with bounces, with renders whose lamps have the mix's power."""

    def lit(key: Any, fill: Any) -> shlight.RenderResult:
        scene = lit_floor()
        scene.add_sphere_light((1, 0, 2), 0.3, np.multiply(4.0, key), group="Key")
        scene.add_sphere_light((-1, 0, 2), 0.3, np.multiply([1.0, 2.0, 3.0], fill), group="Fill")
        options = {"passes": ["depth", "diffuse_direct", "diffuse_color"], "max_bounces": 2, "pixel_samples": 4}
        return shlight.render(scene, 12, 9, groups=True, shadow_rays=64, **options)

    rendered = lit(1.0, 1.0)
    mix = rendered.mix({"Key": 1.5, "Fill": (1, 0.9, 0.0)})
    expected = lit(1.5, (1, 0.9, 0.0))
    np.testing.assert_allclose(np.asarray(mix), np.asarray(expected), rtol=2e-3, atol=2e-3 * float(expected.max()))
    total = sum(light.astype(float) for light in mix.groups.values())
    np.testing.assert_allclose(np.asarray(mix)[..., :3], total, rtol=1e-5, atol=1e-5)
    assert set(mix.passes) == {"depth", "diffuse_color"}
    np.testing.assert_array_equal(rendered.mix({}), rendered)
    dark = rendered.mix(dict.fromkeys(rendered.groups, 0))
    assert (np.asarray(dark)[..., :3] <= 1e-6 * float(rendered.max())).all()
    assert (np.asarray(dark) >= 0).all()
    for wrong in ({"Kye": 1}, {"Key": -1}, {"Key": float("nan")}, {"Key": (1, 2)}, {"Key": "much"}):
        with pytest.raises(ValueError, match=r"^factors"):
            rendered.mix(wrong)


def test_a_notebook_shows_the_picture(result: shlight.RenderResult, tmp_path: Path) -> None:
    (tmp_path / "shown.png").write_bytes(result._repr_png_() or b"")
    np.testing.assert_array_equal(images.read_texture(tmp_path / "shown.png"), images.linear_to_srgb8(result))
    assert result.reshape(-1)._repr_png_() is None
