# SPDX-License-Identifier: MIT
"""What a shader program can read at a hit. Vectors are in world coordinates."""

from __future__ import annotations

from numbers import Integral

from shlight.nodes.values import Color, Number, Step, Value, Vector, minimum, number, select, vector

# Numbers of ShaderSource in the core.
SOURCES = {
    "position": 0,
    "normal": 1,
    "geometric_normal": 2,
    "towards_viewer": 3,
    "attribute": 4,
    "object_to_world": 5,
    "world_to_object": 6,
    "object_value": 7,
    "barycentric": 8,
    "backfacing": 9,
    "ray_length": 10,
    "transparent_depth": 11,
    "height": 12,
    "mesh_normal": 13,
}


def read(source: str, component: int = 0, index: int | str = 0) -> Value:
    """One number of a source; index: of an attribute its name."""
    return Value(Step("input", (), (source, index, component)))


def _vector(source: str, index: int | str = 0) -> Vector:
    return Vector(*(read(source, component, index) for component in range(3)))


def position() -> Vector:
    """The position of the hit."""
    return _vector("position")


def normal() -> Vector:
    """The smooth normal, on the viewer's side."""
    return _vector("normal")


def mesh_normal() -> Vector:
    """The mean of the corners' normals by the hit's place in the mesh's frame, on the viewer's side.

    Where the corners' normals differ it is shorter than these.
    """
    return _vector("mesh_normal")


def geometric_normal() -> Vector:
    """The normal of the triangle, on the viewer's side."""
    return _vector("geometric_normal")


def towards_viewer() -> Vector:
    """The unit vector to where the ray comes from."""
    return _vector("towards_viewer")


def uv(name: str = "uvs") -> Vector:
    """The texture coordinates (u, v, 0) that `Scene.add_mesh` got under this name; (0, 0, 0) if there are none."""
    return Vector(read("attribute", 0, name), read("attribute", 1, name), 0.0)


def attribute(name: str) -> Color:
    """The numbers that `Scene.add_mesh` got under this name as a colour: one number is a grey, none are black."""
    return Color(*(read("attribute", component, name) for component in range(4)))


def attribute_mean(name: str) -> Value:
    """The mean of an attribute's first three numbers; one number as it is."""
    return read("attribute", 4, name)


def object_value(index: int) -> Value:
    """A number of the instance that the hit is on."""
    return read("object_value", 0, index)


def barycentric() -> Vector:
    """(u, v, 0) on the triangle: the weights of its second and third corner."""
    return Vector(read("barycentric", 0), read("barycentric", 1), 0.0)


def backfacing() -> Value:
    """1 where the triangle is seen from behind, else 0."""
    return read("backfacing")


def ray_length() -> Value:
    """How far the ray has come."""
    return read("ray_length")


def transparent_depth() -> Value:
    """How many surfaces the ray has passed through."""
    return read("transparent_depth")


def edge_distance() -> Value:
    """How far the nearest edge of the triangle is; very far where there are no triangles."""
    at, heights = barycentric(), _vector("height")
    nearest = minimum(minimum((1.0 - at.x - at.y) * heights.x, at.x * heights.y), at.y * heights.z)
    return select(heights.x > 0.0, nearest, 1e30)


def texture_place(place: Vector | None) -> Vector:
    """The place at which a texture is looked up; `position()`, if none is given."""
    return position() if place is None else vector(place, "place")


def texture_coordinates(place: Vector | None, w: Number, scale: Number, dimensions: int) -> list[Value]:
    """The coordinates, times a scale, at which a texture of so many dimensions is looked up.

    One is w, two are x and y of the place, three are the place, four the place and w. Raises ValueError naming the
    argument.
    """
    if not isinstance(dimensions, Integral) or not 1 <= dimensions <= 4:
        raise ValueError(f"dimensions must be 1, 2, 3 or 4, got {dimensions!r}")
    where = texture_place(place)
    along = [number(w, "w")] if dimensions in (1, 4) else []
    chosen = [*([*where][: min(dimensions, 3)] if dimensions > 1 else []), *along]
    factor = number(scale, "scale")
    return [x * factor for x in chosen]


def _product(source: str, v: Vector, *, transposed: bool = False, moved: bool = False) -> Vector:
    """A matrix, or its transpose, times a vector; moved: plus the last column."""

    def component(i: int) -> Value:
        first, *rest = (read(source, 4 * j + i if transposed else 4 * i + j) * own for j, own in enumerate(v))
        return sum((*rest, *([read(source, 4 * i + 3)] if moved else [])), start=first)

    return Vector(component(0), component(1), component(2))


def point_to_world(point: Vector) -> Vector:
    """A point of the object's frame in the world."""
    return _product("object_to_world", point, moved=True)


def point_to_object(point: Vector) -> Vector:
    """A point of the world in the object's frame."""
    return _product("world_to_object", point, moved=True)


def vector_to_world(v: Vector) -> Vector:
    """A vector of the object's frame in the world."""
    return _product("object_to_world", v)


def vector_to_object(v: Vector) -> Vector:
    """A vector of the world in the object's frame."""
    return _product("world_to_object", v)


def normal_to_world(n: Vector) -> Vector:
    """A normal of the object's frame in the world, of another length."""
    return _product("world_to_object", n, transposed=True)


def normal_to_object(n: Vector) -> Vector:
    """A normal of the world in the object's frame, of another length."""
    return _product("object_to_world", n, transposed=True)
