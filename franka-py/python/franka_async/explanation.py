"""The parts of an ``Explanation``, which ``franka_async.explain`` makes: the reasons why a robot stopped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .value import Value

__all__ = ["Approach", "Contact", "Moment", "Peak"]


@dataclass(frozen=True)
class Moment:
    """Something that happened, with its time."""

    time_ms: int
    """The cycle, by the robot's clock."""

    kind: str
    """``goal``, ``mode``, ``contact``, ``collision``, ``error``, ``guard``, ``loss`` or ``note``."""

    text: str
    """Description in words."""


@dataclass(frozen=True)
class Approach:
    """Smallest distance of a quantity to its limit."""

    joint: int | None
    """The joint, 1 to 7; ``None`` for the end effector."""

    value: float
    """Measured value: rad, rad/s or N m of joints, m/s or rad/s of the end effector."""

    limit: float
    """The limit at that cycle, on the side of the value."""

    margin: float
    """Distance from the value to the limit; negative beyond it."""

    time_ms: int
    """Time by the robot's clock, ms."""


@dataclass(frozen=True)
class Peak:
    """Largest value of a quantity."""

    joint: int | None
    """The joint, 1 to 7; ``None`` for the end effector."""

    value: float
    """Its size: N m of ``external_torque``, N of ``force``, rad of ``following_error``."""

    time_ms: int
    """Time by the robot's clock, ms."""


@dataclass(frozen=True, eq=False)
class Contact(Value):
    """Place of a contact with the arm in the base frame, derived from the external torques of the joints."""

    link: int
    """The link that was touched, ``0`` to ``7``. The number ``8`` stands for everything mounted on the flange."""

    point: NDArray[np.float64]
    """Point of contact, ``(3,)`` m."""

    force: NDArray[np.float64]
    """Force that the contact exerted on the arm, ``(3,)`` N."""

    spread: float
    """Extent of the places that explain the torques equally well, m."""

    probability: float
    """Probability of this link, 0 to 1."""

    next: tuple[int, float] | None
    """The next likely link, and its probability."""

    time_ms: int
    """The cycle whose torques were evaluated, by the robot's clock."""
