"""The Franka Hand."""

from __future__ import annotations

from ... import _native
from .._gripper import VERSION, Fingers
from ._errors import FrankaError, translated

GripperState = _native.GripperState


class Gripper(Fingers):
    """A connected Hand. Calls that wait release the interpreter for other threads. Another thread may call ``stop``."""

    _translated = staticmethod(translated)
    _refused = staticmethod(lambda text: FrankaError(text, kind="command"))

    def __init__(self, address: str) -> None:
        self._connect(_native.Gripper(address))

    @property
    def server_version(self) -> int:
        """The version that the Hand speaks."""
        return VERSION

    def move(self, width: float, speed: float) -> bool:
        """Moves the fingers to this width, m, at this speed, m/s. Returns True if they arrived."""
        return self._move(width, speed)

    def read_once(self) -> GripperState:
        """Waits for the next state."""
        state = self._next()
        if state is None:
            raise FrankaError("libfranka gripper: UDP receive: Timeout", kind="network")
        return state

    def __repr__(self) -> str:
        return f"Gripper(server_version={self.server_version})"
