"""Time-optimal motions of any machine with axes, inside limits of velocity, acceleration and jerk.

::

    from franka_async import otg

    limits = otg.AxisLimits(velocity=2.0, acceleration=10.0, jerk=5000.0)
    trajectory = otg.plan([0.0, 0.5], [0.3, -0.2], limits)
    position, velocity, acceleration = trajectory.at(0.1)
    times, positions, velocities, accelerations = trajectory.sample(0.001)

``AxisLimits.fr3()`` and ``AxisLimits.fer()`` are the limits of the robots' joints. A robot needs none of this: it plans its
motions on the control thread. It is for looking ahead, and for other machines.
"""

from typing import Literal, TypeAlias

from ._native import AxisLimits, Trajectory
from ._native import plan_trajectory as plan

__all__ = ["AxisLimits", "Synchronisation", "Trajectory", "plan"]

Synchronisation: TypeAlias = Literal["straight", "time"]
"""The way to synchronise axes: move on a straight line where they can, or only be at the target at the same time."""
