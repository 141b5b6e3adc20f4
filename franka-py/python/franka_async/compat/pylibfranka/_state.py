"""States as lists, and the enumerations in them."""

from __future__ import annotations

import enum
from collections.abc import Callable
from typing import Any

import numpy as np

from ... import _native


class _Number(enum.Enum):
    """An enumeration whose members have a number, as those of the original."""

    def __int__(self) -> int:
        return int(self.value)

    def __index__(self) -> int:
        return int(self.value)


class ControllerMode(_Number):
    """Which of the robot's controllers follows a motion generator."""

    JointImpedance = 0
    CartesianImpedance = 1


class RealtimeConfig(_Number):
    """Whether a computer without real-time scheduling is refused."""

    kEnforce = 0
    kIgnore = 1


class RobotMode(_Number):
    """What the robot does."""

    Other = 0
    Idle = 1
    Move = 2
    Guiding = 3
    Reflex = 4
    UserStopped = 5
    AutomaticErrorRecovery = 6


class Duration:
    """A time."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds

    def to_sec(self) -> float:
        """Returns it in seconds."""
        return self._seconds


class Errors:
    """The errors of a robot: 41 truth values, by the vendor's names in lower case."""

    def __init__(self, names: list[str]) -> None:
        self._names = names
        self._set = frozenset(name.lower() for name in names)

    def __getattr__(self, name: str) -> bool:
        if name in ERRORS:
            return name in self._set
        raise AttributeError(f"'Errors' object has no attribute {name!r}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *ERRORS]

    def __bool__(self) -> bool:
        return bool(self._names)

    def __str__(self) -> str:
        return "[" + ", ".join(f'"{name}"' for name in self._names) + "]"

    __repr__ = __str__


ERRORS = frozenset(name.lower() for name in _native.ERROR_NAMES)

_MODES = {
    "other": RobotMode.Other,
    "idle": RobotMode.Idle,
    "move": RobotMode.Move,
    "guiding": RobotMode.Guiding,
    "reflex": RobotMode.Reflex,
    "user_stopped": RobotMode.UserStopped,
    "automatic_error_recovery": RobotMode.AutomaticErrorRecovery,
}


def _vector(values: Any) -> list[float]:
    listed: list[float] = np.ravel(values, order="F").tolist()
    return listed


_LISTS = """
    q q_d dq dq_d ddq_d tau_J tau_J_d dtau_J theta dtheta joint_contact joint_collision tau_ext_hat_filtered
    cartesian_contact cartesian_collision O_F_ext_hat_K K_F_ext_hat_K O_dP_EE_d O_dP_EE_c O_ddP_EE_c O_ddP_O
    F_x_Cee F_x_Cload F_x_Ctotal elbow elbow_d elbow_c delbow_c ddelbow_c
    O_T_EE O_T_EE_d O_T_EE_c F_T_EE F_T_NE NE_T_EE EE_T_K I_ee I_load I_total
""".split()

_FIELDS: dict[str, Callable[[Any], Any]] = {
    **dict.fromkeys(_LISTS, _vector),
    **dict.fromkeys(["m_ee", "m_load", "m_total", "control_command_success_rate"], float),
    "time": Duration,
    "robot_mode": _MODES.__getitem__,
    "current_errors": Errors,
    "last_motion_errors": Errors,
}


class RobotState:
    """Everything that the robot says in one millisecond. Arrays are lists, poses 16 numbers column by column.

    A program may set its attributes; the robot does not see that.
    """

    def __init__(self, state: _native.RobotState) -> None:
        self._state = state

    def __getattr__(self, name: str) -> Any:
        """Makes an attribute when it is read first."""
        make = _FIELDS.get(name)
        if make is None:
            raise AttributeError(f"'RobotState' object has no attribute {name!r}")
        value = make(getattr(self._state, name))
        self.__dict__[name] = value
        return value

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *_FIELDS]
