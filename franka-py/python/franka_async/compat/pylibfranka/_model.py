"""The model of the connected arm."""

from __future__ import annotations

from typing import Any

import numpy as np

from ... import _native
from ._state import NoConstructor, RobotState

_FRAMES = ("joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7", "flange", "ee", "stiffness")


class Model(metaclass=NoConstructor):
    """Dynamics and Jacobians for a state, as lists, column by column."""

    def __init__(self, model: _native.Model) -> None:
        self._model = model

    def coriolis(self, robot_state: RobotState, /) -> list[float]:
        """Returns the torques of Coriolis and centrifugal forces, 7, N m."""
        s = _checked("coriolis", robot_state)
        load = (_square(s.I_total, 3), s.m_total, s.F_x_Ctotal)
        return _listed(self._model.coriolis(s.q, s.dq, *load))

    def gravity(self, robot_state: RobotState, /) -> list[float]:
        """Returns the torques that hold the arm against gravity as the robot measures it, 7, N m."""
        s = _checked("gravity", robot_state)
        return _listed(self._model.gravity(s.q, s.m_total, s.F_x_Ctotal, s.O_ddP_O))

    def mass(self, robot_state: RobotState, /) -> list[float]:
        """Returns the joint-space inertia, 49, kg m^2."""
        s = _checked("mass", robot_state)
        return _listed(self._model.mass(s.q, _square(s.I_total, 3), s.m_total, s.F_x_Ctotal))

    def zero_jacobian(self, *arguments: Any) -> list[float]:
        """Returns the zero Jacobian, 42, of the end effector, or of the frame (number or name) that precedes the state in
        the arguments.
        """
        if len(arguments) not in (1, 2):
            raise TypeError("zero_jacobian() takes a RobotState, or a frame and a RobotState")
        *frame, s = arguments
        _checked("zero_jacobian", s)
        name: Any = frame[0] if frame else "ee"
        name = name if isinstance(name, str) else _FRAMES[int(name)]
        tool = (_square(s.F_T_EE, 4), _square(s.EE_T_K, 4))
        return _listed(self._model.zero_jacobian(name, s.q, *tool))


def _checked(method: str, state: object) -> RobotState:
    if not isinstance(state, RobotState):
        raise TypeError(f"{method}(): got {type(state).__name__}, expected RobotState")
    return state


def _square(values: list[float], size: int) -> Any:
    return np.reshape(values, (size, size), order="F")


def _listed(array: Any) -> list[float]:
    listed: list[float] = np.ravel(array, order="F").tolist()
    return listed
