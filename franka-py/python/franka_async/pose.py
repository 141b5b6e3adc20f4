"""Poses from positions and quaternions, and back. A pose is ``(4, 4)``, with the translation in the last column.

::

    from franka_async import pose

    target = pose.rotated(robot.pose(), [0.0, 0.0, 0.3])        # turned by 0.3 rad about z of the base, in place
    position, quaternion = pose.to_xyzw(target)
"""

from ._native import from_xyzw, rotated, to_xyzw

__all__ = ["from_xyzw", "rotated", "to_xyzw"]
