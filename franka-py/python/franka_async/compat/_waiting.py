"""Functions that wait for operations and for the next item, on any thread, even on a thread that runs an event loop."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")

SILENCE = 1.0
"""Longest silence of a robot, s."""

_PAUSE = 0.0002


def wait(operation: Any) -> Any:
    """Waits for an operation, and returns its result. The interpreter is released for other threads.

    A notebook runs its cells on a thread with an event loop. In this case another thread waits for the operation. The event
    loop is blocked meanwhile, as in the original packages.
    """
    if not _in_event_loop():
        return operation.wait()
    outcome: list[Any] = []

    async def await_it() -> Any:
        return await operation

    def run() -> None:
        asyncio.set_event_loop(loop)
        try:
            outcome.append((True, loop.run_until_complete(task)))
        except BaseException as error:  # noqa: BLE001  (raised by the thread that waits)
            outcome.append((False, error))

    loop = asyncio.new_event_loop()
    task = loop.create_task(await_it())
    thread = threading.Thread(target=run, name="franka_async.compat", daemon=True)
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.05)  # Python handles signals between two waits.
    except BaseException:
        loop.call_soon_threadsafe(task.cancel)
        thread.join()
        raise
    finally:
        loop.close()
    succeeded, result = outcome[0]
    if succeeded:
        return result
    raise result


def _in_event_loop() -> bool:
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return False
    return True


def changed(read: Callable[[], T], when: Callable[[T], Any]) -> T | None:
    """Returns the result of ``read()`` once ``when(result)`` has changed; ``None`` if it does not change within
    :data:`SILENCE`.
    """
    before = when(read())
    end = time.monotonic() + SILENCE
    while time.monotonic() < end:
        newest = read()
        if when(newest) != before:
            return newest
        time.sleep(_PAUSE)
    return None
