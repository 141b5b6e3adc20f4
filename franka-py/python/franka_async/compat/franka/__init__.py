"""``franka`` of the distribution ``franka-rs`` 0.4 on top of this package: ``import franka_async.compat.franka as franka``.

Classes, keywords, defaults, exceptions and semantics match the original. States and models are the classes of this package,
which have the same names. The layer raises no thread of the program to real-time priority.
"""

import numpy as np
import numpy.typing as npt

from ..._native import FLAT_LAYOUT, RobotState, __version__
from ._errors import ControlException, FrankaError
from ._gripper import Gripper, GripperState
from ._robot import Model, Robot
from ._rotation import rotated_by
from ._targets import CartesianTargets, JointTargets

__all__ = [
    "FLAT_LAYOUT",
    "FLAT_LEN",
    "CartesianTargets",
    "ControlException",
    "FrankaError",
    "Gripper",
    "GripperState",
    "JointTargets",
    "Model",
    "Robot",
    "RobotState",
    "__version__",
    "rotated",
]

FLAT_LEN: int = RobotState.FLAT_LEN
"""The length of ``RobotState.flat()``."""


def rotated(quaternion: npt.ArrayLike, rotation_vector: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Returns ``quaternion`` (x y z w) turned by ``rotation_vector``, rad, in the base frame. ``move_by`` turns targets in
    this way.
    """
    return rotated_by(quaternion, rotation_vector)
