"""Streams of states and events."""

from __future__ import annotations

from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._native import RobotState, Source

__all__ = ["Reading", "Stream", "TaredState"]

T = TypeVar("T")


class Stream(Generic[T]):
    """Iterator over items as they arrive: ``async for`` in a coroutine, plain ``for`` on a thread without an event loop.

    The stream ends with the connection. If a wait is cancelled or times out, no item is lost: the next ``anext()`` returns
    it. Several tasks may share a stream; each item then goes to one of the tasks.
    """

    def __init__(self, source: Source) -> None:
        self._source = source

    def __repr__(self) -> str:
        return "<Stream: items as they come, by 'async for' or 'for'>"

    def __aiter__(self) -> Stream[T]:
        return self

    async def __anext__(self) -> T:
        while True:
            await self._source.ready()
            # No other code runs in this thread between ``ready`` and ``take``.
            taken = self._source.take()
            if taken is not None:
                item: T = taken[0]
                return item

    def __iter__(self) -> Stream[T]:
        return self

    def __next__(self) -> T:
        return self.next()

    def next(self, timeout: float | None = None) -> T:
        """Waits for the next item on this thread, and returns it. The interpreter is released meanwhile.

        Raises ``StopIteration`` at the end, and ``TimeoutError`` after ``timeout`` seconds. The next call then returns the
        item.
        """
        while True:
            self._source.ready().wait(timeout)
            try:
                taken = self._source.take()
            except StopAsyncIteration:
                raise StopIteration from None
            if taken is not None:
                item: T = taken[0]
                return item


class Reading(NamedTuple):
    """A state, and the number of missing states before it."""

    state: RobotState
    """The state."""

    missed: int
    """Number of states that the robot sent before this state and that the stream does not contain. They are counted from the
    previous state of the stream, or from its beginning."""


class TaredState(NamedTuple):
    """A state, and its external wrench minus a tare."""

    state: RobotState
    """The state, as the robot reports it."""

    wrench: NDArray[np.float64] | None
    """Wrench minus the tare, as ``WrenchTare.compensate`` returns it. ``None`` if the robot has no estimate."""

    turned: float
    """Largest change of a joint since the tare, rad: beyond ``WrenchTare.NEAR``, take a new tare."""
