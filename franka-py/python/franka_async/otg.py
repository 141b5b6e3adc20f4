"""Time-optimal motions of any machine with axes, inside limits of velocity, acceleration and jerk.

::

    from franka_async import otg

    limits = otg.AxisLimits(velocity=2.0, acceleration=10.0, jerk=5000.0)
    trajectory = otg.plan([0.0, 0.5], [0.3, -0.2], limits)
    position, velocity, acceleration = trajectory.at(0.1)
    times, positions, velocities, accelerations = trajectory.sample(0.001)

``AxisLimits.fr3()`` and ``AxisLimits.fer()`` are the limits of the robots' joints. Control of a robot does not need this
module, because the driver plans motions on the control thread. Use it to compute a motion in advance, or for other machines.
"""

from typing import Literal, TypeAlias

from ._native import AxisLimits, Trajectory
from ._native import plan_trajectory as plan

__all__ = ["AxisLimits", "Synchronisation", "Trajectory", "plan"]

Synchronisation: TypeAlias = Literal["straight", "time"]
"""Synchronisation of the axes: ``straight`` moves on a straight line if possible; with ``time`` all axes only arrive
together."""
