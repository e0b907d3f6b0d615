# SPDX-License-Identifier: MIT
"""`shlight render` with real processes, and a real scheduler over loopback."""

from __future__ import annotations

import datetime
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("distributed", reason="the farm needs Dask: pip install 'shlight[farm]'")
psutil = pytest.importorskip("psutil")

from shlight.images import read_exr  # noqa: E402

COMMAND = "import sys; from shlight.farm.command import main; sys.exit(main(sys.argv[1:]))"
SECONDS = 120

# The camera of frame 5 has no size while the file "fault" is there.
SCENE = """
import bpy
from pathlib import Path
HERE = Path(__file__).parent
def spoil(scene, *_):
    scene.camera.scale = (0, 0, 0) if scene.frame_current == 5 and (HERE / "fault").exists() else (1, 1, 1)
def build_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "SHLIGHT"
    scene.shlight.noise_threshold, scene.shlight.max_bounces = 0.01, 0
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    bpy.ops.mesh.primitive_plane_add(size=9)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0.4, 0, 0.5))
    bpy.ops.object.light_add(type='AREA', location=(1, 0, 3))
    lamp = bpy.context.object
    lamp.data.energy = 300
    for frame in (1, 24):
        lamp.location.x = frame / 12
        lamp.keyframe_insert("location", frame=frame)
    bpy.ops.object.camera_add(location=(0, 0, 5))
    scene.camera = bpy.context.object
    bpy.app.handlers.frame_change_pre.append(spoil)
    return scene
"""

DISPLAYED = """
    bpy.data.objects["Plane"].scale = (0.1, 0.1, 1)
    scene.render.film_transparent = True
    scene.view_settings.view_transform, scene.view_settings.exposure = "Filmic", 1
    scene.frame_set(20)
    return scene
"""

SAVED_BY_BLENDER = """
import runpy, sys
import bpy, shlight_blender
shlight_blender.register()
scene = runpy.run_path(sys.argv[1])["build_scene"]()
scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
import os
os._exit(0)
"""

STEREO = """
    scene.camera.data.stereo.convergence_mode = "PARALLEL"
    scene.camera.data.stereo.pivot = "CENTER"
    scene.camera.data.stereo.interocular_distance = 0.4
    for name, x in (("left eye", -0.2), ("right eye", 0.2)):
        eye = bpy.data.objects.new(name, scene.camera.data)
        eye.location = (x, 0, 5)
        scene.collection.objects.link(eye)
    return scene"""

# Four planes with a picture each: a symbolic link beside the file, one named by its absolute path, a sequence of three,
# and one of a library that is linked by its absolute path.
FILES = """
import sys
import bpy
from pathlib import Path
folder, elsewhere = Path(sys.argv[1]), Path(sys.argv[2])
def picture(path, color):
    path.parent.mkdir(exist_ok=True)
    image = bpy.data.images.new("new", 4, 4)
    image.pixels = [*color, 1] * 16
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
def plane(x, path):
    bpy.ops.mesh.primitive_plane_add(size=1, location=(x, 0, 0))
    material = bpy.data.materials.new("seen")
    material.use_nodes = True
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.load(str(path))
    surface = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    bpy.context.object.data.materials.append(material)
    return texture
bpy.ops.wm.read_factory_settings(use_empty=True)
picture(elsewhere / "library.png", (0, 0, 1))
plane(1.5, elsewhere / "library.png")
bpy.data.images[0].filepath = "//library.png"
bpy.context.object.name = "Linked"
bpy.ops.wm.save_as_mainfile(filepath=str(elsewhere / "library.blend"), relative_remap=False)
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.resolution_x, scene.render.resolution_y = 96, 32
picture(elsewhere / "beside.png", (1, 0, 0))
(folder / "beside.png").symlink_to(elsewhere / "beside.png")
picture(elsewhere / "absolute.png", (0, 1, 0))
for frame in (1, 2, 3):
    picture(folder / "sequence" / f"s_00{frame}.png", (frame / 3, 1, 1))
plane(-1.5, folder / "beside.png").image.filepath = "//beside.png"
plane(-0.5, elsewhere / "absolute.png")
texture = plane(0.5, folder / "sequence" / "s_001.png")
texture.image.filepath = "//sequence/s_001.png"
texture.image.source = "SEQUENCE"
texture.image_user.frame_duration = 3
texture.image_user.use_auto_refresh = True
with bpy.data.libraries.load(str(elsewhere / "library.blend"), link=True) as (_, wanted):
    wanted.objects = ["Linked"]
scene.collection.objects.link(wanted.objects[0])
bpy.ops.object.light_add(type='AREA', location=(0, 0, 3))
bpy.context.object.data.energy = 300
bpy.ops.object.camera_add(location=(0, 0, 5))
scene.camera = bpy.context.object
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"), relative_remap=False)
"""

# A hostile script would write to the second folder and run code from there.
HOSTILE = """
import sys
import bpy
from pathlib import Path
folder, target = Path(sys.argv[1]), Path(sys.argv[2])
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
render = scene.render
render.resolution_x, render.resolution_y = 32, 32
bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=2)
cloth = bpy.context.object.modifiers.new("cloth", "CLOTH")
bpy.ops.mesh.primitive_cube_add(size=3)
fluid = bpy.context.object.modifiers.new("fluid", "FLUID")
fluid.fluid_type = "DOMAIN"
fluid.domain_settings.cache_directory = str(target / "fluid")
bpy.ops.object.light_add(type='AREA', location=(0, 0, 3))
bpy.ops.object.camera_add(location=(0, 0, 5))
scene.camera = bpy.context.object
code = f"import os; os.system('touch {target}/code')"
bpy.data.texts.new("run.py").write(code)
bpy.data.texts["run.py"].use_module = True
driver = scene.camera.driver_add("location", 0).driver
driver.expression = f"__import__('os').system('touch {target}/driver') * 0"
is_new = hasattr(scene, "compositing_node_group")  # since Blender 5.0
if is_new:
    scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
else:
    scene.use_nodes = True
tree = scene.compositing_node_group if is_new else scene.node_tree
layers = tree.nodes.new("CompositorNodeRLayers")
node = tree.nodes.new("CompositorNodeOutputFile")
if is_new:
    node.directory = str(target)
    node.file_output_items.new("RGBA", "Image")
else:
    node.base_path = str(target)
tree.links.new(layers.outputs["Image"], node.inputs[0])
render.use_compositing = True
render.filepath = str(target / "picture")
render.use_overwrite = True
render.use_multiview = True
render.views_format = "MULTIVIEW"
for view, suffix in zip(render.views, ("../../x", f"{target}/y"), strict=True):
    view.file_suffix = suffix
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "hostile.blend"))
cloth.point_cache.use_disk_cache = True  # of a file that has a name
bpy.ops.wm.save_as_mainfile(filepath=str(folder / "hostile.blend"))
"""

# Nobody sees the folders any more once they are packed.
HIDE_WHAT_IS_SENT = """
import os, sys
from shlight.farm.command import main
from shlight_blender.farm import source
pack = source.packed
def pack_and_hide(*arguments):
    archive = pack(*arguments)
    for folder in sys.argv[1:3]:
        os.rename(folder, folder + "_hidden")
    return archive
source.packed = pack_and_hide
sys.exit(main(sys.argv[3:]))
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.py"
    path.write_text(SCENE)
    return path


def start(*arguments: object, code: str = COMMAND) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", code, *map(str, arguments)]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=subprocess.STDOUT, text=True, start_new_session=True)


def run(*arguments: object, code: str = COMMAND) -> tuple[int, str]:
    with start(*arguments, code=code) as process:
        try:
            output, _ = process.communicate(timeout=SECONDS)
        finally:
            process.kill()
        print(output)
        return process.returncode, output


def wait_for(path: Path) -> None:
    end = time.monotonic() + SECONDS
    while not path.exists():
        assert time.monotonic() <= end, f"{path} did not appear"
        time.sleep(0.05)


def renderers(pid: int) -> list[int]:
    """Processes below this one that have loaded Blender."""
    below = psutil.Process(pid).children(recursive=True)
    return [own.pid for own in below if "/bpy/" in Path(f"/proc/{own.pid}/maps").read_text()]


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.slow
def test_survives_a_killed_worker_and_a_frame_that_fails(scene: Path, tmp_path: Path) -> None:
    (tmp_path / "fault").touch()
    out, alone = tmp_path / "out", tmp_path / "alone"
    options = [scene, "--frames", "1-6", "--set", "shlight.noise_threshold=0.002", "--workers"]
    process = start(*options, 2, "--out", out / "x_##.exr")
    wait_for(out / "x_01.exr")
    os.kill(renderers(process.pid)[-1], signal.SIGKILL)
    output, _ = process.communicate(timeout=SECONDS)
    print(output)
    assert process.returncode == 1
    assert " is lost" in output
    assert "  frame 5: Camera 'Camera': its transform is not finite or has scale 0" in output
    assert names(out) == [f"x_0{frame}.exr" for frame in (1, 2, 3, 4, 6)]

    (tmp_path / "fault").unlink()
    assert run(*options, 0, "--out", alone / "x_##.exr")[0] == 0
    (out / "x_06.exr").write_bytes((out / "x_06.exr").read_bytes()[:-100])
    code, output = run(*options, 2, "--out", out / "x_##.exr")
    assert code == 0
    assert "2 rendered, 4 kept, 0 failed" in output  # the one that failed, and the one that is not whole
    for frame in range(1, 7):
        assert (out / f"x_0{frame}.exr").read_bytes() == (alone / f"x_0{frame}.exr").read_bytes()


@pytest.mark.slow
def test_tiles_are_the_same_pixels_everywhere(scene: Path, tmp_path: Path) -> None:
    options = [scene, "--frames", 1, "--scale", 2, "--tile", 64]
    for workers in (0, 2):
        assert run(*options, "--workers", workers, "--out", tmp_path / f"{workers}.exr")[0] == 0
    assert run(*options[:-1], 0, "--out", tmp_path / "whole.exr")[0] == 0
    alone, farm, whole = (read_exr(tmp_path / f"{name}.exr") for name in ("0", "2", "whole"))
    assert alone.shape == (128, 192, 4)
    np.testing.assert_array_equal(farm, alone)
    assert np.abs(farm - whole).mean() <= 0.005 * whole.mean()


def test_a_picture_for_display_is_the_one_that_blender_saves(scene: Path, tmp_path: Path) -> None:
    """The frame of the file, the view transform, and alpha."""
    scene.write_text(scene.read_text().replace("    return scene", DISPLAYED))
    assert run(scene, "--out", tmp_path / "farm.png")[0] == 0
    assert "0 rendered, 1 kept" in run(scene, "--out", tmp_path / "farm.png")[1]
    run(scene, tmp_path / "blender.png", code=SAVED_BY_BLENDER)
    farm, blender = (np.asarray(Image.open(tmp_path / f"{name}.png")) for name in ("farm", "blender"))
    assert len(np.unique(blender[..., 3])) > 1
    np.testing.assert_array_equal(farm, blender)


@pytest.mark.slow
def test_views_are_eyes_and_cameras(scene: Path, tmp_path: Path) -> None:
    """The eyes of parallel stereoscopy see what cameras see that stand where they are."""
    scene.write_text(scene.read_text().replace("    return scene", STEREO))
    options = [scene, "--frames", 1, "--workers", 0, "--out"]
    assert run(*options, tmp_path / "camera.exr", "--views", "left eye,right eye")[0] == 0
    assert run(*options, tmp_path / "view.exr", "--set", "render.use_multiview=true")[0] == 0
    assert run(*options, tmp_path / "one.exr", "--set", "render.use_multiview=true", "--views", "right")[0] == 0
    left, right, one = (read_exr(tmp_path / f"{name}.exr") for name in ("view_L", "view_R", "one_R"))
    for seen, eye in ((left, "left"), (right, "right"), (one, "right")):
        camera = read_exr(tmp_path / f"camera_{eye}_eye.exr")
        assert np.abs(seen - camera).mean() <= 0.005 * camera.mean()  # the noise threshold
    assert np.abs(left - right).mean() >= 0.05 * left.mean()
    assert names(tmp_path) == [
        "camera_left_eye.exr", "camera_right_eye.exr", "one_R.exr", "scene.py", "view_L.exr", "view_R.exr",
    ]  # fmt: skip


def test_a_hostile_file_writes_nothing_and_runs_nothing(tmp_path: Path) -> None:
    own, target, out = tmp_path / "own", tmp_path / "target", tmp_path / "a" / "b" / "c"
    own.mkdir()
    target.mkdir()
    run(own, target, code=HOSTILE)  # whatever the exit code, with which Blender's fluids may end
    for made in (target, own / "blendcache_hostile"):
        shutil.rmtree(made, ignore_errors=True)
    target.mkdir()
    before = set(tmp_path.rglob("*"))
    code, output = run(own / "hostile.blend", "--frames", "1-2", "--workers", 0, "--out", out / "x_#.exr")
    assert code == 0
    assert "compositing is left out" in output
    assert "the fluid of 'Cube' is left out" in output
    written = [path for path in sorted(set(tmp_path.rglob("*")) - before) if path.is_file()]
    assert [path.parent for path in written] == 4 * [out]


def certificates(folder: Path) -> list[str]:
    """Options that name an authority and a certificate for all."""
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec

    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "farm")])
    now = datetime.datetime.now(datetime.UTC)
    builder = x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number())
    builder = builder.not_valid_before(now).not_valid_after(now + datetime.timedelta(days=1))
    certificate = builder.add_extension(x509.BasicConstraints(ca=True, path_length=None), critical=True)
    (folder / "cert.pem").write_bytes(certificate.sign(key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM))
    text = serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    (folder / "key.pem").write_bytes(key.private_bytes(*text))
    cert, key_file = str(folder / "cert.pem"), str(folder / "key.pem")
    return ["--tls-ca-file", cert, "--tls-cert", cert, "--tls-key", key_file]


@pytest.fixture
def tls(tmp_path: Path) -> Iterator[tuple[str, list[str], subprocess.Popen[str]]]:
    """A scheduler and a worker that speak TLS: its address, options for it, and its process."""
    options = certificates(tmp_path)
    port = 20000 + os.getpid() % 20000
    address = f"tls://127.0.0.1:{port}"
    dask = [sys.executable, "-m", "distributed.cli"]
    scheduler = ["dask_scheduler", "--protocol", "tls", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
    worker = ["dask_worker", address, "--nthreads", "1", "--local-directory", str(tmp_path / "dask"), "--no-dashboard"]
    processes = []
    for name, *arguments in (scheduler, worker):
        code = f"from distributed.cli.{name} import main; main()"
        processes.append(subprocess.Popen([dask[0], "-c", code, *arguments, *options], text=True, cwd=tmp_path))
    yield address, ["--tls-ca", *options[1:]], processes[0]
    for process in processes:
        process.terminate()
        process.wait(SECONDS)


@pytest.mark.slow
def test_workers_elsewhere_get_all_files_sent_over_tls(
    tmp_path: Path, tls: tuple[str, list[str], subprocess.Popen[str]]
) -> None:
    address, options, scheduler = tls
    folder, elsewhere = tmp_path / "scene", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    assert run(folder, elsewhere, code=FILES)[0] == 0
    scene = folder / "scene.blend"
    assert run(scene, "--frames", "1-3", "--workers", 0, "--out", tmp_path / "here_##.exr")[0] == 0
    frames = [scene, "--scheduler", address, "--send", *options, "--out", tmp_path / "sent_##.exr", "--frames"]
    assert run(folder, elsewhere, *frames, "1-3", code=HIDE_WHAT_IS_SENT)[0] == 0
    for frame in ("01", "02", "03"):
        assert (tmp_path / f"sent_{frame}.exr").read_bytes() == (tmp_path / f"here_{frame}.exr").read_bytes()
    colors = [read_exr(tmp_path / f"here_0{frame}.exr")[16, 12::24, :3] for frame in (1, 3)]
    assert [color.argmax() for color in colors[0][[0, 1, 3]]] == [0, 1, 2]  # of each plane's own picture
    assert colors[0][2][0] <= 0.5 * colors[1][2][0]

    for hidden in (folder, elsewhere):
        hidden.with_name(f"{hidden.name}_hidden").rename(hidden)
    process = start(*frames, "1-400")
    wait_for(tmp_path / "sent_05.exr")
    scheduler.kill()
    output, _ = process.communicate(timeout=SECONDS)
    print(output[-2000:])
    assert process.returncode == 1
    assert "shlight render: the scheduler is lost" in output
    assert not [name for name in names(tmp_path) if name.startswith(".")]


def test_an_interrupt_leaves_whole_files_and_no_processes(scene: Path, tmp_path: Path) -> None:
    process = start(scene, "--frames", "1-400", "--workers", 2, "--out", tmp_path / "x_###.exr")
    wait_for(tmp_path / "x_002.exr")
    below = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    output, _ = process.communicate(timeout=SECONDS)
    assert process.returncode == 130
    assert "interrupted; the files that are there are whole" in output
    assert "Traceback" not in output
    assert not psutil.wait_procs(below, timeout=10)[1]
    assert not [name for name in names(tmp_path) if name.startswith(".")]
    assert read_exr(tmp_path / "x_002.exr").shape == (64, 96, 4)


BAD_REQUESTS = {
    "out must have #": ["--out", "x.exr"],
    "set: shlight.noise_threshold must be 0 … 1": ["--out", "x_#.exr", "--set", "shlight.noise_threshold=2"],
    "there is no view or camera 'left'": ["--out", "x_#.exr", "--views", "left", "--workers", "0"],
    "cannot be given both": ["--out", "x_#.exr", "--scheduler", "tcp://127.0.0.1:1", "--workers", "2"],
    "scheduler tcp://farm:1 is elsewhere": ["--out", "x_#.exr", "--scheduler", "tcp://farm:1"],
    "belong together": ["--out", "x_#.exr", "--tls-ca", "x"],
    "the scene has no property 'shlight.nois'": ["--out", "x_#.exr", "--set", "shlight.nois=2", "--workers", "0"],
}
IN_TURN = """
import json, sys
from shlight.farm.command import main
sys.exit(any([main([*sys.argv[2:], *options]) != 2 for options in json.loads(sys.argv[1])]))
"""


def test_bad_requests_are_one_line(scene: Path) -> None:
    code, output = run(json.dumps(list(BAD_REQUESTS.values())), scene, "--frames", "1-2", code=IN_TURN)
    assert code == 0
    lines = output.splitlines()
    assert [text in line for text, line in zip(BAD_REQUESTS, lines, strict=True)] == 7 * [True], output
