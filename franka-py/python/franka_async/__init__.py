"""Driver for Franka robots: motions are awaitables, states are numpy arrays, control stays on a real-time thread."""

from ._native import ControlLog, Motion, Operation, Robot, RobotState, Sim
from .errors import (
    ActionError,
    ActiveError,
    CommandError,
    ConnectError,
    ControlError,
    FrankaError,
    IdentifyError,
    MotionError,
    ReadError,
)

__all__ = [
    "ActionError",
    "ActiveError",
    "CommandError",
    "ConnectError",
    "ControlError",
    "ControlLog",
    "FrankaError",
    "IdentifyError",
    "Motion",
    "MotionError",
    "Operation",
    "ReadError",
    "Robot",
    "RobotState",
    "Sim",
]
