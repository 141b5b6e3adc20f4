"""Quaternions ``x y z w`` and rotation vectors."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def rotated_by(quaternion: npt.ArrayLike, rotation_vector: npt.ArrayLike) -> Array:
    """Returns the quaternion turned about axes of the base: ``exp(r) q``. The length of the quaternion does not change."""
    q = vector("quaternion", quaternion, 4)
    r = vector("rotation_vector", rotation_vector, 3)
    angle = float(np.linalg.norm(r))
    # sin(angle / 2) / angle, which is 1/2 at angle zero.
    turn = np.append(r * (0.5 * np.sinc(angle / (2.0 * np.pi))), np.cos(angle / 2.0))
    return product(turn, q)


def product(a: Array, b: Array) -> Array:
    """Returns the quaternion of the rotation ``b`` followed by ``a``."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


def normalised(quaternion: Array) -> Array:
    """Returns the quaternion with length 1. Raises ``ValueError`` if its length is zero."""
    length = float(np.linalg.norm(quaternion))
    if length < 1e-12:
        raise ValueError("franka: the orientation quaternion has zero length")
    return quaternion / length


def numbers(name: str, values: npt.ArrayLike, *counts: int) -> Array:
    """Returns a vector whose length is one of these. Raises ``TypeError`` for anything but a vector, and ``ValueError`` for
    another length and for non-finite numbers.
    """
    array = vector(name, values, *counts)
    if not np.isfinite(array).all():
        raise ValueError(f"franka: {name} must be finite, got {array.tolist()}")
    return array


def vector(name: str, values: npt.ArrayLike, *counts: int) -> Array:
    """Returns a vector whose length is one of these, or any. Raises ``TypeError`` or ``ValueError``."""
    array = np.array(values, dtype=np.float64)
    if array.ndim != 1:
        raise TypeError(f"franka: {name} is a vector, got the shape {array.shape}")
    if counts and array.shape[0] not in counts:
        expected = " or ".join(map(str, counts))
        raise ValueError(f"franka: {name} has {expected} elements, got {array.shape[0]}")
    return array
