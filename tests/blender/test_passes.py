# SPDX-License-Identifier: MIT
"""Passes of view layers and light groups against those of Cycles, and that they are named and complete."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from numpy.typing import NDArray

from shlight_blender import compat, passes
from shlight_blender.ui import data

oiio = pytest.importorskip("OpenImageIO")

SWITCHES = ("z", "mist", "position", "normal", "uv", "object_index", "material_index", "emit", "environment")
SWITCHES += ("diffuse_direct", "diffuse_indirect", "diffuse_color")
SWITCHES += ("glossy_direct", "glossy_indirect", "glossy_color")
SWITCHES += ("transmission_direct", "transmission_indirect", "transmission_color")
MATTES = ("cryptomatte_object", "cryptomatte_material", "cryptomatte_asset")
GROUPS = ("key", "fill", "sky")


def scene_with_groups(studio: Any) -> Any:
    scene = studio.scene
    studio.resolution(48, 36)
    matt = studio.material("ShaderNodeBsdfDiffuse", "Matt", Color=(0.6, 0.5, 0.3))
    glossy = studio.material("ShaderNodeBsdfGlossy", "Glossy", Color=(0.9, 0.7, 0.4), Roughness=0.5)
    for material, index in ((matt, 4), (glossy, 7)):
        material.pass_index = index
    floor = studio.plane(8, matt, "Floor")
    floor.data.uv_layers.new(name="UVMap")
    floor.pass_index = 3
    child = studio.box((1, 1, 1), glossy, "Box", location=(0.5, 0, 0.5))
    child.parent = floor
    node = glossy.node_tree.nodes.new("ShaderNodeOutputAOV")
    setattr(node, "aov_name" if hasattr(node, "aov_name") else "name", "tint")
    node.inputs["Color"].default_value = (1.0, 0.5, 0.25, 1.0)
    studio.lamp("POINT", 300, (3, -3, 4), shadow_soft_size=0.4).lightgroup = "key"
    studio.area(150, (-3, -1, 3), size=1.5).lightgroup = "fill"
    glowing = studio.material("ShaderNodeEmission", "Glowing", Color=(0.5, 0.2, 0.1))
    studio.box((0.4, 0.4, 0.4), glowing, "Lantern", location=(-1.5, -1, 0.2)).lightgroup = "fill"
    studio.plain_world((0.1, 0.15, 0.2))
    scene.world.lightgroup = "sky"
    scene.world.mist_settings.start, scene.world.mist_settings.depth = 4.0, 8.0
    studio.camera()
    view_layer = scene.view_layers[0]
    for name in GROUPS:
        view_layer.lightgroups.add(name=name)
    aov = view_layer.aovs.add()
    aov.name, aov.type = "tint", "COLOR"
    for name in (*SWITCHES, *MATTES):
        setattr(view_layer, f"use_pass_{name}", True)
    view_layer.cycles.denoising_store_passes = True
    if hasattr(scene.render.image_settings, "media_type"):
        scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.shlight.noise_threshold = 0.002
    scene.cycles.film_exposure = 1.7
    return view_layer


def rendered(studio: Any, engine: str) -> tuple[dict[str, NDArray[np.float32]], dict[str, str]]:
    """Passes (height, width, channels) by "layer.name", and what the file says of itself."""
    path = studio.folder / f"{engine}.exr"
    studio.scene.render.engine = engine
    studio.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    file, found, part = oiio.ImageInput.open(str(path)), {}, 0
    notes = {own.name: str(own.value) for own in file.spec().extra_attribs}
    while file.seek_subimage(part, 0):
        spec = file.spec()
        pixels = file.read_image("float").reshape(spec.height, spec.width, -1)
        for channel, name in enumerate(spec.channelnames):
            found.setdefault(name.rpartition(".")[0], []).append(pixels[..., channel])
        part += 1
    file.close()
    return {name: np.stack(channels, axis=-1) for name, channels in found.items()}, notes


def shares(levels: NDArray[np.float32]) -> dict[float, NDArray[np.float64]]:
    """The share of each pixel for each identity of a Cryptomatte pass."""
    pairs = levels.reshape(*levels.shape[:2], -1, 2)
    return {
        float(identity): np.where(pairs[..., 0] == identity, pairs[..., 1], 0).sum(axis=-1)
        for identity in np.unique(pairs[..., 0])
        if identity != 0
    }


def relative_error(image: NDArray[np.float32], expected: NDArray[np.float32]) -> float:
    """relMSE over all channels, of whatever number; far away is as good as far away."""
    near, far = np.minimum(image, 100.0).astype(np.float64), np.minimum(expected, 100.0).astype(np.float64)
    return float(np.mean((near - far) ** 2 / (far**2 + 0.01 * np.abs(far).mean() ** 2 + 1e-12)))


def test_passes_are_those_of_cycles(studio: Any) -> None:
    scene_with_groups(studio)
    studio.scene.cycles.samples = 2560
    (own, own_notes), (reference, notes) = rendered(studio, "SHLIGHT"), rendered(studio, "CYCLES")
    for name in compat.DENOISING_LEFT_OUT:
        reference.pop(f"ViewLayer.{name}")
    assert set(own) == set(reference)
    assert {name: own[name].shape for name in own} == {name: reference[name].shape for name in own}
    worst = {}
    for name, expected in reference.items():
        image = own[name]
        if ".Crypto" in name:
            mine, theirs = shares(image), shares(expected)
            assert set(mine) == set(theirs)
            worst[name] = max([np.abs(mine[i] - theirs[i]).max() for i in mine], default=0.0) ** 2
        else:
            # Cycles 5.2 gives rays without a hit a share of the largest float as denoising depth.
            known = expected[..., 0] < 1e30
            worst[name] = relative_error(image[known], expected[known])
    print({name: f"{error:.1e}" for name, error in worst.items()})
    # Shares differ by the rays that find an edge; the world's and glossy direct light are Cycles' noise, which makes
    # half of the latter's error against 16384 samples.
    allowed = {name: 5e-3 if ".Crypto" in name or name.endswith("sky") else 1e-3 for name in worst}
    allowed["ViewLayer.DiffDir"] = allowed["ViewLayer.Diffuse Direct"] = 2e-3
    allowed["ViewLayer.GlossDir"] = allowed["ViewLayer.Glossy Direct"] = 3e-3
    assert {name: error for name, error in worst.items() if not error <= allowed[name]} == {}
    keys = [key for key in notes if key.startswith("cryptomatte/") and not key.endswith("manifest")]
    assert keys
    assert {key: own_notes[key] for key in keys} == {key: notes[key] for key in keys}


@pytest.mark.parametrize(
    ("width", "samples", "tolerance"), [(40, 128, 0.06), pytest.param(64, 1024, 0.02, marks=pytest.mark.slow)]
)
def test_light_that_bounces_has_the_passes_of_cycles(studio: Any, width: int, samples: int, tolerance: float) -> None:
    """In small pictures few points find the light that bounces; light in a pass of another kind is more than that."""
    scene_with_groups(studio)
    mirror = studio.material("ShaderNodeBsdfGlossy", "Mirror", Color=(0.9, 0.9, 0.9), Roughness=0.0)
    studio.box((0.2, 2, 1.5), mirror, "Wall", location=(-2, 1, 0.75))
    white = studio.material("ShaderNodeBsdfDiffuse", "White", Color=(0.8, 0.8, 0.8))
    studio.box((4, 0.2, 2), white, "Back", location=(0, 2.5, 1))
    for at, roughness in (((0.5, -1.5, 0.4), 0.0), ((-0.6, -2.0, 0.4), 0.3)):
        glass = studio.material("ShaderNodeBsdfGlass", "Glass", Color=(0.8, 0.9, 1.0), Roughness=roughness, IOR=1.3)
        studio.box((0.6, 0.6, 0.6), glass, "Glass", location=at)
    pane = studio.material("ShaderNodeBsdfRefraction", "Pane", Color=(0.9, 0.8, 0.8), Roughness=0.0, IOR=1.4)
    studio.plane(0.8, pane, "Pane", location=(0.3, -3, 1.72), rotation_euler=(1.0, 0, 0.7))  # before the lantern
    paper = studio.material("ShaderNodeBsdfTranslucent", "Paper", Color=(0.8, 0.6, 0.5))
    studio.plane(1.0, paper, "Paper", location=(-2, -1, 0.6), rotation_euler=(1.2, 0, 0.4))
    # The lamps' light that the mirror throws on the floor would be a patch that few of a record's rays meet.
    for lamp in (shown for shown in studio.scene.objects if shown.type == "LIGHT"):
        lamp.visible_glossy = lamp.visible_transmission = False
    cycles, scene = studio.scene.cycles, studio.scene
    studio.resolution(width, 3 * width // 4)
    cycles.samples, scene.shlight.max_bounces = samples, 2
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 2
    cycles.caustics_reflective = True
    (own, _), (reference, _) = rendered(studio, "SHLIGHT"), rendered(studio, "CYCLES")
    names = [
        compat.PASSES[f"use_pass_{switch}"][0]
        for switch in SWITCHES
        if switch.startswith(("diffuse", "glossy", "transmission"))
    ]
    names += [f"Combined_{group}" for group in GROUPS]
    means = {name: [float(found[f"ViewLayer.{name}"].mean()) for found in (own, reference)] for name in names}
    print({name: f"{mine:.5f} {theirs:.5f}" for name, (mine, theirs) in means.items()})
    assert {name: both for name, both in means.items() if abs(both[0] - both[1]) > tolerance * both[1]} == {}


def test_places_are_exact_where_cycles_looks_through_the_middles_too(studio: Any) -> None:
    scene_with_groups(studio)
    cycles = studio.scene.cycles
    cycles.samples, cycles.pixel_filter_type, cycles.filter_width = 1, "BLACKMAN_HARRIS", 0.01
    (own, _), (reference, _) = rendered(studio, "SHLIGHT"), rendered(studio, "CYCLES")
    for name in ("Depth", "Position", "Normal", "UV"):
        image, expected = own[f"ViewLayer.{name}"], reference[f"ViewLayer.{name}"]
        at_edges = (
            np.abs(image - expected).max(axis=-1) > 2e-3
        )  # one of 256 rays, within the filter's width, meets something else
        assert at_edges.mean() <= 2e-3
        np.testing.assert_allclose(image[~at_edges], expected[~at_edges], rtol=1e-5, atol=2e-5)


def test_a_pass_for_each_lamp_adds_up_in_every_layer_and_view(studio: Any) -> None:
    scene_with_groups(studio)
    scene = studio.scene
    scene.shlight.use_pass_lights = True
    scene.view_layers.new("Second")
    shown = studio.link("Shown", None)
    inside = bpy.data.collections.new("Inside")
    lamp = studio.lamp("POINT", 50, (-1, 2, 2))
    lamp.name = "Hidden away"
    for collection in list(lamp.users_collection):
        collection.objects.unlink(lamp)
    inside.objects.link(lamp)
    shown.instance_type, shown.instance_collection = "COLLECTION", inside
    own, _ = rendered(studio, "SHLIGHT")
    for layer in ("ViewLayer", "Second"):
        picture = own[f"{layer}.Combined"][..., :3]
        lights = {name: light for name, light in own.items() if name.startswith(f"{layer}.Light_")}
        assert f"{layer}.Light_Hidden away" in lights
        assert sum(light.max() > 0 for light in lights.values()) == 5
        assert np.abs(sum(lights.values()) - picture).max() <= 2e-6 * picture.max()
    grouped = sum(own[f"ViewLayer.Combined_{name}"] for name in GROUPS)
    rest = own["ViewLayer.Combined"][..., :3] - own["ViewLayer.Light_Hidden away"]
    assert np.abs(grouped - rest).max() <= 2e-6 * rest.max()


def test_panels_offer_the_passes_that_there_are(studio: Any) -> None:
    view_layer = scene_with_groups(studio)
    for name in ("", "_aov", "_cryptomatte", "_lightgroups"):
        assert "SHLIGHT" in getattr(bpy.types, f"VIEWLAYER_PT_layer_passes{name}").COMPAT_ENGINES
    offered = {*data.DATA, *data.INDEXES, *sum(data.LIGHT.values(), ()), *data.OTHER}
    assert {switch.removeprefix("use_pass_") for switch in passes.PASSES} <= offered
    assert len({own.name for own in passes.layer_passes(studio.scene, view_layer)}) == len(SWITCHES) + 9 + 3 + 1 + 3
