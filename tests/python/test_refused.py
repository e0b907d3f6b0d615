# SPDX-License-Identifier: MIT
"""What functions refuse: by a ValueError that begins with the argument's name, wherever the argument stands."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest
from argument_walk import CALLS, GGX, RELATED, TRIANGLE

import shlight
from shlight import Bsdf, nodes

NAN, INF = math.nan, math.inf
FAR = (1.001e10, 3.4e18, 1e19, 1e38, 1e300)  # docs/conventions.md: a scene reaches to 1e10
FAR_MESH = [[0, 0, 0], [3e38, 0, 0], [0, 1, 0]]
NO_NUMBER = ("big", None, NAN, INF)
NO_VECTOR = ("up", None, 1.0, [1, 2], [[1, 2, 3, 4]], [1j, 0, 1], [[1, 2, 3], [4]], [NAN, 0, 1], [0, -INF, 1])
NO_DIRECTION = (*NO_VECTOR, [0, 0, 0])
NO_PLACE = (*NO_VECTOR, *([0, far, 0] for far in FAR))
NO_COLOR = ("red", -0.1, NAN, INF, 1e11, [0.1, 0.2], [0.1, 0.2, -0.3])
NO_POLYGON = (
    *("square", None, [], [1, 2, 3], TRIANGLE[:2], [TRIANGLE[:2]] * 3, [[1, 2]] * 3, [[1, 0, 1, 0]] * 3),
    *([[bad, 0, 1], *TRIANGLE[1:]] for bad in (NAN, INF)),
    [[1, 1, 1], [-1, 1, 1], [-1, -1, 1], [1, -1, 1.5]],  # not planar
)
ONE_PLACE = dict.fromkeys(("object_values", "object_names", "asset_names", "object_indices"))
NO_PICTURE = (np.zeros((4, 4)), np.zeros((4, 4, 2)), np.zeros((0, 4, 3)), [["a"]], None)
OF_NODES: dict[str, tuple[Any, str, tuple[Any, ...]]] = {
    "emission": (nodes.emission, "radiance", (*NO_COLOR[:4], 1.1e15)),
    "transparent": (nodes.transparent, "share", NO_COLOR),
    "translucent": (nodes.translucent, "albedo", NO_COLOR),
    "mix": (lambda factor: nodes.mix(nodes.lambert(0.5), nodes.emission(1.0), factor), "factor", ("half", NAN, INF)),
    "glass": (lambda ior: nodes.glass(0.5, 0.1, ior), "ior", ("high", NAN, INF)),
    "edge": (lambda tint: nodes.metallic(0.5, tint, 0.5), "edge_tint", NO_COLOR[:1] + NO_COLOR[2:4]),
    "extinction": (lambda k: nodes.conductor(1.5, k, 0.5), "extinction", NO_COLOR[:1] + NO_COLOR[2:4]),
    "film": (lambda nm: nodes.principled(thin_film_thickness=nm), "thin_film_thickness", ("thick", NAN, INF)),
    "film_ior": (lambda ior: nodes.glass(0.5, 0.1, thin_film_ior=ior), "thin_film_ior", ("high", NAN, INF)),
    "film_model": (lambda name: nodes.principled(thin_film_model=name), "thin_film_model", (None, "spectrum", 1)),
    "diffuse_model": (lambda name: nodes.oren_nayar(0.5, 1.0, diffuse_model=name), "diffuse_model", (None, "fujii", 1)),
    "fibres": (lambda roughness: nodes.microfibre(0.5, roughness), "roughness", ("high", NAN, INF)),
    "velvet": (lambda sigma: nodes.velvet(0.5, sigma), "sigma", ("high", NAN, INF)),
    "toon": (lambda size: nodes.toon(0.5, size, 0.0), "size", ("high", NAN, INF)),
    "smooth": (lambda smooth: nodes.toon(0.5, 0.5, smooth), "smooth", ("high", NAN, INF)),
    "disney": (nodes.disney_sheen, "tint", NO_COLOR),
    "coat": (lambda roughness: nodes.disney_clearcoat(1.0, roughness), "roughness", ("high", NAN, INF)),
    "body": (lambda radius: nodes.subsurface(0.5, radius), "radius", NO_COLOR[:1] + NO_COLOR[2:4]),
    "product": (nodes.lambert(0.5).__mul__, "factor", NO_COLOR),
    "lambert": (nodes.lambert, "albedo", ("red",)),
    "image": (nodes.image, "pixels", (np.ones((2, 2, 5)),)),
    "interpolation": (lambda kind: nodes.image(np.ones((2, 2, 3)), interpolation=kind), "interpolation", ("nearest",)),
    "mix_color": (lambda blend: nodes.mix_color(1, 0, 0.5, blend), "blend", ("over",)),
}
UNKNOWN = {
    "cap_coefficients": ("tolerance", "samples", "seed", "sampling"),
    "cap_coefficients/quadrature": ("samples",),
    "cap_coefficients/random": ("tolerance",),
    "shade_spheres": ("samples", "seed", "sampling"),
    "shade_spheres/quadrature": ("order", "samples"),
    "shade_spheres/cubature": ("seed",),
}


def placed(x: float, y: float, z: float) -> Any:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


# These values must be refused in every call that has an argument of the name; "call.argument" replaces them for one.
REFUSED: dict[str, tuple[Any, ...]] = {
    "albedo": NO_COLOR,
    "denoise.albedo": (np.ones((2, 3, 3)),),
    "alpha_threshold": (2.0,),
    "angle": (-1.0, NAN, 3.2),
    "aovs": ("all",),
    "aperture_blades": (-1,),
    "aperture_ratio": (0,),
    "aperture_rotation": (INF,),
    "aperture_size": (-1, NAN),
    "axes": NO_DIRECTION,
    "blend": (1.1,),
    "bottom": (1.0,),
    "bounce_rays": (1, -1, 2**15),
    "background": ("sky", (1, 2), (1, 2, -3), np.full((2, 4, 3), NAN), np.zeros((4, 4))),
    "bsdf": (0.5, "ggx", [0.8]),
    "center": NO_PLACE,
    "centers": NO_VECTOR,
    "clip_start": (-1.0, 11.0),
    "clamp_indirect": (-1, INF),
    "coefficients": (np.zeros(15), np.zeros(65 * 65), np.zeros((2, 5))),
    "cos_theta_o": (*NO_NUMBER, -0.01, 1.001, 1j),
    "cryptomatte_levels": (1,),
    "direction": (*NO_DIRECTION, np.ones((3, 3)), np.eye(4)),
    "directions": NO_DIRECTION,
    "disk_coefficients.centers": (*NO_VECTOR, [0.5, 0.1, 0]),  # the last lies around the shading point
    "dtype": (np.int32, np.float16),
    "emission": ([1, 2, NAN], [0, 2e15, 0]),
    "exposure": (NAN,),
    "f0": NO_COLOR,
    "factor": NO_COLOR,
    "filter_glossy": (-1, 101),
    "filter_width": (0,),
    "first": ([1], [0, 3], [0, 2], [], [0.0], [-1], [[0]]),
    "fisheye_fov": (0,),
    "fisheye_polynomial": (1, [0, INF, 0, 0, 0]),
    "focus_distance": (0, 1e-11),
    "fov_x": (0, np.pi),
    "glossy_bounces": (-1, 1025),
    "gradient": ("all",),
    "group": (3, ""),
    "groups": (1,),
    "half_angles": (*NO_NUMBER, 0, -1, [0.5, -0.5], 3.15),
    "half_axes_u": ([1, 0], [INF, 0, 0], [0, 0, 0]),
    "half_axes_v": (1.0, [0, 1e400, 0], [2, 0, 0]),
    "half_axis_u": ([0, 0, 0], [NAN, 0, 0], *([far, 0, 0] for far in FAR)),
    "half_axis_v": ([0, 0, 0], [-2, 0, 0], [NAN, 1, 0]),
    "height": (0, -1),
    "image": NO_PICTURE,
    "image_srgb_uint8": (np.zeros((2, 2, 3)),),
    "intensity": ([INF, 0, 0], [1, NAN, 1], "bright", [0, 0, 1.1e30]),
    "ior": (0, 1, 0.5, -1.5, NAN, INF),
    # Programs clamp other numbers.
    **{f"Bsdf.principled.{name}": ("large", NAN, INF) for name in CALLS["Bsdf.principled"][1]},
    "irradiance": ([1, NAN, 1], "bright"),
    "Scene.add_sun_light.irradiance": ([1, NAN, 1], "bright", [1.1e15, 0, 0]),
    "left": (1.0, *FAR),
    "light": (np.zeros(15), np.zeros(25), np.zeros((2, 15))),
    "material_indices": ([0, 0], [1], [-1]),
    "material_names": ([1],),
    "max_bounces": (-1, 1025, 0.5),
    "max_samples": (0, 2**21),
    "method": ("best", None),
    "min_samples": (0, 8),
    "mist": ((1.0, 2.0), (1.0, INF, 2.0)),
    "noise_threshold": (-1, NAN),
    "View.relight.noise_threshold": (0, -1, NAN, 2),
    "normal": (np.ones((2, 2, 4)),),
    "normals": (np.full((3, 3), NAN), np.ones((4, 3)), "up"),
    "shading_frames.normals": ([[0, 0, 1], [0, 0, 0]],),
    "object_indices": ([-1], 0.5),
    "object_names": (["a", "b"],),
    "on_update": (5,),
    "order": (0, -1, 65, 10**30, 2.5, "8", "low", None, [8]),
    "origins": ([[0, 0, 0], [0, NAN, 0]], [0, 2e10, 0], [0, 0]),
    "panorama_type": ("fisheye",),
    "passes": (["deep"], "depth", ["depth", "depth"]),
    "images.write_layers.passes": ({}, "depth"),
    "phi_out": ([0.0, 120.0, 240.0],),
    "pixel_filter": ("tent",),
    "pixel_samples": (0,),
    "points": ([[0, 0, 0], [NAN, 0, 0]], [[0, 0]], [0, 2e10, 0]),
    "position": NO_PLACE,
    "progress": (5,),
    "quality": ("best",),
    "radiance": ("red", [1, 2], [1, NAN, 0], [1, INF, 0], [1.1e15, 0, 0]),
    "Scene.set_environment.radiance": (
        *("sky", None, (1, 2), (1, 2, -3), (1, NAN, 0), (1, INF, 0), [[1, 2, 3]], (2e15, 0, 0)),
        *(np.zeros(shape) for shape in ((0, 4, 3), (4, 4), (4, 4, 4), (2, 4, 4, 3))),
        *(np.full((2, 4, 3), bad) for bad in (-1e-6, INF, 2e15)),
    ),
    "radii": (*NO_NUMBER, 0, -1, [0.5, -0.5], 2.001),  # the last is around the shading point
    **dict.fromkeys(
        ("Scene.add_curves.radii", "Scene.add_point_cloud.radii"),
        ("thick", None, NAN, INF, -0.1, [0.1, 0.1], [0.1, NAN, 0.1], [[0.1] * 3], *FAR),
    ),
    "radius": (-0.1, NAN, *FAR),
    "Scene.add_sphere_light.radius": (0, -1, NAN, *FAR),
    "roughness": (-0.5, 1.5, NAN),
    "sampling": ("everywhere",),
    "samples": (0, 1.5),
    "methods.render_monte_carlo.samples": (0, 2**20 + 1, 2**70 - 2**69),
    "seed": (-1, 0.5, 2**32),
    "sensor_width": (0, INF),
    "Scene.set_environment.to_world": (np.eye(4), 2 * np.eye(3), -np.eye(3), np.full((3, 3), NAN), "north", 1.0),
    "shadow_rays": (-1, 10**10),
    "sigma": ("rough", NAN, -INF),
    "spot_angle": (0.0, 4.0),
    "spread": (0.0, 4.0),
    "subdivisions": (0, 17, 2.5),
    "tangents": ([0, 0, 0], [0, NAN, 0]),
    "theta_in": ([1.0, 0.0],),
    "theta_out": ([0.0, 57.0],),
    "threads": (-1, 1.5, None),
    "time_limit": (0, NAN),
    "to_world": (np.eye(3), np.zeros((4, 4)), np.full((4, 4), NAN), "north", 1.0, placed(0, FAR[0], 0)),
    "tolerance": ("big", NAN, INF, 0, -1e-3, [1e-3, 1e-2]),
    "top": FAR,
    "transforms": (
        *(np.eye(4), [np.ones((4, 4))], [np.diag([1, 1, 0, 1])], [np.diag([1, 1, NAN, 1])]),
        *([placed(far, 0, 0)] for far in FAR),
        *([np.diag([far, far, far, 1])] for far in FAR),
    ),
    "transmission_bounces": (-1, 1025),
    "triangles": ([[0, 1, 3]], [[0, 1, -1]], [[0, 1, 2**32]], [[0, 1]], np.ones((1, 3))),
    "uvs": (np.zeros((3, 3)),),
    "values": (np.ones((1, 3, 2, 3)), -np.ones((2, 3, 2, 3))),
    "vertices": NO_POLYGON,
    **dict.fromkeys(
        ("Scene.add_mesh.vertices", "Scene.add_curves.points", "Scene.add_point_cloud.points"),
        (np.ones((3, 2)), np.full((3, 3), NAN), "floor", np.ones((3, 3), complex), FAR_MESH),
    ),
    "Scene.add_polygon_light.vertices": (
        *NO_POLYGON,
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]],  # no area
        [[0, 0, 0], [2, 2, 0], [2, 0, 0], [0, 3, 0]],  # a bow tie
        *([[0, 0, 0], [far, 0, 0], [0, far, 0]] for far in FAR),
    ),
    "wi": NO_DIRECTION,
    "width": (0, -1, 10**12),
    "wo": NO_DIRECTION,
}
# A call, the arguments that are changed together, and the name by which they are refused.
TOGETHER: list[tuple[str, dict[str, Any], str]] = [
    ("Scene.set_camera", {"aperture_size": 1.0, "aperture_ratio": 1e-11}, "aperture_size"),
    ("Scene.set_camera", {"aperture_size": 1.0, "to_world": np.diag([1.0, 1e80, 1.0, 1.0])}, "aperture_size"),
    ("Scene.add_sun_light", {"angle": 3.1, "tangent": True}, "angle"),
    ("Scene.add_mesh", {"bsdf": [GGX] * 2, "emission": np.ones((3, 3)), "material_names": None}, "bsdf"),
    *(
        ("Scene.add_mesh", {"transforms": [np.eye(4), np.diag([s, s, s, 1])], **ONE_PLACE}, "transforms")
        for far in FAR
        for s in (far, 1 / far)
    ),
    ("Scene.set_panorama_camera", {"panorama_type": "fisheye_equisolid", "fisheye_lens": -1}, "fisheye_lens"),
    *(
        ("Scene.set_panorama_camera", {"panorama_type": kind, f"{kind}_range": [0, 1, 1, 1]}, f"{kind}_range")
        for kind in ("equirectangular", "central_cylindrical")
    ),
    ("render", {"width": 10**5, "height": 10**5}, "height"),
    ("render", {"pixel_samples": 4, "min_samples": 8}, "min_samples"),
    ("render", {"scene": shlight.Scene()}, "scene|camera"),
    ("evaluate", {"coefficients": np.zeros((2, 16)), "directions": np.ones((3, 3))}, "coefficients.*directions"),
    ("contract", {"light": np.zeros((2, 16)), "material": np.zeros((3, 16))}, "light.*material"),
    ("Scene.radiance", {"origins": np.zeros((3, 3)), "directions": np.ones((2, 3))}, "directions"),
    ("cap_coefficients/random", {"half_angles": 1.7}, "half_angles"),
    ("cap_coefficients/zhou_wei", {"order": 33}, "order"),
    ("cap_coefficients/random", {"sampling": "mis"}, "sampling"),
    ("shade_spheres/quadrature", {"bsdf": Bsdf.ggx(0, 1)}, "bsdf"),
    ("shade_spheres/plain_harmonics", {"order": "auto"}, "order"),
    ("sphere_coefficients/gradient", {"order": 64}, "order"),
    ("sphere_coefficients/gradient", {"method": "zhou_wei"}, "method"),
    ("shade_spheres/gradient", {"order": 3}, "order"),
    ("shade_spheres/gradient", {"method": "quadrature"}, "method"),
    # A method refuses arguments that it does not know.
    *(
        (call, {name: value}, name)
        for call, names in UNKNOWN.items()
        for name, value in {"order": 4, "tolerance": 1e-3, "samples": 4, "seed": 4, "sampling": "area"}.items()
        if name in names
    ),
]


def expect_refusal(call: str, changed: dict[str, Any], name: str) -> None:
    function, arguments = CALLS[call]
    with pytest.raises((TypeError, ValueError)) as caught:
        function(**{**arguments, **changed})
    assert re.match(name, str(caught.value)), changed


@pytest.mark.parametrize("call", CALLS)
def test_arguments_out_of_range_are_refused_by_name(call: str) -> None:
    for name in CALLS[call][1]:
        of_name = REFUSED.get(name, ())
        for bad in REFUSED.get(f"{call.split('/')[0]}.{name}", of_name):
            expect_refusal(call, {name: bad}, "|".join((name, *RELATED.get(name, ()))))


@pytest.mark.parametrize(("function", "name", "refused"), OF_NODES.values(), ids=OF_NODES)
def test_programs_refuse_numbers_out_of_range_by_name(function: Any, name: str, refused: tuple[Any, ...]) -> None:
    for bad in refused:
        with pytest.raises(ValueError, match=f"^{name} "):
            function(bad)


@pytest.mark.parametrize(("call", "changed", "name"), TOGETHER)
def test_arguments_that_do_not_go_together_are_refused_by_name(call: str, changed: dict[str, Any], name: str) -> None:
    expect_refusal(call, changed, name)
