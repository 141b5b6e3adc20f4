"""The same classes for programs without an event loop: their methods wait, with the interpreter released.

::

    from franka_async import sync

    with sync.Robot("172.16.0.2") as robot:
        report = robot.move_by([0.0, 0.0, 0.05])
        with robot.engage() as arm:
            arm.move_by([0.0, 0.1, 0.0])

Ctrl-C brakes the arm and raises ``KeyboardInterrupt``. Other threads run meanwhile, and may call ``robot.stop()``. Names,
arguments and exceptions match ``franka_async``, which also has the classes that are not here. One method differs:
``Team.run`` takes a function for each arm, ``team.run([lambda arm: arm.move_to(a), lambda arm: arm.move_by(b)])``, because
here a call such as ``arm.move_to(a)`` waits for the end of the motion.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

from .. import _native

__all__ = [
    "Arm",
    "AsynchronousControl",
    "Gripper",
    "IdentificationPlan",
    "Recorder",
    "Robot",
    "Team",
    "TeamGrasp",
    "VacuumGripper",
    "tools",
]

_waiting: dict[type, type] = {}
"""For each class of the package, the class of this module."""


class _Waiting:
    """An object whose methods wait."""

    __slots__ = ("_awaiting", "__weakref__")

    def __repr__(self) -> str:
        return repr(self._awaiting)

    def __str__(self) -> str:
        return str(self._awaiting)


def _awaiting(argument: Any) -> Any:
    """Converts an argument of this module to an argument for ``franka_async``."""
    return getattr(argument, "_awaiting", argument)


def _unwrapped(arguments: Sequence[Any], keywords: dict[str, Any]) -> tuple[list[Any], dict[str, Any]]:
    """Converts the arguments of a call of this module to arguments for ``franka_async``."""
    return [_awaiting(argument) for argument in arguments], {name: _awaiting(value) for name, value in keywords.items()}


def _result(result: Any) -> Any:
    """Waits for a result of ``franka_async``, and converts it to a result of this module."""
    if isinstance(result, _native.Operation):
        result = result.wait()
    if type(result) is list:
        return [_result(part) for part in result]
    if type(result) not in _waiting:
        return result
    waiting = object.__new__(_waiting[type(result)])
    waiting._awaiting = result
    return waiting


def _class(of: type) -> Any:
    """Returns a class with the methods of a class of the package; its methods wait."""

    def method(name: str, there: Any) -> Any:
        @functools.wraps(there)
        def call(self: Any, *arguments: Any, **keywords: Any) -> Any:
            arguments, keywords = _unwrapped(arguments, keywords)
            result = _result(getattr(self._awaiting, name)(*arguments, **keywords))
            return self if result.__class__ is self.__class__ and result._awaiting is self._awaiting else result

        return call

    def function(there: Any) -> Any:
        @functools.wraps(there)
        def call(*arguments: Any, **keywords: Any) -> Any:
            arguments, keywords = _unwrapped(arguments, keywords)
            return _result(there(*arguments, **keywords))

        return staticmethod(call)

    def field(name: str, there: Any) -> Any:
        return property(lambda self: _result(getattr(self._awaiting, name)), doc=there.__doc__)

    def __init__(self: Any, *arguments: Any, **keywords: Any) -> None:
        arguments, keywords = _unwrapped(arguments, keywords)
        self._awaiting = of(*arguments, **keywords)

    members: dict[str, Any] = {"__doc__": of.__doc__, "__module__": __name__, "__slots__": ()}
    if "__new__" in vars(of):
        members["__init__"] = __init__
    for name, there in vars(of).items():
        if name in ("__aenter__", "__aexit__"):
            members[name.replace("a", "", 1)] = method(name, there)
        elif name in ("__enter__", "__exit__", "__len__"):
            members[name] = method(name, there)
        elif isinstance(there, staticmethod):
            members[name] = function(there.__func__)
        elif not name.startswith("_"):
            members[name] = method(name, there) if callable(there) else field(name, there)
    _waiting[of] = type(of.__name__, (_Waiting,), members)
    return _waiting[of]


Arm = _class(_native.Arm)
AsynchronousControl = _class(_native.AsynchronousControl)
Gripper = _class(_native.Gripper)
IdentificationPlan = _class(_native.IdentificationPlan)
Recorder = _class(_native.Recorder)
Robot = _class(_native.Robot)
Team = _class(_native.Team)
TeamGrasp = _class(_native.TeamGrasp)
VacuumGripper = _class(_native.VacuumGripper)


def _run(self: Any, motions: Sequence[Callable[[_native.Arm], _native.Motion | _native.Follow]]) -> Any:
    """Moves all arms, which begin together. Each function gets its arm as the class of ``franka_async``, and returns a
    motion that has not begun. Returns and raises as ``move_to``.
    """
    arms = self._awaiting.arms
    if len(motions) != len(arms):
        raise TypeError(f"got {len(motions)} motions, expected {len(arms)}: one for each arm")
    return _result(self._awaiting.run([motion(arm) for motion, arm in zip(motions, arms, strict=True)]))


Team.run = _run

from . import tools  # noqa: E402 - it names the classes above
