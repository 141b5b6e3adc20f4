"""Target control: the robot moves to the newest target, and the program moves the target at its own rate."""

from __future__ import annotations

import contextlib
import threading
import time
import warnings
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ... import _native
from ...goal import Joints
from ...pose import from_xyzw
from .._waiting import wait
from ._errors import FrankaError, translated
from ._rotation import Array, normalised, numbers, rotated_by, vector

_STOPPED = (
    "franka: this target control was stopped; start a new one with Robot.cartesian_targets() or Robot.joint_targets()."
)


_HELD = 5.0
"""Seconds without progress after which the arm counts as held."""

_COMES_FURTHER = 5e-3
"""Change of a joint of the reference that counts as progress, rad. An arm slower than 1 mrad/s counts as held."""


class _Targets:
    """A session. It runs from the call that creates it, with or without ``with``."""

    def __init__(self, robot: _native.Robot, arm: _native.Arm, target: Array) -> None:
        self._robot = robot
        self._arm = arm
        self._lock = threading.Lock()
        self._target = target
        self._is_stopped = False
        # Number of the newest call of `follow`. Older calls end.
        self._following = 0

    def _locked(self) -> threading.Lock:
        self._arm.reference()  # Raises in a forked child, where a thread that does not exist there may hold the lock.
        return self._lock

    def _goal(self, target: Array) -> Any:
        raise NotImplementedError

    def _absolute(self, values: npt.ArrayLike) -> Array:
        raise NotImplementedError

    def _moved(self, delta: npt.ArrayLike) -> Array:
        raise NotImplementedError

    def _set(self, target: Array) -> None:
        if not self.running:
            raise FrankaError(_STOPPED)
        try:
            with translated():
                self._arm.try_set(self._goal(target))
        except FrankaError as error:
            if error.kind == "invalid_argument":
                raise
            # The session ended after the last check.
            raise FrankaError(_STOPPED) from error
        self._target = target

    def move_to(self, target: npt.ArrayLike) -> None:
        """Moves the target to a new place. This never waits."""
        with self._locked():
            self._following += 1
            self._set(self._absolute(target))

    def move_by(self, delta: npt.ArrayLike) -> None:
        """Moves the target relative to its current place. This never waits."""
        with self._locked():
            self._following += 1
            self._set(self._moved(delta))

    def follow(self, chunk: npt.ArrayLike, dt: float = 0.02) -> None:
        """Moves the target along the rows in the background: to the first row now, then to one row every ``dt`` seconds. A
        newer call ends this, and so does a row that cannot be reached.
        """
        if not (dt > 0.0 and np.isfinite(dt)):
            raise ValueError(f"franka: dt must be positive, got {dt}")
        rows = np.array(chunk, dtype=np.float64)
        if rows.ndim != 2:
            raise TypeError(f"franka: a chunk has rows of targets, got the shape {rows.shape}")
        with self._locked():
            targets = [self._absolute(row) for row in rows]
            self._following += 1
            mine = self._following
            if not targets:
                return
            self._set(targets[0])
        background = threading.Thread(target=self._follow, args=(rows[1:], dt, mine), name="franka follow", daemon=True)
        background.start()

    def _follow(self, rows: Array, dt: float, mine: int) -> None:
        due = time.monotonic()
        for row in rows:
            due += dt
            time.sleep(max(0.0, due - time.monotonic()))
            with self._lock, contextlib.suppress(FrankaError, ValueError):
                if self._following != mine:
                    return
                self._set(self._absolute(row))
                continue
            return

    def _check_not_stopped(self) -> None:
        if self._is_stopped:
            raise FrankaError(_STOPPED)

    def target(self) -> Array:
        """Returns the target, (7,)."""
        self._check_not_stopped()
        return self._target.copy()

    def state(self) -> _native.RobotState:
        """Returns the newest state, without waiting."""
        self._check_not_stopped()
        with translated():
            return self._robot.state()

    @property
    def running(self) -> bool:
        """True while the session runs."""
        return not self._is_stopped and self._arm.reference() is not None

    def stop(self) -> None:
        """Waits until the arm rests at the last target, or until something has held the arm for five seconds without
        progress; then ends the session. Raises the error if the session had already ended with one. After the first call,
        this has no effect.
        """
        with self._locked():
            self._following += 1
            if self._is_stopped:
                return
            self._is_stopped = True
        with translated():
            self._wait_for_rest()
            wait(self._arm.disengage())

    def _wait_for_rest(self) -> None:
        since = self._robot.state().time
        before: Array | None = None
        while not wait(self._arm.at_rest(timeout=1.0)):
            reference = self._arm.reference()
            if reference is None:
                return
            if before is None or np.abs(reference.q - before).max() > _COMES_FURTHER:
                since, before = self._robot.state().time, reference.q
            elif self._robot.state().time - since > _HELD:
                return

    def __enter__(self) -> Any:
        return self

    def __exit__(self, kind: object, *_rest: object) -> Literal[False]:
        try:
            self.stop()
        except FrankaError as error:
            if kind is None:
                raise
            warnings.warn(f"target control ended in an error: {error}", RuntimeWarning, stacklevel=2)
        return False

    def __repr__(self) -> str:
        return f"{type(self).__name__}(running={str(self.running).lower()})"


class CartesianTargets(_Targets):
    """A session with targets of the end effector: position, m, and quaternion x y z w, in the base frame."""

    def _goal(self, target: Array) -> Any:
        return target

    def _absolute(self, values: npt.ArrayLike) -> Array:
        array = vector("a Cartesian target", values)
        if array.size not in (3, 7):
            raise ValueError(
                "franka: a Cartesian target has 3 elements (x, y, z in m) or 7 (plus a unit quaternion x, y, z, w), "
                f"got {array.size}"
            )
        target = numbers("a target", array, 3, 7)
        orientation = normalised(target[3:]) if len(target) == 7 else self._target[3:]
        return np.append(target[:3], orientation)

    def _moved(self, delta: npt.ArrayLike) -> Array:
        way = numbers("a Cartesian delta", delta, 3, 6)
        orientation = normalised(rotated_by(self._target[3:], way[3:])) if len(way) == 6 else self._target[3:]
        return np.append(self._target[:3] + way[:3], orientation)

    def target_pose(self) -> Array:
        """Returns the target as a pose, (4, 4)."""
        self._check_not_stopped()
        return from_xyzw(self._target[:3], self._target[3:])


class JointTargets(_Targets):
    """A session with joint targets, (7,), rad."""

    def _goal(self, target: Array) -> Any:
        return Joints(target)

    def _absolute(self, values: npt.ArrayLike) -> Array:
        return numbers("a joint target", values, 7)

    def _moved(self, delta: npt.ArrayLike) -> Array:
        return self._target + numbers("a joint delta", delta, 7)
