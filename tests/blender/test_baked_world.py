# SPDX-License-Identifier: MIT
"""Worlds of nodes that are baked to a picture and suns, against Cycles."""

from __future__ import annotations

import math
import sys
from typing import Any

import numpy as np
import pytest

from shlight_blender import worker_process
from shlight_blender.engine import ShlightRenderEngine
from shlight_blender.export import bake

# Angles and turns without symmetry.
ELEVATION, TURN = 0.5, 0.8


@pytest.fixture(autouse=True)
def _nothing_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bake, "kept", type(bake.kept)())


def background(studio: Any) -> Any:
    """The Background node of a fresh world; the picture it is baked to is small."""
    studio.scene.shlight.world_width = 256
    return studio.world()


def add_node(studio: Any, kind: str, **properties: Any) -> Any:
    """A node of the world; `properties` are its own or its sockets'."""
    node = studio.scene.world.node_tree.nodes.new(kind)
    for name, value in properties.items():
        if name in node.inputs:
            node.inputs[name].default_value = value
        else:
            setattr(node, name, value)
    return node


def link(studio: Any, output: Any, socket: Any) -> None:
    studio.scene.world.node_tree.links.new(output, socket)


def set_sky(studio: Any, *, disc: bool, strength: float = 0.1, **properties: Any) -> Any:
    """A world of the sky with a sun that Blender's version has; returns the node."""
    lit = background(studio)
    lit.inputs["Strength"].default_value = strength
    sky = add_node(studio, "ShaderNodeTexSky")
    kinds = sky.bl_rna.properties["sky_type"].enum_items.keys()
    sky.sky_type = next(kind for kind in ("MULTIPLE_SCATTERING", "NISHITA") if kind in kinds)
    sky.sun_elevation, sky.sun_rotation, sky.sun_disc = ELEVATION, TURN, disc
    for name, value in properties.items():
        setattr(sky, name, value)
    link(studio, sky.outputs["Color"], lit.inputs["Color"])
    return sky


def set_gradient(studio: Any) -> None:
    """Three colours, each bright on a side of its own, mixed with noise that a node bends which makes it be baked."""
    lit = background(studio)
    coordinates = add_node(studio, "ShaderNodeTexCoord")
    half = add_node(studio, "ShaderNodeVectorMath", operation="MULTIPLY_ADD")
    half.inputs[1].default_value = half.inputs[2].default_value = (0.5, 0.5, 0.5)
    noise = add_node(studio, "ShaderNodeTexNoise", Scale=2.0)
    mixed = add_node(studio, "ShaderNodeMixRGB")
    mixed.inputs["Fac"].default_value = 0.3
    link(studio, coordinates.outputs["Generated"], half.inputs[0])
    link(studio, coordinates.outputs["Generated"], noise.inputs["Vector"])
    link(studio, add_node(studio, "ShaderNodeAmbientOcclusion").outputs["AO"], noise.inputs["Distortion"])
    link(studio, half.outputs[0], mixed.inputs["Color1"])
    link(studio, noise.outputs["Color"], mixed.inputs["Color2"])
    link(studio, mixed.outputs["Color"], lit.inputs["Color"])


def ball_and_floor(studio: Any) -> None:
    studio.plane(material=studio.material(Color=(0.7, 0.6, 0.5)))
    studio.ball(material=studio.material(Color=(0.8, 0.7, 0.6)), rings=48, location=(0, 0, 1))
    studio.camera(target=(0, 0, 0.8))
    studio.scene.shlight.shadow_rays = 64
    studio.scene.cycles.samples = 512


def test_sky(studio: Any) -> None:
    studio.ball_in_view_of_the_world()
    studio.resolution(32, 24)
    set_sky(studio, disc=False)
    studio.scene.shlight.pixel_samples = 16
    studio.compare(error=2e-3)
    assert studio.messages() == []


@pytest.mark.parametrize(
    "sun",
    [
        pytest.param({}),
        pytest.param({"sun_size": math.radians(0.05)}, marks=pytest.mark.slow),
        pytest.param({"sun_size": math.radians(4.0)}, marks=pytest.mark.slow),
        pytest.param({"sun_size": math.radians(8.0)}, marks=pytest.mark.slow),
        pytest.param({"sun_elevation": math.radians(0.1), "sun_intensity": 3.0}, marks=pytest.mark.slow),
    ],
)
def test_sky_with_its_sun(studio: Any, sun: dict[str, float]) -> None:
    ball_and_floor(studio)
    studio.resolution(32, 24)
    set_sky(studio, disc=True, **sun)
    studio.compare(error=2e-3)


def test_gradient_and_noise(studio: Any) -> None:
    studio.ball_in_view_of_the_world()
    studio.resolution(32, 24)
    set_gradient(studio)
    studio.scene.shlight.pixel_samples = 16
    studio.compare(error=2e-3)
    assert studio.messages() == []


def bake_now(studio: Any) -> bake.Baked:
    baked = bake.bake_world(studio.scene.world, studio.scene)
    assert baked is not None
    return baked


def test_sun_below_the_horizon(studio: Any) -> None:
    set_sky(studio, disc=True, sun_elevation=math.radians(-3.0))
    assert bake_now(studio).suns == []


def test_rays_are_not_told_apart(studio: Any) -> None:
    """The camera sees red, all else blue: the blue is baked, and named."""
    lit = background(studio)
    rays = add_node(studio, "ShaderNodeLightPath")
    mixed = add_node(studio, "ShaderNodeMixRGB", Color1=(0, 0, 1, 1), Color2=(1, 0, 0, 1))
    link(studio, rays.outputs["Is Camera Ray"], mixed.inputs["Fac"])
    link(studio, mixed.outputs["Color"], lit.inputs["Color"])
    np.testing.assert_allclose(bake_now(studio).picture.mean(axis=(0, 1)), (0, 0, 1), atol=1e-6)
    studio.camera()
    assert studio.messages() == [
        "World 'World', node 'Light Path': kinds of rays are not told apart; all see what diffuse rays see"
    ]


def test_frame_of_an_animated_world(studio: Any) -> None:
    lit = background(studio)
    half = add_node(studio, "ShaderNodeValue")
    doubled = add_node(studio, "ShaderNodeMath", operation="MULTIPLY")
    doubled.inputs[1].default_value = 2.0
    link(studio, half.outputs[0], doubled.inputs[0])
    link(studio, doubled.outputs[0], lit.inputs["Strength"])
    lit.inputs["Color"].default_value = (1, 1, 1, 1)
    for frame, value in ((1, 0.1), (11, 0.3)):
        half.outputs[0].default_value = value
        half.outputs[0].keyframe_insert("default_value", frame=frame)
    studio.scene.frame_set(11)
    np.testing.assert_allclose(bake_now(studio).picture.mean(), 0.6, rtol=1e-5)


def test_renders_of_the_same_world_bake_it_once(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    studio.ball_in_view_of_the_world()
    studio.resolution(16, 12)
    set_gradient(studio)
    studio.scene.shlight.world_width = 128
    started: list[Any] = []
    run = bake._baked
    monkeypatch.setattr(bake, "_baked", lambda *given: started.append(given) or run(*given))
    first, second = studio.render("SHLIGHT"), studio.render("SHLIGHT")
    assert len(started) == 1
    np.testing.assert_array_equal(first, second)
    studio.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value *= 2.0
    # Twice the light everywhere: both draw the same samples.
    np.testing.assert_allclose(studio.render("SHLIGHT")[..., :3], 2.0 * first[..., :3], rtol=1e-3, atol=1e-5)
    assert len(started) == 2


# --- what can go wrong


def test_a_bake_that_fails_is_named(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    studio.plane()
    studio.camera()
    set_sky(studio, disc=False)
    monkeypatch.setattr(bake, "command", lambda *_: [sys.executable, "-c", "raise SystemExit('no Cycles')"])
    text = "\n".join(studio.messages())
    assert "World 'World': it could not be baked to a picture (Blender ended unexpectedly with code 1" in text
    assert "no Cycles" in text
    assert "node 'Sky Texture': Sky Texture is not supported" in text
    monkeypatch.setattr(bake, "command", lambda *_: ["/nowhere/blender"])
    assert "No such file" in "\n".join(studio.messages())


def sleeping(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The bake does nothing for a minute; returns its processes."""
    started: list[Any] = []
    popen = worker_process.subprocess.Popen

    def start(command: Any, **given: Any) -> Any:
        started.append(popen([sys.executable, "-c", "import time; time.sleep(60)"], **given))
        return started[-1]

    monkeypatch.setattr(worker_process.subprocess, "Popen", start)
    return started


def test_a_render_that_is_stopped_in_the_bake_is_empty(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    studio.camera()
    set_sky(studio, disc=False)
    started = sleeping(monkeypatch)
    said: list[str] = []

    def wait(self: ShlightRenderEngine, text: str) -> bool:
        said.append(text)
        return text != "Baking the world"

    monkeypatch.setattr(ShlightRenderEngine, "_wait", wait)
    assert not studio.render("SHLIGHT").any()
    assert said[-1] == "Baking the world"
    assert started[0].returncode < 0


def test_a_bake_that_takes_too_long_is_stopped(studio: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    set_sky(studio, disc=False)
    started = sleeping(monkeypatch)
    monkeypatch.setattr(bake, "LONGEST_SECONDS", 0.2)
    with pytest.raises(bake.BakeError, match="takes longer"):
        bake.bake_world(studio.scene.world, studio.scene)
    assert started[0].returncode < 0
