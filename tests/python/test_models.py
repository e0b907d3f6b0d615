# SPDX-License-Identifier: MIT
"""Models from files: what a reader finds equals the scene that is built by hand."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import shlight
from shlight import cli, nodes
from shlight.images import write_exr, write_png

trimesh = pytest.importorskip("trimesh")
image_module = pytest.importorskip("PIL.Image")

QUAD = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])  # y is up
FACES = [[0, 2, 1], [0, 3, 2]]
UVS = np.array([[0.0, 1], [1, 1], [1, 0], [0, 0]])  # as trimesh has them: v is up
Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
MOVED = np.array([[0.5, 0, 0, 0.25], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.25], [0, 0, 0, 1]])
PIXELS = np.random.default_rng(1).integers(0, 255, (4, 8, 3), dtype=np.uint8)
WIDE = np.random.default_rng(2).integers(0, 255, (2, 2, 3), dtype=np.uint8)


def picture(scene: shlight.Scene) -> Any:
    scene.set_environment((1, 1, 1))
    return np.asarray(shlight.render(scene, 40, 30, max_samples=4, max_bounces=1))


def camera(scene: shlight.Scene) -> None:
    scene.set_camera(shlight.look_at((0.3, -2.5, 2), (0, 0, 0.1)), 0.9)


def glb(header_changes: Callable[[dict[str, Any]], None] = lambda header: None) -> bytes:
    """A quad with a normal map in two places, made by trimesh, after changes of its JSON."""
    pbr = trimesh.visual.material.PBRMaterial(
        baseColorTexture=image_module.fromarray(PIXELS),
        metallicRoughnessTexture=image_module.fromarray(WIDE),
        normalTexture=image_module.fromarray(np.full((2, 2, 3), (150, 110, 240), np.uint8)),
        metallicFactor=0.25,
        roughnessFactor=0.75,
    )
    visual = trimesh.visual.TextureVisuals(uv=UVS, material=pbr)
    mesh = trimesh.Trimesh(QUAD, FACES, process=False, visual=visual, vertex_normals=np.tile([0.0, 1, 0], (4, 1)))
    scene = trimesh.Scene()
    scene.add_geometry(mesh, node_name="floor")
    data = scene.export(file_type="glb", include_normals=True)
    length = int.from_bytes(data[12:16], "little")
    header, rest = json.loads(data[20 : 20 + length]), data[20 + length :]
    header["nodes"].append({"name": "again", "mesh": 0, "matrix": MOVED.T.ravel().tolist()})
    header["scenes"][0]["nodes"].append(len(header["nodes"]) - 1)
    header_changes(header)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    sizes = np.array([2, 20 + len(text) + len(rest), len(text), 0x4E4F534A], "<u4").tobytes()
    return b"glTF" + sizes + text + rest


def loaded(path: Path, data: bytes) -> shlight.Scene:
    path.write_bytes(data)
    return shlight.load(path)


def test_a_glb_is_the_scene_built_by_hand(tmp_path: Path) -> None:
    scene = loaded(tmp_path / "quad.glb", glb())
    camera(scene)
    wide = nodes.image(WIDE)
    normals = np.tile([0.0, 1, 0], (4, 1))
    shader = nodes.principled(
        nodes.image(PIXELS, encoding="srgb"),
        metallic=wide.z * 0.25,
        roughness=wide.y * 0.75,
        at=nodes.normal_map(nodes.image(np.full((2, 2, 3), (150, 110, 240), np.uint8))),
    )
    by_hand = shlight.Scene()
    by_hand.add_mesh(
        QUAD,
        FACES,
        normals=normals,
        uvs=UVS,
        attributes={"tangents": np.tile([1.0, 0, 0, 1], (4, 1))},
        transforms=[Y_UP, Y_UP @ MOVED],
        bsdf=shader,
    )
    camera(by_hand)
    expected = picture(by_hand)
    assert expected[..., :3].std() > 0.02
    np.testing.assert_array_equal(picture(scene), expected)


def test_a_gltf_with_files_beside_it_is_read_and_its_alpha_cuts(tmp_path: Path) -> None:
    def changed(header: dict[str, Any]) -> None:
        header["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.3, 0.4, 0.4]}, "alphaMode": "MASK"}]

    data = glb(changed)
    length = int.from_bytes(data[12:16], "little")
    header, rest = json.loads(data[20 : 20 + length]), data[28 + length :]
    header["buffers"][0]["uri"] = "data.bin"
    (tmp_path / "data.bin").write_bytes(rest)
    scene = loaded(tmp_path / "quad.gltf", json.dumps(header).encode())
    camera(scene)
    np.testing.assert_array_equal(picture(scene)[..., :3], 1)
    header["materials"][0]["alphaCutoff"] = 0.3
    scene = loaded(tmp_path / "quad.gltf", json.dumps(header).encode())
    camera(scene)
    assert picture(scene)[15, 20, 2] < 0.9


def test_lights_and_cameras_stand_where_the_file_says(tmp_path: Path) -> None:
    """Irradiance by the formulas of lamps, on a matt floor seen from above: I cosθ / r², and of a sun its lux."""

    def lit(kind: str, **more: Any) -> float:
        def changed(header: dict[str, Any]) -> None:
            matt = {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0, "roughnessFactor": 1}
            header["materials"] = [
                {"pbrMetallicRoughness": matt, "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}
            ]
            lamp = {"type": kind, "color": [1, 1, 1], "intensity": 683.0, **more}
            header["extensions"] = {"KHR_lights_punctual": {"lights": [lamp]}}
            half = math.sqrt(0.5)
            down = {"translation": [0, 2, 0], "rotation": [-half, 0, 0, half]}
            header["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.2, "aspectRatio": 2, "znear": 0.1}}]
            header["nodes"] += [
                {**down, "extensions": {"KHR_lights_punctual": {"light": 0}}},
                {**down, "camera": 0},
            ]
            header["scenes"][0]["nodes"] = [0, 2, 3]

        scene = loaded(tmp_path / f"{kind}.glb", glb(changed))
        image = shlight.render(scene, 21, 11, pixel_samples=1, max_samples=1, max_bounces=0)
        assert (image[..., 3] == 1).all()  # 2 tan 0.1 · 2 m wide: within the floor
        return float(image[5, 10, 0]) * math.pi / 0.5

    assert lit("point") == pytest.approx(1 / 4, rel=1e-4)
    assert lit("spot", spot={"outerConeAngle": 0.5}) == pytest.approx(1 / 4, rel=1e-4)
    assert lit("directional") == pytest.approx(1, rel=1e-4)


def test_emission_lights_other_surfaces(tmp_path: Path) -> None:
    def changed(header: dict[str, Any]) -> None:
        strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 3.0}}
        header["materials"] = [{"emissiveFactor": [1, 0.5, 0.25], "extensions": strength}]

    scene = loaded(tmp_path / "glow.glb", glb(changed))
    vertices = [[-1, -1.5, 0], [1, -1.5, 0], [1, -1.5, 2], [-1, -1.5, 2]]
    scene.add_mesh(vertices, [[0, 1, 2], [0, 2, 3]], bsdf=shlight.Bsdf.lambert(0.5))
    scene.set_camera(shlight.look_at((0, -1.4, 0.3), (0, -1.5, 0.3)), 0.1)
    wall = np.asarray(shlight.render(scene, 4, 4, max_bounces=0))
    scene.set_camera(shlight.look_at((0, -1.2, 1.5), (0, 0, 0)), 0.1)
    glow = np.asarray(shlight.render(scene, 4, 4, max_bounces=0))
    np.testing.assert_allclose(glow[..., :3], np.broadcast_to([3, 1.5, 0.75], (4, 4, 3)), rtol=1e-5)
    assert wall[..., 0].min() > 0.05
    np.testing.assert_allclose(wall[..., 1], 0.5 * wall[..., 0], rtol=1e-4)


def test_obj_and_ply_with_materials_and_colours(tmp_path: Path) -> None:
    write_png(tmp_path / "t.png", PIXELS)
    (tmp_path / "m.mtl").write_text("newmtl red\nKd 1 1 1\nNs 100\nKs 0.5 0.5 0.5\nNi 1.4\nmap_Kd t.png\nbump t.png\n")
    lines = [f"v {x} {y} {z}" for x, y, z in QUAD] + [f"vt {u} {v}" for u, v in UVS]
    lines += ["usemtl red", "f 1/1 3/3 2/2", "f 1/1 4/4 3/3"]
    (tmp_path / "m.obj").write_text("\n".join(["mtllib m.mtl", *lines]))
    with pytest.warns(UserWarning, match=r"material 'red': .*bump"):
        scene = shlight.load(tmp_path / "m.obj", scale=0.5)
    camera(scene)
    by_hand = shlight.Scene()
    roughness = 1 - math.sqrt(100.0 / 900.0)
    bsdf = nodes.principled(nodes.image(PIXELS, encoding="srgb"), roughness=roughness, ior=1.4)
    by_hand.add_mesh(QUAD, FACES, uvs=UVS, bsdf=bsdf, transforms=[np.diag([0.5, 0.5, 0.5, 1]) @ Y_UP])
    camera(by_hand)
    np.testing.assert_array_equal(picture(scene), picture(by_hand))

    mesh = trimesh.Trimesh(QUAD[:, [0, 2, 1]], FACES, process=False, vertex_colors=[[188, 188, 0, 255]] * 4)
    (tmp_path / "c.ply").write_bytes(mesh.export(file_type="ply"))
    scene = shlight.load(tmp_path / "c.ply")
    camera(scene)
    linear = ((188 / 255 + 0.055) / 1.055) ** 2.4
    np.testing.assert_allclose(picture(scene)[15, 20, :3], [linear, linear, 0], rtol=1e-3, atol=1e-6)


def test_what_is_not_supported_is_named(tmp_path: Path) -> None:
    def changed(header: dict[str, Any]) -> None:
        header["animations"] = [{"channels": [], "samplers": []}]
        header["extensionsUsed"] = ["KHR_materials_sheen"]
        header["materials"][0]["name"] = "wood"
        header["materials"][0]["occlusionTexture"] = {"index": 0}

    (tmp_path / "odd.glb").write_bytes(glb(changed))
    with pytest.warns(UserWarning, match=r"odd\.glb: .*occlusionTexture.*; animations; KHR_materials_sheen"):
        shlight.load(tmp_path / "odd.glb")


def test_wrong_files_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.glb").write_bytes(b"no glTF at all")
    (tmp_path / "b.gltf").write_text('{"asset": {"version": "2.0"}}')
    (tmp_path / "c.ply").write_bytes(b"ply nonsense")
    for name in ("a.glb", "b.gltf", "c.ply", "d.step"):
        with pytest.raises(ValueError, match=r"^path"):
            shlight.load(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        shlight.load(tmp_path / "missing.glb")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(ImportError, match=r"trimesh: pip install 'shlight\[files\]'"):
        shlight.load(tmp_path / "a.glb")


def test_the_command_renders_models_and_scripts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "m.glb").write_bytes(glb())
    write_exr(tmp_path / "sky.exr", np.ones((4, 8, 3), np.float32))
    common = ["--size", "24x16", "--scale", "0.5", "--set", "max_samples=4", "--threads", "1"]
    out = tmp_path / "out.exr"
    command = [
        "render",
        str(tmp_path / "m.glb"),
        "--environment",
        str(tmp_path / "sky.exr"),
        "--out",
        str(out),
        *common,
    ]
    assert cli.main(command) == 0
    scene = shlight.load(tmp_path / "m.glb")
    scene.set_environment(np.ones((4, 8, 3)))
    np.testing.assert_array_equal(shlight.images.read_exr(out), shlight.render(scene, 12, 8, max_samples=4))

    script = tmp_path / "scene.py"
    script.write_text(f"import shlight\ndef build_scene():\n    return shlight.load({str(tmp_path / 'm.glb')!r})\n")
    assert cli.main(["render", str(script), "--out", str(tmp_path / "x.png"), *common]) == 1
    assert "the scene has no light" in capsys.readouterr().err
    script.write_text("import shlight\ndef build():\n    return 3\n")
    assert cli.main(["render", str(script), "--out", str(tmp_path / "x.png"), *common]) == 2
    assert "must return a shlight.Scene" in capsys.readouterr().err
    assert cli.main(["render", str(tmp_path / "m.glb"), "--out", str(tmp_path / "x.jpg")]) == 2
    capsys.readouterr()
    assert cli.main(["render", str(tmp_path / "m.glb"), "--out", str(tmp_path / "none" / "x.png")]) == 2
    said = capsys.readouterr()
    assert said.out == "", "nothing was rendered"
    assert f"{tmp_path / 'none' / 'x.png'}: No such file" in said.err
