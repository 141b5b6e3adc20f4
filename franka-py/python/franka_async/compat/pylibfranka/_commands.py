"""Commands: numbers, and whether they are the last."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar, SupportsFloat


def numbers(what: str, values: Sequence[SupportsFloat], count: int) -> list[float]:
    """Returns so many numbers as a list.

    Raises ``TypeError`` for anything else, as the original does.
    """
    try:
        listed = [float(value) for value in values]
    except (TypeError, ValueError) as error:
        raise TypeError(f"{what}: got {values!r}, expected {count} numbers") from error
    if len(listed) != count:
        raise TypeError(f"{what}: got {len(listed)} numbers, expected {count}")
    return listed


class _Numbers:
    """An attribute that is a list of so many numbers."""

    def __init__(self, count: int) -> None:
        self.count = count

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name
        self.key = f"_{name}"

    def __get__(self, command: object, owner: type | None = None) -> list[float]:
        if command is None:
            return self  # type: ignore[return-value]
        values: list[float] = getattr(command, self.key)
        return list(values)

    def __set__(self, command: Any, values: Sequence[SupportsFloat]) -> None:
        setattr(command, self.key, numbers(f"{type(command).__name__}.{self.name}", values, self.count))


class _Command:
    _field: ClassVar[str]

    def __init__(self, values: Sequence[SupportsFloat], /) -> None:
        setattr(self, self._field, values)
        self.motion_finished = False

    def values(self) -> list[float]:
        """Returns the numbers."""
        listed: list[float] = getattr(self, self._field)
        return listed


class Torques(_Command):
    """Joint torques without gravity and friction, 7, N m."""

    _field = "tau_J"
    tau_J = _Numbers(7)


class JointPositions(_Command):
    """Joint positions, 7, rad."""

    _field = "q"
    q = _Numbers(7)


class JointVelocities(_Command):
    """Joint velocities, 7, rad/s."""

    _field = "dq"
    dq = _Numbers(7)


class CartesianPose(_Command):
    """A pose of the end effector in the base frame, 16, column by column."""

    _field = "O_T_EE"
    O_T_EE = _Numbers(16)


class CartesianVelocities(_Command):
    """A twist of the end effector in the base frame, 6, m/s and rad/s."""

    _field = "O_dP_EE"
    O_dP_EE = _Numbers(6)
