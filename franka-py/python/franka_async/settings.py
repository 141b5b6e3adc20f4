"""Settings of a robot."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["VirtualWall"]


@dataclass(frozen=True, eq=False)
class VirtualWall:
    """A virtual wall, as set up in Desk: a cuboid that the end effector cannot leave."""

    size: NDArray[np.float64]
    """Corner of the cuboid that is opposite to the origin of the cuboid's frame, in this frame, ``(3,)`` m."""

    pose: NDArray[np.float64]
    """Pose of the cuboid's frame in the base frame, ``(4, 4)``."""

    is_active: bool
    """True if the wall is active."""
