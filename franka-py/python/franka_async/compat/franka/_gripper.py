"""The Franka Hand."""

from __future__ import annotations

from ... import _native
from .._waiting import changed, wait
from ..pylibfranka._gripper import VERSION
from ._errors import FrankaError, translated

GripperState = _native.GripperState


class Gripper:
    """A connected Hand. Calls that wait leave the interpreter to other threads, and ``stop`` may come from one."""

    def __init__(self, address: str) -> None:
        self._connect(_native.Gripper(address))

    def _connect(self, gripper: _native.Gripper) -> None:
        self._gripper = gripper
        with translated():
            wait(gripper.connect())

    @property
    def server_version(self) -> int:
        """The version that the Hand speaks."""
        return VERSION

    def homing(self) -> bool:
        """Finds how wide the fingers open; returns whether that succeeded."""
        with translated():
            return bool(wait(self._gripper.homing()))

    def move(self, width: float, speed: float) -> bool:
        """Moves the fingers to this width, m, at this speed, m/s; returns whether they arrived."""
        with translated():
            return bool(wait(self._gripper.move_to(width, speed)))

    def grasp(
        self, width: float, speed: float, force: float, epsilon_inner: float = 0.005, epsilon_outer: float = 0.005
    ) -> bool:
        """Grasps an object of this width, m, at this speed, m/s, with this force, N; returns whether it holds it."""
        with translated():
            grasping = self._gripper.grasp(
                width, speed=speed, force=force, epsilon_inner=epsilon_inner, epsilon_outer=epsilon_outer
            )
            return bool(wait(grasping))

    def stop(self) -> bool:
        """Stops the fingers; returns whether that succeeded."""
        with translated():
            return bool(wait(self._gripper.stop()))

    def read_once(self) -> GripperState:
        """Waits for the next state."""
        with translated():
            state = changed(self._gripper.state, lambda state: state.time)
        if state is None:
            raise FrankaError("libfranka gripper: UDP receive: Timeout", "network")
        return state
