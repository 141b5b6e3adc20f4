"""The vendor's ``pylibfranka`` 0.21 on top of this package: ``import franka_async.compat.pylibfranka as pylibfranka``.

Names, arguments, lists (column-major), enumerations, exceptions and their texts match the original. Three points differ:

* it also works with a Franka Emika Robot;
* it leaves the interpreter to other threads whenever it waits;
* it raises no thread of the program to real-time priority: run the control loop on a thread that you give the priority.
"""

from ._asynchronous import AsyncPositionControlHandler, TargetStatus
from ._commands import CartesianPose, CartesianVelocities, JointPositions, JointVelocities, Torques
from ._exceptions import (
    CommandException,
    ControlException,
    FrankaException,
    InvalidOperationException,
    NetworkException,
    RealtimeException,
)
from ._gripper import Gripper, GripperState
from ._model import Model
from ._robot import ActiveControlBase, Robot
from ._state import ControllerMode, Duration, Errors, RealtimeConfig, RobotMode, RobotState

__version__ = "0.21.3"
"""The version of the original that this interface matches."""

__all__ = [
    "ActiveControlBase",
    "AsyncPositionControlHandler",
    "CartesianPose",
    "CartesianVelocities",
    "CommandException",
    "ControlException",
    "ControllerMode",
    "Duration",
    "Errors",
    "FrankaException",
    "Gripper",
    "GripperState",
    "InvalidOperationException",
    "JointPositions",
    "JointVelocities",
    "Model",
    "NetworkException",
    "RealtimeConfig",
    "RealtimeException",
    "Robot",
    "RobotMode",
    "RobotState",
    "TargetStatus",
    "Torques",
]
