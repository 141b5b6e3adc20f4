"""Commands: numbers, and a flag that marks the last command."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, SupportsFloat


def numbers(what: str, values: Iterable[SupportsFloat], count: int) -> list[float]:
    """Returns ``count`` numbers as a list.

    Raises ``TypeError`` for anything else, as the original does.
    """
    if isinstance(values, str | bytes | Mapping):
        raise TypeError(f"{what}: got {type(values).__name__}, expected {count} numbers")
    try:
        listed = [number(what, value) for value in values]
    except TypeError as error:
        raise TypeError(f"{what}: got {values!r}, expected {count} numbers") from error
    if len(listed) != count:
        raise TypeError(f"{what}: got {len(listed)} numbers, expected {count}")
    return listed


def number(what: str, value: SupportsFloat) -> float:
    """Returns a number. Raises ``TypeError`` for anything else, even for text."""
    if isinstance(value, str | bytes):
        raise TypeError(f"{what}: got {value!r}, expected a number")
    return float(value)


class _Numbers:
    """An attribute that is a list with a fixed number of numbers."""

    def __init__(self, count: int) -> None:
        self.count = count

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, command: Any, owner: type | None = None) -> list[float]:
        if command is None:
            return self  # type: ignore[return-value]
        values: list[float] = command._values
        return values.copy()

    def __set__(self, command: Any, values: Iterable[SupportsFloat]) -> None:
        command._values = numbers(f"{type(command).__name__}.{self.name}", values, self.count)


class _Command:
    __slots__ = ("__weakref__", "_is_last", "_values")

    _field: ClassVar[str]

    def __init__(self, values: Iterable[SupportsFloat], /) -> None:
        setattr(self, self._field, values)
        self._is_last = False

    @property
    def motion_finished(self) -> bool:
        """True for the last command of the motion."""
        return self._is_last

    @motion_finished.setter
    def motion_finished(self, finished: Any) -> None:
        # As in the original, accepts None and any value that defines its own truth, and refuses text and lists.
        if finished is not None and not hasattr(finished, "__bool__"):
            raise TypeError(f"motion_finished: got {finished!r}, expected a bool")
        self._is_last = bool(finished)

    def values(self) -> list[float]:
        """Returns the numbers."""
        listed: list[float] = getattr(self, self._field)
        return listed


class Torques(_Command):
    """Joint torques without gravity and friction, 7, N m."""

    __slots__ = ()

    _field = "tau_J"
    tau_J = _Numbers(7)


class JointPositions(_Command):
    """Joint positions, 7, rad."""

    __slots__ = ()

    _field = "q"
    q = _Numbers(7)


class JointVelocities(_Command):
    """Joint velocities, 7, rad/s."""

    __slots__ = ()

    _field = "dq"
    dq = _Numbers(7)


class CartesianPose(_Command):
    """A pose of the end effector in the base frame, 16, column by column."""

    __slots__ = ()

    _field = "O_T_EE"
    O_T_EE = _Numbers(16)


class CartesianVelocities(_Command):
    """A twist of the end effector in the base frame, 6, m/s and rad/s."""

    __slots__ = ()

    _field = "O_dP_EE"
    O_dP_EE = _Numbers(6)
