"""Settings of a robot, as they are set and read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["VirtualWall"]


@dataclass(frozen=True, eq=False)
class VirtualWall:
    """A cuboid that the end effector stays inside of, as it is set up in Desk."""

    size: NDArray[np.float64]
    """The corner opposite to the origin of its frame, ``(3,)`` m, in that frame."""

    pose: NDArray[np.float64]
    """Pose of its frame in the base frame, ``(4, 4)``."""

    is_active: bool
    """True if it is active."""
