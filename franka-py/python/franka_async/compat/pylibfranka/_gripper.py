"""The Franka Hand."""

from __future__ import annotations

from ... import _native
from .._waiting import changed, wait
from ._exceptions import NetworkException, translated
from ._state import Duration


VERSION = 3
"""The version that every Hand speaks; a connection to one that speaks another is refused."""


class GripperState:
    """What the Hand says of itself."""

    def __init__(self, state: _native.GripperState) -> None:
        self.width: float = state.width
        self.max_width: float = state.max_width
        self.is_grasped: bool = state.is_grasped
        self.temperature: int = state.temperature
        self.time = Duration(state.time)


class Gripper:
    """A connected Hand. Every call that waits leaves the interpreter to other threads, and ``stop`` may come from one."""

    def __init__(self, franka_address: str) -> None:
        self._gripper = _native.Gripper(franka_address)
        with translated():
            wait(self._gripper.connect())

    def homing(self) -> bool:
        """Finds how wide the fingers open; returns whether that succeeded."""
        with translated():
            return bool(wait(self._gripper.homing()))

    def grasp(
        self, width: float, speed: float, force: float, epsilon_inner: float = 0.005, epsilon_outer: float = 0.005
    ) -> bool:
        """Grasps an object of this width, m, at this speed, m/s, with this force, N; returns whether it holds it."""
        with translated():
            grasping = self._gripper.grasp(
                width, speed=speed, force=force, epsilon_inner=epsilon_inner, epsilon_outer=epsilon_outer
            )
            return bool(wait(grasping))

    def move(self, width: float, speed: float, /) -> bool:
        """Moves the fingers to this width, m, at this speed, m/s; returns whether they arrived."""
        with translated():
            return bool(wait(self._gripper.move_to(width, speed)))

    def stop(self) -> bool:
        """Stops the fingers; returns whether that succeeded."""
        with translated():
            return bool(wait(self._gripper.stop()))

    def read_once(self) -> GripperState:
        """Waits for the next state."""
        with translated():
            state = changed(self._gripper.state, lambda state: state.time)
        if state is None:
            raise NetworkException("libfranka gripper: UDP receive: Timeout")
        return GripperState(state)

    def server_version(self) -> int:
        """Returns the version that the Hand speaks."""
        return VERSION
