"""Parts of an ``Explanation``, the result of ``franka_async.explain``: why a robot stopped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .value import Value

__all__ = ["Approach", "Contact", "Moment", "Peak"]


@dataclass(frozen=True)
class Moment:
    """An event and its time."""

    time_ms: int
    """Time of the cycle, by the robot's clock, ms."""

    kind: str
    """``goal``, ``mode``, ``contact``, ``collision``, ``error``, ``guard``, ``loss`` or ``note``."""

    text: str
    """Description in words."""


@dataclass(frozen=True)
class Approach:
    """Smallest distance of a quantity from its limit."""

    joint: int | None
    """The joint, 1 to 7; ``None`` for the end effector."""

    value: float
    """Measured value: in rad, rad/s or N m for joints, in m/s or rad/s for the end effector."""

    limit: float
    """Limit in this cycle, on the side of the value."""

    margin: float
    """Distance from the value to the limit; negative beyond the limit."""

    time_ms: int
    """Time by the robot's clock, ms."""


@dataclass(frozen=True)
class Peak:
    """Largest value of a quantity."""

    joint: int | None
    """The joint, 1 to 7; ``None`` for the end effector."""

    value: float
    """Magnitude: in N m for ``external_torque``, N for ``force``, rad for ``following_error``."""

    time_ms: int
    """Time by the robot's clock, ms."""


@dataclass(frozen=True, eq=False)
class Contact(Value):
    """Place of a contact with the arm in the base frame, derived from the external torques of the joints."""

    link: int
    """The touched link, ``0`` to ``7``. The number ``8`` stands for everything mounted on the flange."""

    point: NDArray[np.float64]
    """Point of contact, ``(3,)`` m."""

    force: NDArray[np.float64]
    """Force that the contact exerted on the arm, ``(3,)`` N."""

    spread: float
    """Extent of the points that explain the torques equally well, m."""

    probability: float
    """Probability of this link, 0 to 1."""

    next: tuple[int, float] | None
    """The second most likely link, and its probability."""

    time_ms: int
    """Time of the cycle whose torques were evaluated, by the robot's clock, ms."""
