# SPDX-License-Identifier: MIT
"""Materials whose numbers vary: sums of lobes with expressions for their colours, widths and normals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple, TypeAlias

from shlight import _core
from shlight._arrays import checked_flag, checked_number
from shlight.nodes.inputs import normal as smooth_normal
from shlight.nodes.inputs import towards_viewer
from shlight.nodes.program import ProgramBuilder
from shlight.nodes.rays import Ray, color_on_ray, has_filters, on_ray, with_vectors
from shlight.nodes.values import (
    LARGEST_RADIANCE,
    Color,
    Number,
    Value,
    Varying,
    Vector,
    clamp,
    color,
    dot,
    normalize,
    number,
    reflectance,
    vector,
)

BLACK = (0.0, 0.0, 0.0)

# The share of light that a bump does not throw its own shadow on: G1 of GGX (Estevez, Lecocq & Stein 2019), or a cubic
# polynomial of the cosines (Chiang, Li & Burley 2019).
BumpShadow: TypeAlias = Literal["ggx", "cubic"]
# The angles [rad] between both normals from which on it shows.
LEAST_LEANS: dict[BumpShadow, float] = {"ggx": math.radians(6.0), "cubic": math.radians(1.5)}
# How much of Lambert's lobe is in diffuse lobes.
LAMBERT_PARTS = {"lambert": 1.0, "oren_nayar": math.pi, "disney": 1.0}


# How rays enter: shlight::SubsurfaceEntry.
REFRACTED, SKIN, DIFFUSE, DISK, EXIT_ONLY = range(5)


@dataclass(frozen=True)
class Subsurface:
    """This is how light gets below a surface and is scattered there until it comes out."""

    # extinction [1/m], albedo of single scattering, and gain, three each; alpha, index, and the mean cosine
    numbers: tuple[Value, ...]
    entry: int

    @cached_property
    def exit_only(self) -> Subsurface:
        """The same for lobes that follow this one's, by which light only comes out."""
        return replace(self, entry=EXIT_ONLY)


@dataclass(frozen=True)
class Lobe:
    """A part of a material: `weight` times a shape of the core."""

    # "lambert", "bumped_lambert_ggx", "bumped_lambert_cubic", "oren_nayar", "oren_nayar_loss", "translucent"; "disney",
    # "disney_retro", "disney_retro_square", "disney_entry", "disney_sheen"; one lobe of a Bsdf; "toon" and
    # "glossy_toon", whose alpha is the size and `rest` the smoothness; or microfacets, "ggx", "beckmann" or
    # "ashikhmin_shirley" with Fresnel factor 1, and the same with "_schlick" or "_dielectric" for its rise towards
    # grazing angles, "_dip", "_wide_dip" or "_narrow_dip" for what a metal's curve lacks, and "_broad_dip" and
    # "_linear" for films; with "stretched_" before it they have two widths: `rest` is alpha across the tangent, and the
    # three of the tangent
    kind: str | _core.Bsdf
    weight: Color
    alpha: Value | None = None  # roughness², of microfacets; along the tangent, if they have two
    normal: Vector | None = None  # None: the smooth one
    ior: float = 1.5  # of "ggx_dielectric"
    several_bounces: bool = False  # the weight makes up for what microfacets of GGX lose to each other
    rest: tuple[Value, ...] = ()  # what follows alpha of a shape with more numbers, in the order of `ShadedLobe::alpha`
    leans_from: Vector | None = None  # the smooth normal; None: the interpolated one
    bump_shadow: BumpShadow = "ggx"  # of LAMBERT_PARTS that lean from it
    below: Subsurface | None = None  # light comes out of the body, and this is by what it enters


@dataclass(frozen=True)
class Refraction:
    """An interface to a transparent body that the mesh bounds, which light that bounces goes through.

    Inside it reflects light, too; lobes are what its front reflects.
    """

    weight: Color
    alpha: Value  # roughness²
    ior: Value  # of the body
    normal: Vector | None = None  # None: the smooth one
    reflects: bool = True  # False: all light goes through that can
    is_beckmann: bool = False  # its microfacets, else those of GGX


_Below: TypeAlias = tuple[int, int] | None
_ListedLobe: TypeAlias = tuple[str | _core.Bsdf, float, int, int | None, int | None, bool, _Below, int | None]


class _Listed(NamedTuple):
    """The steps of a material, and which of their results are what: arguments of `_core.surface_shader`."""

    camera: ProgramBuilder
    shadow: ProgramBuilder
    surface: tuple[list[_ListedLobe], int | None, int | None]
    rest: tuple[list[tuple[str, int, bool]], list[tuple[int, int, int, int | None, bool, bool]]]


@dataclass(frozen=True)
class Shader:
    """The scattering and emission of a surface; made by functions of `shlight.nodes`, used in `Scene.add_mesh`."""

    lobes: tuple[Lobe, ...] = ()
    emission: Color = field(default_factory=lambda: color(BLACK))  # radiance towards the viewer
    transparency: Color = field(default_factory=lambda: color(BLACK))  # share of light that goes on straight through
    aovs: Mapping[str, Value | Color] = field(default_factory=dict)  # see with_aovs
    refractions: tuple[Refraction, ...] = ()
    blocks_shadow_rays: bool = False  # True: light of lamps does not pass where other rays do
    absorption: Color = field(default_factory=lambda: color(BLACK))  # see absorbing

    __array_ufunc__ = None  # an array of numpy times a shader is a shader

    def __add__(self, other: Shader) -> Shader:
        return Shader(
            _merged(self.lobes + other.lobes),
            color(self.emission + other.emission),
            color(self.transparency + other.transparency),
            {**self.aovs, **other.aovs},
            self.refractions + other.refractions,
            self.blocks_shadow_rays or other.blocks_shadow_rays,
            color(self.absorption + other.absorption),
        )

    def __radd__(self, start: Literal[0]) -> Shader:  # what sum() begins with
        return self if start == 0 else NotImplemented

    def __mul__(self, factor: Varying) -> Shader:
        by = reflectance(factor, "factor")
        lobes = tuple(replace(lobe, weight=color(lobe.weight * by)) for lobe in self.lobes)
        through = tuple(replace(own, weight=color(own.weight * by)) for own in self.refractions)
        rest: dict[str, Any] = {
            name: color(getattr(self, name) * by) for name in ("emission", "transparency", "absorption")
        }
        return replace(self, lobes=lobes, refractions=through, **rest)

    __rmul__ = __mul__

    def with_aovs(self, aovs: Mapping[str, Varying]) -> Shader:
        """The same, with values that `shlight.render` delivers as passes by these names: numbers, or colours (RGBA)."""
        own = {name: number(of) if isinstance(of, Value | int | float) else color(of) for name, of in aovs.items()}
        return replace(self, aovs={**self.aovs, **own})

    def with_normal(self, normal: Vector) -> Shader:
        """The same with another normal wherever the smooth one counts, in expressions too.

        A lobe whose own normal leans from this one throws the shadow of a bump; this one throws none, as that of a bump
        that Cycles makes of a displacement.
        """
        n = vector(normal, "normal")
        vectors = {id(None): n}  # by id of what they take the place of: lobes that share a normal still do

        def own(value: Value) -> Value:
            return with_vectors([value], {"normal": n})[0]

        def own_color(of: Color) -> Color:
            return Color(*with_vectors((*of, of.alpha), {"normal": n}))

        def own_normal(of: Vector | None) -> Vector:
            if of is not None and id(of) not in vectors:
                vectors[id(of)] = Vector(*with_vectors(of, {"normal": n}))
            return vectors[id(of)]

        def turned(of: Any) -> Any:
            alpha = None if of.alpha is None else own(of.alpha)
            return replace(of, weight=own_color(of.weight), alpha=alpha, normal=own_normal(of.normal))

        def turned_lobe(lobe: Lobe) -> Any:
            below = lobe.below
            if below is not None:
                below = replace(below, numbers=tuple(own(value) for value in below.numbers))
            before = own_normal(lobe.leans_from)
            rest = tuple(own(value) for value in lobe.rest)
            return replace(turned(lobe), rest=rest, leans_from=before, below=below)

        return replace(
            self,
            lobes=tuple(turned_lobe(lobe) for lobe in self.lobes),
            emission=own_color(self.emission),
            transparency=own_color(self.transparency),
            aovs={name: own(of) if isinstance(of, Value) else own_color(of) for name, of in self.aovs.items()},
            refractions=tuple(replace(turned(of), ior=own(of.ior)) for of in self.refractions),
        )

    def with_bump_shadow(self, bump_shadow: BumpShadow) -> Shader:
        """The same with another shadow of bumps: "ggx", as in Cycles since Blender 4.5, or "cubic", as before.

        Raises ValueError naming the argument.
        """
        if bump_shadow not in LEAST_LEANS:
            raise ValueError(f"bump_shadow must be 'ggx' or 'cubic', not {bump_shadow!r}")
        return replace(self, lobes=tuple(replace(lobe, bump_shadow=bump_shadow) for lobe in self.lobes))

    def compiled(self) -> _core.SurfaceShader:
        """The core's object of this shader."""
        return self._compiled

    @property
    def attribute_names(self) -> list[str]:
        """The attributes that it reads of a mesh; known before its pictures are read."""
        return list(self._listed.camera.attributes)

    @property
    def is_anisotropic(self) -> bool:
        """Whether it matters how the surface's tangent lies."""
        return any(isinstance(lobe.kind, _core.Bsdf) and lobe.kind.is_anisotropic for lobe in self.lobes)

    @property
    def operation_count(self) -> int:
        """How many operations the core runs for each hit."""
        return self._program.operation_count

    @cached_property
    def _is_filtered(self) -> bool:
        """Whether pictures are filtered. Where one decides what is seen at all they are not: the mean of its colours,
        of which most may belong to what is not seen, says nothing of those that are.
        """
        return not has_filters(color_on_ray(self.transparency, Ray.CAMERA))

    def _lobes_for_camera(self) -> list[Lobe]:
        """Lobes that show."""
        normals: dict[int, Vector] = {}
        found = []
        for lobe in _merged(tuple(part for whole in self.lobes for part in _shadowed_by_bumps(whole))):
            weight = color_on_ray(lobe.weight, Ray.CAMERA, filtered=self._is_filtered)
            if weight.constant == BLACK:
                continue
            normal, before = (
                None if of is None else normals.setdefault(id(of), Vector(*on_ray(of, Ray.CAMERA)))
                for of in (lobe.normal, lobe.leans_from)
            )
            alpha = None if lobe.alpha is None else on_ray([lobe.alpha], Ray.CAMERA)[0]
            rest = tuple(on_ray(lobe.rest, Ray.CAMERA))
            below = lobe.below
            if below is not None:
                below = replace(below, numbers=tuple(on_ray(below.numbers, Ray.CAMERA)))
            bent = replace(lobe, normal=normal, leans_from=before)
            found.append(replace(bent, weight=weight, alpha=alpha, rest=rest, below=below))
        return found

    @cached_property
    def _listed(self) -> _Listed:
        builder = ProgramBuilder()

        def listed(*values: Value, filtered: bool = self._is_filtered) -> int:
            return builder.result(on_ray(values, Ray.CAMERA, filtered=filtered))

        lobes = []
        normals: dict[int, int] = {}  # lobes with the same normal share the number of its result
        for lobe in self._lobes_for_camera():
            weight = builder.result(tuple(lobe.weight))
            alpha = None if lobe.alpha is None else builder.result([lobe.alpha, *lobe.rest])
            for leaning in (lobe.normal, lobe.leans_from):
                if leaning is not None and id(leaning) not in normals:
                    normals[id(leaning)] = builder.result(tuple(leaning))
            normal, before = (None if own is None else normals[id(own)] for own in (lobe.normal, lobe.leans_from))
            below = None if lobe.below is None else (builder.result(lobe.below.numbers), lobe.below.entry)
            lobes.append((lobe.kind, lobe.ior, weight, alpha, normal, lobe.several_bounces, below, before))
        glow, seen = (
            color_on_ray(own, Ray.CAMERA, filtered=self._is_filtered) for own in (self.emission, self.transparency)
        )
        lit = color_on_ray(self.transparency, Ray.SHADOW)
        glow_result = None if glow.constant == BLACK else builder.result(tuple(glow))
        is_opaque = seen.constant == lit.constant == BLACK
        through = None if is_opaque else builder.result(tuple(seen))
        aovs = []
        for name, value in self.aovs.items():
            parts = [value] if isinstance(value, Value) else list(value)
            aovs.append((name, listed(*parts), len(parts) == 3))
        refractions = []
        for own in self.refractions:
            weight = listed(*own.weight)
            alpha, ior = (listed(value, filtered=True) for value in (own.alpha, own.ior))
            bent = None if own.normal is None else listed(*own.normal, filtered=True)
            refractions.append((weight, alpha, ior, bent, own.reflects, own.is_beckmann))
        shadows = ProgramBuilder(builder.attributes)
        shadows.result(tuple(lit))
        return _Listed(builder, shadows, (lobes, glow_result, through), (aovs, refractions))

    @cached_property
    def _program(self) -> _core.ShaderProgram:
        return self._listed.camera.program()

    @cached_property
    def _compiled(self) -> _core.SurfaceShader:
        camera, shadow, surface, rest = self._listed
        absorption = self.absorption.constant
        if absorption is None:
            raise ValueError("absorption must be the same everywhere inside a body")
        return _core.surface_shader(
            self._program, *surface, shadow.program(), camera.attributes, *rest, self.blocks_shadow_rays, absorption
        )


def _merged(lobes: tuple[Lobe, ...]) -> tuple[Lobe, ...]:
    """The same with one lobe for each shape and normal."""
    found: dict[tuple[Any, ...], Lobe] = {}
    for lobe in lobes:
        numbers = [_identity(value) for value in (lobe.alpha, *lobe.rest)]
        objects = map(id, (lobe.normal, lobe.leans_from, lobe.below))
        key = (lobe.kind, lobe.ior, *objects, lobe.several_bounces, lobe.bump_shadow, *numbers)
        same = found.get(key)
        found[key] = lobe if same is None else replace(lobe, weight=color(same.weight + lobe.weight))
    return tuple(found.values())


def _shadowed_by_bumps(lobe: Lobe) -> tuple[Lobe, ...]:
    """A lobe with Lambert's part of it in the shadow that a bump throws on itself, where its normal leans."""
    part = LAMBERT_PARTS.get(lobe.kind) if isinstance(lobe.kind, str) else None
    if part is None or lobe.normal is None or lobe.normal is lobe.leans_from:
        return (lobe,)
    n = normalize(lobe.normal)
    smooth = smooth_normal() if lobe.leans_from is None else lobe.leans_from
    own = lobe.weight * part * (dot(n, smooth) < math.cos(LEAST_LEANS[lobe.bump_shadow]))
    if lobe.kind == "disney":
        away = 1.0 - clamp(dot(towards_viewer(), n))
        own = own * (1.0 - 0.5 * (away * away * away * away * away))
    below = None if lobe.below is None else lobe.below.exit_only
    less = replace(lobe, kind="lambert", weight=color(own * -1.0), below=below)
    return lobe, less, replace(lobe, kind=f"bumped_lambert_{lobe.bump_shadow}", weight=color(own), below=below)


def _identity(value: Value | None) -> Any:
    """Equal for numbers that are known to be equal: the same value, or the same operation on the same values."""
    if value is None:
        return None
    if value.constant is not None:
        return value.constant
    step = value.step
    known_by = tuple((id(a.step), a.output) for a in step.arguments) or id(step)
    return (step.name, id(step.data), known_by, value.output)


def scaled(bsdf: _core.Bsdf, factor: Varying) -> Shader:
    """A Bsdf times a colour that varies."""
    by = reflectance(factor, "factor")
    lobes, colors = _core.uncolored(bsdf)
    own = zip(_core.single_lobes(lobes), colors, strict=True)
    return Shader(tuple(Lobe(lobe, color(by * tuple(c.tolist()))) for lobe, c in own))


def lambert(albedo: Varying, normal: Vector | None = None) -> Shader:
    """Lambert's reflection.

    Where a normal leans away from the smooth one it is in the shadow that a bump throws on itself, as in Cycles; see
    `Shader.with_bump_shadow`.
    """
    return Shader((Lobe("lambert", reflectance(albedo, "albedo"), normal=normal),))


def translucent(albedo: Varying, normal: Vector | None = None) -> Shader:
    """Lambert's reflection of light from the other side: Blender's Translucent BSDF."""
    return Shader((Lobe("translucent", reflectance(albedo, "albedo"), normal=normal),))


def toon(tint: Varying, size: Number, smooth: Number, *, glossy: bool = False, at: Vector | None = None) -> Shader:
    """Light within a cone about the normal counts evenly, and no other: Blender's Toon BSDF, component Diffuse.

    The cone's half angle is size * 90°; from there on light counts less and less, over smooth * 90°, both clamped to
    0 … 1. glossy: the cone is about the mirror direction of the view instead. Raises ValueError naming an argument.
    """
    kind = "glossy_toon" if checked_flag("glossy", glossy) else "toon"
    own, rest = clamp(number(size, "size")), (clamp(number(smooth, "smooth")),)
    return Shader((Lobe(kind, reflectance(tint, "tint"), own, None if at is None else vector(at, "at"), rest=rest),))


def ggx(roughness: Number, f0: Varying, *, ior: float | None = None, normal: Vector | None = None) -> Shader:
    """A microfacet reflection whose alpha is roughness², like `Bsdf.ggx`."""
    if ior is not None and not 1 < checked_number("ior", ior) < math.inf:
        raise ValueError("ior must be finite and greater than 1")
    f0_color = reflectance(f0, "f0")
    r = number(roughness, "roughness", 0.0, 1.0)
    edge = "ggx_schlick" if ior is None else "ggx_dielectric"
    rest = color(1.0 - f0_color)
    return Shader(
        (
            Lobe("ggx", f0_color, r * r, normal),
            Lobe(edge, rest, r * r, normal, 1.5 if ior is None else ior),
        )
    )


def emission(radiance: Varying) -> Shader:
    """A surface that gives light [W m^-2 sr^-1] to both sides."""
    return Shader(emission=color(radiance, "radiance", 0.0, LARGEST_RADIANCE))


def transparent(share: Varying = 1.0) -> Shader:
    """A surface that lets light go straight through."""
    return Shader(transparency=reflectance(share, "share"))


def absorbing(absorption: Varying) -> Shader:
    """Light fades inside the body that a mesh bounds, whose triangles are counter-clockwise seen from outside.

    It is added to what its surface is: `glass(1.0, 0.0) + absorbing((0.1, 0.5, 2.0))`. absorption: [1/m], constant; of
    light, exp(-absorption * way) is left. Raises ValueError naming the argument.
    """
    return Shader(absorption=reflectance(absorption, "absorption"))


def mix(a: Shader, b: Shader, factor: Number) -> Shader:
    """(1 - factor) a + factor b; factor is clamped to 0 … 1."""
    t = clamp(number(factor, "factor"))
    return (1.0 - t) * a + t * b
