"""The robot, and active control."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ... import _native, errors
from .._waiting import changed, wait
from ._commands import (
    CartesianPose,
    CartesianVelocities,
    JointPositions,
    JointVelocities,
    Torques,
    numbers,
)
from ._exceptions import (
    PREEMPTED,
    SILENT,
    CommandException,
    ControlException,
    NetworkException,
    translated,
)
from ._model import Model
from ._state import ControllerMode, Duration, NoConstructor, RealtimeConfig, RobotState, made

_CONTROLLERS = {
    ControllerMode.JointImpedance: "joint_impedance",
    ControllerMode.CartesianImpedance: "cartesian_impedance",
}
_AFTER = "writeOnce must not be called after the motion has finished."
_WRONG = "Wrong writeOnce method called for currently active control!"


class ActiveControlBase(metaclass=NoConstructor):
    """A motion in which the program itself reads states and writes commands, in turn, once a millisecond."""

    def __init__(self, control: _native.ActiveControl, command: type) -> None:
        self._control = control
        self._command = command
        self._is_over = False
        self._is_preempted = False

    def readOnce(self) -> tuple[RobotState, Duration]:
        """Waits for the next state. Returns it and the time since the previous state."""
        if self._is_preempted:
            raise ControlException(PREEMPTED)
        try:
            with translated():
                state, step = self._control.read_once()
        except Exception as error:
            self._is_over = True
            if self._is_preempted:
                raise ControlException(PREEMPTED) from error
            raise
        return made(RobotState, state), made(Duration, step)

    def writeOnce(self, command: Any, /) -> None:
        """Sends the command that answers the newest state. A command with ``motion_finished`` ends the motion."""
        if not isinstance(command, Torques | JointPositions | JointVelocities | CartesianPose | CartesianVelocities):
            raise TypeError(f"writeOnce(): got {type(command).__name__}, expected Torques or a command to a motion generator")
        if not isinstance(command, self._command):
            raise ControlException(_WRONG)
        if self._is_over:
            raise ControlException(PREEMPTED if self._is_preempted else _AFTER)
        values: Any = command.values()
        if not all(map(math.isfinite, values)):
            raise ValueError("Commanding value is infinite or NaN.")
        if isinstance(command, CartesianPose):
            values = np.reshape(values, (4, 4), order="F")
        try:
            with translated():
                self._control.write_once(values, command.motion_finished)
        except Exception as error:
            # Another thread may be stopping the motion at this moment.
            if self._is_preempted:
                raise ControlException(PREEMPTED) from error
            raise
        self._is_over = command.motion_finished

    def _preempt(self) -> None:
        if not self._is_over:
            self._is_preempted = self._is_over = True
            self._control.stop()


class Robot:
    """A connected robot. The constructor connects; the connection lasts as long as the object lives."""

    def __init__(
        self, robot_ip_address: str, realtime_config: RealtimeConfig = RealtimeConfig.kEnforce
    ) -> None:
        if not isinstance(realtime_config, RealtimeConfig):
            raise TypeError(f"realtime_config: got {realtime_config!r}, expected RealtimeConfig")
        realtime: Any = "enforce" if realtime_config is RealtimeConfig.kEnforce else "ignore"
        self._robot = _native.Robot(robot_ip_address, realtime=realtime)
        self._active: weakref.ref[ActiveControlBase] | None = None
        with translated():
            try:
                wait(self._robot.connect())
            except errors.ConnectError as error:
                # Like the original, connects to the robot before it checks this computer.
                if error.kind == "realtime":
                    robot = _native.Robot(robot_ip_address, realtime="ignore")
                    wait(robot.connect())
                    wait(robot.shutdown())
                raise

    def read_once(self) -> RobotState:
        """Waits for the next state. Under active control, which reads every state, returns the newest state."""
        active = self._active and self._active()
        with translated():
            if active and not active._is_over:
                return made(RobotState, self._robot.state())
            state = changed(self._robot.state, lambda state: state.time_ms)
        if state is None:
            raise NetworkException(SILENT)
        return made(RobotState, state)

    def start_torque_control(self) -> ActiveControlBase:
        """Begins torque control."""
        return self._start(self._robot.active_torques, Torques)

    def start_joint_position_control(self, control_type: ControllerMode, /) -> ActiveControlBase:
        """Begins control with joint positions."""
        return self._start(self._robot.active_joint_positions, JointPositions, control_type)

    def start_joint_velocity_control(self, control_type: ControllerMode, /) -> ActiveControlBase:
        """Begins control with joint velocities."""
        return self._start(self._robot.active_joint_velocities, JointVelocities, control_type)

    def start_cartesian_pose_control(self, control_type: ControllerMode, /) -> ActiveControlBase:
        """Begins control with poses of the end effector."""
        return self._start(self._robot.active_cartesian_pose, CartesianPose, control_type)

    def start_cartesian_velocity_control(self, control_type: ControllerMode, /) -> ActiveControlBase:
        """Begins control with twists of the end effector."""
        return self._start(self._robot.active_cartesian_velocities, CartesianVelocities, control_type)

    def _start(self, begin: Callable[..., Any], command: type, *mode: ControllerMode) -> ActiveControlBase:
        for one in mode:
            if not isinstance(one, ControllerMode):
                raise TypeError(f"control_type: got {one!r}, expected ControllerMode")
        with translated():
            control = wait(begin(*(_CONTROLLERS[one] for one in mode)))
        active = made(ActiveControlBase, control, command)
        self._active = weakref.ref(active)
        return active

    def set_collision_behavior(
        self,
        lower_torque_thresholds: Sequence[float],
        upper_torque_thresholds: Sequence[float],
        lower_force_thresholds: Sequence[float],
        upper_force_thresholds: Sequence[float],
    ) -> None:
        """Sets the thresholds of contact (lower) and collision (upper). Each torque threshold has 7 numbers, N m; each force
        threshold has 6, N and N m.
        """
        thresholds = [
            numbers("set_collision_behavior()", values, count)
            for values, count in (
                (lower_torque_thresholds, 7),
                (upper_torque_thresholds, 7),
                (lower_force_thresholds, 6),
                (upper_force_thresholds, 6),
            )
        ]
        self._set("Set Collision Behavior", lambda: self._robot.set_collision_behavior(*thresholds))

    def set_joint_impedance(self, K_theta: Sequence[float], /) -> None:
        """Sets the stiffness of the robot's joint impedance controller, 7, N m/rad."""
        stiffness = numbers("set_joint_impedance()", K_theta, 7)
        self._set("Set Joint Impedance", lambda: self._robot.set_joint_impedance(stiffness))

    def set_cartesian_impedance(self, K_x: Sequence[float], /) -> None:
        """Sets the stiffness of the robot's Cartesian impedance controller, 6, N/m and N m/rad."""
        stiffness = numbers("set_cartesian_impedance()", K_x, 6)
        self._set("Set Cartesian Impedance", lambda: self._robot.set_cartesian_impedance(stiffness))

    def set_K(self, EE_T_K: Sequence[float], /) -> None:
        """Sets the stiffness frame in the end effector frame, 16, column by column."""
        self._set_pose("set_K()", "Set EE to K", self._robot.set_k, EE_T_K)

    def set_EE(self, NE_T_EE: Sequence[float], /) -> None:
        """Sets the end effector frame in the nominal end effector frame, 16, column by column."""
        self._set_pose("set_EE()", "Set NE to EE", self._robot.set_ee, NE_T_EE)

    def _set_pose(self, name: str, command: str, setter: Callable[..., Any], values: Sequence[float]) -> None:
        pose = np.reshape(numbers(name, values, 16), (4, 4), order="F")
        self._set(command, lambda: setter(pose))

    def _set(self, command: str, setting: Callable[[], Any]) -> None:
        try:
            operation = setting()
        except ValueError as error:
            # The original does not check this; the robot does.
            raise CommandException(f"libfranka: {command} command rejected: invalid argument!") from error
        with translated():
            wait(operation)

    def set_load(
        self, load_mass: float, F_x_Cload: Sequence[float], load_inertia: Sequence[float], /
    ) -> None:
        """Declares the load.

        ``load_mass`` is in kg, ``F_x_Cload`` is its centre in the flange frame in m. ``load_inertia`` has nine numbers in kg m^2,
        column by column.
        """
        center = numbers("set_load()", F_x_Cload, 3)
        inertia = np.reshape(numbers("set_load()", load_inertia, 9), (3, 3), order="F")
        self._set("Set Load", lambda: self._robot.set_load(load_mass, center, inertia))

    def automatic_error_recovery(self) -> None:
        """Recovers the robot from a reflex."""
        with translated():
            wait(self._robot.recover())

    def load_model(self) -> Model:
        """Returns the model of this arm."""
        with translated():
            return made(Model, self._robot.model())

    def stop(self) -> None:
        """Stops every motion. ``readOnce`` of this motion then raises ControlException."""
        # Under active control, the stop must not need the thread that reads, because it may be this thread.
        if active := self._active and self._active():
            active._preempt()
        with translated():
            wait(self._robot.stop())
