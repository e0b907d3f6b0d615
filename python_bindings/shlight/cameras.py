# SPDX-License-Identifier: MIT
"""Where cameras stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from shlight._arrays import Floats, all_rows, broadcast, check_finite, checked_vectors, given_type
from shlight._calls import names_rows

__all__ = ["look_at"]

LEAST_SINE = 1e-8  # between the line of sight and `up`


@names_rows
def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 0.0, 1.0)) -> Floats:
    """The matrix of a camera at `eye` that looks at `target`, as `Scene.set_camera` takes it.

    eye, target, up: (..., 3), points and a direction of any length in the world; leading axes broadcast.
    Returns (..., 4, 4), camera to world for column vectors: the camera looks along its own -z, and its y axis lies in
    the plane of the line of sight and `up`, as in Blender. float32 where eye and target are, else float64.
    ValueError naming the row where eye and target are one point, and where `up` is 0 or parallel to the line of sight.

    >>> shlight.look_at((0, -4, 0), (0, 0, 0))
    array([[ 1.,  0.,  0.,  0.],
           [ 0.,  0., -1., -4.],
           [-0.,  1.,  0.,  0.],
           [ 0.,  0.,  0.,  1.]])
    """
    arrays, shapes = checked_vectors(np.float64, eye=eye, target=target, up=up)
    for name, array in arrays.items():
        check_finite(name, array, core_axes=1)
    shape = broadcast(**shapes)
    place, aim, above = all_rows(arrays, shape)
    back, towards = _unit(place / 2 - aim / 2), _unit(above)  # halves, whose difference cannot overflow
    right = np.cross(towards, back)
    for name, vectors, least, text in (
        ("target", back, 0.0, "is the point where the camera stands"),
        ("up", towards, 0.0, "must not be 0"),
        ("up", right, LEAST_SINE, "must not be parallel to the line of sight"),
    ):
        short = np.linalg.norm(vectors, axis=-1) <= least
        if short.any():
            raise ValueError(f"{name} {text}", int(np.argmax(short)))
    right = _unit(right)
    to_world = np.zeros((len(place), 4, 4), given_type(eye, target))
    to_world[:, :3] = np.stack([right, np.cross(back, right), back, place], axis=-1)
    to_world[:, 3, 3] = 1.0
    return to_world.reshape(*shape, 4, 4)


def _unit(vectors: Floats) -> Floats:
    """Unit vectors (n, 3); 0 of 0."""
    scale = np.abs(vectors).max(axis=-1, keepdims=True, initial=0.0)
    scaled = np.divide(vectors, scale, out=np.zeros_like(vectors), where=scale > 0)
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return np.divide(scaled, length, out=scaled, where=length > 0)
