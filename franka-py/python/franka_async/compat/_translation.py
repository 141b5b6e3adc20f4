"""Exceptions of the originals in the place of those of this package."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

from .. import errors


def translation(exception: Callable[[errors.FrankaError], Exception]) -> Callable[[], AbstractContextManager[None]]:
    """Returns a context that raises what ``exception`` makes of the exceptions of this package, which are its cause."""

    @contextmanager
    def translated() -> Iterator[None]:
        try:
            yield
        except errors.FrankaError as error:
            raise exception(error) from error

    return translated
