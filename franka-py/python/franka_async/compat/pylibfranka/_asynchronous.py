"""Sparse joint targets between which the robot itself plans."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from dataclasses import dataclass

from ... import _native, errors
from .._waiting import wait
from ._commands import number, numbers
from ._robot import Robot
from ._state import NoConstructor, RobotState, _Number, made

_NEAREST, _FARTHEST = 1e-6, 20.0
"""Least and greatest tolerance that the driver accepts, rad."""

_ABORTED = "Control interface is in aborted state."


class TargetStatus(_Number):
    """Progress of the robot towards a target."""

    kIdle = 0
    kExecuting = 1
    kTargetReached = 2
    kAborted = 3


_STATUS = {
    "idle": TargetStatus.kIdle,
    "executing": TargetStatus.kExecuting,
    "target_reached": TargetStatus.kTargetReached,
    "aborted": TargetStatus.kAborted,
}


def _seven(name: str, values: Sequence[float]) -> list[float]:
    if len(values) != 7:
        raise ValueError(f"{name} must have exactly7 values")  # The text of the original.
    return numbers(name, values, 7)


def _check(name: str, value: object, expected: type) -> None:
    if not isinstance(value, expected):
        raise TypeError(f"{name}: got {type(value).__name__}, expected {expected.__name__}")


class AsyncPositionControlHandler(metaclass=NoConstructor):
    """A motion between sparse joint targets. ``configure`` creates it."""

    class Configuration:
        """Largest joint velocities, 7, rad/s, and the distance from the target that counts as reached, rad."""

        def __init__(self, maximum_joint_velocities: Sequence[float], goal_tolerance: float) -> None:
            self.maximum_joint_velocities: list[float] | None = _seven("joint_velocities", maximum_joint_velocities)
            self.goal_tolerance: float | None = number("goal_tolerance", goal_tolerance)

    @dataclass
    class ConfigurationResult:
        """The handler, or the reason why the configuration failed."""

        handler: AsyncPositionControlHandler | None
        error_message: str | None

    class JointPositionTarget:
        """Target of a motion, 7, rad."""

        def __init__(self, joint_positions: Sequence[float]) -> None:
            self.joint_positions = _seven("joint_positions", joint_positions)

    @dataclass
    class CommandResult:
        """Answer to a target: whether the robot accepted it."""

        motion_uuid: str | None
        was_successful: bool
        error_message: str | None

    @dataclass
    class TargetFeedback:
        """Progress of the robot towards a target, and the reason if it ended early."""

        status: TargetStatus
        error_message: str | None

    def __init__(self, control: _native.AsynchronousControl, reaches: bool) -> None:
        self._control: _native.AsynchronousControl | None = control
        self._reaches = reaches

    @staticmethod
    def configure(robot: Robot, configuration: Configuration, /) -> ConfigurationResult:
        """Begins the motion, and returns its handler."""
        result = AsyncPositionControlHandler.ConfigurationResult
        _check("configuration", configuration, AsyncPositionControlHandler.Configuration)
        begin = robot._robot.asynchronous_joint_positions
        tolerance, distance = configuration.goal_tolerance, configuration.goal_tolerance
        if tolerance is not None:
            # The original accepts any number. With 0, a negative number or NaN, no target ever counts as reached.
            distance = min(tolerance, _FARTHEST) if tolerance > _NEAREST else _NEAREST
        reaches = tolerance is None or tolerance > 0.0
        try:
            control = wait(begin(configuration.maximum_joint_velocities, distance))
        except (errors.FrankaError, ValueError) as error:
            return result(None, str(error))
        return result(made(AsyncPositionControlHandler, control, reaches), None)

    def set_joint_position_target(self, target: JointPositionTarget, /) -> CommandResult:
        """Sends the robot to a target. It replaces the previous target."""
        result = AsyncPositionControlHandler.CommandResult
        _check("target", target, AsyncPositionControlHandler.JointPositionTarget)
        if self._control is None:
            return result(None, False, _ABORTED)
        try:
            self._control.set_target(target.joint_positions)
        except errors.FrankaError:
            return result(None, False, _ABORTED)
        except ValueError as error:
            return result(None, False, str(error))
        return result(str(uuid.uuid4()), True, None)

    def get_target_feedback(self, robot_state: RobotState | None = None) -> TargetFeedback:
        """Returns the progress towards the newest target, according to the newest state."""
        result = AsyncPositionControlHandler.TargetFeedback
        if self._control is None:
            return result(TargetStatus.kAborted, _ABORTED)
        status, reason = self._control.status()
        if status == "target_reached" and not self._reaches:
            status = "executing"
        return result(_STATUS[status], reason)

    def stop_control(self) -> None:
        """Stops the robot."""
        control, self._control = self._control, None
        if control is not None:
            control.stop()
