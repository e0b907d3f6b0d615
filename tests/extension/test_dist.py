# SPDX-License-Identifier: MIT
"""What `./dev extension` makes: the zip in Blenders that know nothing of the source tree, and the wheel."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from shlight.images import read_exr, read_texture, write_png
from shlight_blender import native

ROOT = Path(__file__).resolve().parents[2]
DIST = ROOT / os.environ.get("SHLIGHT_DIST", "dist")
BLENDER = shutil.which("blender")

# Blender's first scene, by a lamp with a penumbra, and a texture that is read by OpenImageIO.
RENDER = """
import bpy, os, sys
def render(path):
    scene = bpy.context.scene
    bpy.data.objects["Light"].data.type = "AREA"
    lamp = bpy.data.objects["Light"].data  # another class now
    lamp.energy, lamp.size = 300, 2
    image = bpy.data.images.load(os.environ["SHLIGHT_TEXTURE"])
    tree = bpy.data.objects["Cube"].active_material.node_tree
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    scene.render.engine, scene.shlight.max_bounces = "SHLIGHT", 0
    scene.render.resolution_x, scene.render.resolution_y = 48, 32
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
"""

FROM_SOURCE_TREE = f"""
sys.path[:0] = {[str(ROOT / "python_bindings"), str(ROOT / "blender_addon")]}
import shlight_blender
shlight_blender.register()
render(sys.argv[-1])
"""

AS_EXTENSION = """
for _ in range(2):
    if bpy.app.version >= (4, 2):
        name = "bl_ext.user_default.shlight_blender"
        bpy.ops.extensions.package_install_files(filepath=sys.argv[-2], repo="user_default", enable_on_install=True)
    else:
        name = "shlight_blender"
        bpy.ops.preferences.addon_install(filepath=sys.argv[-2])
        bpy.ops.preferences.addon_enable(module=name)
for _ in range(10):
    bpy.ops.preferences.addon_disable(module=name)
    bpy.ops.preferences.addon_enable(module=name)
import shlight, OpenImageIO
render(sys.argv[-1])
print("from", shlight.__file__, OpenImageIO.__file__)
bpy.ops.shlight.compare()
print("compared", *bpy.data.images["shlight Comparison"].size)
"""

UNINSTALL = """
repos = bpy.context.preferences.extensions.repos
number = next(i for i, repo in enumerate(repos) if repo.module == "user_default")
bpy.ops.extensions.package_uninstall(repo_index=number, pkg_id="shlight_blender")
"""


@pytest.fixture(scope="module")
def archive() -> Path:
    """The zip."""
    return next(DIST.glob("shlight-*.zip"))


@pytest.fixture
def profile(tmp_path: Path) -> Path:
    """An empty home, with a texture beside it."""
    colors = np.zeros((8, 8, 3), dtype=np.uint8)
    colors[::2, ::2] = (200, 60, 30)
    write_png(str(tmp_path / "texture.png"), colors)
    (tmp_path / "home").mkdir()
    return tmp_path / "home"


def run(command: list[str], profile: Path) -> str:
    """Output of a program that knows of nothing but the profile; it must end well and without a traceback."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "BLENDER"))}
    environment |= {"HOME": str(profile), "BLENDER_USER_RESOURCES": str(profile / "blender")}
    environment["SHLIGHT_TEXTURE"] = str(profile.parent / "texture.png")
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=240, check=False)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert "Traceback" not in said, said
    return said


def blender_alone(folder: Path) -> list[str]:
    """A Python that has the module bpy and what belongs to it, and nothing of shlight."""
    if importlib.util.find_spec("bpy") is None:
        pytest.skip("there is no module bpy")
    for package in Path(np.__file__).parents[1].iterdir():
        if not package.name.lower().startswith(("shlight", "openimageio", "_editable")):
            (folder / package.name).symlink_to(package)
    return [sys.executable, "-S", "-c", f"import sys; sys.path.append({str(folder)!r})"]


def files_of_shlight(profile: Path) -> list[Path]:
    """Files that an installation has left in a profile."""
    return [path for path in profile.rglob("*") if path.is_file() and {"shlight", "OpenImageIO"} & set(path.parts)]


def test_the_zip_is_an_extension(archive: Path, profile: Path) -> None:
    """Installed twice into an empty profile and enabled again and again, it renders what the source tree renders.

    It compares, and leaves nothing when it goes.
    """
    pictures = [str(profile.parent / f"{number}.exr") for number in range(2)]
    (profile.parent / "packages").mkdir()
    *python, script = blender_alone(profile.parent / "packages")
    said = run([*python, script + RENDER + AS_EXTENSION + UNINSTALL, str(archive), pictures[0]], profile)
    places = next(line for line in said.splitlines() if line.startswith("from")).split()[1:]
    assert all(place.startswith(str(profile)) for place in places), places
    assert "compared 48 32" in said
    assert files_of_shlight(profile) == []
    run([sys.executable, "-c", RENDER + FROM_SOURCE_TREE, pictures[1]], profile)
    np.testing.assert_array_equal(*(read_exr(picture) for picture in pictures))


@pytest.mark.slow
@pytest.mark.skipif(BLENDER is None, reason="no program named blender is installed")
def test_the_zip_is_a_legacy_add_on(archive: Path, profile: Path) -> None:
    """In Blender 3.4 it renders what the source tree renders, compares, and has all in its own folder."""
    pictures = [str(profile.parent / f"{number}.exr") for number in range(2)]
    for script, picture in (
        (RENDER + AS_EXTENSION, pictures[0]),
        (RENDER + FROM_SOURCE_TREE, pictures[1]),
    ):
        (profile.parent / "script.py").write_text(script)
        arguments = ["--factory-startup", "--python-exit-code", "1", "--python", str(profile.parent / "script.py")]
        said = run([str(BLENDER), "-b", *arguments, "--", str(archive), picture], profile)
        assert ("compared 48 32" in said) == (AS_EXTENSION in script)
    folder = next(profile.rglob("shlight_blender"))
    assert folder.parts[-3:] == ("scripts", "addons", "shlight_blender")
    assert all(path.is_relative_to(folder) for path in files_of_shlight(profile))
    assert not list(folder.rglob(".part-*"))
    np.testing.assert_allclose(*(read_exr(picture) for picture in pictures), rtol=1e-5, atol=1e-6)


def test_the_wheel_is_a_package(tmp_path: Path, profile: Path) -> None:
    wheel = next(DIST.glob("shlight-*.whl"))
    assert "manylinux_2_34_x86_64" in wheel.name  # as README has it; Red Hat 9 is such a system
    environment = tmp_path / "environment"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    python = str(environment / "bin/python")
    pip = [sys.executable, "-m", "pip", "--python", python, "install", "-q", "--no-compile"]
    subprocess.run([*pip, wheel], check=True)
    picture = tmp_path / "ball.png"
    run([python, str(ROOT / "examples/render_from_python.py"), str(picture)], profile)
    image = read_texture(picture)[..., :3].astype(float)
    ball, floor = image[image.shape[0] // 2, image.shape[1] // 2], image[-image.shape[0] // 8, image.shape[1] // 12]
    assert ball[0] > 1.3 * max(ball[1:])  # as the screen shows them
    assert floor.max() < 1.3 * floor.min()
    with zipfile.ZipFile(wheel) as files:
        names = files.namelist()
        assert "shlight/py.typed" in names
        # Rivals and the reference are for developers.
        assert not any("shlight_tools" in name or "/bench/" in name or "/charts/" in name for name in names)
        core = files.read(next(name for name in names if name.startswith("shlight/_core") and name.endswith(".so")))
        assert not any(word in core for word in (b"monte_carlo", b"zhou_wei", b"float128"))


class Wheels:
    """A folder of wheels as the add-on's, and what it says of it."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
        self.patch = monkeypatch
        self.folder = folder / "wheels"
        self.folder.mkdir(parents=True)
        manifest = folder / "manifest"
        manifest.write_text("\n".join([f'version = "{native.RUNNING}"', *(f'"./wheels/{name}"' for name in names)]))
        for name in names:
            (self.folder / name).write_bytes(b"no zip")
        monkeypatch.setattr(native, "MANIFEST", manifest)
        monkeypatch.setattr(native, "WHEELS", self.folder)
        monkeypatch.setattr(native, "_unpacking_problem", "")

    def problem(self) -> str:
        with self.patch.context() as missing:
            missing.setitem(sys.modules, "shlight", None)
            native.find_packages()
            return native.native_problem()


def test_what_is_wrong_with_wheels_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = Wheels(tmp_path / "other", monkeypatch, "shlight-1-cp39-cp39-x.whl")
    assert f"this Blender has Python {native.PYTHON}, and this zip is for 3.9" in other.problem()
    broken = Wheels(tmp_path / "broken", monkeypatch, f"shlight-1-{native.TAG}-{native.TAG}-x.whl")
    said = broken.problem()
    assert "cannot be unpacked" in said
    assert "install the add-on's zip again" in said
    assert [path.name for path in broken.folder.iterdir()] == [f"shlight-1-{native.TAG}-{native.TAG}-x.whl"]


def test_another_version_of_the_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import shlight

    assert native.native_problem() == ""
    # The zip gives its manifest the version of the package, too.
    monkeypatch.setattr(native, "WHEELS", tmp_path)
    monkeypatch.setattr(native, "RUNNING", shlight.__version__)
    monkeypatch.setattr(native, "_version", lambda: native.RUNNING)
    assert native.native_problem() == ""
    monkeypatch.setattr(shlight, "__version__", "0.0.9")
    assert "is version 0.0.9: restart Blender" in native.native_problem()


def test_a_version_installed_over_another_replaces_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blender 3.4 installs over the old version: files of both exist, and the old version's modules stay loaded."""
    wheels = Wheels(tmp_path, monkeypatch)
    monkeypatch.setattr(sys, "path", sys.path[:])
    for version in ("1", "2"):
        name = f"shlight-{version}-{native.TAG}-{native.TAG}-x.whl"
        with zipfile.ZipFile(wheels.folder / name, "w") as archive:
            archive.writestr("version", version)
        native.MANIFEST.write_text(f'version = "{version}"\n"./wheels/{name}"')
        native.forget_packages()
        native.find_packages()
        folder, wheel = sorted(wheels.folder.iterdir(), reverse=True)
        assert (folder / "version").read_text() == version
        assert wheel.name == name
        assert [path for path in sys.path if str(wheels.folder) in path] == [str(folder)]
    assert f"version 2 of the add-on is installed, and version {native.RUNNING} is running" in native.native_problem()
