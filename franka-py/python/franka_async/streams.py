"""Streams of states and events."""

from __future__ import annotations

from typing import Generic, NamedTuple, TypeVar

from ._native import RobotState, Source

__all__ = ["Reading", "Stream"]

T = TypeVar("T")


class Stream(Generic[T]):
    """Items as they come: ``async for`` in a coroutine, plain ``for`` on a thread without an event loop.

    It ends when the connection does. No item is lost where the waiting for it is cancelled or times out: the next ``anext()``
    returns it. Several tasks may share one; each item goes to one of them.
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
            # Nothing else runs in this thread between the two.
            taken = self._source.take()
            if taken is not None:
                item: T = taken[0]
                return item

    def __iter__(self) -> Stream[T]:
        return self

    def __next__(self) -> T:
        return self.next()

    def next(self, timeout: float | None = None) -> T:
        """Waits for the next item on this thread, with the interpreter released, and returns it.

        Raises ``StopIteration`` at the end, and ``TimeoutError`` after ``timeout`` seconds. The next call then returns the item.
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
    """A state, with the number of missing states before it."""

    state: RobotState
    """The state."""

    missed: int
    """Number of states that the robot sent between the previous state of the stream, or the beginning of the stream, and this
    one."""
