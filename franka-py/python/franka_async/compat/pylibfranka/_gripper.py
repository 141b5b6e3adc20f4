"""The Franka Hand."""

from __future__ import annotations

from ... import _native
from .._gripper import VERSION, Fingers
from ._exceptions import CommandException, NetworkException, translated
from ._state import Duration, NoConstructor, made


class GripperState(metaclass=NoConstructor):
    """State that the Hand reports."""

    __slots__ = ("is_grasped", "max_width", "temperature", "time", "width")

    def __init__(self, state: _native.GripperState) -> None:
        self.width: float = state.width
        self.max_width: float = state.max_width
        self.is_grasped: bool = state.is_grasped
        self.temperature: int = state.temperature
        self.time = made(Duration, state.time)


class Gripper(Fingers):
    """A connected Hand. Every call that waits releases the interpreter for other threads. Another thread may call ``stop``."""

    _translated = staticmethod(translated)
    _refused = CommandException

    def __init__(self, franka_address: str) -> None:
        self._connect(_native.Gripper(franka_address))

    def move(self, width: float, speed: float, /) -> bool:
        """Moves the fingers to this width, m, at this speed, m/s. Returns True if they arrived."""
        return self._move(width, speed)

    def read_once(self) -> GripperState:
        """Waits for the next state."""
        state = self._next()
        if state is None:
            raise NetworkException("libfranka gripper: UDP receive: Timeout")
        return made(GripperState, state)

    def server_version(self) -> int:
        """Returns the version that the Hand speaks."""
        return VERSION
