"""Tools on the flange, by name: they are saved in a file and declared to a robot.

    tool = await tools.identify(robot)            # a minute of small motions, with the tool on
    tools.save("screwdriver", tool)
    await tools.load(robot, "screwdriver")        # in this or a later program
    await tools.unload(robot)                     # the flange is bare again

The file is ``franka_async/tools.json`` in the user's configuration directory, ``$XDG_CONFIG_HOME`` or ``~/.config``; the
variable ``FRANKA_TOOLS`` names another one. The file is written completely or not at all. A program that reads it meanwhile
finds the old file.
"""

from __future__ import annotations

import json
import math
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._native import Robot

__all__ = ["Tool", "ToolFileError", "delete", "get", "identify", "load", "names", "path", "save", "unload"]

_VERSION = 1


class ToolFileError(ValueError):
    """The file of tools cannot be used as it is. This package has not changed it."""


def _matrix(name: str, value: ArrayLike, shape: tuple[int, ...]) -> tuple[Any, ...]:
    array = np.asarray(value, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name} has the shape {array.shape}, expected {shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} holds {array[~np.isfinite(array)][0]}, expected finite numbers")
    rows = array.tolist()
    return tuple(tuple(row) if isinstance(row, list) else row for row in rows)


_IDENTITY = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


@dataclass(frozen=True, kw_only=True)
class Tool:
    """A tool on the flange, in addition to the end effector that is configured on the robot.

    Raises ``ValueError`` for values that no tool has.
    """

    mass: float = 0.0
    """Mass, kg."""

    center: ArrayLike = (0.0, 0.0, 0.0)
    """Centre of mass in the flange frame, 3 numbers, m."""

    inertia: ArrayLike = ((0.0,) * 3,) * 3
    """Inertia about the centre of mass, a matrix of 3 rows, kg m^2."""

    frame: ArrayLike = _IDENTITY
    """``NE_T_EE``: the pose of the end effector in the frame of the nominal end effector, 4 x 4."""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mass) and 0.0 <= self.mass):
            raise ValueError(f"mass is {self.mass}, expected a finite number of 0 or more")
        for name, shape in (("center", (3,)), ("inertia", (3, 3)), ("frame", (4, 4))):
            object.__setattr__(self, name, _matrix(name, getattr(self, name), shape))
        object.__setattr__(self, "mass", float(self.mass))
        if not np.array_equal(np.transpose(np.asarray(self.inertia)), np.asarray(self.inertia)):
            raise ValueError(f"inertia is {self.inertia}, expected a symmetric matrix")
        least, middle, greatest = np.linalg.eigvalsh(np.asarray(self.inertia)).tolist()
        # The same tolerance as the driver's, because states have single precision, and their loads become tools.
        rounding = 1e-9 + 1e-6 * float(np.abs(self.inertia).max())
        if least < -rounding or greatest > least + middle + rounding:
            moments = f"{round(least, 6):g}, {round(middle, 6):g} and {round(greatest, 6):g} kg m^2"
            raise ValueError(f"inertia has the principal moments {moments}, expected no moment below 0 and no moment above the sum of the other two")
        rotation = self.pose[:3, :3]
        if not (np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6) and np.linalg.det(rotation) > 0):
            raise ValueError(f"frame is {self.frame}, expected a rigid transformation")
        if self.pose[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
            raise ValueError(f"frame ends with the row {self.pose[3]}, expected (0, 0, 0, 1)")

    @property
    def pose(self) -> NDArray[np.float64]:
        """Returns ``frame`` as a new array, ``(4, 4)``."""
        return np.array(self.frame)


def path() -> Path:
    """Returns the path of the file, which may not exist yet."""
    chosen = os.environ.get("FRANKA_TOOLS")
    if chosen:
        return Path(chosen)
    home = os.environ.get("XDG_CONFIG_HOME")
    # The specification of these directories requires programs to ignore relative paths.
    base = Path(home) if home and os.path.isabs(home) else Path.home() / ".config"
    return base / "franka_async" / "tools.json"


def names() -> list[str]:
    """Returns the names of all tools, in order."""
    return sorted(_read())


def get(name: str) -> Tool:
    """Returns the tool with this name. Raises ``KeyError``, which lists the existing names."""
    tools = _read()
    if name not in tools:
        known = ", ".join(sorted(tools)) or "none"
        raise KeyError(f"got the tool {name!r}, expected a tool of {path()}: {known}")
    return tools[name]


def save(name: str, tool: Tool) -> None:
    """Saves a tool under this name, in place of any previous tool with this name."""
    if not name or name != name.strip():
        raise ValueError(f"got the name {name!r}, expected text without blanks around it")
    tools = _read()
    tools[name] = tool
    _write(tools)


def delete(name: str) -> None:
    """Deletes the tool with this name. Raises ``KeyError`` as ``get`` does."""
    get(name)
    tools = _read()
    del tools[name]
    _write(tools)


async def load(robot: Robot, tool: str | Tool) -> Tool:
    """Declares a tool to the robot: its load, and the frame of the end effector. ``tool`` is a name or a ``Tool``. Returns
    the ``Tool``.

    The robot refuses this during a motion (``CommandError``). If the robot accepts the load and then refuses the frame, the
    load stays declared. If this call is cancelled, the robot may have accepted only the load; call it again.
    """
    chosen = get(tool) if isinstance(tool, str) else tool
    await robot.set_load(chosen.mass, chosen.center, chosen.inertia)
    await robot.set_ee(chosen.pose)
    return chosen


async def unload(robot: Robot) -> None:
    """Removes the declared tool from the robot: no load, and the frame of the nominal end effector. Raises as ``load`` does."""
    await load(robot, Tool())


async def identify(robot: Robot, *, frame: ArrayLike = _IDENTITY) -> Tool:
    """Measures the load on the flange with a minute of small motions, as ``robot.identify()`` plans them. Returns the load
    as a tool.

    A declared load is part of the result. This declares and saves nothing. The inertia is not measured, so it is zero.
    Raises ``IdentifyError``, ``MotionError``, and ``ValueError`` if the load is too light to be detected. Cancelling brakes
    the arm.
    """
    return _found(await robot.identify().run(), frame)


def _found(found: Identified, frame: ArrayLike) -> Tool:
    if found.center is None:
        raise ValueError(
            f"found {found.mass:.3f} kg with a deviation of {found.mass_deviation:.3f} kg: too light to be a tool"
        )
    return Tool(mass=found.mass, center=found.center, frame=frame)


def _read() -> dict[str, Tool]:
    file = path()
    try:
        text = file.read_text(encoding="utf-8")
    except FileNotFoundError:
        return {}
    except UnicodeDecodeError as error:
        raise ToolFileError(f"{file} is not a text file: {error}") from None
    try:
        content = json.loads(text)
    except json.JSONDecodeError as error:
        raise ToolFileError(f"{file}, line {error.lineno}, column {error.colno}: {error.msg}") from None
    if not isinstance(content, dict) or not isinstance(content.get("tools"), dict):
        raise ToolFileError(f'{file}: expected an object with "version" and "tools"')
    if content.get("version") != _VERSION:
        raise ToolFileError(f"{file}: got the version {content.get('version')!r}, expected {_VERSION}")
    tools = {}
    for name, fields in content["tools"].items():
        try:
            tools[name] = Tool(**fields)
        except (TypeError, ValueError) as error:
            raise ToolFileError(f"{file}, tool {name!r}: {error}") from None
    return tools


def _write(tools: dict[str, Tool]) -> None:
    file = path()
    content = {
        "version": _VERSION,
        "tools": {
            name: {"mass": tool.mass, "center": tool.center, "inertia": tool.inertia, "frame": tool.frame}
            for name, tool in sorted(tools.items())
        },
    }
    file.parent.mkdir(parents=True, exist_ok=True)
    # The temporary file is in the same directory, so that it replaces the file in one step.
    descriptor, draft = tempfile.mkstemp(dir=file.parent, prefix=".tools-", suffix=".json")
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8") as out:
            json.dump(content, out, indent=2)
            out.write("\n")
            out.flush()
            os.fsync(out.fileno())
        os.replace(draft, file)
    except BaseException:
        os.unlink(draft)
        raise
