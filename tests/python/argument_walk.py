# SPDX-License-Identifier: MIT
"""Calls public functions with each argument replaced by what a stranger may type, and says what came of it.

Run as a script with a step and the names of calls: one that ends the process is seen by whoever ran it.
"""

from __future__ import annotations

import contextlib
import inspect
import reprlib
import sys
import tempfile
import warnings
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

import shlight
from shlight import Bsdf, Bsdfs, images, nodes
from shlight_tools import methods

TRIANGLE = [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, -1.0, 1.0]]
FACES = [[0, 1, 2]]
GGX = Bsdf.ggx(0.3, [0.9, 0.5, 0.1])
TABLE = {
    "values": np.ones((2, 3, 2, 3)),
    **{"theta_in": [0.0, 1.0], "phi_in": [0.0, 2.0, 4.0], "theta_out": [0.0, 1.0], "phi_out": [0.0, 2.0, 4.0]},
}
SPHERE = {"centers": [0.0, 0.0, 2.0], "radii": 1.0}
CAP = {"axes": [0.0, 0.0, 2.0], "half_angles": 1.0}
POLYGON = {"vertices": TRIANGLE}
DISK = {"centers": [0.0, 0.0, 1.0], "half_axes_u": [1.0, 0.0, 0.0], "half_axes_v": [0.0, 1.0, 0.0]}
COEFFICIENTS = {"order": 3, "clip": True, "dtype": np.float32, "threads": 0, "out": None}
EXACT = {**COEFFICIENTS, "method": "exact", "tolerance": None, "samples": None, "seed": None, "sampling": None}
RANDOM = {**COEFFICIENTS, "method": "monte_carlo", "samples": 8, "seed": 1, "sampling": "area"}
SHADED = {"bsdf": GGX, "cos_theta_o": 0.5, "phi_o": 0.3, "tolerance": 1e-3, "threads": 0, "return_effort": True}
AUTO = {**SHADED, "order": "auto", "method": "auto", "samples": None, "seed": None, "sampling": None}
SAMPLED = {**SHADED, "method": "monte_carlo", "samples": 8, "seed": 1, "sampling": "mis"}
SEEN_BY: dict[str, Any] = {
    **{"shadows": True, "diffuse": True, "glossy": True, "camera": False, "group": "key"},
    **{"receivers": [0], "blockers": {0, 2}, "profile": np.ones((2, 4))},
}
RGB = [1.0, 2.0, 3.0]
LIGHTS: dict[str, dict[str, Any]] = {
    "add_sphere_light": {"center": [0, 0, 1], "radius": 0.1, "radiance": RGB, "facing_disk": False},
    "add_polygon_light": {"vertices": TRIANGLE, "radiance": RGB, "spread": 1.0},
    "add_disk_light": {
        "center": [0, 0, 1],
        "half_axis_u": [1, 0, 0],
        "half_axis_v": [0, 1, 0],
        "radiance": RGB,
        "spread": 1.0,
    },
    "add_point_light": {"position": [0, 0, 1], "intensity": RGB},
    "add_spot_light": {
        "position": [0, 0, 1],
        "direction": [0, 0, -1],
        "spot_angle": 1.0,
        "blend": 0.5,
        "intensity": RGB,
        "radius": 0.1,
        "facing_disk": False,
        "times_cosine": False,
    },
    "add_sun_light": {"direction": [0, 0, -1], "angle": 0.1, "irradiance": RGB, "tangent": False},
}
WINDOW = {"left": -1.0, "right": 1.0, "bottom": -1.0, "top": 1.0, "orthographic": False}
SHARES = {"left": 0.0, "right": 1.0, "bottom": 0.0, "top": 1.0}
CLIPS = {"clip_start": 0.0, "clip_end": 10.0}
LENS = {
    "aperture_size": 0.1,
    "focus_distance": 2.0,
    "aperture_blades": 5,
    "aperture_rotation": 0.5,
    "aperture_ratio": 1.5,
}
PANORAMA = {
    "panorama_type": "fisheye_lens_polynomial",
    "equirectangular_range": [-1.0, 1.0, -0.5, 0.5],
    "central_cylindrical_range": [-1.0, 1.0, -0.5, 0.5],
    "fisheye_fov": 3.0,
    "fisheye_lens": 0.01,
    "fisheye_polynomial": [0.0, -20.0, 0.0, 0.0, 0.0],
    "sensor_width": 0.03,
    "sensor_height": 0.02,
}
MESH = {
    "vertices": TRIANGLE,
    "triangles": FACES,
    "normals": TRIANGLE,
    "uvs": [[0.0, 0.0]] * 3,
    "colors": [[0.0, 0.0, 0.0]] * 3,
    "attributes": {"height": [0.0, 1.0, 2.0]},
    "bsdf": GGX,
    "emission": RGB,
    "material_indices": [0],
    "transforms": [np.eye(4)],
    "object_values": [[1.0, 2.0]],
    "group": "key",
    "object_names": "Cube",
    "asset_names": ["Cube"],
    "object_indices": [1],
    "material_names": ["Matt"],
    "material_pass_indices": 2,
    "turn_normals": False,
    "visible_to": ["camera", "shadow"],
    "holdout": True,
    "light_set": 1,
    "shadow_set": 1,
    "receivers": [1],
    "blockers": [0],
    "terminator_geometry_offset": 0.1,
    "terminator_shading_offset": 0.1,
}
STRANDS = {
    "points": TRIANGLE,
    "radii": [0.1, 0.2, 0.1],
    **{
        name: MESH[name]
        for name in MESH
        if not name.endswith(("normals", "geometry_offset", "colors", "receivers", "blockers"))
    },
}
del STRANDS["vertices"], STRANDS["triangles"]
CURVES = {**STRANDS, "first": [0], "ribbons": True, "subdivisions": 3, "uvs": [[0.0, 0.0]]}
CLOUD = {**STRANDS, "material_indices": [0, 0, 0]}
OF_MATERIALS = ("bsdf", "emission", "group", "material_names", "material_pass_indices")
OF_PLACES = ("transforms", "object_values", "object_names", "asset_names", "object_indices")
PICTURE = Path(__file__).parents[2] / "docs" / "images" / "preview.png"
RENDER = {"width": 2, "height": 2, "threads": 1, "progress": None}
SETTINGS = {
    "order": "auto",
    "tolerance": 0.1,
    "noise_threshold": 0.5,
    "min_samples": None,
    "max_samples": 1,
    "pixel_samples": 1,
    "time_limit": 10.0,
    "pixel_filter": "gaussian",
    "filter_width": 1.0,
    "shadows": True,
    "shadow_rays": 1,
    "transparent_bounces": 1,
    "max_bounces": 1,
    "glossy_bounces": 1,
    "transmission_bounces": None,
    "filter_glossy": 1.0,
    "clamp_indirect": 10.0,
    "darken_doubled": True,
    "passes": ["depth"],
    "groups": True,
    "aovs": True,
    "alpha_threshold": 0.5,
    "mist": (1.0, 2.0, 1.0),
    "exposure": 2.0,
    "cryptomatte_levels": 4,
    "seed": 3,
    "on_update": None,
}
RAYS = {"origins": [[0.0, 0.0, 3.0], [0.0, 0.0, 4.0]], "directions": [0.0, 0.0, -1.0]}
POINTS = {"points": [[0.0, 0.0, 3.0], [0.0, 0.0, 4.0]], "normals": [0.0, 0.0, 1.0]}
SHADOWED = {"rays": 2, "transparent_bounces": 1, "max_bounces": 1, "bounce_rays": 2, "threads": 1, "seed": 3}
TOLD = {"return_error": True, "progress": None}
OF_RADIANCE = (
    *("order", "tolerance", "noise_threshold", "max_samples", "shadows", "shadow_rays", "transparent_bounces"),
    *("max_bounces", "glossy_bounces", "transmission_bounces", "seed"),
)


OF_VIEW = (
    *("order", "tolerance", "pixel_samples", "pixel_filter", "filter_width", "shadows", "shadow_rays"),
    *("transparent_bounces", "seed"),
)


def new_scene() -> shlight.Scene:
    scene = shlight.Scene()
    scene.add_mesh(TRIANGLE, FACES)
    scene.set_camera(np.eye(4), 1.0)
    return scene


def of_mesh(name: str) -> Callable[..., Any]:
    return lambda **arguments: getattr(shlight.Scene().add_mesh(**MESH), name)(**arguments)


def of_scene(name: str) -> Callable[..., Any]:
    return lambda **arguments: getattr(new_scene(), name)(**arguments)


def picture(channels: int, dtype: Any) -> Any:
    return np.ones((2, 2, channels), dtype)


FILES = tempfile.TemporaryDirectory()
LAYERS, MODEL = (Path(FILES.name, name) for name in ("layers.exr", "model.ply"))
images.write_layers(LAYERS, {"depth": picture(1, np.float32)})
MODEL.write_text(
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)

# For each way to call a function its arguments by name; "/" and what follows it tells ways of one function apart.
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "Bsdf.lambert": (Bsdf.lambert, {"albedo": 0.5}),
    "Bsdf.ggx": (Bsdf.ggx, {"roughness": 0.5, "f0": 0.04, "ior": 1.5}),
    "Bsdf.ggx/varying": (Bsdf.ggx, {"roughness": 0.5, "f0": nodes.uv().x, "ior": 1.5}),
    "Bsdf.oren_nayar": (Bsdf.oren_nayar, {"albedo": 0.5, "sigma": 0.5}),
    "Bsdf.principled": (
        Bsdf.principled,
        {
            **dict.fromkeys(inspect.signature(Bsdf.principled).parameters, 0.5),
            "several_bounces": False,
            "subsurface_method": "burley",
            "thin_film_model": "gaussians",
            "diffuse_model": "openpbr",
            "thin_wall": False,
        },
    ),
    "Bsdf.layer": (Bsdf.layer, {"top": GGX, "base": Bsdf.lambert(1.0)}),
    "Bsdf.from_function": (
        Bsdf.from_function,
        {"f": lambda view, light: light[:, 2], "isotropic": True, "order": "auto", "samples": 8},
    ),
    "Bsdf.from_table": (Bsdf.from_table, {**TABLE, "order": "auto"}),
    "Bsdf.read": (Bsdf.read, {"path": "missing.bin", "order": "auto"}),
    "Bsdf.coefficients": (GGX.coefficients, {"cos_theta_o": 0.5, "order": 3, "phi_o": 0.3}),
    "Bsdf.residual": (GGX.residual, {"cos_theta_o": 0.5, "order": 3, "phi_o": 0.3}),
    "Bsdf.evaluate": (GGX.evaluate, {"wi": [0.0, 0.6, 0.8], "wo": [0.0, 0.0, 1.0]}),
    "Bsdf.__mul__": (GGX.__mul__, {"factor": 0.5}),
    "Bsdf.__rmul__": (GGX.__rmul__, {"factor": 0.5}),
    "Bsdfs.lambert": (Bsdfs.lambert, {"albedo": [RGB, RGB]}),
    "Bsdfs.ggx": (Bsdfs.ggx, {"roughness": [0.2, 0.5], "f0": [[0.5] * 3] * 2, "ior": 1.5}),
    "Bsdfs.__mul__": (Bsdfs.lambert(0.5).__mul__, {"factor": [RGB, RGB]}),
    "Bsdfs.__rmul__": (Bsdfs.lambert(0.5).__rmul__, {"factor": 0.5}),
    **{f"Scene.{name}": (of_scene(name), {**light, **SEEN_BY}) for name, light in LIGHTS.items()},
    "Scene.add_mesh": (of_scene("add_mesh"), MESH),
    "Scene.add_curves": (of_scene("add_curves"), CURVES),
    "Scene.add_point_cloud": (of_scene("add_point_cloud"), CLOUD),
    "Scene.remove_lights": (of_scene("remove_lights"), {}),
    "Scene.intersect": (of_scene("intersect"), {**RAYS, "threads": 1}),
    "Scene.irradiance": (of_scene("irradiance"), {**POINTS, **SHADOWED, **TOLD}),
    "Scene.light_coefficients": (
        of_scene("light_coefficients"),
        {**POINTS, **SHADOWED, **TOLD, "order": 2, "tangents": [1.0, 0.0, 0.0], "shadows": True},
    ),
    "Scene.radiance": (
        of_scene("radiance"),
        {
            **RAYS,
            **{name: SETTINGS[name] for name in OF_RADIANCE},
            "min_samples": 1,
            "lights": False,
            "threads": 1,
            "progress": None,
        },
    ),
    "Scene.view": (
        of_scene("view"),
        {"width": 4, "height": 3, "threads": 1, **{name: SETTINGS[name] for name in OF_VIEW}},
    ),
    "View.relight": (new_scene().view(4, 3).relight, {"noise_threshold": 0.5, "progress": None}),
    "Light.remove": (lambda: shlight.Scene().add_point_light([0, 0, 1], RGB).remove(), {}),
    "SceneMesh.set_bsdf": (of_mesh("set_bsdf"), {name: MESH[name] for name in OF_MATERIALS}),
    "SceneMesh.set_transforms": (of_mesh("set_transforms"), {name: MESH[name] for name in OF_PLACES}),
    "SceneMesh.remove": (of_mesh("remove"), {}),
    "Scene.set_environment": (
        of_scene("set_environment"),
        {"radiance": np.ones((2, 4, 3)), "to_world": np.eye(3), "visible": True, "group": "sky", "background": RGB},
    ),
    "Scene.set_camera": (of_scene("set_camera"), {"to_world": np.eye(4), "fov_x": 1.0, **LENS}),
    "Scene.set_camera_window": (of_scene("set_camera_window"), {"to_world": np.eye(4), **WINDOW, **CLIPS, **LENS}),
    "Scene.set_panorama_camera": (
        of_scene("set_panorama_camera"),
        {"to_world": np.eye(4), **PANORAMA, **SHARES, **CLIPS, **LENS},
    ),
    "cap_coefficients": (shlight.cap_coefficients, {**CAP, **EXACT}),
    "cap_coefficients/random": (shlight.cap_coefficients, {**CAP, **RANDOM}),
    "disk_coefficients": (shlight.disk_coefficients, {**DISK, **COEFFICIENTS}),
    "polygon_coefficients": (shlight.polygon_coefficients, {**POLYGON, **EXACT}),
    "polygon_coefficients/random": (shlight.polygon_coefficients, {**POLYGON, **RANDOM}),
    "sphere_coefficients": (shlight.sphere_coefficients, {**SPHERE, **EXACT}),
    "sphere_coefficients/random": (shlight.sphere_coefficients, {**SPHERE, **RANDOM}),
    "sphere_coefficients/gradient": (shlight.sphere_coefficients, {**SPHERE, **EXACT, "gradient": True}),
    "shade_spheres/gradient": (shlight.shade_spheres, {**SPHERE, **AUTO, "gradient": "places"}),
    "shade_polygons/gradient": (shlight.shade_polygons, {**POLYGON, **AUTO, "gradient": True}),
    "evaluate": (shlight.evaluate, {"coefficients": [1.0, 0, 0, 0], "directions": [0.0, 0, 1], "threads": 0}),
    "sh_basis": (shlight.sh_basis, {"directions": [0.0, 0, 1], "order": 3, "dtype": None, "threads": 0, "out": None}),
    "contract": (shlight.contract, {"light": [1.0, 0, 0, 0], "material": [1.0, 0, 0, 0], "threads": 0}),
    "shading_frames": (shlight.shading_frames, {"normals": [[0.0, 0.0, 1.0]] * 2, "tangents": [1.0, 0.0, 0.0]}),
    "shade_spheres": (shlight.shade_spheres, {**SPHERE, **AUTO}),
    "shade_spheres/random": (shlight.shade_spheres, {**SPHERE, **SAMPLED}),
    "shade_polygons": (shlight.shade_polygons, {**POLYGON, **AUTO}),
    "shade_polygons/random": (shlight.shade_polygons, {**POLYGON, **SAMPLED}),
    "shade_disks": (shlight.shade_disks, {**DISK, **SHADED, "order": "auto", "method": "auto"}),
    "load": (shlight.load, {"path": MODEL, "up": "z", "scale": 1.0}),
    "look_at": (shlight.look_at, {"eye": [3.0, 0, 1], "target": [0.0, 0, 0], "up": [0, 0, 1]}),
    "luminous": (shlight.luminous, {"irradiance": RGB}),
    "denoise": (
        shlight.denoise,
        {
            **{name: picture(3, np.float32) for name in ("image", "albedo", "normal")},
            **{"quality": "fast", "threads": 1, "progress": None},
        },
    ),
    "has_denoiser": (shlight.has_denoiser, {}),
    "KeptLight.clear": (shlight.KeptLight().clear, {}),
    "render": (
        shlight.render,
        {"scene": new_scene(), **RENDER, **SETTINGS, "kept_light": shlight.KeptLight(), "return_report": True},
    ),
    "RenderResult.save": (shlight.RenderResult({"combined": picture(4, np.float32)}).save, {"path": "a.png"}),
    "RenderResult.mix": (
        shlight.RenderResult({"combined": picture(4, np.float32), "combined_Key": picture(3, np.float32)}).mix,
        {"factors": {"Key": 0.5}},
    ),
    "RenderResult.keys": (shlight.RenderResult({"combined": picture(4, np.float32)}).keys, {}),
    "RenderResult.items": (shlight.RenderResult({"combined": picture(4, np.float32)}).items, {}),
    "images.write_exr": (images.write_exr, {"path": "a.exr", "image": picture(4, np.float32)}),
    "images.write_layers": (
        images.write_layers,
        {"path": "a.exr", "passes": {"depth": picture(1, np.float32)}, "view_layer": "ViewLayer"},
    ),
    "images.read_environment": (images.read_environment, {"path": PICTURE}),
    "images.read_exr": (images.read_exr, {"path": "missing.exr"}),
    "images.read_layers": (images.read_layers, {"path": LAYERS, "view_layer": "ViewLayer"}),
    "images.read_texture": (images.read_texture, {"path": PICTURE, "associate": False}),
    "images.write_png": (images.write_png, {"path": "a.png", "image_srgb_uint8": picture(3, np.uint8)}),
    "images.linear_to_srgb8": (images.linear_to_srgb8, {"image": picture(3, np.float32), "exposure": 1.0}),
    "methods.coefficient_methods": (methods.coefficient_methods, {}),
    "methods.shading_methods": (methods.shading_methods, {}),
    "methods.lobe_condition": (methods.lobe_condition, {"band": 3}),
    "methods.render_monte_carlo": (
        methods.render_monte_carlo,
        {"scene": new_scene(), **RENDER, "samples": 1, "seed": 0},
    ),
}

for name, method in methods.coefficient_methods().items():
    if method.knows_caps:
        CALLS[f"sphere_coefficients/{name}"] = shlight.sphere_coefficients, {**SPHERE, "order": 3, "method": name}
        CALLS[f"cap_coefficients/{name}"] = shlight.cap_coefficients, {**CAP, "order": 3, "method": name}
    if method.knows_polygons:
        CALLS[f"polygon_coefficients/{name}"] = shlight.polygon_coefficients, {**POLYGON, "order": 3, "method": name}
for name, way in methods.shading_methods().items():
    of_method = {"bsdf": GGX, "cos_theta_o": 0.5, "method": name, **({"order": 3} if way.harmonic else {})}
    CALLS[f"shade_spheres/{name}"] = shlight.shade_spheres, {**SPHERE, **of_method}
    CALLS[f"shade_polygons/{name}"] = shlight.shade_polygons, {**POLYGON, **of_method}

# Arguments on which the range of another argument may depend.
RELATED = {
    "albedo": ("normal",),
    "aperture_ratio": ("aperture_size", "focus_distance"),
    "aperture_size": ("focus_distance",),
    "centers": ("radii",),
    "emission": ("material_names",),
    "f0": ("roughness",),
    "eye": ("target", "up"),
    "clip_start": ("clip_end",),
    "half_axes_u": ("half_axes_v", "centers"),
    "half_axes_v": ("centers",),
    "half_axis_u": ("half_axis_v",),
    "image": ("albedo", "normal"),
    "left": ("right",),
    "bottom": ("top",),
    "light": ("material",),
    "material": ("light",),
    "method": ("order", "tolerance", "samples", "seed", "sampling"),
    "max_samples": ("min_samples",),
    "normals": ("tangents",),
    "origins": ("directions",),
    "first": ("uvs", "material_indices"),
    "points": ("normals", "radii", "first", "uvs", "material_indices"),
    "radius": ("intensity",),
    "tangents": ("normals",),
    "target": ("up",),
    **dict.fromkeys(("theta_in", "phi_in", "theta_out", "phi_out"), ("values",)),
    "triangles": ("material_indices",),
    "vertices": ("normals", "triangles"),
}
NUMBERS = [0, 1, -1, 2**31, 2**40, 2**63, 2**64, 10**400, -(10**400), 10**5000, 0.5, -0.0, -0.5, 1e-45, 1e-320]
NUMBERS += [1e38, 1e39, 1e200, 1.7e308, float("nan"), float("inf"), -float("inf"), 1j, 1 + 0j, complex("nan")]
WRONG: list[Any] = [
    *(None, "x", "", "1", b"x", "a\0b", "float16", "float64", True, object(), Fraction(1, 3), repr, int, GGX),
    *([], [[]], {}, (), [[], [1]], set(), ["x"] * 3, [None] * 3, {1: 2}),
    *NUMBERS,
    *([number] * 3 for number in NUMBERS),
    *([number] * 4 for number in NUMBERS[::3]),
    *([[number] * 3] * 3 for number in NUMBERS[::3]),
    *(
        np.ones(shape)
        for shape in [(), 0, (0, 3), (3, 0), 1, 4, (2, 2), (4, 4), (7, 3), (2, 4, 3), (2, 3, 4, 5), (1,) * 30]
    ),
    *(
        np.ones((2, 2, 3), np.uint8),
        np.ones(3, np.float32)[::-1],
        np.zeros(2, "f4,f4"),
        np.array([2**64 - 1] * 3, np.uint64),
    ),
    *(np.array([1, None], object), np.array([1.0, 2.0, 3.0], object), np.array("x"), np.array(["1"] * 3)),
    *(np.array(True), np.array([True, False, True]), np.array([1 + 1j] * 3), np.array(1 + 1j)),
    *(np.bool_(True), np.complex64(1), np.longdouble("1e4000"), np.float16(0.5), np.int8(-1), np.uint64(2**64 - 1)),
    *(np.datetime64("2020-01-01"), np.timedelta64(1), np.float64, np.floating),
]


def complaint(call: str, name: str, value: Any) -> str | None:
    """What is wrong with the answer to one wrong argument; None: nothing."""
    function, arguments = CALLS[call]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            result = function(**{**arguments, name: value})
    except (TypeError, ValueError) as error:
        named = str(error).startswith((name, *RELATED.get(name, ())))
        return None if named or name in ("f", "progress", "on_update") else f"{type(error).__name__}: {error}"
    except OSError as error:
        return None if "path" in arguments else f"{type(error).__name__}: {error}"
    except shlight.RenderCancelled:
        return None if name == "progress" else "cancelled"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    for array in result if isinstance(result, tuple) else (result,):
        if isinstance(array, np.ndarray | np.floating) and not np.isfinite(array).all():
            return "the result is not finite"
    return None


def printable(value: Any) -> bool:
    """Python refuses to print integers of thousands of digits."""
    try:
        return bool(repr(value))
    except ValueError:
        return False


def main() -> None:
    """Problems to standard output; to standard error what is tried, so that its last line is what ended the process."""
    step = int(sys.argv[1])
    for call in sys.argv[2:]:
        # A folder for each, so that none reads what another has written.
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            for number, name in enumerate(CALLS[call][1]):
                for value in WRONG[number % step :: step]:
                    shown = f"{call}({name}={reprlib.repr(value) if printable(value) else type(value)})"
                    print(shown, file=sys.stderr, flush=True)
                    problem = complaint(call, name, value)
                    if problem is not None:
                        print(f"{shown}: {problem}")


if __name__ == "__main__":
    main()
