# SPDX-License-Identifier: MIT
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, Literal, TypedDict, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shlight import _tables
from shlight.nodes.principled import principled as _principled
from shlight.nodes.shader import Shader
from shlight.nodes.values import Value, Vector
from shlight.queries import Hits
from shlight.rendering import RenderResult

_Floats = NDArray[Any]
DEFAULT_TOLERANCE: float
LUMINANCE: tuple[float, float, float]

_Shaded = tuple[NDArray[np.float32], NDArray[np.int32]]  # radiance and effort

def checked_number(name: str, value: object) -> float: ...
def checked_integer(name: str, value: object, least: int, largest: int) -> int: ...
def checked_flag(name: str, value: object) -> bool: ...
def converted_array(name: str, value: object, single: bool) -> _Floats: ...
def kernel_targets() -> list[str]: ...
def kernel_target() -> str: ...
def force_kernel_target(target: str) -> None: ...
def sh_basis(directions: _Floats, order: int, threads: int, out: _Floats | None = None) -> _Floats: ...
def evaluate(coefficients: _Floats, directions: _Floats, order: int, threads: int) -> _Floats: ...
def sphere_coefficients(
    centers: _Floats, radii: _Floats, order: int, clip: bool, threads: int, out: _Floats | None = None
) -> _Floats: ...
def sphere_coefficients_gradient(
    centers: _Floats, radii: _Floats, order: int, clip: bool, threads: int, out: _Floats | None = None
) -> tuple[_Floats, _Floats, _Floats]: ...
def cap_coefficients(
    axes: _Floats, half_angles: _Floats, order: int, clip: bool, threads: int, out: _Floats | None = None
) -> _Floats: ...
def polygon_coefficients(
    vertices: _Floats, order: int, clip: bool, threads: int, out: _Floats | None = None
) -> _Floats: ...
def disk_coefficients(
    centers: _Floats,
    half_axes_u: _Floats,
    half_axes_v: _Floats,
    order: int,
    clip: bool,
    threads: int,
    out: _Floats | None = None,
) -> _Floats: ...
def contract(light: _Floats, material: _Floats, order: int, threads: int) -> _Floats: ...

_Step = tuple[int, float, int, int, list[int]]

class TexturePixels:
    @property
    def size_in_bytes(self) -> int: ...

class ImageTexture:
    @property
    def size(self) -> tuple[int, int]: ...
    def sample(
        self, u: float, v: float, footprint: tuple[float, float, float, float]
    ) -> tuple[float, float, float, float]: ...

class ShaderProgram:
    def evaluate(self, inputs: Sequence[tuple[tuple[int, int, int], _Floats]], count: int) -> NDArray[np.float32]: ...
    @property
    def operation_count(self) -> int: ...

class SurfaceShader: ...

def shader_operations() -> list[tuple[str, int, int]]: ...
def script_instructions() -> list[str]: ...
def texture_pixels(pixels: NDArray[Any], encoding: int, interpolation: int, extension: int) -> TexturePixels: ...
def image_texture(
    tiles: Sequence[tuple[int, int, TexturePixels]], interpolation: int, extension: int, unassociate: bool, tiled: bool
) -> ImageTexture: ...
def shader_program(
    steps: Sequence[_Step],
    tables: Sequence[tuple[_Floats, list[int]]],
    images: Sequence[ImageTexture],
    scripts: Sequence[tuple[NDArray[np.uint32], NDArray[np.uint32], int, list[int]]],
    results: Sequence[int],
) -> ShaderProgram: ...
def surface_shader(
    program: ShaderProgram,
    lobes: Sequence[tuple[str | Bsdf, float, int, int | None, int | None, bool, tuple[int, int] | None, int | None]],
    emission: int | None,
    transparency: int | None,
    shadow_program: ShaderProgram,
    attribute_names: Sequence[str],
    aovs: Sequence[tuple[str, int, bool]],
    refractions: Sequence[tuple[int, int, int, int | None, bool, bool]],
    blocks_shadow_rays: bool,
    absorption: tuple[float, float, float],
) -> SurfaceShader: ...

class LobeTable:
    @property
    def is_isotropic(self) -> bool: ...
    def values(self, wi: _Floats, wo: _Floats) -> NDArray[np.float64]: ...
    def with_sampling_errors(self, errors: Sequence[float]) -> LobeTable: ...
    def bsdf(self, order: int) -> Bsdf: ...

def lobe_table(
    half_vector: bool,
    axes: Sequence[tuple[Sequence[float], float]],
    channels: int,
    entries: _Floats,
    sampling_errors: Sequence[float],
) -> LobeTable: ...
def uncolored(bsdf: Bsdf) -> tuple[Bsdf, NDArray[np.float32]]: ...
def single_lobes(bsdf: Bsdf) -> list[Bsdf]: ...
def varying_ggx(ior: float | None) -> Bsdf: ...

LEAST_ROUGHNESS: float

class Bsdf:
    __array_ufunc__: None
    @overload
    @staticmethod
    def lambert(albedo: ArrayLike) -> Bsdf: ...
    @overload
    @staticmethod
    def lambert(albedo: Value | Vector) -> Shader: ...
    @overload
    @staticmethod
    def ggx(roughness: float, f0: ArrayLike, *, ior: float | None = None) -> Bsdf: ...
    @overload
    @staticmethod
    def ggx(roughness: Value | float, f0: Value | Vector | ArrayLike, *, ior: float | None = None) -> Bsdf | Shader: ...
    @staticmethod
    def oren_nayar(albedo: Value | Vector | ArrayLike, sigma: Value | float) -> Shader: ...
    principled = staticmethod(_principled)
    @staticmethod
    def layer(top: Bsdf, base: Bsdf) -> Bsdf: ...
    from_function = staticmethod(_tables.from_function)
    from_table = staticmethod(_tables.from_table)
    read = staticmethod(_tables.read)
    def coefficients(
        self, cos_theta_o: ArrayLike, order: int, phi_o: ArrayLike | None = None
    ) -> NDArray[np.float32]: ...
    def residual(self, cos_theta_o: ArrayLike, order: int, phi_o: ArrayLike | None = None) -> NDArray[np.float64]: ...
    @property
    def is_anisotropic(self) -> bool: ...
    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]: ...
    def __add__(self, other: Bsdf) -> Bsdf: ...
    def __radd__(self, start: Literal[0]) -> Bsdf: ...
    @overload
    def __mul__(self, factor: ArrayLike) -> Bsdf: ...
    @overload
    def __mul__(self, factor: Value | Vector) -> Shader: ...
    @overload
    def __rmul__(self, factor: ArrayLike) -> Bsdf: ...
    @overload
    def __rmul__(self, factor: Value | Vector) -> Shader: ...

def shade_spheres(
    centers: _Floats,
    radii: _Floats,
    bsdf: Bsdf,
    cos_theta_o: _Floats,
    azimuth: _Floats,
    colors: _Floats,
    alphas: _Floats,
    order: int,
    tolerance: float,
    threads: int,
    with_effort: bool,
) -> _Shaded: ...
def shade_polygons(
    vertices: _Floats,
    bsdf: Bsdf,
    cos_theta_o: _Floats,
    azimuth: _Floats,
    colors: _Floats,
    alphas: _Floats,
    order: int,
    tolerance: float,
    threads: int,
    with_effort: bool,
) -> _Shaded: ...
def shade_disks(
    centers: _Floats,
    half_axes_u: _Floats,
    half_axes_v: _Floats,
    bsdf: Bsdf,
    cos_theta_o: _Floats,
    azimuth: _Floats,
    colors: _Floats,
    alphas: _Floats,
    order: int,
    tolerance: float,
    threads: int,
    with_effort: bool,
) -> _Shaded: ...
def shade_spheres_gradient(
    centers: _Floats,
    radii: _Floats,
    bsdf: Bsdf,
    cos_theta_o: _Floats,
    azimuth: _Floats,
    with_roughness: bool,
    threads: int,
) -> tuple[_Floats, _Floats, _Floats]: ...
def shade_polygons_gradient(
    vertices: _Floats, bsdf: Bsdf, cos_theta_o: _Floats, azimuth: _Floats, with_roughness: bool, threads: int
) -> tuple[_Floats, _Floats]: ...

class RenderCancelled(RuntimeError): ...  # noqa: N818  the name says what happened, not what went wrong

class RenderReport:
    @property
    def order_shares(self) -> dict[int, float]: ...
    @property
    def cubature_share(self) -> float: ...
    @property
    def mirror_share(self) -> float: ...
    @property
    def over_tolerance(self) -> float: ...
    @property
    def hits(self) -> int: ...
    @property
    def shadow_rays(self) -> int: ...
    @property
    def records(self) -> int: ...
    @property
    def passes(self) -> int: ...
    @property
    def noise(self) -> float: ...
    @property
    def seconds_left(self) -> float: ...
    @property
    def build_seconds(self) -> float: ...
    @property
    def dark(self) -> str: ...
    @property
    def doubled(self) -> list[tuple[int, int]]: ...
    @property
    def render_seconds(self) -> float: ...
    @property
    def stage_seconds(self) -> dict[str, float]: ...

class KeptLight:
    def __init__(self) -> None: ...
    @property
    def max_bytes(self) -> int: ...
    @max_bytes.setter
    def max_bytes(self, value: int) -> None: ...
    @property
    def nbytes(self) -> int: ...
    @property
    def record_count(self) -> int: ...
    def clear(self) -> None: ...

class _SeenBy(TypedDict, total=False):
    """Keywords of every light."""

    shadows: bool  # True unless given
    diffuse: bool  # True unless given
    glossy: bool  # True unless given
    camera: bool  # False unless given
    group: str | None  # None unless given
    receivers: Collection[int] | None  # None unless given
    blockers: Collection[int] | None  # None unless given
    profile: ArrayLike | None  # None unless given

class _Lens(TypedDict, total=False):
    aperture_size: float  # 0 unless given
    focus_distance: float
    aperture_blades: int
    aperture_rotation: float
    aperture_ratio: float

class SceneMesh:
    def set_bsdf(
        self,
        bsdf: Bsdf | Shader | Sequence[Bsdf | Shader] | None,
        *,
        emission: ArrayLike | None = None,
        group: str | None = None,
        material_names: str | Sequence[str] | None = None,
        material_pass_indices: ArrayLike | None = None,
    ) -> None: ...
    def set_transforms(
        self,
        transforms: ArrayLike | None,
        *,
        object_values: ArrayLike | None = None,
        object_names: str | Sequence[str] | None = None,
        asset_names: str | Sequence[str] | None = None,
        object_indices: ArrayLike | None = None,
    ) -> None: ...
    def remove(self) -> None: ...
    @property
    def index(self) -> int: ...
    @property
    def to_world(self) -> NDArray[np.float64]: ...
    @to_world.setter
    def to_world(self, value: ArrayLike) -> None: ...
    @property
    def group(self) -> str | None: ...
    @group.setter
    def group(self, value: str | None) -> None: ...

class Light:
    @property
    def radiance(self) -> NDArray[np.float64]: ...
    @radiance.setter
    def radiance(self, value: ArrayLike) -> None: ...
    @property
    def intensity(self) -> NDArray[np.float64]: ...
    @intensity.setter
    def intensity(self, value: ArrayLike) -> None: ...
    @property
    def irradiance(self) -> NDArray[np.float64]: ...
    @irradiance.setter
    def irradiance(self, value: ArrayLike) -> None: ...
    @property
    def to_world(self) -> NDArray[np.float64]: ...
    @to_world.setter
    def to_world(self, value: ArrayLike) -> None: ...
    @property
    def group(self) -> str | None: ...
    @group.setter
    def group(self, value: str | None) -> None: ...
    def remove(self) -> None: ...

class View:
    def relight(
        self, *, noise_threshold: float | None = None, progress: Callable[[float], object] | None = None
    ) -> RenderResult: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...

class Scene:
    def __init__(self) -> None: ...
    def __copy__(self) -> Scene: ...
    def __deepcopy__(self, memo: object) -> Scene: ...
    def add_mesh(
        self,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | Mapping[str, ArrayLike] | None = None,
        colors: ArrayLike | Mapping[str, ArrayLike] | None = None,
        attributes: ArrayLike | Mapping[str, ArrayLike] | None = None,
        bsdf: Bsdf | Shader | Sequence[Bsdf | Shader] | None = None,
        emission: ArrayLike | None = None,
        material_indices: ArrayLike | None = None,
        transforms: ArrayLike | None = None,
        object_values: ArrayLike | None = None,
        group: str | None = None,
        object_names: str | Sequence[str] | None = None,
        asset_names: str | Sequence[str] | None = None,
        object_indices: ArrayLike | None = None,
        material_names: str | Sequence[str] | None = None,
        material_pass_indices: ArrayLike | None = None,
        turn_normals: bool = True,
        terminator_geometry_offset: float = 0.0,
        terminator_shading_offset: float = 0.0,
        visible_to: Collection[str] | None = None,
        holdout: bool = False,
        light_set: int = 0,
        shadow_set: int = 0,
        receivers: Collection[int] | None = None,
        blockers: Collection[int] | None = None,
    ) -> SceneMesh: ...
    def add_curves(
        self,
        points: ArrayLike,
        radii: ArrayLike,
        first: ArrayLike,
        *,
        ribbons: bool = True,
        subdivisions: int = 5,
        uvs: ArrayLike | Mapping[str, ArrayLike] | None = None,
        attributes: ArrayLike | Mapping[str, ArrayLike] | None = None,
        bsdf: Bsdf | Shader | Sequence[Bsdf | Shader] | None = None,
        emission: ArrayLike | None = None,
        material_indices: ArrayLike | None = None,
        transforms: ArrayLike | None = None,
        object_values: ArrayLike | None = None,
        group: str | None = None,
        object_names: str | Sequence[str] | None = None,
        asset_names: str | Sequence[str] | None = None,
        object_indices: ArrayLike | None = None,
        material_names: str | Sequence[str] | None = None,
        material_pass_indices: ArrayLike | None = None,
        terminator_shading_offset: float = 0.0,
        visible_to: Collection[str] | None = None,
        holdout: bool = False,
        light_set: int = 0,
        shadow_set: int = 0,
    ) -> SceneMesh: ...
    def add_point_cloud(
        self,
        points: ArrayLike,
        radii: ArrayLike,
        *,
        uvs: ArrayLike | Mapping[str, ArrayLike] | None = None,
        attributes: ArrayLike | Mapping[str, ArrayLike] | None = None,
        bsdf: Bsdf | Shader | Sequence[Bsdf | Shader] | None = None,
        emission: ArrayLike | None = None,
        material_indices: ArrayLike | None = None,
        transforms: ArrayLike | None = None,
        object_values: ArrayLike | None = None,
        group: str | None = None,
        object_names: str | Sequence[str] | None = None,
        asset_names: str | Sequence[str] | None = None,
        object_indices: ArrayLike | None = None,
        material_names: str | Sequence[str] | None = None,
        material_pass_indices: ArrayLike | None = None,
        terminator_shading_offset: float = 0.0,
        visible_to: Collection[str] | None = None,
        holdout: bool = False,
        light_set: int = 0,
        shadow_set: int = 0,
    ) -> SceneMesh: ...
    def remove_lights(self) -> None: ...
    def add_sphere_light(
        self,
        center: ArrayLike,
        radius: float,
        radiance: ArrayLike,
        *,
        facing_disk: bool = False,
        **seen_by: Unpack[_SeenBy],
    ) -> Light: ...
    def add_polygon_light(
        self,
        vertices: ArrayLike,
        radiance: ArrayLike,
        *,
        spread: float = ...,
        **seen_by: Unpack[_SeenBy],
    ) -> Light: ...
    def add_disk_light(
        self,
        center: ArrayLike,
        half_axis_u: ArrayLike,
        half_axis_v: ArrayLike,
        radiance: ArrayLike,
        *,
        spread: float = ...,
        **seen_by: Unpack[_SeenBy],
    ) -> Light: ...
    def add_point_light(
        self,
        position: ArrayLike,
        intensity: ArrayLike,
        **seen_by: Unpack[_SeenBy],
    ) -> Light: ...
    def add_spot_light(
        self,
        position: ArrayLike,
        direction: ArrayLike,
        spot_angle: float,
        blend: float,
        intensity: ArrayLike,
        *,
        radius: float = 0.0,
        facing_disk: bool = False,
        times_cosine: bool = False,
        **seen_by: Unpack[_SeenBy],
    ) -> Light: ...
    def add_sun_light(
        self,
        direction: ArrayLike,
        angle: float,
        irradiance: ArrayLike,
        *,
        tangent: bool = False,
        **seen_by: Unpack[_SeenBy],
    ) -> Light: ...
    def set_environment(
        self,
        radiance: ArrayLike,
        *,
        to_world: ArrayLike | None = None,
        visible: bool = True,
        group: str | None = None,
        background: ArrayLike | None = None,
    ) -> None: ...
    def view(
        self,
        width: int,
        height: int,
        *,
        order: Literal["auto"] | int = "auto",
        tolerance: float = ...,
        pixel_samples: int = 1,
        pixel_filter: Literal["box", "gaussian", "blackman_harris"] = "box",
        filter_width: float = 1.5,
        shadows: bool = True,
        shadow_rays: int = 4,
        transparent_bounces: int = 8,
        threads: int = 0,
        seed: int = 0,
    ) -> View: ...
    def intersect(self, origins: ArrayLike, directions: ArrayLike, *, threads: int = 0) -> Hits: ...
    @overload
    def irradiance(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        *,
        rays: int = 64,
        max_bounces: int = 0,
        bounce_rays: int = 256,
        return_error: Literal[False] = False,
        transparent_bounces: int = 8,
        threads: int = 0,
        seed: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> _Floats: ...
    @overload
    def irradiance(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        *,
        rays: int = 64,
        max_bounces: int = 0,
        bounce_rays: int = 256,
        return_error: Literal[True],
        transparent_bounces: int = 8,
        threads: int = 0,
        seed: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> tuple[_Floats, _Floats]: ...
    @overload
    def light_coefficients(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        order: int,
        *,
        tangents: ArrayLike | None = None,
        shadows: bool = True,
        rays: int = 64,
        max_bounces: int = 0,
        bounce_rays: int = 256,
        return_error: Literal[False] = False,
        transparent_bounces: int = 8,
        threads: int = 0,
        seed: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> _Floats: ...
    @overload
    def light_coefficients(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        order: int,
        *,
        tangents: ArrayLike | None = None,
        shadows: bool = True,
        rays: int = 64,
        max_bounces: int = 0,
        bounce_rays: int = 256,
        return_error: Literal[True],
        transparent_bounces: int = 8,
        threads: int = 0,
        seed: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> tuple[_Floats, _Floats]: ...
    def radiance(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        order: Literal["auto"] | int = "auto",
        tolerance: float = ...,
        noise_threshold: float = 0.01,
        min_samples: int = 1,
        max_samples: int = 256,
        lights: bool = True,
        shadows: bool = True,
        shadow_rays: int = 16,
        transparent_bounces: int = 8,
        max_bounces: int = 0,
        glossy_bounces: int | None = None,
        transmission_bounces: int | None = None,
        threads: int = 0,
        seed: int = 0,
        progress: Callable[[float], object] | None = None,
    ) -> _Floats: ...
    def set_camera(self, to_world: ArrayLike, fov_x: float, **lens: Unpack[_Lens]) -> None: ...
    def set_camera_window(
        self,
        to_world: ArrayLike,
        left: float,
        right: float,
        bottom: float,
        top: float,
        *,
        orthographic: bool = False,
        clip_start: float = 0.0,
        clip_end: float = ...,
        **lens: Unpack[_Lens],
    ) -> None: ...
    def set_panorama_camera(
        self,
        to_world: ArrayLike,
        panorama_type: Literal[
            "equirectangular",
            "central_cylindrical",
            "fisheye_equidistant",
            "fisheye_equisolid",
            "fisheye_lens_polynomial",
            "mirrorball",
            "equiangular_cubemap_face",
        ],
        *,
        left: float = 0.0,
        right: float = 1.0,
        bottom: float = 0.0,
        top: float = 1.0,
        equirectangular_range: ArrayLike = ...,
        central_cylindrical_range: ArrayLike = ...,
        fisheye_fov: float = ...,
        fisheye_lens: float = 0.0105,
        fisheye_polynomial: ArrayLike = ...,
        sensor_width: float = 0.036,
        sensor_height: float = 0.036,
        clip_start: float = 0.0,
        clip_end: float = ...,
        **lens: Unpack[_Lens],
    ) -> None: ...

def render(
    scene: Scene, width: int, height: int, **options: Any
) -> tuple[dict[str, NDArray[np.float32]], RenderReport]: ...
def cryptomatte_hash(name: str) -> int: ...
