"""States as lists, and the enumerations in them."""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ... import _native
from ._commands import number, numbers


class _Number(enum.Enum):
    """An enumeration whose members have a number as value, as in the original."""

    def __int__(self) -> int:
        return int(self.value)

    def __index__(self) -> int:
        return int(self.value)

    @classmethod
    def _missing_(cls, value: object) -> None:
        if not isinstance(value, int):
            raise TypeError(f"{cls.__name__}(): got {value!r}, expected a number")


class ControllerMode(_Number):
    """The controller of the robot that follows a motion generator."""

    JointImpedance = 0
    CartesianImpedance = 1


class RealtimeConfig(_Number):
    """Policy for a computer without real-time scheduling: refuse to control the robot or not."""

    kEnforce = 0
    kIgnore = 1


class RobotMode(_Number):
    """Mode of the robot."""

    Other = 0
    Idle = 1
    Move = 2
    Guiding = 3
    Reflex = 4
    UserStopped = 5
    AutomaticErrorRecovery = 6


class NoConstructor(type):
    """Base of classes that only this package can instantiate, as in the original."""

    def __call__(cls, *_arguments: Any, **_keywords: Any) -> Any:
        raise TypeError(f"pylibfranka.{cls.__qualname__}: No constructor defined!")


_T = TypeVar("_T")


def made(of: Callable[..., _T], *arguments: Any) -> _T:
    """Creates an object of a class without a constructor."""
    instance: _T = type.__call__(of, *arguments)
    return instance


class Duration(metaclass=NoConstructor):
    """A duration."""

    __slots__ = ("_seconds",)

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds

    def to_sec(self) -> float:
        """Returns the duration in seconds."""
        return self._seconds


class Errors:
    """The errors of a robot: 41 truth values, by the vendor's names in lower case."""

    __slots__ = ("_names", "_set")

    def __init__(self, names: Iterable[str] = ()) -> None:
        self._names = list(names)
        self._set = frozenset(name.lower() for name in names)

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> bool: ...

    def __bool__(self) -> bool:
        return bool(self._names)

    def __str__(self) -> str:
        return "[" + ", ".join(f'"{name}"' for name in self._names) + "]"

    __repr__ = __str__


ERRORS = frozenset(name.lower() for name in _native.ERROR_NAMES)

for _name in ERRORS:
    # The vendor's library omits the end of one name.
    setattr(Errors, _name.removesuffix("_flag"), property(lambda errors, name=_name: name in errors._set))

_MODES = {
    "other": RobotMode.Other,
    "idle": RobotMode.Idle,
    "move": RobotMode.Move,
    "guiding": RobotMode.Guiding,
    "reflex": RobotMode.Reflex,
    "user_stopped": RobotMode.UserStopped,
    "automatic_error_recovery": RobotMode.AutomaticErrorRecovery,
}


def _listed(values: Any) -> list[float]:
    listed: list[float] = np.ravel(values, order="F").tolist()
    return listed


class _Field:
    """An attribute of a state, computed when it is first read. A list is a new list each time."""

    def __init__(self, name: str, make: Callable[[Any], Any], take: Callable[[Any], Any]) -> None:
        self.name = name
        self.make = make
        self.take = take

    def __get__(self, state: RobotState | None, owner: type) -> Any:
        if state is None:
            return self
        values = state._values
        if self.name not in values:
            values[self.name] = self.make(getattr(state._state, self.name))
        value = values[self.name]
        return value.copy() if isinstance(value, list) else value

    def __set__(self, state: RobotState, value: Any) -> None:
        state._values[self.name] = self.take(value)


class RobotState(metaclass=NoConstructor):
    """State of the robot in one millisecond. Arrays are lists; a pose is a list of 16 numbers, column by column.

    A program may set the attributes of a state. This has no effect on the robot.
    """

    __slots__ = ("__weakref__", "_state", "_values")

    def __init__(self, state: _native.RobotState) -> None:
        self._state = state
        self._values: dict[str, Any] = {}

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any: ...


_LENGTHS = {
    16: "O_T_EE O_T_EE_d O_T_EE_c F_T_EE F_T_NE NE_T_EE EE_T_K",
    9: "I_ee I_load I_total",
    7: "q q_d dq dq_d ddq_d tau_J tau_J_d dtau_J theta dtheta joint_contact joint_collision tau_ext_hat_filtered",
    6: """cartesian_contact cartesian_collision O_F_ext_hat_K K_F_ext_hat_K O_dP_EE_d O_dP_EE_c O_ddP_EE_c""",
    3: "O_ddP_O F_x_Cee F_x_Cload F_x_Ctotal",
    2: "elbow elbow_d elbow_c delbow_c ddelbow_c",
}


def _taking(name: str, expected: type) -> Callable[[Any], Any]:
    def take(value: Any) -> Any:
        if not isinstance(value, expected):
            raise TypeError(f"RobotState.{name}: got {type(value).__name__}, expected {expected.__name__}")
        return value

    return take


def _fields() -> Iterable[_Field]:
    for length, names in _LENGTHS.items():
        for name in names.split():
            yield _Field(name, _listed, lambda values, n=name, c=length: numbers(f"RobotState.{n}", values, c))
    for name in ("m_ee", "m_load", "m_total", "control_command_success_rate"):
        yield _Field(name, float, lambda value, n=name: number(f"RobotState.{n}", value))
    yield _Field("time", lambda seconds: made(Duration, seconds), _taking("time", Duration))
    yield _Field("robot_mode", _MODES.__getitem__, _taking("robot_mode", RobotMode))
    for name in ("current_errors", "last_motion_errors"):
        yield _Field(name, Errors, _taking(name, Errors))


for _field in _fields():
    setattr(RobotState, _field.name, _field)
