"""Targets from an asynchronous iterator."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterable, Awaitable, Callable
from typing import TYPE_CHECKING, Any

from ._native import Latest

if TYPE_CHECKING:
    from .goal import Target
    from .motion import MotionReport

__all__ = ["follow"]


async def follow(
    begin: Callable[..., Awaitable[MotionReport]], targets: AsyncIterable[Target], options: dict[str, Any] | None
) -> MotionReport:
    """Awaits ``begin(latest, **options)``, while a task in the event loop sets ``latest`` to each new target of ``targets``.

    An exception in ``targets`` brakes the arm and is raised. Cancelling ends both the motion and the task.
    """
    latest = Latest()

    async def feed() -> None:
        async for target in targets:
            latest.set(target)
        latest.close()

    motion = asyncio.ensure_future(begin(latest, **(options or {})))
    feeding = asyncio.ensure_future(feed())
    both = {motion, feeding}
    try:
        await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
        if feeding.done():
            feeding.result()
        return await motion
    finally:
        for task in both:
            task.cancel()
        await asyncio.gather(*both, return_exceptions=True)
