"""Parts that the Hand classes of both packages share."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager

from .. import _native
from ._waiting import changed, wait

VERSION = 3
"""Version of the protocol that every Hand speaks. A connection to a Hand of another version is refused."""


class Fingers:
    """A connected Hand. Calls that wait release the interpreter for other threads. Another thread may call ``stop``."""

    _translated: Callable[[], AbstractContextManager[None]]
    """Raises the exceptions of the original package instead of the exceptions of this package."""

    _refused: Callable[[str], Exception]
    """Makes the exception for a command that the Hand does not carry out."""

    def _connect(self, gripper: _native.Gripper) -> None:
        self._gripper = gripper
        with self._translated():
            wait(gripper.connect())

    def homing(self) -> bool:
        """Homes the fingers to find their largest opening. Returns True if this succeeded."""
        return self._act(self._gripper.homing)

    def grasp(
        self, width: float, speed: float, force: float, epsilon_inner: float = 0.005, epsilon_outer: float = 0.005
    ) -> bool:
        """Grasps an object of this width, m, at this speed, m/s, with this force, N. Returns True if the Hand holds the
        object.
        """
        return self._act(lambda: self._gripper.grasp(width, speed, force, epsilon_inner, epsilon_outer))

    def stop(self) -> bool:
        """Stops the fingers. Returns True if this succeeded."""
        return self._act(self._gripper.stop)

    def _move(self, width: float, speed: float) -> bool:
        return self._act(lambda: self._gripper.move_to(width, speed))

    def _act(self, action: Callable[[], _native.Operation[bool]]) -> bool:
        with self._translated():
            try:
                return bool(wait(action()))
            except ValueError as error:
                # The original packages do not check this; the Hand does.
                raise self._refused("libfranka gripper: Command failed!") from error

    def _next(self) -> _native.GripperState | None:
        """Waits for the next state; ``None`` if no state comes."""
        with self._translated():
            return changed(self._gripper.state, lambda state: state.time)
