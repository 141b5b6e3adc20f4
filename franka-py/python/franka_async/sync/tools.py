"""The functions of ``franka_async.tools``, which wait here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..tools import Tool, ToolFileError, delete, get, names, path, save
from ..tools import _IDENTITY, _found

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from . import Robot

__all__ = ["Tool", "ToolFileError", "delete", "get", "identify", "load", "names", "path", "save", "unload"]


def load(robot: Robot, tool: str | Tool) -> Tool:
    """As ``franka_async.tools.load``."""
    chosen = get(tool) if isinstance(tool, str) else tool
    robot.set_load(chosen.mass, chosen.center, chosen.inertia)
    robot.set_ee(chosen.pose)
    return chosen


def unload(robot: Robot) -> None:
    """As ``franka_async.tools.unload``."""
    load(robot, Tool())


def identify(robot: Robot, *, frame: ArrayLike = _IDENTITY) -> Tool:
    """As ``franka_async.tools.identify``."""
    return _found(robot.identify().run(), frame)
